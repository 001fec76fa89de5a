// SPDX-License-Identifier: GPL-3.0-or-later
// The functions whose last bits C libraries do not agree on, the same everywhere: SLEEF's plain C
// code, without fused products, within 1 unit in the last place. States, meshes and curves are made
// of these alone; a test of the house sees to it. (sqrt, fma, fmod and such are exact by standard.)
#pragma once

namespace swage::portable {

double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double exp(double x);
double expm1(double x);
double log(double x);
double log10(double x);
double pow(double x, double y);
double hypot(double x, double y);

}  // namespace swage::portable

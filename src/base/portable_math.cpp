// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/portable_math.h"

#include <sleef.h>

namespace swage::portable {

double sin(double x) { return Sleef_sind1_u10purec(x); }
double cos(double x) { return Sleef_cosd1_u10purec(x); }
double tan(double x) { return Sleef_tand1_u10purec(x); }
double asin(double x) { return Sleef_asind1_u10purec(x); }
double acos(double x) { return Sleef_acosd1_u10purec(x); }
double atan(double x) { return Sleef_atand1_u10purec(x); }
double atan2(double y, double x) { return Sleef_atan2d1_u10purec(y, x); }
double exp(double x) { return Sleef_expd1_u10purec(x); }
double expm1(double x) { return Sleef_expm1d1_u10purec(x); }
double log(double x) { return Sleef_logd1_u10purec(x); }
double log10(double x) { return Sleef_log10d1_u10purec(x); }
double pow(double x, double y) { return Sleef_powd1_u10purec(x, y); }
double hypot(double x, double y) { return Sleef_hypotd1_u05purec(x, y); }

}  // namespace swage::portable

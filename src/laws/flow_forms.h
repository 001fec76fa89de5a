// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of flow curves, e the plastic strain, as points of one in straight lines:
//
//     K (e0 + e)^n                     H. Swift, "Plastic instability under plane stress", J. Mech.
//                                      Phys. Solids 1, 1952
//     A + B e^n                        P. Ludwik, "Elemente der technologischen Mechanik", 1909;
//                                      Johnson & Cook 1983 at rest and at room temperature
//     s0 + Q (1 - exp(-b e))           E. Voce, "The relationship between stress and strain for
//                                      homogeneous deformation", J. Inst. Metals 74, 1948
//
// The lines stay within kFormError of the form up to a strain of kFormEnd, and are flat from there
// on: some 150 to 700 points, thousands where a form is very steep. NOTE: a law of its own for each
// form would ask for a power in every round of a search, in every cell, to gain what no data sheet
// knows.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/portable_math.h"
#include "laws/flow_curve.h"

namespace swage {

inline constexpr double kFormError = 1e-5;  // of the stress
inline constexpr double kFormEnd = 10;

struct SwiftForm {
    double K, e0, n;  // [Pa], > 0; > 0; > 0 to 1
    double operator()(double e) const { return K * portable::pow(e0 + e, n); }
};
struct LudwikForm {
    double A, B, n;  // [Pa], > 0; [Pa], >= 0; > 0 to 1
    double operator()(double e) const { return A + (e > 0 ? B * portable::pow(e, n) : 0.0); }
};
struct VoceForm {
    double s0, Q, b;  // [Pa], > 0; [Pa], >= 0; > 0
    double operator()(double e) const { return s0 - Q * portable::expm1(-b * e); }
};

template <typename Form>
std::vector<FlowPoint> points_of(const Form& form) {
    // Looked at more closely where a line begins, as powers are steepest there.
    constexpr int kLooks = 8;
    constexpr double kSafe = 0.9, kLonger = 1.3, kShorter = 0.85;
    std::vector<FlowPoint> point = {{0, form(0)}};
    for (double length = kFormEnd; point.back().strain < kFormEnd;) {
        const auto& [strain, stress] = point.back();
        length = std::min(kLonger * length, kFormEnd - strain);
        const auto fits = [&] {
            const double rise = form(strain + length) - stress;
            for (int look = 1; look < kLooks; ++look) {
                const double share = double(look * look) / (kLooks * kLooks),
                             is = form(strain + share * length);
                if (std::abs(stress + share * rise - is) > kSafe * kFormError * is) return false;
            }
            return true;
        };
        while (!fits()) length *= kShorter;
        const double end = strain + length < kFormEnd ? strain + length : kFormEnd;
        point.push_back({end, form(end)});
    }
    return point;
}

}  // namespace swage

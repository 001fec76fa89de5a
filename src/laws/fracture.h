// SPDX-License-Identifier: GPL-3.0-or-later
// Fracture from strength and toughness. A cell whose largest strain reaches s_0 acts as its 24
// plain connections from then on (k of laws/spring_damper.h, edges 1/4 and diagonals 1/2 of it, at
// the cell's share of material), and each of these softens by its own strain s:
//
//     w = max(s, the largest s so far)
//     1 - D = 1                                   w <= s_1
//             s_1 (s_f - w) / (w (s_f - s_1))     s_1 < w < s_f
//             0                                   w >= s_f: the connection is broken
//     T = (1 - D) k l s                           tension [N], l its rest_length
//     lost = k l^2 s_1 s_f (w - s_1) / (2 (s_f - s_1))     [J]; k l^2 s_1 s_f / 2 of a broken one
//
// Unloading goes to the origin. An edge that is pressed has all its stiffness, broken or not: a
// closed crack carries pressure without friction. Broken diagonals are gone: they would glue it.
// The two diagonals of a face go together, for alone the one that softens more would let the other
// carry all, and the sides slide apart. With m the mean of their strains, d half the difference,
//
//     s^2 = m+^2 + kSlide (d - m-)^2 + (kSlant - kSlide) min(m+, d)^2
//
// m+ what they are pulled on the whole, m- pressed, d - m- at least 0. A face that opens aslant
// has m = d, one that slides m = 0: kSlide gives sliding along a (100) plane the toughness that
// opening it has. Pressed, it softens by what one of the two is still pulled.
//
//     s_0 = sigma / E      sigma = min(sigma_f, sqrt(E G_c / (kLeastReach a)))
//     s_1 = s_0 / 2        s_f = G_c / (1.8 a E s_1)
//
// G_c: energy of parting a (100) plane, 1 edge and 4 diagonals of k = 0.4 E a over each a^2, all
// opened to s_f: 1.8 E a s_1 s_f. Equal strain, not equal elongation, for edges and diagonals: else
// cracks lock onto the one or the other. Nothing is added for the lattice: with l_c = E G_c /
// sigma^2, a crack asks 1.01 G_c along the axis at l_c / a = 4 and 8, and 1.15 and 1.09 along a
// diagonal (kSlant = 5; 1.24 by the larger of the two strains); 1.09 and 1.6 at 2
// (`swage verify crack`).
//
// NOTE: s_1 = s_0, with no cell law before it, is the simpler choice; but diagonals across a plane
// that opens strain half as much as edges, so the plane would carry up to twice sigma_f, and a bar
// that is pulled would be damaged all along before it parts. With s_1 = s_0 / 2 the plane carries
// 0.9 sigma_f once its cells have turned into springs.
// NOTE: where a spacing cannot resolve the softening (l_c / a < kLeastReach) the strength is
// lowered and the toughness kept: a crack then runs at the right load, a smooth body breaks at too
// low a one.
//
// Sources: crack band (Bazant, Oh, Materials and Structures 16, 155, 1983), cohesive crack
// (Hillerborg, Modeer, Petersson, Cement and Concrete Research 6, 773, 1976).
#pragma once

#include <algorithm>
#include <cmath>

namespace swage {

struct Fracture {
    double onset = 0;   // s_0; 0: nothing ever breaks
    double peak = 0;    // s_1
    double broken = 0;  // s_f
};

inline constexpr double kLeastReach = 4;
inline constexpr double kSlant = 5;
inline constexpr double kSlide = 4.0 / 9;

// l_c [m]; a spacing of l_c / kLeastReach and below gives the material its whole strength.
inline double fracture_reach(double young_modulus, double strength, double toughness) {
    return young_modulus * toughness / (strength * strength);
}

// The strength [Pa] that a spacing can give the material.
inline double strength_at(double young_modulus, double strength, double toughness, double spacing) {
    return std::min(strength, std::sqrt(young_modulus * toughness / (kLeastReach * spacing)));
}

inline Fracture fracture_law(double young_modulus, double strength, double toughness,
                             double spacing) {
    const double onset = strength_at(young_modulus, strength, toughness, spacing) / young_modulus;
    return {onset, 0.5 * onset, toughness / (1.8 * spacing * young_modulus * 0.5 * onset)};
}

// The strain by which the two diagonals of a face soften.
inline double face_strain(double one, double other) {
    const double mean = 0.5 * (one + other), half = 0.5 * std::abs(one - other);
    const double pulled = std::max(0.0, mean), both = std::min(pulled, half);
    const double slid = mean < 0 ? std::max(0.0, half + mean) : half;
    return std::sqrt(pulled * pulled + kSlide * slid * slid + (kSlant - kSlide) * both * both);
}

// 1 - D after the largest strain w.
template <typename Number>
Number kept_share(const Fracture& law, const Number& w) {
    if (w <= law.peak) return Number(1);
    if (w >= law.broken) return Number(0);
    return law.peak * (law.broken - w) / (w * (law.broken - law.peak));
}

// The largest strain so far, of a connection with this D.
inline double worst_strain(const Fracture& law, double damage) {
    return law.peak * law.broken / (law.peak + (1 - damage) * (law.broken - law.peak));
}

// T / (k l) at strain s after w.
template <typename Number>
Number softened_strain(const Fracture& law, const Number& w, const Number& s) {
    if (s <= 0) return s;
    return kept_share(law, s > w ? s : w) * s;
}

// Stored energy over k l^2.
template <typename Number>
Number softened_energy(const Fracture& law, const Number& w, const Number& s) {
    return 0.5 * softened_strain(law, w, s) * s;
}

// Lost energy over k l^2.
template <typename Number>
Number fracture_loss(const Fracture& law, const Number& w) {
    if (w <= law.peak) return Number(0);
    const Number most = w < law.broken ? w : Number(law.broken);
    return 0.5 * law.peak * law.broken * (most - law.peak) / (law.broken - law.peak);
}

}  // namespace swage

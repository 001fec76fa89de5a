// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of the matter on a skin: a number for each vertex, of the matter that it is mounted on.
//
//     plastic_strain    [1]   alpha, the accumulated equivalent plastic strain: the integral of
//                             sqrt(2/3 d : d) over time, d the rate of plastic strain; as committed
//     stress            [Pa]  equivalent stress after von Mises, sqrt(3/2 s : s), s = sigma + p
//     pressure          [Pa]  p = -tr(sigma) / 3: above 0 where matter is pressed
//     principal_stress  [Pa]  the largest eigenvalue of sigma: above 0 where it is pulled
//     yield_use         [1]   stress over that at which it flows now, as its law has both: less the
//                             back stress; 1: it flows
//     strength_use      [1]   E times the largest principal strain over the strength, which is the
//                             measure of laws/fracture.h; 1: it breaks, or has broken
//
// sigma is Cauchy's stress, force over area as it is now, of the elastic strain that there is; what
// damps a motion and what keeps a crushed cell from turning inside out are not in it. Where it is
// known is told by matter/stress_sample.h, how it comes to vertices by skin/skin_fields.h.
//
// Source of the first four: e.g. J. Simo, T. Hughes, "Computational Inelasticity", 1998, ch. 2.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace swage {

enum class SkinField {
    plastic_strain,
    stress,
    pressure,
    principal_stress,
    yield_use,
    strength_use,
};

struct SkinFieldWords {
    const char* name;   // in files
    const char* title;  // on pictures
    const char* unit;   // empty: a plain number
    bool is_signed;
};
inline constexpr std::array<SkinFieldWords, 6> kSkinFieldWords = {{
    {"plastic_strain", "plastic strain", "", false},
    {"stress", "von Mises stress", "Pa", false},
    {"pressure", "pressure", "Pa", true},
    {"principal_stress", "largest principal stress", "Pa", true},
    {"yield_use", "use of yield stress", "", false},
    {"strength_use", "use of strength", "", false},
}};
inline const SkinFieldWords& words_of(SkinField field) {
    return kSkinFieldWords[static_cast<std::size_t>(field)];
}
inline std::optional<SkinField> skin_field_named(std::string_view name) {
    for (std::size_t n = 0; n < kSkinFieldWords.size(); ++n) {
        if (name == kSkinFieldWords[n].name) return static_cast<SkinField>(n);
    }
    return std::nullopt;
}

// By field, then by vertex.
using SkinFieldValues = std::vector<std::vector<float>>;

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of the matter on a skin: a number for each vertex, of the matter that it is mounted on.
//
//     plastic_strain    [1]   alpha, the accumulated equivalent plastic strain: the integral of
//                             sqrt(2/3 d : d) over time, d the rate of plastic strain; as committed
//     stress            [Pa]  equivalent stress after von Mises, sqrt(3/2 s : s), s = sigma + p
//     pressure          [Pa]  p = -tr(sigma) / 3: above 0 where matter is pressed
//     principal_stress  [Pa]  the largest eigenvalue of sigma: above 0 where it is pulled
//
// sigma is Cauchy's stress, force over area as it is now, of the elastic strain that there is; what
// damps a motion and what keeps a crushed cell from turning inside out are not in it. Where it is
// known is told by matter/stress_sample.h, how it comes to vertices by skin/skin_fields.h.
//
// Source of the four: e.g. J. Simo, T. Hughes, "Computational Inelasticity", 1998, ch. 2.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace swage {

enum class SkinField { plastic_strain, stress, pressure, principal_stress };

struct SkinFieldWords {
    const char* name;   // in files
    const char* title;  // on pictures
    const char* unit;   // empty: a plain number
    bool is_signed;
};
inline constexpr std::array<SkinFieldWords, 4> kSkinFieldWords = {{
    {"plastic_strain", "plastic strain", "", false},
    {"stress", "von Mises stress", "Pa", false},
    {"pressure", "pressure", "Pa", true},
    {"principal_stress", "largest principal stress", "Pa", true},
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

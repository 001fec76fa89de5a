// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes and records call a material's mechanics and its law.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "matter/material.h"

namespace swage {

template <typename T>
using NameList = std::vector<std::pair<std::string, T>>;

inline const NameList<Mechanics> kMechanicsNames = {{"cells", Mechanics::cells},
                                                    {"springs", Mechanics::springs}};
inline const NameList<Elasticity> kElasticityNames = {{"hencky", Elasticity::hencky},
                                                      {"neo-hookean", Elasticity::neo_hookean},
                                                      {"storakers", Elasticity::storakers}};

template <typename T>
const std::string& name_in(const NameList<T>& names, T what) {
    std::size_t n = 0;
    while (names.at(n).second != what) ++n;
    return names[n].first;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/material_volumes.h"

namespace swage {

std::vector<double> material_volumes(const Aggregate& matter) {
    std::vector<double> volume(matter.material_count(), 0.0);
    auto mixed = matter.mixed_cell.begin();
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        const double whole = matter.cell_fill[c];
        const auto cell = static_cast<CellId>(c);
        if (mixed == matter.mixed_cell.end() || mixed->cell != cell) {
            volume[matter.material_number(cell)] += whole;
            continue;
        }
        const double sum = double(mixed->fill[0]) + mixed->fill[1];
        for (int m : {0, 1}) volume[mixed->material[m]] += whole * mixed->fill[m] / sum;
        ++mixed;
    }
    const double a = matter.lattice.spacing;
    for (double& v : volume) v *= a * a * a;
    return volume;
}

std::vector<double> material_masses(const Aggregate& matter) {
    std::vector<double> mass = material_volumes(matter);
    for (std::size_t m = 0; m < mass.size(); ++m) mass[m] *= matter.material_at(m).density;
    return mass;
}

}  // namespace swage

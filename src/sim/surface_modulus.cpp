// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/surface_modulus.h"

#include <algorithm>

#include "laws/spring_moduli.h"
#include "matter/mixed_place.h"

namespace swage {

double pressed_modulus(const Material& material, Solver solver) {
    const bool springs = material.mechanics == Mechanics::springs;
    const double nu = springs ? kPoissonOfSprings : material.poisson_ratio;
    const double bulk = material.young_modulus / (3 * (1 - 2 * nu));
    return in_motion(solver) ? std::max(material.young_modulus, bulk) : material.young_modulus;
}

std::vector<double> surface_moduli(const Aggregate& matter, const SurfacePoints& points,
                                   Solver solver) {
    if (matter.inset.empty()) return {};
    const std::vector<CellId> cell = matter.lattice.cells_by_low_corner();
    std::vector<double> modulus;
    for (std::size_t p = 0; p < points.size(); ++p) {
        // A particle that no cell holds any more counts as the body's own material.
        const CellId own = points.is_loose(p) ? -1 : cell[points.row(p)[0]];
        int material = own < 0 ? 0 : matter.cell_material[own];
        if (const MixedCell* mixed = matter.mixed_at(own)) {
            material = material_at(*mixed, points.place(p) - Vec3::Constant(0.5));
        }
        modulus.push_back(pressed_modulus(matter.material_at(material), solver));
    }
    return modulus;
}

double surface_modulus(const Aggregate& matter, Solver solver) {
    const std::vector<double> modulus = surface_moduli(matter, matter.surface, solver);
    const double own = pressed_modulus(matter.material, solver);
    if (modulus.empty()) return own;
    double sum = 0, area = 0;
    for (std::size_t p = 0; p < modulus.size(); ++p) {
        sum += matter.surface.area(p) * modulus[p];
        area += matter.surface.area(p);
    }
    return area > 0 ? sum / area : own;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/material_laws.h"

#include <algorithm>
#include <cmath>

#include "laws/layer_guard.h"
#include "sim/elasticity_of.h"

namespace swage {

std::vector<MaterialLaw> material_laws(const Aggregate& matter, Flow flow) {
    constexpr double kNeverYields = 1e100;  // [Pa]
    std::vector<MaterialLaw> laws;
    const bool cells = matter.material.mechanics == Mechanics::cells;
    const bool is_thin =
        std::ranges::none_of(matter.cell_fill, [](float fill) { return fill > kThinFill; });
    for (std::size_t n = 0; n < matter.material_count(); ++n) {
        const Material& m = matter.material_at(n);
        const Elasticity elasticity = elasticity_of(matter, n);
        CellKind kind = elasticity == Elasticity::neo_hookean ? CellKind::rubber
                        : elasticity == Elasticity::storakers ? CellKind::foam
                        : std::isfinite(m.yield_stress)       ? CellKind::yielding
                                                              : CellKind::elastic;
        const bool yields = kind == CellKind::yielding, flows = yields && flow == Flow::trial;
        const bool shifts = cells && flows && m.shifts();
        if (shifts) kind = CellKind::kinematic;
        laws.push_back({cell_moduli(m.young_modulus, m.poisson_ratio, matter.lattice.spacing,
                                    flows ? m.yield_stress : kNeverYields, yields ? m.hardening : 0,
                                    flows ? m.flow_curve : std::vector<FlowPoint>()),
                        kind});
        if (is_thin) laws.back().moduli.sliver_strength = 1;
        if (!shifts) continue;
        laws.back().moduli.back_stress = m.back_stress;
        laws.back().moduli.back_rate = 1 / m.back_strain;
    }
    return laws;
}

double guarded_volume(const MaterialLaw& law) { return guarded_volume(law.kind, law.moduli); }

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// How a cell's trial stress (laws/cell.h) returns to where it flows, by linear hardening or along a
// flow curve (laws/flow_curve.h).
#pragma once

#include "laws/cell_moduli.h"
#include "laws/lane_tensor.h"

namespace swage {

template <typename N>
struct CellReturn {
    N over;  // of the trial stress beyond the line [Pa]; more than 0: it flows
    N d_alpha;
    N kept;            // w
    FlowLine<N> line;  // that it ends on
};

// `line`: one for all lanes, or one a lane.
template <typename N, typename L>
SWAGE_INLINE CellReturn<N> return_to(const CellModuli& law, const FlowLine<L>& line,
                                     const N& stress, const N& alpha) {
    const N over = stress - line.stress - line.slope * alpha;
    const N flows = larger(over, 0.0 * over);
    return {over,
            (1.0 / (3 * law.shear + line.slope)) * flows,
            1.0 - (3 * law.shear / (3 * law.shear + line.slope)) * flows / stress,
            {line.stress + N{}, line.slope + N{}}};
}
// `distortion`: dev E squared; `mode_energy`: f^2 times twice W_q.
template <typename N>
SWAGE_INLINE CellReturn<N> return_cell(const CellModuli& law, const N& distortion,
                                       const N& mode_energy, const N& alpha) {
    const double volume = law.spacing * law.spacing * law.spacing;
    const N stress =
        root((6 * law.shear * law.shear) * distortion + (3 * law.shear / volume) * mode_energy) +
        1e-300;
    if (!law.curve.empty()) [[unlikely]] {
        return return_to(law, line_at(law.curve, stress + (3 * law.shear) * alpha), stress, alpha);
    }
    return return_to(law, FlowLine<double>{law.yield_stress, law.hardening}, stress, alpha);
}

// Modes that flow by themselves, beside a mean that ends on this line.
template <typename N>
struct ModesReturn {
    N over;  // as above
    N d_alpha;
    N kept;
    N took;  // per volume of material [J/m3]
};
template <typename N>
SWAGE_INLINE ModesReturn<N> return_modes(const CellModuli& law, const CellReturn<N>& mean,
                                         const N& mode_energy, const N& alpha) {
    const double volume = law.spacing * law.spacing * law.spacing;
    const N stress = root((3 * law.shear / volume) * mode_energy) + 1e-300;
    const N yield = law.sliver_strength * (mean.line.stress + mean.line.slope * alpha);
    const N over = stress - yield, flows = larger(over, 0.0 * over);
    const N d_alpha = (1.0 / (3 * law.shear)) * flows;
    return {over, d_alpha, 1.0 - flows / stress, yield * d_alpha};
}

// What flow takes per d_alpha [Pa].
inline double mean_flow_stress(const CellModuli& law, double alpha, double d_alpha) {
    return law.curve.empty() ? law.yield_stress + law.hardening * (alpha + 0.5 * d_alpha)
                             : mean_flow_stress(law.curve, alpha, d_alpha);
}
// By how much the return lowers the energy of the increment, per volume of material [J/m3]: on one
// line, and what a curve takes less than that.
inline double saved_by_flow(const CellModuli& law, double alpha, const CellReturn<double>& r) {
    const double over = r.over > 0 ? r.over : 0;
    const auto& [stress, slope] = r.line;
    const double less =
        stress + slope * (alpha + 0.5 * r.d_alpha) - mean_flow_stress(law, alpha, r.d_alpha);
    return over * over / (2 * (3 * law.shear + slope)) + r.d_alpha * less;
}
inline double saved_by_flow(const CellModuli& law, const ModesReturn<double>& r) {
    return r.over > 0 ? r.over * r.over / (6 * law.shear) : 0;
}

}  // namespace swage

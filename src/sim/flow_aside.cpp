// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/flow_aside.h"

#include <array>
#include <cmath>

#include "base/parallel.h"
#include "laws/cell_back.h"
#include "sim/cell_volume.h"
#include "sim/material_laws.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 256;
constexpr double kTiny = 1e-9;  // of their sum: own stiffnesses of what flow may lack

// The gradients of P_x, P_y and P_z.
std::array<CellModes<double>, 3> modes_along(const Symmetric<double>& m) {
    std::array<CellModes<double>, 3> along{};
    along[0].xy.y = m.yy, along[0].zx.z = m.zz, along[0].xy.z = along[0].zx.y = m.yz;
    along[1].xy.x = m.xx, along[1].yz.z = m.zz, along[1].xy.z = along[1].yz.x = m.zx;
    along[2].zx.x = m.xx, along[2].yz.y = m.yy, along[2].zx.y = along[2].yz.x = m.xy;
    return along;
}

// The way of a cell's corners as their sums.
CornerSums<double> corner_ways(const Vec3Array& motion, const CellRun& run, int n) {
    double way[3][8];
    for (int c = 0; c < 8; ++c) {
        const Vec3 v = motion.at(run.corner(n, c));
        for (int d = 0; d < 3; ++d) way[d][c] = v[d];
    }
    return sum_corners(way);
}

// dE of dF, about.
Symmetric<double> strain_of(const Columns<double>& f, const Columns<double>& df) {
    const auto both = [](const Triple<double>& a, const Triple<double>& da, const Triple<double>& b,
                         const Triple<double>& db) { return 0.5 * (dot(a, db) + dot(b, da)); };
    return {both(f.x, df.x, f.x, df.x), both(f.y, df.y, f.y, df.y), both(f.z, df.z, f.z, df.z),
            both(f.x, df.x, f.y, df.y), both(f.y, df.y, f.z, df.z), both(f.z, df.z, f.x, df.x)};
}

// What the return on trial says of a cell.
struct OnTrial {
    double d_alpha, kept, slope;  // slope: of its flow stress, at most [Pa]
    Symmetric<double> distortion;
};
OnTrial on_trial(const Aggregate& matter, CellId id, const MaterialLaw& own,
                 const CellHistory<double>& history, const Symmetric<double>& strain,
                 const CellModes<double>& modes) {
    const CellModuli& law = own.moduli;
    const double fill = matter.cell_fill[id];
    if (own.kind == CellKind::kinematic) {
        const BackFlowed<double> r =
            flow_with_back(law, history, committed_back(matter, id), strain, modes, fill);
        return {r.d_alpha, r.kept_modes, r.line.slope + law.back_rate * law.back_stress,
                r.distortion};
    }
    const CellFlowed<double> r = flow_cell(law, history, strain, modes, fill);
    return {r.d_alpha, r.kept_modes, r.line.slope, r.distortion};
}

}  // namespace

FlowAside::FlowAside(const Aggregate& matter, const Vec3Array& motion) {
    const std::vector<MaterialLaw> laws = material_laws(matter);
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const double a = matter.lattice.spacing;
    const auto add = [&](const CellRun& run, int n, std::vector<Cell>& found) {
        const CellId id = run.first + n;
        const MaterialLaw& own = laws[matter.material_number(id)];
        const double fill = matter.cell_fill[id];
        if (!can_flow(own.kind) || fill < kFlowingFill || matter.mixed_at(id) != nullptr) return;
        const CellHistory<double> history = committed_history(matter, id);
        const Symmetric<double> stretch = taken_back(history);
        const CornerSums<double> sums = corner_sums(matter, run, n);
        const Triple<double> at = material_place(matter, id);
        const Columns<double> f = centroid_gradient(sums, at, a) * stretch;
        const OnTrial r =
            on_trial(matter, id, own, history, cell_strain(f).log, pulled_back(f, sums));
        const double size = std::sqrt(contract(r.distortion, r.distortion));
        if (!(r.d_alpha > 0) || !(size > 0)) return;
        const Symmetric<double> m = (1 / size) * r.distortion;
        const CornerSums<double> way = corner_ways(motion, run, n);
        const CellModes<double> q = pulled_back(f, way);
        const std::array<CellModes<double>, 3> along = modes_along(m);
        Mat3 stiffness;
        Vec3 force;
        for (int i = 0; i < 3; ++i) {
            const CellModes<double> g = mode_stress(own.moduli, stretch, along[i]);
            for (int j = 0; j < 3; ++j) stiffness(i, j) = product(g, along[j]);
            force[i] = product(g, q);
        }
        stiffness.diagonal().array() += kTiny * stiffness.trace();
        const double share = 3 * own.moduli.shear / (3 * own.moduli.shear + r.slope);
        const Vec3 gone = share * solve_symmetric(stiffness, force);
        const Columns<double> df = centroid_gradient(way, at, a) * stretch;
        const double strain = std::sqrt(2.0 / 3) * contract(m, strain_of(f, df));
        found.push_back({id, fill * r.d_alpha, fill * std::abs(strain),
                         r.kept * mode_fill(fill) * force.dot(gone),
                         gone[0] * along[0] + gone[1] * along[1] + gone[2] * along[2]});
    };
    cell_ =
        parallel_collect<Cell>(runs.size(), kRunsPerChunk,
                               [&](std::size_t begin, std::size_t end, std::vector<Cell>& found) {
                                   for (std::size_t r = begin; r < end; ++r) {
                                       for (int n = 0; n < runs[r].count; ++n)
                                           add(runs[r], n, found);
                                   }
                               });
}

double FlowAside::borne() const {
    double sum = 0;
    for (const Cell& cell : cell_) sum += cell.borne;
    return sum;
}

double FlowAside::as_far_as_flow() const {
    double flows = 0, strains = 0;
    for (const Cell& cell : cell_) flows += cell.flows, strains += cell.strains;
    return strains > 0 ? flows / strains : 0;
}

void FlowAside::commit(Aggregate& matter, double by) const {
    for (const Cell& cell : cell_) {
        CellHistory<double> history = committed_history(matter, cell.id);
        if (!(history.alpha > 0)) continue;
        history.modes = history.modes + by * cell.modes;
        for_each_number(history, [&](int n, double number) {
            matter.cell_history.row[n][cell.id] = static_cast<float>(number);
        });
    }
}

}  // namespace swage

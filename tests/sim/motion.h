// SPDX-License-Identifier: GPL-3.0-or-later
// For tests of bodies in motion.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/advance.h"
#include "tests/shared/block.h"

namespace swage::test {

inline const Material kSpringy{.young_modulus = 1e6, .density = 1000, .damping_ratio = 0};

inline void place(Aggregate& m, const Pose& pose) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, pose * m.particle_reference.at(p));
    }
}

// Breaks what joins the particles of two layers of cells across y, in the cells of the one.
inline void break_layer(Aggregate& block, int layer) {
    for (const CellRun& run : block.lattice.cell_run) {
        if (run.j != layer) continue;
        for (int n = 0; n < run.count; ++n) {
            for (const CellConnection& c : kCellConnection) {
                if (kForward[c.direction][1] == 0) continue;
                block.connection[c.direction].weight.set(
                    run.row[c.corner >> 1] + n + (c.corner & 1), 0);
            }
        }
    }
}

inline SimSettings motion_settings(Solver solver = Solver::explicit_steps) {
    SimSettings s;
    s.solver = solver;
    return s;
}

inline Drive still(double time) {
    Drive d;
    d.time = time;
    return d;
}

// A flat tool under a body, its upper side at y = 0.
inline Apparatus floor_with(double friction) {
    Apparatus a;
    a.name = "floor";
    a.tool.push_back({"floor", BoxShape{Vec3(50, 2, 50), 0}, friction});
    return a;
}
inline Drive floor_at(double time) {
    Drive d = still(time);
    d.world_from_tool.push_back({Quat::Identity(), Vec3(0, -1, 0)});
    return d;
}

// A force along x on all points of the block's lower side.
inline Load push_below(const Aggregate& block, double force) {
    Load push;
    push.name = "push";
    const std::vector<double> y = block.particle_reference.all().y;
    const double low = *std::min_element(y.begin(), y.end());
    push.point = points_where(block, [&](const Vec3& x) { return x.y() < low + 1e-4; });
    push.force.assign(push.point.size(), Vec3(force / double(push.point.size()), 0, 0));
    return push;
}

// The most that any unsevered connection differs from its length, over that.
inline double largest_stretch(const Aggregate& m) {
    double most = 0;
    for (const Span& span : m.lattice.span) {
        const double length = reference_length(m.lattice, span.direction);
        for (int n = 0; n < span.count; ++n) {
            if (!(m.connection[span.direction].weight[span.lower + n] > 0)) continue;
            const double distance =
                (m.particle_position.at(span.upper + n) - m.particle_position.at(span.lower + n))
                    .norm();
            most = std::max(most, std::abs(distance / length - 1));
        }
    }
    return most;
}

}  // namespace swage::test

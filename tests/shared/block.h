// SPDX-License-Identifier: GPL-3.0-or-later
// A block of whole cells, made by hand: what tests of rooms below `mold` work on.
#pragma once

#include "matter/aggregate.h"

namespace swage::test {

// nx * ny * nz cells of edge a, centred on the origin. Four surface points a cell face.
inline Aggregate make_block(int nx, int ny, int nz, double a, const Material& material) {
    Aggregate m;
    m.material = material;
    std::vector<Vec3i> cells;
    for (int k = 0; k < nz; ++k) {
        for (int j = 0; j < ny; ++j) {
            for (int i = 0; i < nx; ++i) cells.emplace_back(i, j, k);
        }
    }
    const Vec3i count(nx, ny, nz);
    const Vec3 origin = -0.5 * a * count.cast<double>();
    m.lattice = make_lattice(origin, a, count, cells);
    std::size_t particles = 0;
    for (const ParticleRun& run : m.lattice.particle_run) particles += run.count;
    m.particle_reference = ReferencePlaces(origin, Vec3::Constant(a), m.lattice);
    m.particle_velocity.resize(particles);
    m.particle_mass.assign(particles, 0.0);
    m.particle_position = m.particle_reference.all();
    std::array<std::vector<float>, kForwardCount> weight;
    for (auto& w : weight) w.assign(particles, 0.0f);
    m.cell_fill.assign(cells.size(), 1.0f);
    m.cell_centroid = SparseArray<Eigen::Vector3f>(cells.size(), Eigen::Vector3f::Zero());
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const auto corner = m.lattice.cell_corners(static_cast<CellId>(c));
        for (ParticleId p : corner) m.particle_mass[p] += material.density * a * a * a / 8;
        // Every connection that lies in this cell gets the cell's share.
        for (int low = 0; low < 8; ++low) {
            for (int d = 0; d < kForwardCount; ++d) {
                int high = 0;
                bool inside = true;
                for (int axis = 0; axis < 3; ++axis) {
                    const int at = (low >> axis & 1) + kForward[d][axis];
                    inside = inside && at >= 0 && at <= 1;
                    high |= (at & 1) << axis;
                }
                if (inside) weight[d][corner[low]] += d < kEdgeCount ? 0.25f : 0.5f;
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            for (int end = 0; end < 2; ++end) {
                if (cells[c][axis] != (end ? count[axis] - 1 : 0)) continue;
                for (int q = 0; q < 4; ++q) {
                    Vec3 xi = Vec3::Zero(), normal = Vec3::Zero();
                    xi[axis] = end;
                    normal[axis] = end ? 1 : -1;
                    xi[(axis + 1) % 3] = q & 1 ? 0.75 : 0.25;
                    xi[(axis + 2) % 3] = q & 2 ? 0.75 : 0.25;
                    m.surface.add({corner[0], corner[2], corner[4], corner[6]}, xi, a * a / 4,
                                  normal);
                }
            }
        }
    }
    for (int d = 0; d < kForwardCount; ++d) {
        m.connection[d].weight = SparseArray<float>(weight[d], 1.0f);
    }
    return m;
}

// Holds every surface point whose reference position satisfies the condition.
template <typename Condition>
std::vector<int> points_where(const Aggregate& matter, const Condition& condition) {
    std::vector<int> points;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        if (condition(matter.surface_reference(p))) points.push_back(static_cast<int>(p));
    }
    return points;
}

}  // namespace swage::test

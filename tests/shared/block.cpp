// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/block.h"

namespace swage::test {

Aggregate make_matter(const Vec3& origin, double a, const Vec3i& count,
                      const std::vector<Vec3i>& cells, const std::vector<float>& fill,
                      const Material& material) {
    Aggregate m;
    m.material = material;
    m.lattice = make_lattice(origin, a, count, cells);
    m.particle_reference = ReferencePlaces(origin, Vec3::Constant(a), m.lattice);
    m.particle_position = m.particle_reference.all();
    const std::size_t particles = m.particle_reference.size();
    m.particle_velocity.resize(particles);
    m.particle_mass.assign(particles, 0.0);
    std::array<std::vector<float>, kForwardCount> weight;
    for (auto& w : weight) w.assign(particles, 0.0f);
    m.cell_fill = fill;
    m.cell_centroid = SparseArray<Eigen::Vector3f>(cells.size(), Eigen::Vector3f::Zero());
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const auto corner = m.lattice.cell_corners(static_cast<CellId>(c));
        for (ParticleId p : corner) {
            m.particle_mass[p] += fill[c] * material.density * a * a * a / 8;
        }
        for (const auto& [d, low] : kCellConnection) {
            weight[d][corner[low]] += fill[c] * (d < kEdgeCount ? .25f : .5f);
        }
    }
    for (int d = 0; d < kForwardCount; ++d) {
        m.connection[d].weight = SparseArray<float>(weight[d], 1.0f);
    }
    return m;
}

Aggregate make_block(int nx, int ny, int nz, double a, const Material& material) {
    std::vector<Vec3i> cells;
    for (int k = 0; k < nz; ++k) {
        for (int j = 0; j < ny; ++j) {
            for (int i = 0; i < nx; ++i) cells.emplace_back(i, j, k);
        }
    }
    const Vec3i count(nx, ny, nz);
    Aggregate m = make_matter(-0.5 * a * count.cast<double>(), a, count, cells,
                              std::vector<float>(cells.size(), 1.0f), material);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const auto row = m.lattice.cell_row(static_cast<CellId>(c));
        for (int axis = 0; axis < 3; ++axis) {
            for (int end = 0; end < 2; ++end) {
                if (cells[c][axis] != (end ? count[axis] - 1 : 0)) continue;
                for (int q = 0; q < 4; ++q) {
                    Vec3 xi = Vec3::Zero(), normal = Vec3::Zero();
                    xi[axis] = end;
                    normal[axis] = end ? 1 : -1;
                    xi[(axis + 1) % 3] = q & 1 ? 0.75 : 0.25;
                    xi[(axis + 2) % 3] = q & 2 ? 0.75 : 0.25;
                    m.surface.add(row, xi, a * a / 4, normal);
                }
            }
        }
    }
    return m;
}

}  // namespace swage::test

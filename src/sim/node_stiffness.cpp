// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/node_stiffness.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/lattice_transfer.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 512;

// From one corner of a cell to another.
int near_of(int from, int to) {
    const int dx = (to & 1) - (from & 1), dy = (to >> 1 & 1) - (from >> 1 & 1),
              dz = (to >> 2) - (from >> 2);
    return dx + 1 + 3 * (dy + 1) + 9 * (dz + 1);
}

}  // namespace

NodeStiffness::NodeStiffness(const Lattice& lattice) {
    const std::size_t count = particle_count(lattice);
    neighbour_.assign(count * kNear, -1);
    block_.resize(count * kNear);
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            for (int a = 0; a < 8; ++a) {
                const ParticleId p = run.corner(n, a);
                for (int b = 0; b < 8; ++b) {
                    neighbour_[std::size_t(p) * kNear + near_of(a, b)] = run.corner(n, b);
                }
            }
        }
    }
    clear();
}

void NodeStiffness::clear() { std::fill(block_.begin(), block_.end(), Mat3(Mat3::Zero())); }

void NodeStiffness::add_cells(const Lattice& lattice, const std::vector<CellMatrix>& cells) {
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellMatrix& cell = cells[run.first + n];
            for (int a = 0; a < 8; ++a) {
                const ParticleId p = run.corner(n, a);
                for (int b = 0; b < 8; ++b) {
                    Mat3& block = block_[std::size_t(p) * kNear + near_of(a, b)];
                    for (int i = 0; i < 3; ++i) {
                        for (int j = 0; j < 3; ++j) block(i, j) += cell(3 * a + i, 3 * b + j);
                    }
                }
            }
        }
    }
}

void NodeStiffness::add_point(const std::array<ParticleId, 8>& corner,
                              const std::array<double, 8>& weight, const Mat3& stiffness) {
    for (int a = 0; a < 8; ++a) {
        for (int b = 0; b < 8; ++b) {
            block_[std::size_t(corner[a]) * kNear + near_of(a, b)] +=
                weight[a] * weight[b] * stiffness;
        }
    }
}

void NodeStiffness::add_diagonal(ParticleId p, double stiffness) {
    block_[std::size_t(p) * kNear + kNear / 2].diagonal().array() += stiffness;
}

void NodeStiffness::product(const Vec3Array& x, Vec3Array& result) const {
    result.resize(size());
    parallel_each(size(), kChunk, [&](std::size_t p) {
        Vec3 sum = Vec3::Zero();
        for (int near = 0; near < kNear; ++near) {
            const ParticleId q = neighbour_[p * kNear + near];
            if (q >= 0) sum += block_[p * kNear + near] * x.at(q);
        }
        result.set(p, sum);
    });
}

}  // namespace swage

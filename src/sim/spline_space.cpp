// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/spline_space.h"

#include <algorithm>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr int kChunkParticles = 8192;

std::vector<SplineSpace::Place> places(int cells, int elements) {
    std::vector<SplineSpace::Place> place;
    for (int site = 0; site <= cells; ++site) {
        const double at = double(site) * elements / cells;
        const int node = std::min(static_cast<int>(at), elements - 1);
        const double t = at - node;
        place.push_back({node, {0.5 * (1 - t) * (1 - t), 0.5 + t - t * t, 0.5 * t * t}});
    }
    return place;
}

}  // namespace

SplineSpace::SplineSpace(const Lattice& lattice, const Vec3i& elements)
    : nodes_(elements + Vec3i::Constant(2)) {
    for (int d = 0; d < 3; ++d) place_[d] = places(lattice.cell_count[d], elements[d]);
    for (int q = 0; q < 3; ++q) {
        for (const Place& at : place_[0]) weight_[q].push_back(at.weight[q]);
    }
    int filled = kChunkParticles;
    for (const ParticleRun& run : lattice.particle_run) {
        if (filled >= kChunkParticles) {
            chunk_.push_back(row_.size());
            filled = 0;
        }
        filled += run.count;
        Row row{stretch_.size(), 0, run.j, run.k};
        for (int n = 0; n < run.count;) {
            Stretch s{run.first + n, 0, run.i + n, place_[0][run.i + n].node};
            for (; n < run.count && place_[0][run.i + n].node == s.node; ++n) ++s.count;
            stretch_.push_back(s);
        }
        row.last = stretch_.size();
        row_.push_back(row);
    }
    chunk_.push_back(row_.size());
}

// Row by row into the lines of nodes of one plane, and that into the planes of nodes.
SplineSpace::Vector SplineSpace::restricted(const Vec3Array& force) const {
    const std::size_t chunks = chunk_.size() - 1;
    const Eigen::Index width = 3 * nodes_.x(), area = width * nodes_.y();
    std::vector<Vector> part(chunks);
    parallel_for(chunks, [&](std::size_t chunk) {
        Vector sum = Vector::Zero(3 * node_count()), plane = Vector::Zero(area), line(width);
        const auto end_plane = [&](int k) {
            const Place& z = place_[2][k];
            for (int q = 0; q < 3; ++q) {
                sum.segment((z.node + q) * area, area) += z.weight[q] * plane;
            }
            plane.setZero();
        };
        for (std::size_t r = chunk_[chunk]; r < chunk_[chunk + 1]; ++r) {
            const Row& row = row_[r];
            const Eigen::Index low = 3 * stretch_[row.first].node,
                               size = 3 * stretch_[row.last - 1].node + 9 - low;
            line.head(size).setZero();
            for (std::size_t n = row.first; n < row.last; ++n) {
                const Stretch& s = stretch_[n];
                Mat3 total = Mat3::Zero();  // of each node, by columns
                for (int m = 0; m < s.count; ++m) {
                    const Vec3 f = force.at(s.first + m);
                    for (int q = 0; q < 3; ++q) total.col(q) += weight_[q][s.site + m] * f;
                }
                line.segment<9>(3 * s.node - low) += total.reshaped();
            }
            const Place& y = place_[1][row.j];
            for (int q = 0; q < 3; ++q) {
                plane.segment((y.node + q) * width + low, size) += y.weight[q] * line.head(size);
            }
            if (r + 1 == chunk_[chunk + 1] || row_[r + 1].k != row.k) end_plane(row.k);
        }
        part[chunk] = std::move(sum);
    });
    Vector sum = Vector::Zero(3 * node_count());
    for (const Vector& p : part) sum += p;
    return sum;
}

void SplineSpace::add(const Vector& motion, double keep, Vec3Array& fine) const {
    const Eigen::Index width = 3 * nodes_.x(), area = width * nodes_.y();
    parallel_for(chunk_.size() - 1, [&](std::size_t chunk) {
        Vector plane(area), line(width);
        for (std::size_t r = chunk_[chunk]; r < chunk_[chunk + 1]; ++r) {
            const Row& row = row_[r];
            if (r == chunk_[chunk] || row_[r - 1].k != row.k) {
                const Place& z = place_[2][row.k];
                plane = z.weight[0] * motion.segment(z.node * area, area) +
                        z.weight[1] * motion.segment((z.node + 1) * area, area) +
                        z.weight[2] * motion.segment((z.node + 2) * area, area);
            }
            const Place& y = place_[1][row.j];
            const Eigen::Index low = 3 * stretch_[row.first].node,
                               size = 3 * stretch_[row.last - 1].node + 9 - low;
            const auto along = [&](int q) {
                return plane.segment((y.node + q) * width + low, size);
            };
            line.head(size) =
                y.weight[0] * along(0) + y.weight[1] * along(1) + y.weight[2] * along(2);
            for (std::size_t n = row.first; n < row.last; ++n) {
                const Stretch& s = stretch_[n];
                const double* node = line.data() + 3 * s.node - low;
                const auto move = [&](std::vector<double>& component, int axis) {
                    const double a = node[axis], b = node[3 + axis], c = node[6 + axis];
                    const double* w[3];
                    for (int q = 0; q < 3; ++q) w[q] = weight_[q].data() + s.site;
                    double* x = component.data() + s.first;
                    for (int m = 0; m < s.count; ++m) {
                        x[m] = keep * x[m] + (w[0][m] * a + w[1][m] * b + w[2][m] * c);
                    }
                };
                move(fine.x, 0);
                move(fine.y, 1);
                move(fine.z, 2);
            }
        }
    });
}

}  // namespace swage

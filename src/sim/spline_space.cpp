// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/spline_space.h"

#include <algorithm>

#include "base/parallel.h"

namespace swage {

namespace {

// Particles of a chunk, at the least: each has sums of its own, which one thread adds up.
constexpr std::size_t kChunkParticles = 2048, kMostChunks = 32;

using Places = std::array<std::vector<SplineSpace::Place>, 3>;

Places places_of(const Lattice& lattice, const Vec3i& elements) {
    Places place;
    for (int d = 0; d < 3; ++d) {
        for (int site = 0; site <= lattice.cell_count[d]; ++site) {
            const double at = double(site) * elements[d] / lattice.cell_count[d];
            const int node = std::min(static_cast<int>(at), elements[d] - 1);
            const double t = at - node;
            place[d].push_back({node, {0.5 * (1 - t) * (1 - t), 0.5 + t - t * t, 0.5 * t * t}});
        }
    }
    return place;
}

std::array<std::vector<int>, 3> elements_of_sites(const Places& place) {
    std::array<std::vector<int>, 3> element;
    for (int d = 0; d < 3; ++d) {
        for (const SplineSpace::Place& at : place[d]) element[d].push_back(at.node);
    }
    return element;
}

}  // namespace

SplineSpace::SplineSpace(const Lattice& lattice,
                         const std::array<ConnectionArrays, kForwardCount>& connection,
                         const Vec3i& elements)
    : grid_(elements + Vec3i::Constant(2)),
      place_(places_of(lattice, elements)),
      parts_(lattice, connection, elements_of_sites(place_), elements) {
    for (int q = 0; q < 3; ++q) {
        for (const Place& at : place_[0]) weight_[q].push_back(at.weight[q]);
    }
    std::vector<char> plain;  // parts
    for (const SplineParts::Nodes& nodes : parts_.node) {
        plain.push_back(*std::max_element(nodes.begin(), nodes.end()) < grid_.prod());
    }
    const std::size_t share = parts_.of_particle.size() / kMostChunks;
    const int most = static_cast<int>(std::max(kChunkParticles, share));
    int filled = most;
    for (const ParticleRun& run : lattice.particle_run) {
        if (filled >= most) {
            chunk_.push_back(row_.size());
            filled = 0;
        }
        filled += run.count;
        Row row{stretch_.size(), 0, run.j, run.k, true};
        for (int n = 0; n < run.count;) {
            const int part = parts_.of_particle[run.first + n];
            Stretch s{run.first + n, 0, run.i + n, place_[0][run.i + n].node, part};
            for (; n < run.count && parts_.of_particle[run.first + n] == part; ++n) ++s.count;
            stretch_.push_back(s);
            row.plain = row.plain && plain[part];
        }
        row.last = stretch_.size();
        row_.push_back(row);
    }
    chunk_.push_back(row_.size());
}

std::array<double, 9> SplineSpace::weights_across(const Row& row) const {
    const Place &y = place_[1][row.j], &z = place_[2][row.k];
    std::array<double, 9> weight;
    for (int n = 0; n < 9; ++n) weight[n] = y.weight[n % 3] * z.weight[n / 3];
    return weight;
}

// Plain rows into the lines of nodes of one plane, and that into the planes of nodes.
SplineSpace::Vector SplineSpace::restricted(const Vec3Array& force) const {
    const std::size_t chunks = chunk_.size() - 1;
    const Eigen::Index width = 3 * grid_.x(), area = width * grid_.y();
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
        const auto total_of = [&](const Stretch& s) {
            Mat3 total = Mat3::Zero();  // of each node along x, by columns
            for (int m = 0; m < s.count; ++m) {
                const Vec3 f = force.at(s.first + m);
                for (int q = 0; q < 3; ++q) total.col(q) += weight_[q][s.site + m] * f;
            }
            return total;
        };
        const auto add_plain = [&](const Row& row) {
            const Eigen::Index low = 3 * stretch_[row.first].node,
                               size = 3 * stretch_[row.last - 1].node + 9 - low;
            line.head(size).setZero();
            for (std::size_t n = row.first; n < row.last; ++n) {
                line.segment<9>(3 * stretch_[n].node - low) += total_of(stretch_[n]).reshaped();
            }
            const Place& y = place_[1][row.j];
            for (int q = 0; q < 3; ++q) {
                plane.segment((y.node + q) * width + low, size) += y.weight[q] * line.head(size);
            }
        };
        const auto add_any = [&](const Row& row) {
            const std::array<double, 9> weight = weights_across(row);
            for (std::size_t n = row.first; n < row.last; ++n) {
                const Mat3 total = total_of(stretch_[n]);
                const SplineParts::Nodes& node = parts_.node[stretch_[n].part];
                for (int q = 0; q < SplineParts::kNodes; ++q) {
                    sum.segment<3>(3 * node[q]) += weight[q / 3] * total.col(q % 3);
                }
            }
        };
        for (std::size_t r = chunk_[chunk]; r < chunk_[chunk + 1]; ++r) {
            row_[r].plain ? add_plain(row_[r]) : add_any(row_[r]);
            if (r + 1 == chunk_[chunk + 1] || row_[r + 1].k != row_[r].k) end_plane(row_[r].k);
        }
        part[chunk] = std::move(sum);
    });
    Vector sum = Vector::Zero(3 * node_count());
    for (const Vector& p : part) sum += p;
    return sum;
}

void SplineSpace::add(const Vector& motion, double keep, Vec3Array& fine) const {
    const Eigen::Index width = 3 * grid_.x(), area = width * grid_.y();
    parallel_for(chunk_.size() - 1, [&](std::size_t chunk) {
        Vector plane(area), line(width);
        // `node`: of the three nodes along x, three numbers each.
        const auto move = [&](const Stretch& s, const double* node) {
            const auto along = [&](std::vector<double>& component, int axis) {
                const double a = node[axis], b = node[3 + axis], c = node[6 + axis];
                const double* w[3];
                for (int q = 0; q < 3; ++q) w[q] = weight_[q].data() + s.site;
                double* x = component.data() + s.first;
                for (int m = 0; m < s.count; ++m) {
                    x[m] = keep * x[m] + (w[0][m] * a + w[1][m] * b + w[2][m] * c);
                }
            };
            along(fine.x, 0);
            along(fine.y, 1);
            along(fine.z, 2);
        };
        const auto move_plain = [&](const Row& row) {
            const Place& y = place_[1][row.j];
            const Eigen::Index low = 3 * stretch_[row.first].node,
                               size = 3 * stretch_[row.last - 1].node + 9 - low;
            const auto along = [&](int q) {
                return plane.segment((y.node + q) * width + low, size);
            };
            line.head(size) =
                y.weight[0] * along(0) + y.weight[1] * along(1) + y.weight[2] * along(2);
            for (std::size_t n = row.first; n < row.last; ++n) {
                move(stretch_[n], line.data() + 3 * stretch_[n].node - low);
            }
        };
        const auto move_any = [&](const Row& row) {
            const std::array<double, 9> weight = weights_across(row);
            for (std::size_t n = row.first; n < row.last; ++n) {
                const SplineParts::Nodes& node = parts_.node[stretch_[n].part];
                Mat3 own = Mat3::Zero();
                for (int q = 0; q < SplineParts::kNodes; ++q) {
                    own.col(q % 3) += weight[q / 3] * motion.segment<3>(3 * node[q]);
                }
                move(stretch_[n], own.data());
            }
        };
        for (std::size_t r = chunk_[chunk]; r < chunk_[chunk + 1]; ++r) {
            const Row& row = row_[r];
            if (r == chunk_[chunk] || row_[r - 1].k != row.k) {
                const Place& z = place_[2][row.k];
                plane = z.weight[0] * motion.segment(z.node * area, area) +
                        z.weight[1] * motion.segment((z.node + 1) * area, area) +
                        z.weight[2] * motion.segment((z.node + 2) * area, area);
            }
            row.plain ? move_plain(row) : move_any(row);
        }
    });
}

// By pair_of().
std::array<double, 6> SplineSpace::pairs(const Place& at) {
    const auto& [a, b, c] = at.weight;
    return {a * a, b * b, c * c, a * b, a * c, b * c};
}

std::vector<SplineSpace::PartMasses> SplineSpace::masses(const std::vector<double>& mass) const {
    std::vector<PartMasses> sum(parts_.node.size(), PartMasses{});
    for (const Row& row : row_) {
        const std::array<double, 6> y = pairs(place_[1][row.j]), z = pairs(place_[2][row.k]);
        std::array<double, 36> across;
        for (int n = 0; n < 36; ++n) across[n] = y[n % 6] * z[n / 6];
        for (std::size_t n = row.first; n < row.last; ++n) {
            const Stretch& s = stretch_[n];
            std::array<double, 6> along{};
            for (int m = 0; m < s.count; ++m) {
                const std::array<double, 6> x = pairs(place_[0][s.site + m]);
                for (int q = 0; q < 6; ++q) along[q] += mass[s.first + m] * x[q];
            }
            PartMasses& of = sum[s.part];
            for (int q = 0; q < 216; ++q) of[q] += along[q % 6] * across[q / 6];
        }
    }
    return sum;
}

}  // namespace swage

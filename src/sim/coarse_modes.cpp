// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/coarse_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/KroneckerProduct>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr int kMostNodes = 40;
constexpr int kChunkParticles = 8192;

// As many coarse cells along each axis as make them about cubes, without too many nodes.
Vec3i coarse_nodes(const Vec3i& cells) {
    for (double size = 2;; size *= 1.02) {
        Vec3i nodes;
        for (int d = 0; d < 3; ++d) {
            nodes[d] = 1 + std::max(1, static_cast<int>(std::lround(cells[d] / size)));
        }
        if (nodes.prod() <= kMostNodes) return nodes;
    }
}

}  // namespace

CoarseModes::CoarseModes(const Aggregate& matter)
    : cells_(matter.lattice.cell_count), nodes_(coarse_nodes(cells_)) {
    const auto place = [&](int site, int axis, int& node) {
        const double at = double(site) * (nodes_[axis] - 1) / cells_[axis];
        node = std::min(static_cast<int>(at), nodes_[axis] - 2);
        return at - node;
    };
    int filled = kChunkParticles;
    for (const ParticleRun& run : matter.lattice.particle_run) {
        int j, k;
        const double y = place(run.j, 1, j), z = place(run.k, 2, k);
        for (int n = 0; n < run.count;) {
            int i, next = n;
            const double x = place(run.i + n, 0, i);
            for (int other = i; next < run.count; ++next) {
                place(run.i + next, 0, other);
                if (other != i) break;
            }
            if (filled >= kChunkParticles) {
                chunk_.push_back(stretch_.size());
                filled = 0;
            }
            stretch_.push_back({run.first + n, run.first + next, x,
                                double(nodes_.x() - 1) / cells_.x(), node_at(i, j, k), y, z});
            filled += next - n;
            n = next;
        }
    }
    chunk_.push_back(stretch_.size());
}

// Calls act(row of four, weight along y and z, low node): the nodes low and low + 1 along x.
template <typename Act>
void CoarseModes::for_each_corner(const Stretch& s, const Act& act) const {
    for (int q = 0; q < 4; ++q) {
        const double weight = (q & 1 ? s.y : 1 - s.y) * (q & 2 ? s.z : 1 - s.z);
        if (weight != 0) act(weight, s.node + node_at(0, q & 1, q >> 1));
    }
}

CoarseModes::Vector CoarseModes::restricted(const Vec3Array& force) const {
    const std::size_t chunks = chunk_.size() - 1;
    std::vector<Vector> part(chunks);
    parallel_for(chunks, [&](std::size_t chunk) {
        Vector sum = Vector::Zero(3 * nodes_.prod());
        for (std::size_t n = chunk_[chunk]; n < chunk_[chunk + 1]; ++n) {
            const Stretch& s = stretch_[n];
            Vec3 low = Vec3::Zero(), high = Vec3::Zero();
            double at = s.at;
            for (ParticleId p = s.begin; p < s.end; ++p, at += s.step) {
                const Vec3 f = force.at(p);
                low += f;
                high += at * f;
            }
            low -= high;
            for_each_corner(s, [&](double weight, int node) {
                sum.segment<3>(3 * node) += weight * low;
                sum.segment<3>(3 * node + 3) += weight * high;
            });
        }
        part[chunk] = std::move(sum);
    });
    Vector sum = Vector::Zero(3 * nodes_.prod());
    for (const Vector& p : part) sum += p;
    return sum;
}

void CoarseModes::add(const Vector& motion, double keep, Vec3Array& velocity) const {
    parallel_for(chunk_.size() - 1, [&](std::size_t chunk) {
        for (std::size_t n = chunk_[chunk]; n < chunk_[chunk + 1]; ++n) {
            const Stretch& s = stretch_[n];
            Vec3 low = Vec3::Zero(), high = Vec3::Zero();
            for_each_corner(s, [&](double weight, int node) {
                low += weight * motion.segment<3>(3 * node);
                high += weight * motion.segment<3>(3 * node + 3);
            });
            const Vec3 slope = high - low;
            const auto move = [&](std::vector<double>& v, double from, double rise) {
                double at = s.at;
                for (ParticleId p = s.begin; p < s.end; ++p, at += s.step) {
                    v[p] = keep * v[p] + (from + at * rise);
                }
            };
            move(velocity.x, low.x(), slope.x());
            move(velocity.y, low.y(), slope.y());
            move(velocity.z, low.z(), slope.z());
        }
    });
}

// Nodes three apart do not touch the same cells, so they are moved together.
void CoarseModes::find_stiffness(Aggregate& matter, const Forces& forces) {
    const int count = nodes_.prod();
    const double step = 1e-6 * matter.lattice.spacing;
    const Vec3Array position = matter.particle_position;
    Vec3Array here, there;
    forces(here);
    stiffness_ = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    const auto near = [&](int a, int b) {
        const int x = nodes_.x(), y = nodes_.y();
        return std::abs(a % x - b % x) <= 1 && std::abs(a / x % y - b / x % y) <= 1 &&
               std::abs(a / x / y - b / x / y) <= 1;
    };
    for (int color = 0; color < 27; ++color) {
        std::vector<int> moved;
        for (int n = 0; n < count; ++n) {
            const int i = n % nodes_.x(), j = n / nodes_.x() % nodes_.y(),
                      k = n / nodes_.x() / nodes_.y();
            if (i % 3 + 3 * (j % 3) + 9 * (k % 3) == color) moved.push_back(n);
        }
        if (moved.empty()) continue;
        for (int axis = 0; axis < 3; ++axis) {
            Vector motion = Vector::Zero(3 * count);
            for (int n : moved) motion[3 * n + axis] = step;
            add(motion, 1, matter.particle_position);
            forces(there);
            matter.particle_position = position;
            for (std::size_t p = 0; p < here.size(); ++p) there.set(p, here.at(p) - there.at(p));
            const Vector response = restricted(there) / step;
            for (int n : moved) {
                for (int m = 0; m < count; ++m) {
                    if (near(n, m)) {
                        stiffness_.block<3, 1>(3 * m, 3 * n + axis) = response.segment<3>(3 * m);
                    }
                }
            }
        }
    }
    stiffness_ = (0.5 * (stiffness_ + stiffness_.transpose())).eval();
}

// P^T M P.
Eigen::MatrixXd CoarseModes::restricted_mass(const std::vector<double>& mass) const {
    const int count = nodes_.prod();
    Eigen::MatrixXd scalar = Eigen::MatrixXd::Zero(count, count);
    for (const Stretch& s : stretch_) {
        double low = 0, both = 0, high = 0, at = s.at;
        for (ParticleId p = s.begin; p < s.end; ++p, at += s.step) {
            low += mass[p] * (1 - at) * (1 - at);
            both += mass[p] * at * (1 - at);
            high += mass[p] * at * at;
        }
        for_each_corner(s, [&](double wa, int a) {
            for_each_corner(s, [&](double wb, int b) {
                scalar(a, b) += wa * wb * low;
                scalar(a, b + 1) += wa * wb * both;
                scalar(a + 1, b) += wa * wb * both;
                scalar(a + 1, b + 1) += wa * wb * high;
            });
        });
    }
    return Eigen::kroneckerProduct(scalar, Mat3::Identity());
}

// P^T K P of points: how a point follows the nodes is the weighted mean of how its carriers do.
Eigen::MatrixXd CoarseModes::restricted_points(const Aggregate& matter,
                                               const std::vector<HeldPoint>& held) const {
    const int count = nodes_.prod();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * count, 3 * count);
    const Lattice& lattice = matter.lattice;
    for (const HeldPoint& h : held) {
        Vector share = Vector::Zero(count);
        for (int c = 0; c < 8; ++c) {
            const double carried = h.weight[c];
            const Vec3 site =
                (matter.particle_reference.at(h.corner[c]) - lattice.origin) /
                lattice.spacing;
            Vec3i node;
            Vec3 at;
            for (int d = 0; d < 3; ++d) {
                const double place = std::round(site[d]) * (nodes_[d] - 1) / cells_[d];
                node[d] = std::clamp(static_cast<int>(place), 0, nodes_[d] - 2);
                at[d] = place - node[d];
            }
            for (int q = 0; q < 8; ++q) {
                double weight = carried;
                for (int d = 0; d < 3; ++d) weight *= q >> d & 1 ? at[d] : 1 - at[d];
                share[node_at(node.x() + (q & 1), node.y() + (q >> 1 & 1), node.z() + (q >> 2))] +=
                    weight;
            }
        }
        std::vector<int> near;
        for (int n = 0; n < count; ++n) {
            if (share[n] != 0) near.push_back(n);
        }
        for (int a : near) {
            for (int b : near) sum.block<3, 3>(3 * a, 3 * b) += share[a] * share[b] * h.stiffness;
        }
    }
    return sum;
}

void CoarseModes::find_modes(const Aggregate& matter, const std::vector<double>& mass,
                             const std::vector<HeldPoint>& held) {
    Eigen::MatrixXd inertia = restricted_mass(mass);
    const Eigen::MatrixXd stiffness = stiffness_ + restricted_points(matter, held);
    // Nodes that hardly any particle follows must not stand out by themselves.
    inertia.diagonal().array() += 1e-6 * inertia.diagonal().maxCoeff();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness, inertia);
    gains_ = modes.info() == Eigen::Success;
    if (!gains_) return;
    modes_ = modes.eigenvectors();
    eigenvalues_ = modes.eigenvalues();
    limit_gain(most_gain_);
}

void CoarseModes::limit_gain(double most) {
    most_gain_ = most;
    if (eigenvalues_.size() == 0) return;
    const Vector gain = (0.5 / eigenvalues_.array().max(1e-30)).max(1.0).min(std::max(most, 1.0));
    more_ = (gain.array() - 1).matrix().asDiagonal();
    gains_ = gain.maxCoeff() > 1;
}

double CoarseModes::gain_size(const Vector& total) const {
    const Vector amount = modes_.transpose() * total;
    const auto& more = more_.diagonal();
    return (amount.array().square() * more.array() * (more.array() + 2)).sum();
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/coarse_space.h"

#include <algorithm>
#include <cmath>

#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kReach = 2;  // nodes along an axis that share particles
constexpr int kSide = 2 * kReach + 1, kSelf = kSide * kSide * kSide / 2;
constexpr double kFinest = 4;  // cells an element
// Of a banded factor: beside an iteration's own work, and what costs next to nothing.
constexpr double kEntriesPerParticle = 10, kFewEntries = 2e4;
constexpr double kMostWork = 4e8;   // multiplications that a banded factor may take
constexpr double kStaleTurn = 0.1;  // of a cell's edge, over its length
constexpr double kStep = 1e-8;      // of a cell, for differences
constexpr double kLoosest = 1e-6;   // of the largest inertia, that every node has

// The place of a neighbour among those near a node; kNear - 1 less it is the node's among its.
int near_of(const Vec3i& way) { return kSelf + way.x() + kSide * (way.y() + kSide * way.z()); }

// Calls act(i, j, k) for each place from low to high in steps.
template <typename Act>
void for_each_place(const Vec3i& low, const Vec3i& high, int step, const Act& act) {
    for (int k = low.z(); k <= high.z(); k += step) {
        for (int j = low.y(); j <= high.y(); j += step) {
            for (int i = low.x(); i <= high.x(); i += step) act(Vec3i(i, j, k));
        }
    }
}

// About cubes, as small as pays.
Vec3i elements_of(const Lattice& lattice, std::size_t particles) {
    for (double size = kFinest;; size *= 1.02) {
        Vec3i elements;
        for (int d = 0; d < 3; ++d) {
            elements[d] = std::max(1, static_cast<int>(std::lround(lattice.cell_count[d] / size)));
        }
        const Vec3i nodes = elements + Vec3i::Constant(2);
        const double rows = 3.0 * nodes.prod(), band = 2 * rows / nodes.maxCoeff();
        const double entries = std::max(kFewEntries, kEntriesPerParticle * double(particles));
        const bool pays = rows * band <= entries && rows * band * band <= kMostWork;
        if (pays || elements == Vec3i::Ones()) return elements;
    }
}

}  // namespace

CoarseSpace::CoarseSpace(const Aggregate& matter)
    : lattice_(matter.lattice), space_(lattice_, elements_of(lattice_, matter.particle_count())) {
    const auto blocks = static_cast<std::size_t>(space_.node_count()) * kNear;
    stiffness_.assign(blocks, Mat3::Zero());
    held_.assign(blocks, Mat3::Zero());
    find_masses(std::vector<double>(matter.particle_count(), 1.0));
    find_pattern();
    choose_samples();
}

void CoarseSpace::choose_samples() {
    const Vec3i elements = space_.nodes() - Vec3i::Constant(2);
    std::vector<double> nearest(static_cast<std::size_t>(elements.prod()), 1e300);
    std::vector<CellId> cell(nearest.size(), -1);
    for (const CellRun& run : lattice_.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const Vec3 at = (Vec3(run.i + n, run.j, run.k) + Vec3::Constant(0.5))
                                .cwiseProduct(elements.cast<double>())
                                .cwiseQuotient(lattice_.cell_count.cast<double>());
            const Vec3i element = at.cast<int>();
            const double far = (at - element.cast<double>() - Vec3::Constant(0.5)).squaredNorm();
            const auto e = static_cast<std::size_t>(
                element.x() + elements.x() * (element.y() + elements.y() * element.z()));
            if (far < nearest[e]) nearest[e] = far, cell[e] = run.first + n;
        }
    }
    for (CellId c : cell) {
        if (c >= 0) sample_.push_back(c);
    }
}

CoarseSpace::Edges CoarseSpace::edges(CellId cell, const Vec3Array& position) const {
    const auto corner = lattice_.cell_corners(cell);
    const Vec3 low = position.at(corner[0]);
    return {position.at(corner[1]) - low, position.at(corner[2]) - low,
            position.at(corner[4]) - low};
}

bool CoarseSpace::is_stale(const Vec3Array& position) const {
    for (std::size_t n = 0; n < probed_.size(); ++n) {
        const Edges now = edges(sample_[n], position);
        for (int d = 0; d < 3; ++d) {
            if ((now[d] - probed_[n][d]).norm() > kStaleTurn * lattice_.spacing) return true;
        }
    }
    return probed_.empty();
}

// Not over gaps in the body.
void CoarseSpace::find_pattern() {
    const int nodes = space_.node_count();
    const auto neighbor = [&](int n, int near) {
        return n + space_.node_at(near % kSide - kReach, near / kSide % kSide - kReach,
                                  near / kSide / kSide - kReach);
    };
    const auto shares = [&](int n, int near) {
        return near == kSelf || inertia_[n * std::size_t(kNear) + near] != 0;
    };
    std::vector<std::pair<int, int>> pair;
    for (int n = 0; n < nodes; ++n) {
        for (int near = kSelf; near < kNear; ++near) {
            if (shares(n, near)) pair.emplace_back(n, neighbor(n, near));
        }
    }
    factor_ = std::make_unique<PanelCholesky>(nodes, pair);
    neighbor_.resize(nodes);
    for (int n = 0; n < nodes; ++n) {
        for (int near = 0; near < kNear; ++near) {
            if (!shares(n, near)) continue;
            const int m = neighbor(n, near);
            if (factor_->place_of(m) < factor_->place_of(n)) continue;
            neighbor_[n].push_back(
                {m, n * std::size_t(kNear) + near, m * std::size_t(kNear) + kNear - 1 - near});
        }
        std::sort(neighbor_[n].begin(), neighbor_[n].end(), [&](const auto& a, const auto& b) {
            return factor_->place_of(a.node) < factor_->place_of(b.node);
        });
    }
}

// Nodes five apart share no particles with the same nodes, so they are moved together.
void CoarseSpace::find_stiffness(Aggregate& matter, const Forces& forces) {
    const Vec3i last = space_.nodes() - Vec3i::Ones();
    const double step = kStep * lattice_.spacing;
    const Vec3Array position = matter.particle_position;
    Vec3Array here, there;
    forces(here);
    for_each_place(Vec3i::Zero(), last.cwiseMin(kSide - 1), 1, [&](const Vec3i& first) {
        for (int axis = 0; axis < 3; ++axis) {
            Vector motion = Vector::Zero(3 * space_.node_count());
            for_each_place(first, last, kSide, [&](const Vec3i& at) {
                motion[3 * space_.node_at(at.x(), at.y(), at.z()) + axis] = step;
            });
            space_.add(motion, 1, matter.particle_position);
            forces(there);
            matter.particle_position = position;
            combine(1, -1, here, there);
            const Vector response = space_.restricted(there) / -step;
            for_each_place(first, last, kSide, [&](const Vec3i& at) {
                const Vec3i low = (at - Vec3i::Constant(kReach)).cwiseMax(0),
                            high = (at + Vec3i::Constant(kReach)).cwiseMin(last);
                for_each_place(low, high, 1, [&](const Vec3i& other) {
                    const int m = space_.node_at(other.x(), other.y(), other.z());
                    stiffness_[m * std::size_t(kNear) + near_of(at - other)].col(axis) =
                        response.segment<3>(3 * m);
                });
            });
        }
    });
    probed_.clear();
    for (CellId cell : sample_) probed_.push_back(edges(cell, position));
}

void CoarseSpace::find_masses(const std::vector<double>& mass) {
    inertia_.assign(space_.node_count() * std::size_t(kNear), 0.0);
    const int width = space_.nodes().x();
    std::vector<double> line(static_cast<std::size_t>(width) * kSide);  // of a row along x
    for (const ParticleRun& run : lattice_.particle_run) {
        std::fill(line.begin(), line.end(), 0.0);
        for (int n = 0; n < run.count; ++n) {
            const SplineSpace::Place& at = space_.place(0, run.i + n);
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    line[(at.node + a) * kSide + b - a + kReach] +=
                        mass[run.first + n] * at.weight[a] * at.weight[b];
                }
            }
        }
        const SplineSpace::Place &y = space_.place(1, run.j), &z = space_.place(2, run.k);
        for (int a = 0; a < 9; ++a) {
            for (int b = 0; b < 9; ++b) {
                const double weight =
                    y.weight[a % 3] * z.weight[a / 3] * y.weight[b % 3] * z.weight[b / 3];
                const int near = near_of({-kReach, b % 3 - a % 3, b / 3 - a / 3});
                const int node = space_.node_at(0, y.node + a % 3, z.node + a / 3);
                for (int i = 0; i < width; ++i) {
                    double* sum = &inertia_[(node + i) * std::size_t(kNear) + near];
                    for (int s = 0; s < kSide; ++s) sum[s] += weight * line[i * kSide + s];
                }
            }
        }
    }
    // Nodes that hardly any particle follows must not stand out by themselves.
    double largest = 0;
    for (std::size_t n = kSelf; n < inertia_.size(); n += kNear) {
        largest = std::max(largest, inertia_[n]);
    }
    for (std::size_t n = kSelf; n < inertia_.size(); n += kNear) inertia_[n] += kLoosest * largest;
}

// A point follows the nodes as the weighted mean of its carriers does.
void CoarseSpace::hold(const Aggregate& matter, const std::vector<HeldPoint>& held) {
    std::fill(held_.begin(), held_.end(), Mat3::Zero());
    for (const HeldPoint& h : held) {
        struct Share {
            Vec3i at;
            double weight;
        };
        // Over all nodes that the corners of one cell follow: up to four along each axis.
        std::array<double, 64> sum{};
        Vec3i low = Vec3i::Constant(1 << 30);
        std::array<std::array<const SplineSpace::Place*, 3>, 8> place;
        for (int c = 0; c < 8; ++c) {
            const Vec3 site =
                (matter.particle_reference.at(h.corner[c]) - lattice_.origin) / lattice_.spacing;
            for (int d = 0; d < 3; ++d) {
                place[c][d] = &space_.place(d, static_cast<int>(std::lround(site[d])));
                low[d] = std::min(low[d], place[c][d]->node);
            }
        }
        for (int c = 0; c < 8; ++c) {
            const auto& [x, y, z] = place[c];
            for (int q = 0; q < 27; ++q) {
                const int i = x->node - low.x() + q % 3, j = y->node - low.y() + q / 3 % 3,
                          k = z->node - low.z() + q / 9;
                sum[i + 4 * j + 16 * k] +=
                    h.weight[c] * x->weight[q % 3] * y->weight[q / 3 % 3] * z->weight[q / 9];
            }
        }
        std::vector<Share> share;
        for (int q = 0; q < 64; ++q) {
            if (sum[q] != 0) share.push_back({low + Vec3i(q % 4, q / 4 % 4, q / 16), sum[q]});
        }
        for (std::size_t a = 0; a < share.size(); ++a) {
            const int n = space_.node_at(share[a].at.x(), share[a].at.y(), share[a].at.z());
            for (std::size_t b = 0; b < share.size(); ++b) {
                const Vec3i way = share[b].at - share[a].at;
                if (way.cwiseAbs().maxCoeff() > kReach) continue;
                held_[n * std::size_t(kNear) + near_of(way)] +=
                    share[a].weight * share[b].weight * h.stiffness;
            }
        }
    }
    factor();
}

void CoarseSpace::limit_gain(double most) {
    if (most == most_gain_) return;
    most_gain_ = most;
    if (!probed_.empty()) factor();
}

// Where the body is about to buckle, fewer motions are made lighter.
void CoarseSpace::factor() {
    gains_ = false;
    for (double gain = most_gain_; gain > 1 && !gains_; gain /= 10) {
        double* value = factor_->matrix().valuePtr();
        for (int place = 0; place < space_.node_count(); ++place) {
            const int n = factor_->node_at(place);
            for (int b = 0; b < 3; ++b) {
                for (const auto& [m, block, mirror] : neighbor_[n]) {
                    for (int a = m == n ? b : 0; a < 3; ++a) {
                        *value++ = stiffness_[block](b, a) + stiffness_[mirror](a, b) +
                                   2 * held_[block](a, b) + (a == b ? inertia_[block] / gain : 0);
                    }
                }
            }
        }
        gains_ = factor_->factor();
    }
}

void CoarseSpace::add(const Vec3Array& force, double step, double keep, Vec3Array& velocity) const {
    space_.add(factor_->solved(step * space_.restricted(force)), keep, velocity);
}

}  // namespace swage

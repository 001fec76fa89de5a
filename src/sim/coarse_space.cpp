// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/coarse_space.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kReach = 2;  // nodes along an axis that share particles
constexpr int kSide = 2 * kReach + 1, kNear = kSide * kSide * kSide;
constexpr double kFinest = 4;  // cells an element
// Of a banded factor: beside an iteration's own work, and what costs next to nothing.
constexpr double kEntriesPerParticle = 10, kFewEntries = 2e4;
constexpr double kMostWork = 4e8;   // multiplications that a banded factor may take
constexpr double kStaleTurn = 0.1;  // of a cell's edge, over its length
constexpr double kStep = 1e-8;      // of a cell, for differences
constexpr double kLoosest = 1e-6;   // of the largest inertia, that every node has

// The number of a way from a node's place to another.
int near_of(const Vec3i& way) { return kNear / 2 + way.x() + kSide * (way.y() + kSide * way.z()); }

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
    : lattice_(matter.lattice),
      space_(lattice_, matter.connection, elements_of(lattice_, matter.particle_count())) {
    find_pattern();
    choose_turns();
    stiffness_.assign(neighbor_.size(), Mat3::Zero());
    held_.assign(neighbor_.size(), Mat3::Zero());
    choose_samples();
}

void CoarseSpace::choose_samples() {
    const Vec3i elements = space_.grid() - Vec3i::Constant(2);
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

void CoarseSpace::find_pattern() {
    const SplineParts& parts = space_.parts();
    std::vector<std::vector<int>> near(static_cast<std::size_t>(space_.node_count()));
    const auto way_to = [&](int n, int m) { return near_of(parts.place[m] - parts.place[n]); };
    for (std::size_t n = 0; n < near.size(); ++n) near[n].push_back(static_cast<int>(n));
    for (const SplineParts::Nodes& nodes : parts.node) {
        for (int n : nodes) near[n].insert(near[n].end(), nodes.begin(), nodes.end());
    }
    std::vector<std::pair<int, int>> pair;
    for (int n = 0; n < space_.node_count(); ++n) {
        std::sort(near[n].begin(), near[n].end(), [&](int a, int b) {
            return std::pair(way_to(n, a), a) < std::pair(way_to(n, b), b);
        });
        near[n].erase(std::unique(near[n].begin(), near[n].end()), near[n].end());
        auto next = near[n].begin();
        for (int way = 0; way < kNear; ++way) {
            first_.push_back(static_cast<int>(neighbor_.size()));
            for (; next != near[n].end() && way_to(n, *next) == way; ++next) {
                neighbor_.push_back({*next, 0});
                if (*next >= n) pair.emplace_back(n, *next);
            }
        }
    }
    first_.push_back(static_cast<int>(neighbor_.size()));

    factor_ = std::make_unique<PanelCholesky>(space_.node_count(), pair);
    from_here_.resize(near.size());
    for (int n = 0; n < space_.node_count(); ++n) {
        for (int at = first_[n * kNear]; at < first_[(n + 1) * kNear]; ++at) {
            Neighbor& to = neighbor_[at];
            to.mirror = neighbor_at(to.node, n);
            if (factor_->place_of(to.node) >= factor_->place_of(n)) from_here_[n].push_back(at);
        }
        std::sort(from_here_[n].begin(), from_here_[n].end(), [&](int a, int b) {
            return factor_->place_of(neighbor_[a].node) < factor_->place_of(neighbor_[b].node);
        });
    }
}

int CoarseSpace::neighbor_at(int node, int other) const {
    const std::vector<Vec3i>& place = space_.parts().place;
    const Vec3i way = place[other] - place[node];
    if (way.cwiseAbs().maxCoeff() > kReach) return -1;
    const int number = node * kNear + near_of(way);
    for (int at = first_[number]; at < first_[number + 1]; ++at) {
        if (neighbor_[at].node == other) return at;
    }
    return -1;
}

// Nodes five places apart pull on no node both. Of those at one place some may.
void CoarseSpace::choose_turns() {
    const std::vector<Vec3i>& place = space_.parts().place;
    std::map<std::array<int, 3>, std::vector<int>> at_place;
    std::vector<int> round(place.size(), 0);
    std::map<std::array<int, 4>, std::size_t> number;  // by place modulo five, and round
    for (int n = 0; n < space_.node_count(); ++n) {
        std::vector<int>& others = at_place[{place[n].x(), place[n].y(), place[n].z()}];
        const auto meets = [&](int other) {
            if (round[other] != round[n]) return false;
            for (int at = first_[n * kNear]; at < first_[(n + 1) * kNear]; ++at) {
                if (neighbor_at(neighbor_[at].node, other) >= 0) return true;
            }
            return false;
        };
        while (std::any_of(others.begin(), others.end(), meets)) ++round[n];
        others.push_back(n);
        const Vec3i to = place[n].unaryExpr([](int i) { return i % kSide; });
        const auto [at, is_new] =
            number.try_emplace({to.z(), to.y(), to.x(), round[n]}, turn_.size());
        if (is_new) turn_.emplace_back();
        turn_[at->second].push_back(n);
    }
}

void CoarseSpace::find_stiffness(Aggregate& matter, const Forces& forces) {
    const double step = kStep * lattice_.spacing;
    const Vec3Array position = matter.particle_position;
    Vec3Array here, there;
    forces(here);
    for (const std::vector<int>& nodes : turn_) {
        for (int axis = 0; axis < 3; ++axis) {
            Vector motion = Vector::Zero(3 * space_.node_count());
            for (int n : nodes) motion[3 * n + axis] = step;
            space_.add(motion, 1, matter.particle_position);
            forces(there);
            matter.particle_position = position;
            combine(1, -1, here, there);
            const Vector response = space_.restricted(there) / -step;
            for (int n : nodes) {
                for (int at = first_[n * kNear]; at < first_[(n + 1) * kNear]; ++at) {
                    const auto& [m, mirror] = neighbor_[at];
                    stiffness_[mirror].col(axis) = response.segment<3>(3 * m);
                }
            }
        }
    }
    probed_.clear();
    for (CellId cell : sample_) probed_.push_back(edges(cell, position));
}

void CoarseSpace::find_masses(const std::vector<double>& mass) {
    inertia_.assign(neighbor_.size(), 0.0);
    const std::vector<SplineSpace::PartMasses> sums = space_.masses(mass);
    for (std::size_t part = 0; part < sums.size(); ++part) {
        const SplineParts::Nodes& node = space_.parts().node[part];
        for (int a = 0; a < SplineParts::kNodes; ++a) {
            for (int b = 0; b < SplineParts::kNodes; ++b) {
                inertia_[neighbor_at(node[a], node[b])] +=
                    sums[part][SplineSpace::pair_of(a % 3, b % 3) +
                               6 * SplineSpace::pair_of(a / 3 % 3, b / 3 % 3) +
                               36 * SplineSpace::pair_of(a / 9, b / 9)];
            }
        }
    }
    // Nodes that hardly any particle follows must not stand out by themselves.
    double largest = 0;
    for (int n = 0; n < space_.node_count(); ++n) {
        largest = std::max(largest, inertia_[neighbor_at(n, n)]);
    }
    for (int n = 0; n < space_.node_count(); ++n) {
        inertia_[neighbor_at(n, n)] += kLoosest * largest;
    }
}

// A point follows the nodes as the weighted mean of its carriers does. Nodes of matter that is not
// joined near them have no block between them: what would stand there is added to their own, which
// is more than either sign of it. Of two blocks that mirror each other the one is found that the
// factor asks for.
void CoarseSpace::hold(const Aggregate& matter, const std::vector<HeldPoint>& held,
                       const std::vector<PressedPlaces>& pressed) {
    std::fill(held_.begin(), held_.end(), Mat3::Zero());
    const SplineParts& parts = space_.parts();
    std::vector<double> weight(parts.place.size(), 0.0);
    std::vector<char> follows(weight.size(), 0);
    std::vector<int> nodes;
    const auto follow = [&](ParticleId p, double share) {
        const Vec3 site = (matter.particle_reference.at(p) - lattice_.origin) / lattice_.spacing;
        const auto along = [&](int d) {
            return space_.place(d, static_cast<int>(std::lround(site[d]))).weight;
        };
        const std::array<double, 3> x = along(0), y = along(1), z = along(2);
        const SplineParts::Nodes& node = parts.node[parts.of_particle[p]];
        for (int q = 0; q < SplineParts::kNodes; ++q) {
            const double by = share * x[q % 3] * y[q / 3 % 3] * z[q / 9];
            if (by == 0) continue;
            if (!std::exchange(follows[node[q]], 1)) nodes.push_back(node[q]);
            weight[node[q]] += by;
        }
    };
    const auto comes_first = [&](int a, int b) {
        return factor_->place_of(a) < factor_->place_of(b);
    };
    const auto add = [&](const Mat3& stiffness) {
        std::sort(nodes.begin(), nodes.end(), comes_first);
        for (auto a = nodes.begin(); a != nodes.end(); ++a) {
            for (auto b = a; b != nodes.end(); ++b) {
                const double product = weight[*a] * weight[*b];
                const int at = neighbor_at(*a, *b);
                if (at >= 0) {
                    held_[at] += product * stiffness;
                    continue;
                }
                for (int n : {*a, *b}) held_[neighbor_at(n, n)] += std::abs(product) * stiffness;
            }
        }
        for (int n : nodes) weight[n] = 0, follows[n] = 0;
        nodes.clear();
    };
    for (const HeldPoint& h : held) {
        for (int c = 0; c < 8; ++c) {
            if (h.weight[c] != 0) follow(h.corner[c], h.weight[c]);
        }
        add(h.stiffness);
    }
    for (const PressedPlaces& both : pressed) {
        for (int c = 0; c < 16; ++c) {
            if (both.weight[c] != 0) follow(both.particle[c], both.weight[c]);
        }
        add(both.stiffness * Mat3::Identity());
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
                for (int at : from_here_[n]) {
                    const auto& [m, mirror] = neighbor_[at];
                    for (int a = m == n ? b : 0; a < 3; ++a) {
                        *value++ = stiffness_[at](b, a) + stiffness_[mirror](a, b) +
                                   2 * held_[at](a, b) + (a == b ? inertia_[at] / gain : 0);
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

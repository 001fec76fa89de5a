// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/hinges.h"

#include <algorithm>

namespace swage {

namespace {

struct Connection {
    int direction;
    ParticleId lower, upper;
    Vec3 rest, now;  // from lower to upper [spacings]

    bool is_pressed() const { return direction < kEdgeCount && now.squaredNorm() < 1; }
};

// What is left of those with an end in `loose`.
std::vector<Connection> connections_of(const Aggregate& matter, const std::vector<char>& loose) {
    const Vec3Array& x = matter.particle_position;
    const double a = matter.lattice.spacing;
    std::vector<Connection> all;
    for (const Span& span : matter.lattice.span) {
        const auto& f = kForward[span.direction];
        const SparseArray<float>& weight = matter.connection[span.direction].weight;
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if (!(loose[lower] || loose[upper]) || !(weight[lower] > 0)) continue;
            all.push_back({span.direction, lower, upper, Vec3(f[0], f[1], f[2]),
                           (x.at(upper) - x.at(lower)) / a});
        }
    }
    return all;
}

}  // namespace

std::vector<Hinge> find_hinges(const Aggregate& matter, const std::vector<char>& loose,
                               const std::function<double(const Hinge& connection)>& most) {
    const std::vector<Connection> all = connections_of(matter, loose);
    std::vector<Mat3> turn(loose.size());
    for (std::size_t p = 0; p < loose.size(); ++p) {
        if (loose[p]) turn[p].setZero();
    }
    for (const Connection& c : all) {
        for (ParticleId p : {c.lower, c.upper}) {
            if (loose[p]) turn[p] += c.now * c.rest.transpose();
        }
    }
    for (std::size_t p = 0; p < loose.size(); ++p) {
        if (loose[p]) turn[p] = nearest_rotation(turn[p]);
    }
    const auto turned = [&](const Connection& c, ParticleId at) {
        return (c.now - turn[at] * c.rest).norm() / c.rest.norm() / most({c.direction, c.lower});
    };
    std::vector<double> worst(loose.size(), 1);
    const auto for_each_that_may = [&](const auto& act) {
        for (const Connection& c : all) {
            if (loose[c.lower] && loose[c.upper] && !c.is_pressed()) act(c);
        }
    };
    for_each_that_may([&](const Connection& c) {
        for (ParticleId p : {c.lower, c.upper}) worst[p] = std::max(worst[p], turned(c, p));
    });
    std::vector<Hinge> hinges;
    for_each_that_may([&](const Connection& c) {
        const auto is_worst = [&](ParticleId p) {
            const double t = turned(c, p);
            return t > 1 && t >= worst[p];
        };
        if (is_worst(c.lower) || is_worst(c.upper)) hinges.push_back({c.direction, c.lower});
    });
    return hinges;
}

}  // namespace swage

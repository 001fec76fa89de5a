// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crumbs.h"

#include <algorithm>
#include <map>
#include <utility>

namespace swage {

namespace {

constexpr int kCrumb = 8;  // a piece of fewer particles is less than one cell

}  // namespace

std::vector<char> find_crumbs(const Pieces& pieces) {
    std::vector<int> size(pieces.count, 0);
    for (int piece : pieces.particle_piece) ++size[piece];
    std::vector<char> crumb;
    for (int particles : size) crumb.push_back(particles < kCrumb);
    return crumb;
}

std::vector<char> find_unturned(const Pieces& pieces, const Aggregate& matter) {
    struct Row {
        std::vector<Vec3> end;
        bool is_straight = true;
    };
    std::vector<Row> row(pieces.count);
    const double a = matter.lattice.spacing;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        Row& own = row[pieces.particle_piece[p]];
        const Vec3 at = matter.particle_reference.at(p);
        if (own.end.size() < 2) {
            own.end.push_back(at);
        } else if ((own.end[1] - own.end[0]).cross(at - own.end[0]).norm() > 1e-6 * a * a) {
            own.is_straight = false;
        }
    }
    std::vector<char> unturned;
    for (const Row& own : row) unturned.push_back(own.is_straight);
    return unturned;
}

std::ptrdiff_t particles_in_crumbs(const Pieces& pieces) {
    const std::vector<char> crumb = find_crumbs(pieces);
    return std::count_if(pieces.particle_piece.begin(), pieces.particle_piece.end(),
                         [&](int piece) { return crumb[piece] != 0; });
}

void keep_pieces(const Pieces& pieces, const std::vector<char>& crumb,
                 std::deque<std::vector<SeverEvent>>& plan) {
    const std::vector<int>& of = pieces.particle_piece;
    std::map<std::pair<int, int>, double> held;  // of one by another: weights
    for (const std::vector<SeverEvent>& events : plan) {
        for (const SeverEvent& e : events) {
            const int a = of[e.lower], b = of[e.upper];
            if (crumb[a] && !crumb[b]) held[{a, b}] += e.weight;
            if (crumb[b] && !crumb[a]) held[{b, a}] += e.weight;
        }
    }
    std::vector<int> side(pieces.count, -1);
    std::vector<double> most(pieces.count, 0.0);
    for (const auto& [pair, weight] : held) {
        if (weight > most[pair.first]) most[pair.first] = weight, side[pair.first] = pair.second;
    }
    const auto stays = [&](const SeverEvent& e) {
        const int a = of[e.lower], b = of[e.upper];
        return (crumb[a] && (a == b || side[a] == b)) || (crumb[b] && side[b] == a);
    };
    for (std::vector<SeverEvent>& events : plan) std::erase_if(events, stays);
}

}  // namespace swage

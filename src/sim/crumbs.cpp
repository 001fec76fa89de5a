// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/crumbs.h"

#include <algorithm>
#include <map>
#include <utility>

namespace swage {

namespace {

constexpr int kCrumb = 8;  // a piece of fewer particles is less than one cell

// Of each piece, whether it is less than a cell.
std::vector<char> crumbs_of(const Pieces& pieces) {
    std::vector<int> size(pieces.count, 0);
    for (int piece : pieces.particle_piece) ++size[piece];
    std::vector<char> crumb;
    for (int particles : size) crumb.push_back(particles < kCrumb);
    return crumb;
}

}  // namespace

std::ptrdiff_t particles_in_crumbs(const Pieces& pieces) {
    const std::vector<char> crumb = crumbs_of(pieces);
    return std::count_if(pieces.particle_piece.begin(), pieces.particle_piece.end(),
                         [&](int piece) { return crumb[piece] != 0; });
}

void keep_crumbs(const Aggregate& cut, std::deque<std::vector<SeverEvent>>& plan) {
    const Pieces pieces = find_pieces(cut);
    keep_pieces(pieces, crumbs_of(pieces), plan);
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

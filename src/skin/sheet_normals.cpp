// SPDX-License-Identifier: GPL-3.0-or-later
// From triangle to triangle over the edges at which they turn least or come back most exactly, a
// spanning tree of those, as Hoppe et al. do (Surface Reconstruction from Unorganized Points,
// 1992).
#include "skin/sheet_normals.h"

#include <algorithm>
#include <cmath>

#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

struct EdgeUse {
    std::array<double, 6> ends;  // the lesser first
    int triangle;
    bool is_up;  // the triangle goes round from the lesser to the other
};

struct Turn {
    int from, to;
    double sureness;  // |cosine|
    bool turns_over;  // by their corners the two look to different sides
};

std::vector<EdgeUse> edge_uses(const std::vector<std::array<Vec3, 3>>& triangle) {
    std::vector<EdgeUse> uses;
    for (std::size_t t = 0; t < triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const Vec3 &a = triangle[t][k], &b = triangle[t][(k + 1) % 3];
            const std::array<double, 6> up = {a[0], a[1], a[2], b[0], b[1], b[2]};
            const std::array<double, 6> down = {b[0], b[1], b[2], a[0], a[1], a[2]};
            uses.push_back({std::min(up, down), static_cast<int>(t), up < down});
        }
    }
    std::ranges::stable_sort(uses, {}, &EdgeUse::ends);
    return uses;
}

}  // namespace

std::vector<std::vector<Vec3>> sheet_normals(const std::vector<std::array<Vec3, 3>>& sweep,
                                             double most) {
    std::vector<std::array<Vec3, 3>> triangle;
    std::vector<Vec3> normal;
    for (const auto& t : sweep) {
        const Vec3 area = (t[1] - t[0]).cross(t[2] - t[0]);
        if (!(area.norm() > 0)) continue;
        triangle.push_back(t);
        normal.push_back(area.normalized());
    }
    std::vector<Turn> turns;
    const std::vector<EdgeUse> uses = edge_uses(triangle);
    for (std::size_t n = 1; n < uses.size(); ++n) {
        const EdgeUse &one = uses[n - 1], &other = uses[n];
        if (one.ends != other.ends) continue;
        const double same = normal[one.triangle].dot(normal[other.triangle]);
        const bool runs_on = one.is_up != other.is_up;
        const bool comes_back = (runs_on ? same : -same) < most;
        turns.push_back({one.triangle, other.triangle, std::abs(same), runs_on == comes_back});
    }
    std::ranges::stable_sort(turns, std::ranges::greater(), &Turn::sureness);
    DisjointSets sheets(triangle.size());
    std::vector<std::vector<std::pair<int, bool>>> beside(triangle.size());
    for (const Turn& turn : turns) {
        if (sheets.root(turn.from) == sheets.root(turn.to)) continue;
        sheets.unite(turn.from, turn.to);
        beside[turn.from].emplace_back(turn.to, turn.turns_over);
        beside[turn.to].emplace_back(turn.from, turn.turns_over);
    }
    std::vector<int> sign(triangle.size(), 0);
    for (std::size_t first = 0; first < triangle.size(); ++first) {
        if (sign[first] != 0) continue;
        std::vector<int> open = {static_cast<int>(first)};
        sign[first] = 1;
        while (!open.empty()) {
            const int t = open.back();
            open.pop_back();
            for (const auto& [next, turns_over] : beside[t]) {
                if (sign[next] != 0) continue;
                sign[next] = turns_over ? -sign[t] : sign[t];
                open.push_back(next);
            }
        }
    }
    std::vector<int> sheet;
    std::vector<std::vector<Vec3>> found(sheets.number_sets(sheet));
    for (std::size_t t = 0; t < triangle.size(); ++t) {
        found[sheet[t]].push_back(sign[t] * normal[t]);
    }
    return found;
}

}  // namespace swage

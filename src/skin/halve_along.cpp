// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/halve_along.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "skin/cap_front.h"
#include "skin/divided_mesh.h"
#include "skin/piece_map.h"

namespace swage {

namespace {

constexpr int kRounds = 20;  // a millionth of what was there
// Of the longest edge: none shorter is halved for being crossed twice.
constexpr double kLeastTwice = 1.0 / 16;

// Whether the path, which has both ends on one side, goes over it and back.
bool is_crossed_twice(const BladePath& path, const std::vector<Vec3>& position,
                      const std::vector<double>& height, int from, int to) {
    if ((height[from] > 0) != (height[to] > 0)) return false;
    for (const double share : {0.25, 0.5, 0.75}) {
        const Vec3 place = position[from] + share * (position[to] - position[from]);
        if ((path.height(place) > 0) != (height[from] > 0)) return true;
    }
    return false;
}

std::set<Ends> long_edges(const BladePath& path, double longest, const TriMesh& mesh,
                          const std::vector<Vec3>& position) {
    std::vector<double> height;
    for (const Vec3& p : position) height.push_back(path.height(p));
    std::set<Ends> found;
    for (const Corners& t : mesh.triangle) {
        std::array<double, 3> length;
        double off = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            length[k] = (position[t[(k + 1) % 3]] - position[t[k]]).norm();
            off = std::min(off, std::abs(height[t[k]]));
        }
        const double most = *std::ranges::max_element(length);
        if (off > path.steepest * most || !path.near(path.flat(position[t[0]]), most + longest)) {
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            const auto edge = ends(t[k], t[(k + 1) % 3]);
            const bool is_long =
                most > longest && length[k] > std::max(longest, kNearLongest * most);
            if (is_long || (length[k] > kLeastTwice * longest &&
                            is_crossed_twice(path, position, height, edge.first, edge.second))) {
                found.insert(edge);
            }
        }
    }
    return found;
}

}  // namespace

void halve_edges_along(const BladePath& path, double longest, TriMesh& mesh,
                       std::vector<Vec3>& position, Mount& mount, const Aggregate& matter) {
    const PieceMap pieces(matter);
    for (int round = 0; round < kRounds; ++round) {
        const std::set<Ends> edges = long_edges(path, longest, mesh, position);
        if (edges.empty()) return;
        keep_smooth_normals(mesh);
        std::vector<EdgeCut> halved;
        const auto is_long = [&](int low, int high) { return edges.contains({low, high}); };
        mesh = halve_edges(mesh, is_long, halved);
        for (const EdgeCut& edge : halved) {
            const std::array<BodyPlace, 2> both = {mount.place(edge.low), mount.place(edge.high)};
            mount.add(pieces.beside(0.5 * (both[0].reference + both[1].reference), both));
        }
        finish_mount(mount, matter);
        // A skin that was brought to a volume lies beside where its mount has it.
        std::vector<Vec3> carried;
        skin_positions(mount, matter, carried);
        const auto off = [&](int v) -> Vec3 { return position[v] - carried[v]; };
        for (const EdgeCut& edge : halved) {
            const Vec3& own = carried[position.size()];
            position.push_back(own + 0.5 * (off(edge.low) + off(edge.high)));
        }
    }
}

}  // namespace swage

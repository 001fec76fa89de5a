// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/clip_mesh.h"

#include <map>

namespace swage {

namespace {

// Keeps what lies below the plane, seen along the sign.
void clip_at(int axis, double plane, double sign, TriMesh& mesh) {
    std::vector<Vec3>& x = mesh.position;
    const auto over = [&](int v) { return sign * (x[v][axis] - plane) > 0; };
    std::map<std::pair<int, int>, int> crossing;  // of an edge, its lower vertex first
    const auto between = [&](int a, int b) {
        if (a > b) std::swap(a, b);
        const auto [at, is_new] = crossing.emplace(std::pair{a, b}, static_cast<int>(x.size()));
        if (is_new) {
            const double share = (plane - x[a][axis]) / (x[b][axis] - x[a][axis]);
            Vec3 p = x[a] + share * (x[b] - x[a]);
            p[axis] = plane;
            x.push_back(p);
        }
        return at->second;
    };
    std::vector<Corners> triangle;
    for (const Corners& t : mesh.triangle) {
        const int count = over(t[0]) + over(t[1]) + over(t[2]);
        if (count == 0 || count == 3) {
            triangle.push_back(t);
            continue;
        }
        int k = 0;  // the corner that is alone on its side
        while (over(t[k]) != (count == 1)) ++k;
        const int alone = t[k], next = t[(k + 1) % 3], last = t[(k + 2) % 3];
        const int to_next = between(alone, next), to_last = between(alone, last);
        triangle.push_back({alone, to_next, to_last});
        triangle.push_back({to_next, next, last});
        triangle.push_back({to_next, last, to_last});
    }
    for (Vec3& p : x) p[axis] = sign > 0 ? std::min(p[axis], plane) : std::max(p[axis], plane);
    mesh.triangle = std::move(triangle);
}

}  // namespace

TriMesh clipped_to_box(const TriMesh& mesh, const Box& box) {
    TriMesh clipped;
    clipped.position = mesh.position;
    clipped.triangle = mesh.triangle;
    for (int axis = 0; axis < 3; ++axis) {
        clip_at(axis, box.low[axis], -1, clipped);
        clip_at(axis, box.high[axis], 1, clipped);
    }
    return clipped;
}

}  // namespace swage

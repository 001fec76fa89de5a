// SPDX-License-Identifier: GPL-3.0-or-later
// The middles of the severed edges scatter evenly about the blade's path, so a plane fitted to them
// has no bias. One plane is taken for a whole cut when it parts the ends of all its severed edges,
// else a plane around each point, where that parts what is severed nearest to it. NOTE: in rubble
// no plane does; drawn to one all the same, corners of crumbs went off by several cells.
#include "skin/cut_faces.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "base/principal_axes.h"
#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

// Spacings.
constexpr double kReach = 3;         // of the edges that tell a plane around a point
constexpr double kNear = 1.5;        // of those that it has to part
constexpr double kWholeSlack = 0.2;  // how far beside an edge a plane may pass
constexpr double kSlack = 0.4;

struct Severed {
    Vec3 middle;  // of the edge
    int axis;
    int point;  // one of the face's
};

struct PlaneFit {
    double weight = 0;
    Vec3 sum = Vec3::Zero();
    Mat3 square = Mat3::Zero();

    void add(const Vec3& p, double w) {
        weight += w;
        sum += w * p;
        square += w * p * p.transpose();
    }
    // Normal and height; coordinates must be near the origin of their own.
    CutTarget plane() const {
        const Vec3 mean = sum / weight;
        const Vec3 normal = principal_axes(square / weight - mean * mean.transpose()).axis.col(0);
        return {normal, normal.dot(mean)};
    }
};

std::vector<Severed> severed_edges(const Aggregate& matter, const VoxelSurface& surface) {
    std::vector<Severed> edges;
    for (const VoxelFace& face : surface.face) {
        if (!face.cut || face.direction >= 3) continue;  // one of the two sides
        const auto corner = matter.lattice.cell_corners(face.cell);
        const int other = face.corner ^ 1 << face.direction;
        edges.push_back({0.5 * (matter.particle_reference.at(corner[face.corner]) +
                                matter.particle_reference.at(corner[other])),
                         face.direction, face.point[0]});
    }
    return edges;
}

// `slack`: spacings.
bool parts_all(const CutTarget& plane, const std::vector<Severed>& edges,
               const std::vector<int>& members, const Vec3& origin, double a, double slack) {
    return std::all_of(members.begin(), members.end(), [&](int e) {
        const double off = std::abs(plane.normal.dot(edges[e].middle - origin) - plane.height);
        return off <= a * (0.5 * std::abs(plane.normal[edges[e].axis]) + slack);
    });
}

// That parts what is severed nearest to a place. `members`: of the edges, those of one cut.
std::optional<CutTarget> plane_around(const Vec3& place, const std::vector<Severed>& edges,
                                      const std::vector<int>& members, double a) {
    PlaneFit fit;
    std::vector<int> near;
    for (int e : members) {
        const Vec3 way = edges[e].middle - place;
        const double d2 = way.squaredNorm() / (a * a);
        if (d2 < kReach * kReach) fit.add(way, portable::exp(-d2 / 2.25));
        if (d2 < kNear * kNear) near.push_back(e);
    }
    if (fit.weight <= 0) return std::nullopt;
    const CutTarget plane = fit.plane();
    if (!parts_all(plane, edges, near, place, a, kSlack)) return std::nullopt;
    return CutTarget{plane.normal, plane.height + plane.normal.dot(place)};
}

}  // namespace

std::optional<CutTarget> cut_plane_near(const Aggregate& matter, const Vec3i& site) {
    constexpr int kCells = static_cast<int>(kReach);
    std::vector<std::array<int, 4>> found;  // lower site and axis; cells share edges
    for (int n = 0; n < 8 * kCells * kCells * kCells; ++n) {
        const Vec3i step(n % (2 * kCells), n / (2 * kCells) % (2 * kCells),
                         n / (4 * kCells * kCells));
        const Vec3i low = site + step - Vec3i::Constant(kCells);
        const CellId cell = matter.lattice.cell_at(low);
        if (cell < 0) continue;
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        for (int c = 0; c < 8; ++c) {
            const Vec3i at = low + corner_step(c);
            for (int axis = 0; axis < 3; ++axis) {
                if (c >> axis & 1 || matter.connection[axis].weight[corner[c]] > 0) continue;
                found.push_back({at.x(), at.y(), at.z(), axis});
            }
        }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<Severed> edges;
    std::vector<int> all;
    for (const auto& [i, j, k, axis] : found) {
        all.push_back(static_cast<int>(edges.size()));
        edges.push_back({Vec3(i, j, k) + 0.5 * Vec3::Unit(axis), axis, -1});
    }
    return plane_around(site.cast<double>(), edges, all, 1);
}

std::vector<std::optional<CutTarget>> cut_targets(const Aggregate& matter,
                                                  const VoxelSurface& surface,
                                                  const std::vector<Vec3>& place) {
    std::vector<std::optional<CutTarget>> target(surface.site.size());
    const std::vector<Severed> edges = severed_edges(matter, surface);
    if (edges.empty()) return target;
    const double a = matter.lattice.spacing;

    DisjointSets patches(surface.site.size());
    for (const VoxelFace& face : surface.face) {
        for (int k = 1; k < 4 && face.cut; ++k) patches.unite(face.point[0], face.point[k]);
    }
    std::vector<std::vector<int>> members(surface.site.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        members[patches.root(edges[e].point)].push_back(static_cast<int>(e));
    }
    std::vector<char> on_cut(surface.site.size(), 0);
    for (const VoxelFace& face : surface.face) {
        for (int k = 0; k < 4 && face.cut; ++k) on_cut[face.point[k]] = 1;
    }
    std::vector<std::optional<CutTarget>> whole(surface.site.size());  // by patch, about its first
    for (std::size_t p = 0; p < members.size(); ++p) {
        if (members[p].empty()) continue;
        const Vec3 origin = edges[members[p].front()].middle;
        PlaneFit fit;
        for (int e : members[p]) fit.add(edges[e].middle - origin, 1);
        const CutTarget plane = fit.plane();
        if (!parts_all(plane, edges, members[p], origin, a, kWholeSlack)) continue;
        whole[p] = CutTarget{plane.normal, plane.height + plane.normal.dot(origin)};
    }
    for (std::size_t s = 0; s < target.size(); ++s) {
        if (!on_cut[s]) continue;
        const int patch = patches.root(static_cast<int>(s));
        target[s] = whole[patch];
        if (!target[s]) target[s] = plane_around(place[s], edges, members[patch], a);
    }
    return target;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that a blade's edge sweeps: a plane; a relief over one where the edge is bent, or
// goes round a bend, or turns; or one round an axis, of an edge that goes all around.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "base/math.h"
#include "geometry/box.h"
#include "geometry/triangle_tree.h"

namespace swage {

// How far a path lies off its plane or axis: linear on each triangle, and beside them as at their
// rim.
struct Relief {
    TriangleTree flat;                          // the triangles, as (across, up, 0)
    std::vector<std::array<double, 3>> height;  // of their corners [m]
    std::vector<std::array<Vec3, 3>> swept;     // as they lie in the world
    Vec3 point;                                 // the path's then

    double at(const Vec2& p) const;
};

// Where a path lies: over a plane, or round an axis, seen from which it is a band. Along the band
// and around it is `flat`, as places of a plane: those of a band lie around the origin.
struct BladePath {
    Vec3 point, normal;  // of the plane; normal = across cross up
    Vec3 across, up;     // unit, in the plane
    // More than 0 of a path round the axis `up` through `point`: what is added to the way along
    // that to have a distance from the origin [m].
    double first = 0;
    double radius = 0;                          // of that one, in the mean [m]
    std::vector<std::array<Vec2, 3>> triangle;  // flat
    std::vector<std::array<Vec2, 2>> outline;   // edges that only one triangle has
    std::shared_ptr<const Relief> relief;       // none: the path is the plane
    double steepest =
        1;  // how much faster height() changes than the distance from the path, at most

    // From the path along the normal, or away from the axis [m].
    double height(const Vec3& p) const;
    Vec2 flat(const Vec3& p) const;
    Vec3 world(const Vec2& p) const;
    Vec2 middle(const Vec2& a, const Vec2& b) const;
    Vec2 middle(const Vec2& a, const Vec2& b, const Vec2& c) const;
    Vec3 rise(const Vec3& p) const;  // unit: where height() grows
    // 1 or -1: on which side of the triangles themselves. Round an axis height() is bent between
    // their corners: what is severed, which goes by them, may lie on the other side of that.
    int side(const Vec3& p) const;
    bool covers(const Vec2& p) const { return near(p, 0); }
    bool near(const Vec2& p, double reach) const;  // within `reach` [m] of the swept part
};

// Nothing when the triangles leave a common plane by more than `tolerance` [m], or have no area.
std::optional<BladePath> flat_path(const std::vector<std::array<Vec3, 3>>& sweep, double tolerance);

// Over the plane from which the triangles lean away least, or else round an axis. Nothing when one
// leans by more than 80 degrees, or where they lie over each other by more than `tolerance` [m].
// `box`: of what is asked for.
std::optional<BladePath> bent_path(const std::vector<std::array<Vec3, 3>>& sweep, const Box& box,
                                   double tolerance);

// The paths of blades, one each; of one that has several, as of a blade that cuts, draws back, goes
// aside and cuts again, those that part the box.
struct BladePaths {
    std::vector<BladePath> path;
    bool has_folded = false;  // a sweep is neither
};
// `box`: of what may be parted. `tolerance`: how far off a plane its triangles may be [m]; off each
// other fifty times that, for a blade that comes back has other chords.
BladePaths blade_paths(const std::vector<std::array<Vec3, 3>>& sweep, const Box& box,
                       double tolerance);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies with their meshes, and ways to break them by load.
#pragma once

#include "skin/broken_skin.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "geometry/box_mesh.h"
#include "skin/cut_mesh.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/boundary.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

namespace swage::test {

// Breaks by load what `broken` says of a connection's two ends.
inline void break_where(Aggregate& m, const std::function<bool(const Vec3&, const Vec3&)>& broken) {
    for (ConnectionArrays& all : m.connection) all.damage.assign(m.particle_count(), 0.0f);
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if (!broken(m.particle_reference.at(lower), m.particle_reference.at(upper))) continue;
            if (m.connection[span.direction].weight[lower] <= 0) continue;  // a blade was there
            m.connection[span.direction].weight.set(lower, 0);
            m.connection[span.direction].damage[lower] = 1;
        }
    }
}

// A share of all connections.
inline void break_at_random(Aggregate& m, double share) {
    std::mt19937 random(5);
    break_where(m,
                [&](const Vec3&, const Vec3&) { return random() < share * std::mt19937::max(); });
}

inline void break_along(Aggregate& m, const Vec3& point, const Vec3& normal) {
    break_where(m, [&](const Vec3& p, const Vec3& q) {
        return (normal.dot(p - point) >= 0) != (normal.dot(q - point) >= 0);
    });
}

struct BrokenFixture {
    Aggregate matter;
    TriMesh mesh;
    Mount mount;
    BrokenSkin broken;

    BrokenFixture(Aggregate body, TriMesh skin) : matter(std::move(body)), mesh(std::move(skin)) {
        mount = mount_mesh(mesh.position, matter, SkinKind::mount);
    }
    // The quarter plane from `point` on along u and v, or all of the plane.
    void cut(const Vec3& point, const Vec3& u, const Vec3& v, bool all) {
        const auto at = [&](double s, double t) -> Vec3 { return point + 3 * (s * u + t * v); };
        const double low = all ? -1 : 0;
        const CutResult result =
            cut_skin(mesh, mesh.position, mount, matter,
                     {{at(low, -1), at(1, -1), at(1, 1)}, {at(low, -1), at(1, 1), at(low, 1)}});
        CHECK(result.cuts == 1);
        CHECK(result.open_parts == 0);
    }
    void break_it(double roughness = 0) { broken = break_skin(mesh, mount, matter, roughness); }
    TriMesh now() const {
        TriMesh moved = broken.mesh;
        skin_positions(broken.mount, matter, moved.position);
        return moved;
    }
};

// The least height of a triangle [m].
inline double thinnest(const TriMesh& mesh) {
    double least = std::numeric_limits<double>::infinity();
    for (const Corners& c : mesh.triangle) {
        const Vec3 &p = mesh.position[c[0]], &q = mesh.position[c[1]], &r = mesh.position[c[2]];
        const double longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
        least = std::min(least, (q - p).cross(r - p).norm() / longest);
    }
    return least;
}

// Of the parts of a surface that hang together the least volume [m3].
inline double least_volume(const TriMesh& mesh) {
    const Components parts = surface_components(mesh);
    std::vector<double> volume(parts.count, 0.0);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const Corners& c = mesh.triangle[t];
        const Vec3 &p = mesh.position[c[0]], &q = mesh.position[c[1]], &r = mesh.position[c[2]];
        volume[parts.triangle_component[t]] += p.dot(q.cross(r)) / 6;
    }
    return *std::min_element(volume.begin(), volume.end());
}

// Textured by place, four big triangles... a box of twelve triangles and a bar of its cells.
inline BrokenFixture bar() {
    TriMesh mesh = box_mesh(Vec3(-.5, -.15, -.15), Vec3(.5, .15, .15));
    for (const Corners& t : mesh.triangle) {
        Corners uv;
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = mesh.position[t[k]];
            uv[k] = static_cast<int>(mesh.uv.size());
            mesh.uv.push_back({p.x() + 2 * p.y(), p.z() - p.x()});
        }
        mesh.triangle_uv.push_back(uv);
    }
    smooth_by_crease_angle(mesh, 0.6);
    return {make_block(20, 6, 6, 0.05, Material{}), mesh};
}

inline BrokenFixture ball() {
    const double a = 1.0 / 9;
    Aggregate matter = make_shape([](const Vec3& p) { return p.norm() - .5; },
                                  Vec3::Constant(-.5 - .07 * a), Vec3i::Constant(10), a);
    TriMesh mesh = boundary_now(matter);
    return {std::move(matter), std::move(mesh)};
}

inline BrokenFixture body(int number) { return number == 0 ? bar() : ball(); }

}  // namespace swage::test

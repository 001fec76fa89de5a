// SPDX-License-Identifier: GPL-3.0-or-later
// Normals on triangles that were divided are those that the whole ones have there.
#include "skin/broken_skin.h"
#include "skin/diced_skin.h"
#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// The largest error of the normals on what is left of a mesh's surface, at its own places, against
// the straight line between those at the corners of the triangle that it was part of.
double worst_shade(const TriMesh& part, const TriMesh& whole) {
    const std::vector<Vec3> corner = smooth_normals(whole, whole.position);
    const std::vector<Vec3> normal = smooth_normals(part, part.position);
    double worst = 0;
    for (std::size_t t = 0; t < part.triangle.size(); ++t) {
        if (part.triangle_uv[t][0] < 0) continue;  // a new face
        for (int k = 0; k < 3; ++k) {
            const Vec3& p = part.position[part.triangle[t][k]];
            double nearest = 1e30;
            Vec3 should = Vec3::Zero();
            for (std::size_t f = 0; f < whole.triangle.size(); ++f) {
                const auto& [a, b, c] = whole.triangle[f];
                Mat3 base;
                base << whole.position[a], whole.position[b], whole.position[c];
                Vec3 weight = base.inverse() * p;  // in the cone from the origin
                weight /= weight.sum();
                const double off = (base * weight - p).norm() - std::min(0.0, weight.minCoeff());
                if (!(off < nearest)) continue;
                nearest = off;
                const Corners& g = whole.triangle_smooth[f];
                should =
                    weight[0] * corner[g[0]] + weight[1] * corner[g[1]] + weight[2] * corner[g[2]];
            }
            REQUIRE(nearest < 1e-9);
            const Vec3& is = normal[part.triangle_smooth[t][k]];
            worst = std::max(worst, (is - should.normalized()).norm());
        }
    }
    return worst;
}

}  // namespace

TEST_CASE("what is left of a surface shades as before, diced, cut or broken") {
    Fixture f(test::sphere_mesh(.14, 1));
    const TriMesh whole = f.mesh;
    SECTION("diced") {
        const DicedSkin diced = dice_skin(whole, f.matter.lattice, {}, [](auto&) { return true; });
        CHECK(diced.mesh.triangle.size() > 2 * whole.triangle.size());
        CHECK(worst_shade(diced.mesh, whole) < 1e-6);
    }
    SECTION("cut, and cut again") {
        for (const Vec3& normal : {Vec3(1, .3, .2), Vec3(-.2, 1, .4)}) {
            sever_plane(f.matter, Vec3(.02, .01, 0), normal.normalized());
            REQUIRE(f.cut(sweep_of({.02, .01, 0}, normal.normalized(), 3)).cuts == 1);
            CHECK(worst_shade(f.mesh, whole) < 1e-6);
        }
    }
    SECTION("broken") {
        for (ConnectionArrays& all : f.matter.connection) {
            all.damage.assign(f.matter.particle_count(), 0.0f);
        }
        for (const Span& span : f.matter.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                const ParticleId lower = span.lower + n;
                const bool is_low = f.matter.particle_reference.at(lower).x() < .01;
                if (is_low == (f.matter.particle_reference.at(span.upper + n).x() < .01)) continue;
                f.matter.connection[span.direction].weight.set(lower, 0);
                f.matter.connection[span.direction].damage[lower] = 1;
            }
        }
        const BrokenSkin broken = break_skin(whole, f.mount, f.matter);
        REQUIRE(broken.faces > 0);
        CHECK(worst_shade(broken.mesh, whole) < 1e-6);
    }
}

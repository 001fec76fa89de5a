// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cut_layout.h"

#include "skin/new_look.h"
#include "tests/skin/cut_fixture.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("cut faces have a place in an image that is in metres and stays in every frame") {
    for (const bool is_textured : {true, false}) {
        Fixture f(bar());
        if (!is_textured) f.mesh.uv.clear(), f.mesh.triangle_uv.clear();
        const Vec3 normal = Vec3(1, 1, 0.01).normalized();  // no axis before another
        f.cut(sweep_of({.0213, 0, 0}, normal, 1));
        const TriMesh before = f.mesh;
        lay_out_cuts(f.mesh);
        REQUIRE(f.mesh.triangle_uv.size() == f.mesh.triangle.size());
        int cut = 0;
        for (std::size_t t = 0; t < f.mesh.triangle.size(); ++t) {
            const Corners& uv = f.mesh.triangle_uv[t];
            if (f.mesh.material[f.mesh.triangle_material[t]].name != kCutMaterial) {
                CHECK(uv == (is_textured ? before.triangle_uv[t] : Corners{-1, -1, -1}));
                continue;
            }
            ++cut;
            for (int k = 0; k < 3; ++k) {  // both sides see it along x
                const Vec3& place = f.mesh.position[f.mesh.triangle[t][k]];
                REQUIRE(uv[k] >= 0);
                CHECK(f.mesh.uv[uv[k]] == Vec2(place.y(), place.z()));
            }
        }
        CHECK(cut > 100);
        TriMesh again = f.mesh;
        lay_out_cuts(again);
        CHECK(again.triangle_uv == f.mesh.triangle_uv);
        CHECK(again.uv == f.mesh.uv);
    }
}

TEST_CASE("a material that a mesh calls cut is not laid out") {
    TriMesh mesh = bar();
    mesh.material.resize(1);
    mesh.material[0].name = kCutMaterial;
    mesh.triangle_material.assign(mesh.triangle.size(), 0);
    lay_out_cuts(mesh);
    CHECK(mesh.triangle_uv.empty());
}

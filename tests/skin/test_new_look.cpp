// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/new_look.h"

#include <algorithm>
#include <memory>
#include <set>
#include <tuple>

#include "geometry/box_mesh.h"
#include "skin/cut_mesh.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/boundary.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

// A side of a box: 0 to 5, by its outward normal.
int side_of(const TriMesh& mesh, const Corners& triangle) {
    const Vec3& a = mesh.position[triangle[0]];
    const Vec3 normal = (mesh.position[triangle[1]] - a).cross(mesh.position[triangle[2]] - a);
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return 2 * axis + (normal[axis] > 0);
}

// The texture of each side is another, and turned another way: seams run along all edges.
Vec2 texture_of(int side, const Vec3& place) {
    const int u = (side / 2 + 1) % 3, v = (side / 2 + 2) % 3;
    return Vec2(10.0 * side + place[u], 3.0 * side + (side % 2 ? -1 : 2) * place[v]);
}

// The box around a block of cells, textured, one material a side.
TriMesh textured_box(const Aggregate& block) {
    Box box;
    for (std::size_t p = 0; p < block.particle_count(); ++p)
        box.grow(block.particle_reference.at(p));
    TriMesh mesh = box_mesh(box);
    for (int side = 0; side < 6; ++side) {
        mesh.material.emplace_back();
        mesh.material.back().name = std::to_string(side);
        mesh.material.back().texture = "/texture.png";
    }
    for (const Corners& triangle : mesh.triangle) {
        const int side = side_of(mesh, triangle);
        const int at = static_cast<int>(mesh.uv.size());
        for (int v : triangle) mesh.uv.push_back(texture_of(side, mesh.position[v]));
        mesh.triangle_uv.push_back({at, at + 1, at + 2});
        mesh.triangle_material.push_back(side);
        mesh.triangle_part.push_back(side % 2);
    }
    mesh.part_name = {"low", "high"};
    for (const Vec3& p : mesh.position) mesh.position_color.push_back(p.cast<float>());
    return mesh;
}

}  // namespace

TEST_CASE("a boundary made anew keeps the mesh's texture, materials and colours, seams too") {
    const Aggregate block = test::make_block(7, 4, 3, 0.1, Material{});
    const NewLook look(textured_box(block));
    const TriMesh mesh = test::boundary_now(block, &look);
    REQUIRE(mesh.material.size() == 6);
    REQUIRE(mesh.part_name.size() == 2);
    double worst = 0, off = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const int side = side_of(mesh, mesh.triangle[t]);
        REQUIRE(mesh.triangle_material[t] == side);
        REQUIRE(mesh.triangle_part[t] == side % 2);
        for (int c = 0; c < 3; ++c) {
            const int at = mesh.triangle_uv[t][c];
            REQUIRE(at >= 0);
            const Vec3& place = mesh.position[mesh.triangle[t][c]];
            worst = std::max(worst, (mesh.uv[at] - texture_of(side, place)).norm());
        }
    }
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        off = std::max(off, (mesh.position_color[v].cast<double>() - mesh.position[v]).norm());
    }
    CHECK(worst < 1e-9);
    CHECK(off < 1e-6);
}

TEST_CASE("faces of a boundary share their places in the texture, all but across seams") {
    const Aggregate block = test::make_block(7, 4, 3, 0.1, Material{});
    const NewLook look(textured_box(block));
    const TriMesh mesh = test::boundary_now(block, &look);
    std::set<std::tuple<int, double, double>> different;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
            const Vec2& uv = mesh.uv[mesh.triangle_uv[t][c]];
            different.emplace(mesh.triangle[t][c], uv.x(), uv.y());
        }
    }
    CHECK(different.size() == mesh.uv.size());
    CHECK(mesh.uv.size() < 1.5 * double(mesh.position.size()));
}

TEST_CASE("faces across a seam take nothing of the picture that belongs to no side of it") {
    const Aggregate block = test::make_block(7, 4, 3, 0.1, Material{});
    TriMesh mesh = textured_box(block);
    // A seam round the middle that no face of a cell ends at: left of it the picture is another.
    const double seam = 0.07;
    TriMesh halves = mesh;
    halves.triangle.clear(), halves.triangle_uv.clear(), halves.uv.clear();
    halves.triangle_material.clear(), halves.triangle_part.clear();
    halves.position.clear(), halves.position_color.clear();
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int half : {0, 1}) {
            const auto on_half = [&](int v) {
                Vec3 p = mesh.position[v];
                p.x() = half ? std::max(p.x(), seam) : std::min(p.x(), seam);
                return p;
            };
            const auto& [a, b, c] = mesh.triangle[t];
            const Vec3 corner[] = {on_half(a), on_half(b), on_half(c)};
            const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
            const int side = mesh.triangle_material[t];
            if (normal.norm() < 1e-9 || (side == 0 && half) || (side == 1 && !half)) continue;
            Corners triangle{}, uv{};
            for (int k = 0; k < 3; ++k) {
                const auto known =
                    std::find(halves.position.begin(), halves.position.end(), corner[k]);
                triangle[k] = static_cast<int>(known - halves.position.begin());
                if (known == halves.position.end()) halves.position.push_back(corner[k]);
                uv[k] = static_cast<int>(halves.uv.size());
                halves.uv.push_back(texture_of(side, corner[k]) + Vec2(100.0 * half, 0));
            }
            halves.triangle.push_back(triangle);
            halves.triangle_uv.push_back(uv);
            halves.triangle_material.push_back(side);
        }
    }
    halves.part_name.clear();
    const NewLook look(halves);
    const TriMesh anew = test::boundary_now(block, &look);
    const auto is_pictured = [&](const Vec2& at) {
        for (const Corners& uv : halves.triangle_uv) {
            const Vec2 a = halves.uv[uv[0]], u = halves.uv[uv[1]] - a, v = halves.uv[uv[2]] - a;
            const double size = u.x() * v.y() - u.y() * v.x();
            const double s = ((at - a).x() * v.y() - (at - a).y() * v.x()) / size;
            const double r = (u.x() * (at - a).y() - u.y() * (at - a).x()) / size;
            if (s > -1e-9 && r > -1e-9 && s + r < 1 + 1e-9) return true;
        }
        return false;
    };
    std::size_t astray = 0;
    for (const Corners& uv : anew.triangle_uv) {
        for (int corner : uv) astray += !is_pictured(anew.uv[corner]);
    }
    CHECK(astray == 0);
}

namespace {

// Of each side that lies around z the next part of one picture, which begins and ends at an edge:
// as a label is wound round a tin.
Vec2 label_at(int side, const Vec3& p, const Vec3& half) {
    const double x = p.x() + half.x(), y = p.y() + half.y(), wide = 2 * half.x(),
                 deep = 2 * half.y();
    const double u = side == 2   ? x
                     : side == 1 ? wide + y
                     : side == 3 ? 2 * wide + deep - x
                                 : 2 * wide + 2 * deep - y;
    return Vec2(u, p.z());
}

}  // namespace

TEST_CASE("where a picture that is wound round a body ends, no face has both of its ends") {
    const Aggregate block = test::make_block(7, 4, 3, 1, Material{});
    const Vec3 half(3.5, 2, 1.5);
    TriMesh mesh = textured_box(block);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const int side = mesh.triangle_material[t];
        for (int k = 0; k < 3; ++k) {
            if (side >= 4) mesh.triangle_uv[t][k] = -1;
            if (side >= 4) continue;
            const Vec2 uv = label_at(side, mesh.position[mesh.triangle[t][k]], half);
            mesh.uv[mesh.triangle_uv[t][k]] = uv;
        }
    }
    const NewLook look(mesh);
    const TriMesh anew = test::boundary_now(block, &look);
    double worst = 0;
    for (std::size_t t = 0; t < anew.triangle.size(); ++t) {
        const int side = side_of(anew, anew.triangle[t]);
        REQUIRE((anew.triangle_uv[t][0] < 0) == (side >= 4));
        for (int k = 0; k < 3 && side < 4; ++k) {
            const Vec3& place = anew.position[anew.triangle[t][k]];
            const Vec2 uv = anew.uv[anew.triangle_uv[t][k]];
            worst = std::max(worst, (uv - label_at(side, place, half)).norm());
        }
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("where sides have the same picture, no face has a corner of the one beside it") {
    const Aggregate cube = test::make_block(4, 4, 4, 1, Material{});
    TriMesh mesh = textured_box(cube);
    const auto place_on = [](int side, const Vec3& p) {
        return Vec2(p[(side / 2 + 1) % 3], p[(side / 2 + 2) % 3]);
    };
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            mesh.uv[mesh.triangle_uv[t][k]] =
                place_on(mesh.triangle_material[t], mesh.position[mesh.triangle[t][k]]);
        }
    }
    const NewLook look(mesh);
    const TriMesh anew = test::boundary_now(cube, &look);
    double worst = 0;
    for (std::size_t t = 0; t < anew.triangle.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const Vec2 uv =
                place_on(side_of(anew, anew.triangle[t]), anew.position[anew.triangle[t][k]]);
            worst = std::max(worst, (anew.uv[anew.triangle_uv[t][k]] - uv).norm());
        }
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("a texture stays where it was on matter that has moved") {
    Aggregate block = test::make_block(7, 4, 3, 0.1, Material{});
    const NewLook look(textured_box(block));
    const TriMesh before = test::boundary_now(block, &look);
    test::deform(block, [](const Vec3& x) { return Vec3(2 * x.y(), x.x() + x.z(), -x.z()); });
    const TriMesh after = test::boundary_now(block, &look);
    double worst = 0;
    for (std::size_t t = 0; t < after.triangle.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
            const Vec3& place = before.position[after.triangle[t][c]];
            const Vec2 uv = texture_of(after.triangle_material[t], place);
            worst = std::max(worst, (after.uv[after.triangle_uv[t][c]] - uv).norm());
        }
    }
    CHECK(worst < 1e-9);
}

TEST_CASE("faces of a cut have a material of their own and no texture") {
    Aggregate block = test::make_block(8, 4, 4, 0.1, Material{});
    const NewLook look(textured_box(block));
    test::sever_plane(block, {0.03, 0, 0}, Vec3::UnitX());
    const TriMesh mesh = test::boundary_now(block, &look);
    double area = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const auto& [a, b, c] = mesh.triangle[t];
        const bool cut = mesh.material[mesh.triangle_material[t]].name == kCutMaterial;
        CHECK((mesh.triangle_uv[t][0] < 0) == cut);
        const Vec3 &p = mesh.position[a], &q = mesh.position[b], &r = mesh.position[c];
        if (cut) area += 0.5 * (q - p).cross(r - p).norm();
    }
    CHECK(area == Approx(2 * 0.4 * 0.4).epsilon(0.01));
}

TEST_CASE("a cut face looks as most of the mesh does, whichever material comes first") {
    // A small badge of red metal, the first material, on a body of blue plastic.
    Aggregate block = test::make_block(8, 4, 4, 0.1, Material{});
    TriMesh mesh = textured_box(block);
    mesh.uv.clear(), mesh.triangle_uv.clear(), mesh.position_color.clear();
    mesh.material.assign(2, {});
    mesh.material[0].metallic = 1;
    mesh.material[0].color = {1, 0, 0};
    mesh.material[1].color = {0, 0, 1};
    mesh.triangle_material.assign(mesh.triangle.size(), 1);
    mesh.triangle_material[0] = 0;
    const auto is_plastic = [](const TriMesh& cut) {
        const SurfaceMaterial& look = cut.material[cut.triangle_material.back()];
        return look.name == kCutMaterial && look.metallic == 0 && look.color.z() > look.color.x();
    };

    Mount mount = mount_mesh(mesh.position, block, SkinKind::mount);
    TriMesh mounted = mesh;
    const std::vector<std::array<Vec3, 3>> blade = {
        {Vec3(0.03, -9, -9), Vec3(0.03, 9, -9), Vec3(0.03, 0, 9)}};
    cut_skin(mounted, mesh.position, mount, block, blade);
    CHECK(is_plastic(mounted));

    test::sever_plane(block, {0.03, 0, 0}, Vec3::UnitX());
    const NewLook look(mesh);
    TriMesh anew = test::boundary_now(block, &look);
    std::stable_sort(anew.triangle_material.begin(), anew.triangle_material.end());
    CHECK(is_plastic(anew));

    // Of a mesh of one material, and of none.
    for (int materials : {1, 0}) {
        mesh.material.resize(materials);
        mesh.triangle_material.clear();
        const TriMesh plain = test::boundary_now(block, std::make_unique<NewLook>(mesh).get());
        CHECK(plain.material.size() == 2);
        CHECK(plain.material[1].name == kCutMaterial);
    }
}

TEST_CASE("metal is metal inside, a plain colour goes through, what a texture hides is pale") {
    TriMesh mesh = box_mesh(Vec3::Zero(), Vec3::Ones());
    mesh.material.resize(1);
    SurfaceMaterial& look = mesh.material[0];
    const auto cut = [](TriMesh of) { return of.material[cut_material(of, of)]; };
    look.color = {0.8, 0.4, 0.2};
    CHECK(cut(mesh).metallic == 0);
    CHECK(cut(mesh).color.x() > 1.5 * cut(mesh).color.z());
    TriMesh red = mesh;
    red.material[0].color = {0.8, 0.1, 0.1};
    CHECK(cut(red).color.y() < cut(mesh).color.y());
    look.metallic = 1;
    CHECK(cut(mesh).metallic == 1);
    CHECK(cut(mesh).color == look.color);
    look.metallic = 0;
    look.clear = 0.9;  // ice is ice inside
    CHECK(cut(mesh).clear == 0.9);
    CHECK(cut(mesh).color == look.color);
    CHECK(cut(mesh).roughness >= 0.3);
    look.clear = 0;
    look.texture = "/texture.png";
    const Vec3 pale = cut(mesh).color;
    look.color = {0.1, 0.1, 0.8};
    CHECK(cut(mesh).color == pale);
    TriMesh again = mesh;
    CHECK(cut_material(again, mesh) == cut_material(again, mesh));
    CHECK(again.material.size() == 2);
}

TEST_CASE("a mesh's own material that is called as that of cut faces stays its own") {
    Aggregate block = test::make_block(8, 4, 4, 0.1, Material{});
    TriMesh mesh = textured_box(block);
    mesh.material[0].name = kCutMaterial;
    mesh.material[0].color = {0, 1, 0};
    Mount mount = mount_mesh(mesh.position, block, SkinKind::mount);
    TriMesh mounted = mesh;
    for (double place : {0.03, -0.13}) {  // what is cut again has one material of cut faces
        const std::vector<std::array<Vec3, 3>> blade = {
            {Vec3(place, -9, -9), Vec3(place, 9, -9), Vec3(place, 0, 9)}};
        const std::vector<Vec3> position = mounted.position;
        cut_skin(mounted, position, mount, block, blade);
    }
    CHECK(mounted.material.size() == mesh.material.size() + 1);
    for (std::size_t t = 0; t < mounted.triangle.size(); ++t) {
        const bool is_new = mounted.triangle_uv[t][0] < 0;
        CHECK(is_new == (mounted.triangle_material[t] == 6));
    }
    test::sever_plane(block, {0.03, 0, 0}, Vec3::UnitX());
    const TriMesh anew = test::boundary_now(block, std::make_unique<NewLook>(mesh).get());
    CHECK(anew.material.size() == mesh.material.size() + 1);
    CHECK(anew.material[0].color == mesh.material[0].color);
    CHECK(anew.material[6].color != mesh.material[0].color);
}

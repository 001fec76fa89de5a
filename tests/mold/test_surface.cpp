// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/surface.h"

#include "tests/mold/checks.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Carried {
    Vec3i cell;
    Vec3 place;  // in it, 0 to 1
};

// What carries a point, given in cells.
Carried carried(const Vec3& point, const std::vector<Vec3i>& cells) {
    const Aggregate matter =
        make_matter(Vec3::Zero(), 1, {10, 10, 1}, cells, std::vector<float>(cells.size(), 1));
    std::vector<CellLayer> layers(1);
    const Vec3i site = point.array().floor().cast<int>();
    layers[0].patch.push_back({site.x(), site.y(), 2 * point, Vec3::UnitZ(), 1});
    const SurfacePoints points = carry_patches(layers, matter.lattice, matter.cell_fill);
    const Vec3 low = matter.particle_reference.at(points.corner(0)[0]);
    return {low.array().round().cast<int>(), points.place(0)};
}

}  // namespace

TEST_CASE("a point far from all matter is carried by the nearest cell, and drawn in to it") {
    // One cell beside its own, and a nearer one two cells on.
    Carried is = carried({2.95, 0.1, 0.5}, {{4, 0, 0}, {1, 1, 0}});
    CHECK(is.cell == Vec3i(4, 0, 0));
    CHECK((is.place - Vec3(-0.25, 0.1, 0.5)).norm() < 1e-6);
    // On either side.
    is = carried({3.5, 0.5, 0.5}, {{1, 0, 0}, {6, 0, 0}});
    CHECK(is.cell == Vec3i(1, 0, 0));
    CHECK((is.place - Vec3(1.25, 0.5, 0.5)).norm() < 1e-6);
    CHECK(carried({4.5, 0.5, 0.5}, {{1, 0, 0}, {6, 0, 0}}).cell == Vec3i(6, 0, 0));
    // Four cells on.
    CHECK(carried({5.5, 0.5, 0.5}, {{0, 0, 0}, {9, 0, 0}}).cell == Vec3i(9, 0, 0));
    CHECK(carried({4.5, 0.5, 0.5}, {{0, 0, 0}, {9, 0, 0}}).cell == Vec3i(0, 0, 0));
}

TEST_CASE("the two sides of a sheet far thinner than its cells have points of their own") {
    MoldSettings settings;
    settings.spacing = 1;
    settings.kind = MoldKind::shape;
    const TriMesh sheet =
        together(box_mesh({0, 0, 0}, {6, 4, 0.3}), box_mesh({0, 0, 0}, {1, 1, 1}));
    const Aggregate matter = mold(sheet, {}, settings);
    double up = 0, down = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        if (matter.surface_reference(p).x() < 2) continue;
        const Vec3 normal = matter.surface.normal(p);
        CHECK(normal.cwiseAbs().maxCoeff() > 1 - 1e-6);
        if (normal.z() > 0.5) up += matter.surface.area(p);
        if (normal.z() < -0.5) down += matter.surface.area(p);
    }
    CHECK(up == Approx(16));
    CHECK(down == Approx(16));
}

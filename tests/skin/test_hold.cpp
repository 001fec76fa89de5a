// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/box_mesh.h"
#include "skin/cut_mesh.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.05;

// Strained by up to 0.3, otherwise in every cell.
Vec3 uneven(const Vec3& p) {
    return p + .006 * Vec3(std::sin(50 * p.x() + 40 * p.y()), std::sin(45 * p.y() - 50 * p.z()),
                           std::cos(55 * p.x() + 35 * p.z()));
}

double largest_gap(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double gap = 0;
    for (std::size_t v = 0; v < a.size(); ++v) gap = std::max(gap, (a[v] - b[v]).norm());
    return gap;
}

enum class Flowed { nothing, cells, mixed_cells };

// A bar of 1 x 0.3 x 0.3, deformed unevenly.
struct Fixture {
    Aggregate matter = test::make_block(20, 6, 6, kSpacing, Material{});
    TriMesh mesh = divide_edges(box_mesh({-.5, -.15, -.15}, {.5, .15, .15}), kSpacing);
    Mount mount;
    std::vector<Vec3> position;

    Fixture(SkinKind kind, Flowed flowed) {
        mount = mount_mesh(mesh.position, matter, kind);
        const std::size_t cells = matter.cell_fill.size();
        if (flowed == Flowed::cells) matter.cell_history.hardening().assign(cells, .3f);
        for (std::size_t c = 0; c < cells && flowed == Flowed::mixed_cells; ++c) {
            MixedCell& mixed = matter.mixed_cell.emplace_back();
            mixed.cell = static_cast<CellId>(c);
            mixed.flowed[1].back() = .3f;
        }
        test::deform(matter, uneven);
        follow();
    }
    void follow() { skin_positions(mount, matter, position); }
    // The skin alone.
    void cut(const Vec3& point, const Vec3& normal) {
        const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
        const auto at = [&](double s, double t) -> Vec3 { return point + 3 * (s * u + t * v); };
        const CutResult result =
            cut_skin(mesh, position, mount, matter,
                     {{at(-1, -1), at(1, -1), at(1, 1)}, {at(-1, -1), at(1, 1), at(-1, 1)}});
        CHECK(result.cuts == 1);
        follow();
    }
};

}  // namespace

TEST_CASE("a skin lies where it lay as its matter is severed, and goes on from there") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::frame4);
    const Flowed flowed = GENERATE(Flowed::cells, Flowed::mixed_cells);
    Fixture f(kind, flowed);
    double angle = 0;
    for (const auto& [point, way] : {std::pair(Vec3(.0137, 0, 0), Vec3(1, .3, .5)),
                                     std::pair(Vec3(.0071, .01, 0), Vec3(-.5, 1, .1))}) {
        const Vec3 normal = way.normalized();
        const std::vector<Vec3> uncut = f.position;
        f.cut(point, normal);
        const std::vector<Vec3> before = f.position;
        double moved = 0, off = 0;
        for (std::size_t v = 0; v < before.size(); ++v) {
            if (v < uncut.size()) {
                moved = std::max(moved, (before[v] - uncut[v]).norm());
            } else {
                off = std::max(off, std::abs(normal.dot(before[v] - point)));
            }
        }
        CHECK(moved < 1e-8 * kSpacing);
        CHECK(off < 0.01 * kSpacing);

        test::sever_plane(f.matter, point, normal);
        f.follow();
        CHECK(largest_gap(f.position, before) > .05 * kSpacing);  // else this is no test
        hold_places(f.mount, f.matter, before);
        f.follow();
        CHECK(largest_gap(f.position, before) < 1e-8 * kSpacing);

        const Quat turn(Eigen::AngleAxisd(angle += .4, Vec3(0, 1, 1).normalized()));
        test::deform(f.matter, [&](const Vec3& p) -> Vec3 { return turn * uneven(p) + normal; });
        f.follow();
        std::vector<Vec3> should;
        for (const Vec3& p : before) should.push_back(turn * p + normal);
        CHECK(largest_gap(f.position, should) < 1e-7 * kSpacing);
        test::deform(f.matter, uneven);
        f.follow();
    }
}

TEST_CASE("a cut skin that was strained elastically is as it was once its matter is let go") {
    const Flowed flowed = GENERATE(Flowed::nothing, Flowed::cells, Flowed::mixed_cells);
    Fixture f(SkinKind::mount, flowed);
    const Vec3 point(.0137, 0, 0), normal = Vec3(1, .3, .5).normalized();
    f.cut(point, normal);
    const std::vector<Vec3> before = f.position;
    test::sever_plane(f.matter, point, normal);
    hold_places(f.mount, f.matter, before);
    test::deform(f.matter, [](const Vec3& p) { return p; });
    f.follow();
    // What has flowed would not come back like this.
    CHECK((largest_gap(f.position, f.mount.reference) < 1e-6 * kSpacing) ==
          (flowed == Flowed::nothing));
}

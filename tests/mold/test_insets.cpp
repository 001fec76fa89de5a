// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/insets.h"

#include "base/error.h"
#include "geometry/clip_mesh.h"
#include "geometry/make_shape.h"
#include "matter/material_volumes.h"
#include "mold/overhang.h"
#include "tests/mold/checks.h"

using namespace swage;
using namespace swage::test;

namespace {

Aggregate with_inset(const TriMesh& body, const TriMesh& solid, int across) {
    Material light, heavy;
    light.density = 1000, heavy.density = 2000;
    MoldSettings settings;
    settings.across = across;
    return mold(body, light, settings, {{solid, heavy}});
}

// Its insets have densities of 1000 kg/m3 more each.
Aggregate with_insets(const TriMesh& body, const std::vector<TriMesh>& solids, int across,
                      std::vector<std::string>* told = nullptr) {
    std::vector<Inset> insets;
    Material material;
    for (const TriMesh& solid : solids) {
        material.density += 1000;
        insets.push_back({solid, material});
    }
    MoldSettings settings;
    settings.across = across;
    return mold(body, {}, settings, insets, told);
}

// About x.
TriMesh rod() {
    return make_shape("rod", {{"length", 0.2}, {"diameter", 0.02}, {"division", 64}}).mesh;
}

// Reaches out of everything but below y.
Box below(double y) { return {{-1, -1, -1}, {1, y, 1}}; }

// All that lies before a plane through `point`, as far as `reach`.
TriMesh half_space(const Vec3& point, const Vec3& normal, double reach) {
    const TriMesh box = box_mesh({-2 * reach, -reach, -reach}, {0, reach, reach});
    return moved(box, {turn_onto(Vec3::UnitX(), normal), point});
}

}  // namespace

TEST_CASE(
    "of an inset that reaches out of the body, that part is of its material that lies in it") {
    const TriMesh bar = box_mesh({-0.05, -0.01, -0.01}, {0.05, 0.01, 0.01});
    // Up to the plane x = 0.5 y - 0.02.
    TriMesh wedge;
    wedge.position = {{-1, -1, -1}, {-0.52, -1, -1}, {0.48, 1, -1}, {-1, 1, -1},
                      {-1, -1, 1},  {-0.52, -1, 1},  {0.48, 1, 1},  {-1, 1, 1}};
    wedge.triangle = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                      {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    CHECK(with_inset(bar, wedge, 6).mass() == Approx(0.052).epsilon(1e-5));
    // A plane through the middle of a bar halves it, whichever way it looks.
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0.1, 0), Vec3(0.2, 1, 0), Vec3(0.1, -0.3, 1),
                               Vec3(-0.1, 0.7, -0.6), Vec3(3, 2, 1), Vec3(-2, 1, -3)}) {
        INFO("normal " << normal.transpose());
        for (int across : {2, 5}) {
            const TriMesh half = half_space(Vec3::Zero(), normal.normalized(), 1);
            CHECK(with_inset(bar, half, across).mass() == Approx(0.06).epsilon(1e-4));
        }
    }
}

TEST_CASE("cells of a box are filled as if the box were larger than what is in it") {
    const TriMesh knot = moved(knot_mesh(120, 16), some_turn());
    const MoldFrame all = frame_over(box_of(knot.position), 0.21);
    for (const Vec3i& first : {Vec3i(0, 0, 0), Vec3i(2, 3, 1), Vec3i(5, 1, 2)}) {
        MoldFrame part = all;
        part.origin = all.point(2 * first.cast<double>());
        part.cell_count = {6, 7, 4};
        REQUIRE((first + part.cell_count - all.cell_count).maxCoeff() <= 0);
        const auto whole = share_cells(knot, all), own = share_cells(knot, part);
        REQUIRE(own.size() == 4);
        std::size_t cells = 0;
        for (int k = 0; k < 4; ++k) {
            std::size_t next = 0;
            for (const CellFill& s : whole[first.z() + k].share) {
                const int i = s.i - first.x(), j = s.j - first.y();
                if (i < 0 || i >= 6 || j < 0 || j >= 7) continue;
                REQUIRE(next < own[k].share.size());
                const CellFill& same = own[k].share[next++];
                REQUIRE((same.i == i && same.j == j));
                CHECK(same.fill == Approx(s.fill).margin(1e-11));
                CHECK((same.moment - s.moment).norm() < 1e-11);
                ++cells;
            }
            CHECK(next == own[k].share.size());
        }
        CHECK(cells > 8);
    }
}

TEST_CASE("an inset that lies beside the body is refused") {
    const TriMesh bar = box_mesh({0, 0, 0}, {4, 1, 1});
    const TriMesh beside = box_mesh({0, 1.5, 0}, {4, 2, 1});
    CHECK_THROWS_AS(with_inset(bar, beside, 2), Error);
    CHECK_THROWS_AS(with_inset(bar, turned_inside_out(bar), 2), Error);
}

TEST_CASE("an inset too thin for its cells is not said to lie outside the body") {
    const TriMesh bar = box_mesh({-0.05, -0.01, -0.01}, {0.05, 0.01, 0.01});
    const auto told = [&](const TriMesh& solid) {
        std::vector<std::string> findings;
        MoldSettings settings;
        settings.across = 4;
        try {
            mold(bar, Material{}, settings, {{solid, Material{}}}, &findings);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return findings.empty() ? std::string() : findings.at(0);
    };
    // Cells of 5 mm; a slab across half of the section.
    const auto slab = [&](double thickness, double from) {
        return told(box_mesh({0.001, from, -0.005}, {0.001 + thickness, 0.005, 0.005}));
    };
    CHECK(slab(4e-6, -0.005) ==
          "cannot mold: inset 1 is less than a thousandth of each cell that it lies in");
    CHECK(slab(20e-6, -0.005).empty());
    // A tenth of a cell more on one side.
    CHECK(slab(40e-6, -0.0055) ==
          "4.76 % of inset 1 is less than a thousandth of its cell and is left out");
    CHECK(told(box_mesh({1, 1, 1}, {2, 2, 2})) ==
          "cannot mold: inset 1 lies outside the work-piece");
    CHECK(told(box_mesh({0.04, -0.01, -0.01}, {0.06, 0.01, 0.01})) ==
          "50 % of inset 1 lies outside the work-piece and is left out");
    // A box around what has rounded edges is meant to hold all of it.
    CHECK(told(box_mesh({-0.05, -0.0102, -0.01}, {0.05, 0.0102, 0.01})).empty());
}

TEST_CASE("a box that ends within cells of a curved surface has what of it lies in the body") {
    const TriMesh body = rod();
    for (const double y : {-0.007, -0.003, 0.0, 0.004}) {
        const double lower = signed_volume(clipped_to_box(body, below(y)));
        for (const int across : {3, 4, 6, 7}) {
            INFO("below " << y << " at " << across << " across");
            const Aggregate matter = with_insets(body, {box_mesh(below(y))}, across);
            const std::vector<double> volume = material_volumes(matter);
            CHECK(volume[1] == Approx(lower).epsilon(1e-6));
            CHECK(volume[0] + volume[1] == Approx(signed_volume(body)).epsilon(1e-6));
            CHECK(matter.mass() == Approx(1000 * (signed_volume(body) + lower)).epsilon(1e-6));
        }
    }
    // And what of it does not is told.
    std::vector<std::string> told;
    const Box box = box_of(body.position);
    with_insets(body, {box_mesh(box.low, {box.high.x(), -0.006, box.high.z()})}, 3, &told);
    const double share = signed_volume(clipped_to_box(body, below(-0.006))) / (0.2 * 0.02 * 0.004);
    REQUIRE(told.size() == 1);
    CHECK(std::stod(told[0]) == Approx(100 * (1 - share)).epsilon(0.01));
}

TEST_CASE("a mesh that ends within cells of a curved surface has what of it lies in the body") {
    const TriMesh body = rod();
    for (const double angle : {0.3, 0.785}) {
        const Pose turn{Quat(Eigen::AngleAxisd(angle, Vec3(1, 0.3, 0.2).normalized())),
                        Vec3::Zero()};
        for (const double y : {-0.007, -0.003, 0.0013}) {
            const double lower =
                signed_volume(clipped_to_box(moved(body, turn.inverse()), below(y)));
            for (const int across : {3, 6}) {
                INFO("below " << y << " turned by " << angle << " at " << across << " across");
                const TriMesh solid = moved(box_mesh(below(y)), turn);
                const std::vector<double> volume =
                    material_volumes(with_insets(body, {solid}, across));
                CHECK(volume[1] == Approx(lower).epsilon(1e-4));
            }
        }
    }
}

TEST_CASE("where surfaces cannot be cut along each other, places tell what lies in both") {
    const TriMesh body = rod(), solid = box_mesh(below(-0.007));
    const MoldFrame frame = frame_over(box_of(body.position), 0.02 / 6);
    const TriangleTree tree(body);
    const Overhang overhang(tree, solid, frame);
    const auto whole = share_cells(body, frame), own = share_cells(solid, frame);
    double sum = 0;
    for (int k = 0; k < static_cast<int>(own.size()); ++k) {
        for (const CellFill& share : own[k].share) {
            const CellFill* all = share_of(whole, share.i, share.j, k);
            if (all != nullptr) sum += overhang.within(share, k, all->fill).fill;
        }
    }
    const double lower = signed_volume(clipped_to_box(body, below(-0.007)));
    CHECK(sum * frame.cell_volume() == Approx(lower).epsilon(0.02));
}

TEST_CASE("by places, of a cell there is no more in both than the body has, about where it lies") {
    // One cell of 1; the body and the insets fill it up to some height each.
    const MoldFrame frame = frame_over({{0, 0, 0}, {1, 1, 1}}, 1);
    const TriMesh body = box_mesh({0, 0, 0}, {1, 0.69, 1});
    const TriangleTree tree(body);
    const auto within = [&](const TriMesh& solid) {
        const auto layers = share_cells(solid, frame);
        return Overhang(tree, solid, frame).within(layers[0].share[0], 0, 0.69);
    };
    CHECK(within(box_mesh({0, 0, 0}, {1, 1, 1})).fill == Approx(0.69));
    // Their places tell of 0.75 of the body.
    CHECK(within(box_mesh({0, 0, 0}, {0.93, 1, 1})).fill == Approx(0.69));
    const CellFill half = within(box_mesh({0, 0, 0}, {0.5, 1, 1}));
    CHECK(half.fill == Approx(0.5 * 0.69).epsilon(0.1));
    CHECK((half.moment / half.fill - Vec3(-0.25, -0.155, 0)).norm() < 0.04);
    // All of a thin one that lies within, about its own middle.
    const CellFill thin = within(box_mesh({0, 0.1, 0}, {1, 0.11, 1}));
    CHECK(thin.fill == Approx(0.01));
    CHECK(thin.moment.y() / thin.fill == Approx(0.105 - 0.5));
    CHECK(within(box_mesh({0, 0.8, 0}, {1, 1, 1})).fill == 0);
}

TEST_CASE("insets laid over each other are those that lie side by side") {
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 2, 2});
    const auto slab = [](double from, double to) {
        return box_mesh({from, -0.1, -0.1}, {to, 2.1, 2.1});
    };
    for (const double end : {2.4, 2.5, 2.75, 3.0}) {
        const Aggregate over = with_insets(bar, {slab(-1, 8), slab(-1, end)}, 2);
        const Aggregate beside = with_insets(bar, {slab(end, 8), slab(-1, end)}, 2);
        CHECK(over.mass() == Approx(beside.mass()).epsilon(1e-9));
        REQUIRE(over.mixed_cell.size() == beside.mixed_cell.size());
        for (std::size_t n = 0; n < over.mixed_cell.size(); ++n) {
            const MixedCell &one = over.mixed_cell[n], &other = beside.mixed_cell[n];
            CHECK(one.cell == other.cell);
            for (int m : {0, 1}) {
                CHECK(one.material[m] == other.material[m]);
                CHECK(one.fill[m] == Approx(other.fill[m]).epsilon(1e-6));
                CHECK((one.centroid[m] - other.centroid[m]).norm() < 1e-6);
            }
            CHECK((one.normal - other.normal).norm() < 1e-6);
        }
    }
}

TEST_CASE("of insets that overlap within cells each has its volume") {
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 4, 4});
    const auto check = [](const Aggregate& matter, const std::vector<double>& volume) {
        const std::vector<double> has = material_volumes(matter);
        REQUIRE(has.size() == volume.size());
        for (std::size_t m = 0; m < has.size(); ++m) {
            INFO("material " << m);
            CHECK(has[m] == Approx(volume[m]).epsilon(1e-6));
        }
    };
    // Cells of 1. Of a corner that both have each time.
    const TriMesh low = box_mesh({-1, -1, -1}, {2.3, 5, 5}),
                  wide = box_mesh({-1, -1, -1}, {6, 2, 5});
    check(with_insets(bar, {wide, low}, 4), {160 - 48 - 2.3 * 8, 48 - 2.3 * 8, 2.3 * 16});
    // The second takes from the first within the cells where the third takes from both.
    check(with_insets(bar,
                      {box_mesh({1, -1, -1}, {7, 5, 5}), box_mesh({1, 1.5, -1}, {9, 5, 5}),
                       box_mesh({1, 1.5, -1}, {5, 5, 5})},
                      4),
          {160 - 36 - 40 - 40, 36, 40, 40});
    // Boxes that are divided otherwise are meshes.
    const auto divided = [](const TriMesh& box) {
        TriMesh mesh = box;
        const Corners t = mesh.triangle[0];
        const int middle = static_cast<int>(mesh.position.size());
        const Vec3 sum = mesh.position[t[0]] + mesh.position[t[1]] + mesh.position[t[2]];
        mesh.position.emplace_back(sum / 3);
        mesh.triangle[0] = {t[0], t[1], middle};
        mesh.triangle.push_back({t[1], t[2], middle});
        mesh.triangle.push_back({t[2], t[0], middle});
        return mesh;
    };
    const std::vector<double> volume{160 - 48 - 2.3 * 8, 48 - 2.3 * 8, 2.3 * 16};
    check(with_insets(bar, {divided(wide), divided(low)}, 4), volume);
    check(with_insets(bar, {wide, divided(low)}, 4), volume);
    check(with_insets(bar, {divided(wide), low}, 4), volume);
    check(with_insets(bar,
                      {divided(box_mesh({1, -1, -1}, {7, 5, 5})),
                       divided(box_mesh({1, 1.5, -1}, {9, 5, 5})),
                       divided(box_mesh({1, 1.3, -1}, {5, 5, 5}))},
                      4),
          {44, 32.8, 40, 43.2});
}

TEST_CASE("what two later insets take from one is taken once, and the rest lies where it lay") {
    // Cells of 1. The second takes a corner of the first along x and y, the third all of its end.
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 4, 4});
    const Aggregate matter =
        with_insets(bar,
                    {box_mesh({-1, 0.3, -1}, {8, 5, 5}), box_mesh({3.5, 1.5, -1}, {12, 5, 5}),
                     box_mesh({-1, -1, -1}, {2.5, 5, 5})},
                    4);
    int seen = 0;
    for (const MixedCell& cell : matter.mixed_cell) {
        const Vec3i site = matter.lattice.cell_site(cell.cell);
        if (site.x() != 2 || site.y() != 0) continue;
        ++seen;  // of which 0.5, 0.35 and 0.15 are of the third, the first and the body
        CHECK((cell.material[0] == 3 && cell.material[1] == 1));
        CHECK(cell.fill[0] / cell.fill[1] == Approx(0.5 / 0.35).epsilon(1e-5));
        CHECK((cell.centroid[0] - Eigen::Vector3f(-0.25f, 0, 0)).norm() < 1e-5f);
        CHECK((cell.centroid[1] - Eigen::Vector3f(0.25f, 0.15f, 0)).norm() < 1e-5f);
    }
    CHECK(seen == 4);
}

TEST_CASE("a boundary between materials looks along its own normal, also at the body's surface") {
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 4, 4});
    for (const int across : {2, 4}) {
        const Aggregate matter = with_insets(bar, {box_mesh({0, 0, 0}, {2.3, 4, 4})}, across);
        CHECK(matter.mixed_cell.size() == std::size_t(across * across));
        for (const MixedCell& cell : matter.mixed_cell) {
            CHECK(std::abs(cell.normal.x()) > 1 - 1e-6f);
        }
    }
}

TEST_CASE("where the body overlaps itself an inset has no more than its own volume") {
    // Cells of 1 that are filled by three quarters.
    const TriMesh body =
        together(box_mesh({0, 0, 0}, {6.2, 1.5, 2}), box_mesh({6, 0, 0}, {10, 1.5, 2}));
    MoldSettings settings;
    settings.spacing = 1;
    const Aggregate matter =
        mold(body, {}, settings, {{box_mesh({2, 0, 0}, {6.5, 1.5, 2}), Material{}}});
    CHECK(material_volumes(matter)[1] == Approx(4.5 * 1.5 * 2).epsilon(1e-6));
}

TEST_CASE("an inset has its part of slivers that cells have taken") {
    // Filled by three quarters, with a film on top that is less than a thousandth of its cells.
    const TriMesh body =
        together(together(box_mesh({0, 0, 0}, {10, 1.5, 2}), box_mesh({8, 0, 2}, {10, 1.5, 3})),
                 box_mesh({2, 0, 2}, {6, 1.5, 2.0009}));
    MoldSettings settings;
    settings.spacing = 1;
    const Aggregate matter =
        mold(body, {}, settings, {{box_mesh({1, -1, -1}, {4.5, 3, 4}), Material{}}});
    CHECK(material_volumes(matter)[1] == Approx(3.5 * 3 + 2.5 * 1.5 * 0.0009).epsilon(1e-6));
}

TEST_CASE("how much of an inset lies outside is told by its volume, not by whole cells") {
    // Cells of 1 that are filled by three quarters; 9 of 48 lie within.
    std::vector<std::string> told;
    MoldSettings settings;
    settings.spacing = 1;
    mold(box_mesh({0, 0, 0}, {10, 1.5, 2}), {}, settings,
         {{box_mesh({2, -1, -1}, {5, 3, 3}), Material{}}}, &told);
    REQUIRE(told.size() == 1);
    CHECK(std::stod(told[0]) == Approx(81.25).epsilon(2e-3));
}

TEST_CASE("the boundary of two insets is the later one's, whatever else the older one ends at") {
    // Cells of 1: in those across, the first ends at y = 2.9 and the second at x = 4.6.
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 4, 4});
    const Aggregate matter = with_insets(
        bar, {box_mesh({1, 1, -1}, {8, 2.9, 5}), box_mesh({2, -1, -1}, {4.6, 5, 5})}, 4);
    int seen = 0;
    for (const MixedCell& cell : matter.mixed_cell) {
        const Vec3i site = matter.lattice.cell_site(cell.cell);
        if (site.x() != 4 || site.y() != 2 || site.z() == 0 || site.z() == 3) continue;
        ++seen;
        CHECK((cell.material[0] == 2 && cell.material[1] == 1));
        CHECK(std::abs(cell.normal.x()) > 1 - 1e-6f);
    }
    CHECK(seen == 2);
}

TEST_CASE("the two materials of a cell fill it as far as the body does") {
    const TriMesh body = rod();
    for (const double end : {0.0, 0.0021}) {
        const Aggregate matter = with_insets(
            body, {box_mesh({-1, -1, -1}, {end, 1, 1}), box_mesh({-1, -1, -1}, {1, -0.001, 1})}, 5);
        REQUIRE(matter.mixed_cell.size() > 20);
        for (const MixedCell& cell : matter.mixed_cell) {
            CHECK(cell.fill[0] + cell.fill[1] == Approx(matter.cell_fill[cell.cell]).epsilon(1e-5));
        }
    }
}

TEST_CASE("an inset whose parts overlap is not said to lie outside of the body") {
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 2, 2});
    const TriMesh part = box_mesh({1, 0.5, 0.5}, {5, 1.5, 1.5});
    std::vector<std::string> told;
    const Aggregate matter = with_insets(bar, {together(part, part)}, 4, &told);
    CHECK(material_volumes(matter)[1] == Approx(4).epsilon(1e-6));
    CHECK(told == std::vector<std::string>());
}

TEST_CASE("a coat within a cell, between two parts of one material, has its volume") {
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 2, 2});
    Material plain, coat;
    coat.density = 5000;
    const auto slab = [](double to) { return box_mesh({-1, -1, -1}, {to, 3, 3}); };
    for (const int across : {2, 4}) {
        MoldSettings settings;
        settings.across = across;
        for (const double end : {2.5, 2.55, 2.7, 3.05}) {
            INFO("to " << end << " at " << across << " across");
            std::vector<std::string> told;
            const Aggregate matter =
                mold(bar, plain, settings, {{slab(end + 0.2), coat}, {slab(end), plain}}, &told);
            CHECK(material_volumes(matter)[1] == Approx(0.8).epsilon(1e-6));
            CHECK(matter.mass() == Approx(40000 + 0.8 * 4000).epsilon(1e-6));
            CHECK(told.size() == 2);  // that they reach out
        }
    }
    // Of three materials the cell holds two, and that is told.
    std::vector<std::string> told;
    const Aggregate matter = with_insets(bar, {slab(2.6), slab(2.5)}, 2, &told);
    CHECK(material_volumes(matter)[1] == 0);
    REQUIRE(told.size() == 4);
    CHECK(told[2].starts_with("inset 1 has 100 % less than its volume"));
}

TEST_CASE("a seam within cells, between two insets, does not vanish without a word") {
    const TriMesh bar = box_mesh({0, 0, 0}, {10, 2, 2});
    const auto told_of = [&](const std::vector<TriMesh>& solids) {
        std::vector<std::string> told;
        with_insets(bar, solids, 2, &told);
        return told;
    };
    const TriMesh left = box_mesh({0, 0, 0}, {4.5, 2, 2});
    const std::vector<std::string> told = told_of({left, box_mesh({4.6, 0, 0}, {10, 2, 2})});
    REQUIRE(told.size() == 2);  // the first gains 1.1 %, too
    CHECK(
        told[1].starts_with("the work-piece's own matter between inset 1 and inset 2 goes to "
                            "these in 4 cells"));
    // On the edge of cells it has cells of its own two materials.
    CHECK(told_of({box_mesh({0, 0, 0}, {3.95, 2, 2}), box_mesh({4.05, 0, 0}, {10, 2, 2})}).empty());
    // Where three meet along a line none of them parts the others.
    for (const std::string& one :
         told_of({box_mesh({0, 0.9, 0}, {4.5, 2, 2}), box_mesh({4.5, 0.9, 0}, {10, 2, 2})})) {
        INFO(one);
        CHECK(one.find("between") == std::string::npos);
    }
}

TEST_CASE("where two materials meet, what is only rounding is nothing") {
    const TriMesh bar = box_mesh({-0.05, -0.01, -0.01}, {0.05, 0.01, 0.01});
    const Pose about_x{Quat(Eigen::AngleAxisd(0.4, Vec3::UnitX())), Vec3::Zero()};
    const Aggregate m =
        with_inset(bar, moved(box_mesh({-0.03, -0.004, -0.02}, {0.04, 0.03, 0.003}), about_x), 2);
    REQUIRE(m.mixed_cell.size() > 10);
    int nothing = 0;
    for (const MixedCell& cell : m.mixed_cell) {
        for (const Eigen::Vector3f& v : {cell.normal, cell.centroid[0], cell.centroid[1]}) {
            for (int axis = 0; axis < 3; ++axis) {
                CHECK((v[axis] == 0 || std::abs(v[axis]) > 1e-9f));
                nothing += v[axis] == 0;
            }
        }
    }
    CHECK(nothing > 0);
}

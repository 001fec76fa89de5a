// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_hardening.h"

#include "geometry/box_mesh.h"
#include "matter/cell_middle.h"
#include "matter/material_volumes.h"
#include "mold/mold.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"

using namespace swage;
using namespace swage::test;

namespace {

double middle_x(const Aggregate& m, std::size_t cell) {
    double x = 0;
    for (ParticleId p : m.lattice.cell_corners(static_cast<CellId>(cell))) {
        x += 0.125 * m.particle_reference.at(p).x();
    }
    return x;
}

}  // namespace

TEST_CASE("what is molded anew is as hard, place by place, as the matter that was there") {
    const Mechanics mechanics = GENERATE(Mechanics::cells, Mechanics::springs);
    const Material metal{.mechanics = mechanics, .yield_stress = 1e3};
    Aggregate old = make_block(8, 4, 4, 0.1, metal);
    for (std::size_t c = 0; c < old.cell_fill.size(); ++c) {
        old.cell_history.hardening().push_back(static_cast<float>(1 + middle_x(old, c)));
    }
    deform(old, [](const Vec3& x) { return Vec3(1.25 * x.x(), 0.9 * x.y(), 0.9 * x.z()); });
    Aggregate anew = make_block(10, 4, 4, 0.1, metal);  // sticks out a little at the sides
    carry_hardening(old, anew);
    const std::vector<float>& hardening = anew.cell_history.hardening();
    REQUIRE(hardening.size() == anew.cell_fill.size());
    for (std::size_t c = 0; c < anew.cell_fill.size(); ++c) {
        CHECK(std::abs(hardening[c] - (1 + middle_x(anew, c) / 1.25)) < 0.051);
    }
    // All of its history is there, and nothing of it but this.
    if (mechanics == Mechanics::cells) {
        for (int n = 0; n + 1 < kCellHistory; ++n) {
            CHECK(anew.cell_history.row[n] == std::vector<float>(anew.cell_fill.size(), 0.0f));
        }
    } else {
        CHECK(anew.cell_history.row[0].empty());
        CHECK(anew.cell_plastic[0] == std::vector<float>(anew.cell_fill.size(), 0.0f));
    }
}

TEST_CASE("what never flowed gives nothing to what is molded anew") {
    const Aggregate old = make_block(2, 2, 2, 0.1, Material{});
    Aggregate anew = old;
    carry_hardening(old, anew);
    CHECK(anew.cell_history.empty());
}

TEST_CASE("what is molded anew has the back stress that the matter had, turned as it was") {
    const Material metal{
        .young_modulus = 1e6, .yield_stress = 1e3, .back_stress = 600, .back_strain = 0.01};
    Aggregate old = make_block(6, 4, 4, 0.1, metal);
    const std::size_t cells = old.cell_fill.size();
    old.cell_history.assign(cells);
    old.cell_back.assign(cells);
    const double shear = metal.young_modulus / 2.5;
    const double strain = 500 / (3 * shear);  // bears 500 Pa, pulled along x
    for (std::size_t c = 0; c < cells; ++c) {
        old.cell_history.hardening()[c] = 0.01f;
        old.cell_back.row[0][c] = static_cast<float>(strain);
        for (int n : {1, 2}) old.cell_back.row[n][c] = static_cast<float>(-0.5 * strain);
        old.cell_back.row[7][c] = 1e-3f;
    }
    const Mat3 turn = Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitZ()).toRotationMatrix();
    deform(old, [&](const Vec3& x) { return Vec3(turn * x); });
    Aggregate anew = make_block(4, 6, 4, 0.1, metal);
    carry_hardening(old, anew);
    REQUIRE(anew.cell_back.row[0].size() == cells);
    for (std::size_t c = 0; c < cells; ++c) {
        CHECK(anew.cell_back.row[1][c] == Approx(strain).epsilon(1e-5));
        CHECK(anew.cell_back.row[0][c] == Approx(-0.5 * strain).epsilon(1e-5));
        CHECK(std::abs(anew.cell_back.row[3][c]) < 1e-5 * strain);
        CHECK(anew.cell_back.row[7][c] == 0);
    }
    // 1000 - 600 (1 - e^-10) of surface are left: without stress there can be no more than that.
    for (float& one : old.cell_history.hardening()) one = 0.1f;
    carry_hardening(old, anew);
    CHECK(3 * shear * anew.cell_back.row[1][0] == Approx(400).epsilon(2e-3));
}

namespace {

// A bar along x, of another material up to that share of its length.
Aggregate bar_of_two(const Vec3& size, double share, int across) {
    Material soft, hard;
    soft.yield_stress = 1e3, hard.yield_stress = 1e6;
    MoldSettings settings;
    settings.across = across;
    Vec3 to = 0.5 * size;
    to.x() = (share - 0.5) * size.x();
    return mold(box_mesh(-0.5 * size, 0.5 * size), soft, settings,
                {{box_mesh(-0.5 * size, to), hard}});
}

// Calls see(material, place, hardening) with each material of each cell, as molded.
template <typename See>
void for_each_part(Aggregate& m, const See& see) {
    const auto place = [&](CellId cell, const Eigen::Vector3f& centroid) -> Vec3 {
        const Vec3 low = m.particle_reference.at(m.lattice.cell_corners(cell)[0]);
        return low + m.lattice.spacing * (Vec3::Constant(0.5) + centroid.cast<double>());
    };
    for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
        const auto cell = static_cast<CellId>(c);
        if (m.mixed_at(cell) != nullptr) continue;
        see(int(m.cell_material[c]), place(cell, m.cell_centroid[c]),
            m.cell_history.hardening()[c]);
    }
    for (MixedCell& mixed : m.mixed_cell) {
        for (int k : {0, 1}) {
            see(int(mixed.material[k]), place(mixed.cell, mixed.centroid[k]),
                mixed.flowed[k].back());
        }
    }
}

}  // namespace

TEST_CASE("the hardening of what is molded anew stays with the material that has it") {
    // The boundary runs through cells of both, at other places of these.
    Aggregate old = bar_of_two({0.4, 0.1, 0.1}, 0.43, 5);
    REQUIRE(!old.mixed_cell.empty());
    old.cell_history.assign(old.cell_fill.size());
    for_each_part(old, [](int material, const Vec3& at, float& hardening) {
        hardening = static_cast<float>(material == 0 ? 1 + at.x() : 10 + at.x());
    });
    deform(old, [](const Vec3& x) { return Vec3(1.25 * x.x(), 0.9 * x.y(), 0.9 * x.z()); });
    // Where the other was, too, as surfaces that bend by their triangles have it.
    const double share = GENERATE(0.36, 0.43, 0.52);
    Aggregate anew = bar_of_two({0.5, 0.09, 0.09}, share, 4);
    REQUIRE(!anew.mixed_cell.empty());
    carry_hardening(old, anew);
    int seen[2] = {0, 0};
    for_each_part(anew, [&](int material, const Vec3& at, float& hardening) {
        CHECK(std::abs(hardening - (material == 0 ? 1 : 10) - at.x() / 1.25) < 0.06);
        ++seen[material];
    });
    CHECK(seen[0] > 100);
    CHECK(seen[1] > 100);
}

TEST_CASE("what flowed in cells of two materials alone is as hard once it is molded anew") {
    Aggregate old = bar_of_two({0.4, 0.1, 0.1}, 0.43, 5);
    for (MixedCell& mixed : old.mixed_cell) {
        for (int k : {0, 1}) mixed.flowed[k].back() = mixed.material[k] == 0 ? 0.5f : 0;
    }
    REQUIRE(old.cell_history.empty());
    Aggregate anew = bar_of_two({0.4, 0.1, 0.1}, 0.43, 5);
    carry_hardening(old, anew);
    REQUIRE(!anew.mixed_cell.empty());
    for_each_part(anew, [&](int material, const Vec3& at, float& hardening) {
        const bool there = material == 0 && at.x() < -0.02;  // where that cell ends
        CHECK(hardening == (there ? 0.5f : 0));
    });
}

namespace {

// Of each material hardening times volume at molding, as its mean.
std::vector<double> means(const Aggregate& m) {
    std::vector<double> sum(m.material_count(), 0.0), volume = material_volumes(m);
    for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
        const auto cell = static_cast<CellId>(c);
        const double whole = m.lattice.cell_volume() * m.cell_fill[c];
        if (const MixedCell* mixed = m.mixed_at(cell)) {
            const double both = double(mixed->fill[0]) + mixed->fill[1];
            for (int k : {0, 1}) {
                sum[mixed->material[k]] += whole * mixed->fill[k] / both * mixed->flowed[k].back();
            }
        } else {
            sum[m.material_number(cell)] += whole * m.cell_history.hardening_of(cell);
        }
    }
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] /= volume[n];
    return sum;
}

Aggregate ball(double spacing, const Mat3& turn = Mat3::Identity()) {
    Material metal;
    metal.yield_stress = 1e3;
    MoldSettings settings;
    settings.spacing = spacing;
    TriMesh mesh = sphere_mesh(0.5, 3);
    for (Vec3& x : mesh.position) x = turn * x;
    return mold(mesh, metal, settings);
}

}  // namespace

TEST_CASE("flow that a few partly filled cells hold is as much once they are molded anew") {
    // In cells of the same size, of other sizes, and askew to them.
    const double spacing = GENERATE(0.14, 0.13, 0.11, 0.17);
    const Mat3 turn = Eigen::AngleAxisd(GENERATE(0.0, 0.6), Vec3(1, 2, 3).normalized()).matrix();
    Aggregate old = ball(0.14);
    old.cell_history.assign(old.cell_fill.size());
    for (std::size_t c = 0; c < old.cell_fill.size(); ++c) {
        const bool flows = old.cell_fill[c] < 0.35f && middle_x(old, c) > 0.3;
        old.cell_history.hardening()[c] = flows ? 0.2f + float(c % 7) : 0;
    }
    deform(old, [&](const Vec3& x) { return Vec3(turn * x); });
    Aggregate anew = ball(spacing, turn);
    carry_hardening(old, anew);
    CHECK(means(anew)[0] == Approx(means(old)[0]).epsilon(1e-6));
    // It is where it was.
    for (std::size_t c = 0; c < anew.cell_fill.size(); ++c) {
        const Vec3 at = turn.transpose() * cell_middle(anew, static_cast<CellId>(c));
        if (at.x() < 0) CHECK(anew.cell_history.hardening()[c] == 0);
    }
}

TEST_CASE("what has flowed evenly has done so once it is molded anew, in more room or less") {
    Aggregate old = ball(0.14);
    old.cell_history.assign(old.cell_fill.size());
    for (float& one : old.cell_history.hardening()) one = 0.37f;
    const Mat3 turn = Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized()).matrix();
    deform(old, [&](const Vec3& x) { return Vec3(turn * (0.97 * x)); });
    Aggregate anew = ball(0.11);
    carry_hardening(old, anew);
    for (float one : anew.cell_history.hardening()) CHECK(one == Approx(0.37f).epsilon(1e-6));
}

TEST_CASE("each material has as much flow, molded anew, as it had itself") {
    Aggregate old = bar_of_two({0.4, 0.1, 0.1}, 0.43, 5);
    old.cell_history.assign(old.cell_fill.size());
    int number = 0;
    for_each_part(old, [&](int material, const Vec3& at, float& hardening) {
        hardening = ++number % 5 == 0 && std::abs(at.x()) < 0.1 ? (material == 0 ? 1 : 10) : 0;
    });
    for (MixedCell& mixed : old.mixed_cell) mixed.flowed[0].back() += 2;
    Aggregate anew = bar_of_two({0.4, 0.1, 0.1}, 0.43, GENERATE(4, 6));
    REQUIRE(!anew.mixed_cell.empty());
    carry_hardening(old, anew);
    for (int m : {0, 1}) CHECK(means(anew)[m] == Approx(means(old)[m]).epsilon(1e-6));
}

TEST_CASE("a new cell across two old ones has what these have of it, back stress too") {
    const Material metal{.mechanics = Mechanics::cells,
                         .young_modulus = 1e6,
                         .yield_stress = 1e3,
                         .back_stress = 600,
                         .back_strain = 0.01};
    Aggregate old = make_block(6, 2, 2, 0.1, metal);
    old.cell_history.assign(old.cell_fill.size());
    old.cell_back.assign(old.cell_fill.size());
    const auto strain = [](std::size_t c) { return c % 6 == 2 ? 4e-4f : 0; };
    for (std::size_t c = 0; c < old.cell_fill.size(); ++c) {
        old.cell_history.hardening()[c] = c % 6 == 2 ? 0.01f : 0;
        old.cell_back.row[0][c] = strain(c);
        old.cell_back.row[1][c] = -strain(c);
    }
    Aggregate anew = make_block(6, 2, 2, 0.1, metal);
    deform(old, [](const Vec3& x) { return Vec3(x + Vec3(0.025, 0, 0)); });
    carry_hardening(old, anew);
    for (std::size_t c = 0; c < anew.cell_fill.size(); ++c) {
        const double share = c % 6 == 2 ? 0.75 : c % 6 == 3 ? 0.25 : 0;
        CHECK(anew.cell_history.hardening()[c] == Approx(0.01 * share).epsilon(1e-5));
        CHECK(anew.cell_back.row[0][c] == Approx(4e-4 * share).epsilon(1e-5));
        CHECK(anew.cell_back.row[1][c] == Approx(-4e-4 * share).epsilon(1e-5));
    }
}

TEST_CASE("of a torn cell each side's flow goes with that side") {
    const Material metal{.yield_stress = 1e3};
    Aggregate old = make_block(5, 2, 2, 0.1, metal);
    old.cell_history.assign(old.cell_fill.size());
    for (std::size_t c = 0; c < old.cell_fill.size(); ++c) {
        if (c % 5 == 2) old.cell_history.hardening()[c] = 1;  // which the cut goes through
    }
    sever_plane(old, Vec3(0.01, 0, 0), Vec3::UnitX());
    for (std::size_t p = 0; p < old.particle_count(); ++p) {
        if (old.particle_reference.at(p).x() > 0) old.particle_position.add(p, Vec3(0.5, 0, 0));
    }
    // Cells 0.1 wide of both halves, and none between them.
    std::vector<Vec3i> cells;
    for (int k : {0, 1}) {
        for (int j : {0, 1}) {
            for (int i : {0, 1, 2, 7, 8, 9}) cells.emplace_back(i, j, k);
        }
    }
    Aggregate anew = make_matter({-0.25, -0.1, -0.1}, 0.1, {10, 2, 2}, cells,
                                 std::vector<float>(cells.size(), 1), metal);
    carry_hardening(old, anew);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const bool torn = cells[c].x() == 2 || cells[c].x() == 7;
        CHECK(anew.cell_history.hardening()[c] == Approx(torn ? 0.6f : 0).epsilon(1e-5));
    }
}

TEST_CASE("flow that is nowhere near what is molded anew is all over it, as much as there was") {
    const Material metal{.yield_stress = 1e3};
    Aggregate old = make_block(6, 2, 2, 0.1, metal);
    old.cell_history.assign(old.cell_fill.size());
    for (std::size_t c = 5; c < old.cell_fill.size(); c += 6) old.cell_history.hardening()[c] = 1;
    deform(old, [](const Vec3& x) { return Vec3(x + Vec3(0.5, 0, 0)); });
    Aggregate anew = make_block(6, 2, 2, 0.1, metal);
    carry_hardening(old, anew);
    for (float one : anew.cell_history.hardening()) CHECK(one == Approx(1.0 / 6).epsilon(1e-6));
}

namespace {

const Material kShifting{.mechanics = Mechanics::cells,
                         .young_modulus = 1e6,
                         .yield_stress = 1e3,
                         .back_stress = 600,
                         .back_strain = 0.01};

// Two cells with three between them, of which the second has twice the flow and back stress.
Aggregate two_apart() {
    Aggregate old =
        make_matter(Vec3::Zero(), 0.1, {5, 1, 1}, {{0, 0, 0}, {4, 0, 0}}, {1, 1}, kShifting);
    old.cell_history.assign(2);
    old.cell_back.assign(2);
    for (std::size_t c : {0, 1}) {
        const auto times = static_cast<float>(c + 1);
        old.cell_history.hardening()[c] = 0.01f * times;
        old.cell_back.row[0][c] = 1e-4f * times;
        old.cell_back.row[1][c] = -1e-4f * times;
    }
    return old;
}

}  // namespace

TEST_CASE("where nothing was, what is molded anew is as the cell nearest to what it holds there") {
    const Aggregate old = two_apart();
    for (const bool is_low : {true, false}) {
        // Right between them, and a quarter full on one side.
        Aggregate anew = make_matter(Vec3::Zero(), 0.1, {5, 1, 1},
                                     {{0, 0, 0}, {2, 0, 0}, {4, 0, 0}}, {1, 0.25f, 1}, kShifting);
        anew.cell_centroid.set(1, Eigen::Vector3f(is_low ? -0.375f : 0.375f, 0, 0));
        carry_hardening(old, anew);
        const std::vector<float>& hardening = anew.cell_history.hardening();
        REQUIRE(hardening.size() == 3);
        CHECK(hardening[1] == hardening[is_low ? 0 : 2]);
        CHECK(hardening[2] == Approx(2 * hardening[0]).epsilon(1e-6));
        REQUIRE(anew.cell_back.row[0].size() == 3);
        for (int n : {0, 1}) {
            CHECK(anew.cell_back.row[n][1] ==
                  Approx((n == 0 ? 1e-4 : -1e-4) * (is_low ? 1 : 2)).epsilon(1e-5));
        }
    }
}

TEST_CASE("back stress goes to no material that has none, nor to a body of several") {
    const Aggregate old = two_apart();
    Material plain = kShifting;
    plain.back_stress = 0;
    Aggregate anew = make_matter(Vec3::Zero(), 0.1, {5, 1, 1}, {{0, 0, 0}}, {1}, plain);
    carry_hardening(old, anew);
    CHECK(anew.cell_back.empty());
    CHECK(anew.cell_history.hardening()[0] > 0);
    anew = make_matter(Vec3::Zero(), 0.1, {5, 1, 1}, {{0, 0, 0}, {1, 0, 0}}, {1, 1}, kShifting);
    anew.inset = {kShifting};
    anew.cell_material = {0, 1};
    carry_hardening(old, anew);
    CHECK(anew.cell_back.empty());
}

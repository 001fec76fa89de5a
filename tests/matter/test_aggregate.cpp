// SPDX-License-Identifier: GPL-3.0-or-later
// What a body is asked for as a whole and cell by cell, and what a step back restores.
#include "matter/aggregate.h"

#include "matter/broken_cells.h"
#include "matter/cell_parts.h"
#include "matter/drive.h"
#include "matter/material_volumes.h"
#include "matter/matter_state.h"
#include "matter/parted.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

// A row of cells, a quarter of the third being of another material, as is all of the fourth.
Aggregate two_materials() {
    Material soft{.young_modulus = 1e6, .density = 1000, .yield_stress = 1e3};
    Aggregate m = make_block(4, 1, 1, 0.1, soft);
    m.inset = {Material{.young_modulus = 5e6, .density = 3000}};
    m.cell_material = {0, 0, 0, 1};
    MixedCell mixed{};
    mixed.cell = 2;
    mixed.material = {0, 1};
    mixed.fill = {0.75f, 0.25f};
    mixed.centroid = {Eigen::Vector3f(-0.125f, 0, 0), Eigen::Vector3f(0.375f, 0, 0)};
    mixed.normal = Eigen::Vector3f::UnitX();
    m.mixed_cell = {mixed};
    return m;
}

// Severed through its last cell, across x.
Aggregate cut_bar(int cells) {
    Aggregate m = make_block(cells, 1, 1, 0.1, Material{});
    sever_plane(m, Vec3(0.05 * cells - 0.03, 0, 0), Vec3::UnitX());
    return m;
}

// Of all connections that are severed.
void set_damage(Aggregate& m, float damage) {
    for (ConnectionArrays& all : m.connection) {
        all.damage.assign(m.particle_count(), 0.0f);
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            if (all.weight[p] <= 0) all.damage[p] = damage;
        }
    }
}

}  // namespace

TEST_CASE("a cell of two materials is as hard as the harder, and counts by what it has of each") {
    Aggregate m = two_materials();
    CHECK(m.mean_modulus() == Approx((2.75 * 1e6 + 1.25 * 5e6) / 4));
    CHECK(material_volumes(m)[0] == Approx(2.75e-3));
    CHECK(material_volumes(m)[1] == Approx(1.25e-3));
    CHECK(material_masses(m)[1] == Approx(3.75));
    CHECK_FALSE(m.has_flowed());
    m.mixed_cell[0].flowed[1].back() = 0.2f;
    CHECK(m.has_flowed());
    CHECK(m.hardening_of(2) == 0.2f);
    CHECK(m.hardening_of(1) == 0);
    m.cell_history.assign(4);
    m.cell_history.hardening()[1] = 0.1f;
    CHECK(m.hardening_of(1) == 0.1f);
    // What is filled in part counts by what is there.
    m.cell_fill = {0.5f, 1, 0.5f, 1};
    m.mixed_cell[0].fill = {0.375f, 0.125f};
    CHECK(m.mean_modulus() == Approx((1.875 * 1e6 + 1.125 * 5e6) / 3));
    CHECK(material_volumes(m)[1] == Approx(1.125e-3));
}

TEST_CASE("the gradient at a point is how its place changes over the cell") {
    Aggregate m = make_block(2, 2, 2, 0.1, Material{});
    deform(m, [](const Vec3& x) {
        return Vec3(x.x() + 3 * x.y() * x.z(), 1.2 * x.y() - 5 * x.x() * x.x(), x.z() + 4 * x.x());
    });
    for (std::size_t p = 0; p < m.surface.size(); ++p) {
        m.surface.move(p, Vec3(0.1, 0.7, 0.45), m.surface.area(p));
        const Mat3 gradient = m.surface_gradient(p);
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = [&](double off) -> Vec3 {
                const auto weight =
                    trilinear_weights(Vec3(0.1, 0.7, 0.45) + off * Vec3::Unit(axis));
                Vec3 x = Vec3::Zero();
                for (int c = 0; c < 8; ++c) {
                    x += weight[c] * m.particle_position.at(m.surface.corner(p)[c]);
                }
                return x;
            };
            CHECK((gradient.col(axis) - (at(0.5) - at(-0.5)) / 0.1).norm() < 1e-6);
        }
    }
}

TEST_CASE("a cell has broken by load alone, and is not sound once it has reached its strength") {
    const auto row = [](const Aggregate& m, CellId cell) { return m.lattice.cell_row(cell); };
    Aggregate m = cut_bar(3);
    CHECK_FALSE(any_damaged(m));
    CHECK_FALSE(cell_is_whole(m, row(m, 2)));
    CHECK_FALSE(cell_has_broken(m, 2, row(m, 2)));  // a blade did it
    set_damage(m, 1);
    CHECK(any_damaged(m));
    CHECK(cell_has_broken(m, 2, row(m, 2)));
    CHECK_FALSE(cell_has_broken(m, 0, row(m, 0)));
    // Of what holds some stiffness may be lost.
    for (ConnectionArrays& all : m.connection) all.damage.assign(m.particle_count(), 0.3f);
    CHECK_FALSE(cell_has_broken(m, 0, row(m, 0)));
    CHECK(cell_is_sound(m, 0, row(m, 0)));
    CHECK_FALSE(cell_is_sound(m, 2, row(m, 2)));
    m.cell_cracked = {1, 0, 0};
    CHECK_FALSE(cell_is_sound(m, 0, row(m, 0)));
    CHECK(cell_has_broken(m, 0, row(m, 0)));
    CHECK(cell_is_sound(m, 1, row(m, 1)));
}

TEST_CASE("what breaks by load parts a cell's corners, but not along a cut") {
    constexpr CornerMask kLow = 0b01010101, kHigh = 0b10101010;
    Aggregate m = cut_bar(2);
    const auto corner = m.lattice.cell_corners(1);
    for (int c = 0; c < 8; ++c) {
        CHECK(corner_groups(m, corner)[c] == (c & 1 ? kHigh : kLow));
        CHECK(corner_groups_of_cut(m, corner)[c] == (c & 1 ? kHigh : kLow));
    }
    CHECK_FALSE(corners_hang_together(m, corner));
    CHECK(corners_hang_together(m, m.lattice.cell_corners(0)));
    set_damage(m, 1);
    for (int c = 0; c < 8; ++c) {
        CHECK(corner_groups(m, corner)[c] == (c & 1 ? kHigh : kLow));
        CHECK(corner_groups_of_cut(m, corner)[c] == kAllCorners);
    }
    const std::array<double, 8> weight = {0.1, 0.5, 0.3, 0.2, 0.3, 0, 0, 0};
    CHECK(heaviest_corner(weight, kAllCorners) == 1);
    CHECK(heaviest_corner(weight, kLow) == 2);  // the first of two
    CHECK(heaviest_corner(weight, 0) == -1);
}

TEST_CASE("a point is torn where those that carry it are parted, not where its cell is") {
    const Aggregate m = cut_bar(3);
    std::size_t torn = 0, parted = 0;
    for (std::size_t p = 0; p < m.surface.size(); ++p) {
        const bool in_last = m.surface_reference(p).x() > 0.05;
        const bool is_at_end = m.surface.normal(p).x() > 0.5;  // carried from beyond the cut alone
        CHECK(is_parted(m, p) == in_last);
        CHECK(is_torn(m, p) == (in_last && !is_at_end));
        torn += is_torn(m, p), parted += is_parted(m, p);
    }
    CHECK(torn == 16);
    CHECK(parted == 20);
}

TEST_CASE("a step back restores all that a body remembers, to the bit") {
    Aggregate m = two_materials();
    m.material.strength = 1e3, m.material.toughness = 1;
    const std::size_t cells = m.cell_fill.size();
    const auto remember = [&](float value) {
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            m.particle_position.set(p, Vec3::Constant(value));
            m.particle_velocity.set(p, Vec3::Constant(2 * value));
        }
        for (ConnectionArrays& all : m.connection) {
            all.plastic.assign(m.particle_count(), value);
            all.damage.assign(m.particle_count(), value);
            all.weight.set(0, value);
        }
        for (auto& row : m.cell_history.row) row.assign(cells, value);
        for (auto& row : m.cell_back.row) row.assign(cells, value);
        for (auto& slot : m.cell_plastic) slot.assign(cells, value);
        m.cell_cracked.assign(cells, value > 0.25f);
        CellSet set{};
        set.cell = value > 0.25f ? 1 : 3;
        set.strain.fill(value);
        m.cell_set = {set};
        m.mixed_cell[0].flowed[0].fill(value);
        m.mixed_cell[0].jump.setConstant(value);
    };
    remember(0.2f);
    const std::uint64_t before = state_hash(m);
    MatterState state;
    state.save(m);
    remember(0.3f);
    CHECK(state_hash(m) != before);
    state.restore(m);
    CHECK(state_hash(m) == before);
    CHECK(m.cell_back.row[3] == std::vector<float>(cells, 0.2f));
    CHECK(m.cell_set.at(0).cell == 3);
}

TEST_CASE("what cells of two materials and set cells remember is in the state's hash") {
    const Aggregate m = two_materials();
    const auto differs = [&](const auto& change) {
        Aggregate other = m;
        change(other);
        return state_hash(other) != state_hash(m);
    };
    CHECK(differs([](Aggregate& a) { a.mixed_cell[0].jump.y() = 1e-9; }));
    CHECK(differs([](Aggregate& a) { a.mixed_cell[0].flowed[1][7] = 1e-9f; }));
    CHECK(differs([](Aggregate& a) { a.lay_down({1, {}}); }));
    CHECK(differs([](Aggregate& a) { a.cell_cracked.assign(4, 0); }));
    CHECK(differs([](Aggregate& a) { a.cell_back.assign(4); }));
    CHECK(differs([](Aggregate& a) { a.branch_memory.push_back({{}, {0.5f}}); }));
    CHECK_FALSE(differs([](Aggregate& a) { a.material.density = 7; }));
}

TEST_CASE("set cells stand in their order, one for each cell") {
    Aggregate m = make_block(4, 1, 1, 0.1, Material{});
    for (const CellId cell : {2, 0, 3, 2}) {
        CellSet set{};
        set.cell = cell;
        set.strain[0] = static_cast<float>(m.cell_set.size());
        m.lay_down(set);
    }
    REQUIRE(m.cell_set.size() == 3);
    CHECK(m.set_of(0)->strain[0] == 1);
    CHECK(m.set_of(1) == nullptr);
    CHECK(m.set_of(2)->strain[0] == 3);  // laid down again
    CHECK(m.set_of(3) == &m.cell_set[2]);
}

TEST_CASE("strengths go evenly from one drive to the next") {
    Drive from, to;
    from.time = 1, to.time = 3;
    from.load_strength = {0, 2}, to.load_strength = {1, -2};
    from.gravity_strength = 0.5, to.gravity_strength = 1;
    const Drive between = drive_between(from, to, 0.25);
    CHECK(between.time == 1.5);
    CHECK(between.load_strength == std::vector<double>{0.25, 1});
    CHECK(between.gravity_strength == 0.625);
}

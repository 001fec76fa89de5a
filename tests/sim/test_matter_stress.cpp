// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/matter_stress.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include "sim/lattice_forces.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/equivalent_stress.h"

using namespace swage;
using test::deform;
using test::equivalent;
using test::make_block;

namespace {

constexpr double kModulus = 2e9;
constexpr int kElasticities = 3;
const Elasticity kElasticity[kElasticities] = {Elasticity::hencky, Elasticity::neo_hookean,
                                               Elasticity::storakers};

Material material_of(Elasticity elasticity, double poisson_ratio) {
    return {.elasticity = elasticity, .young_modulus = kModulus, .poisson_ratio = poisson_ratio};
}

std::vector<CellId> all_of(const Aggregate& matter) {
    std::vector<CellId> cells(matter.cell_fill.size());
    std::iota(cells.begin(), cells.end(), 0);
    return cells;
}

// Of a block that is deformed by f all over.
std::vector<StressSample> bear(const Material& material, const Mat3& f) {
    Aggregate block = make_block(3, 2, 2, 0.01, material);
    deform(block, [&](const Vec3& x) -> Vec3 { return f * x; });
    return stress_samples(block, all_of(block));
}

Mat3 stretch(double along, double across) { return Vec3(along, across, across).asDiagonal(); }

}  // namespace

TEST_CASE("a little stretched matter of any law bears Young's modulus times its strain") {
    constexpr double kStrain = 1e-5, kRatio = 0.3;
    for (const Elasticity elasticity : kElasticity) {
        for (const StressSample& one :
             bear(material_of(elasticity, kRatio), stretch(1 + kStrain, 1 - kRatio * kStrain))) {
            CHECK(one.stress[0] == Approx(kModulus * kStrain).epsilon(1e-4));
            for (int i = 1; i < 6; ++i) {
                CHECK(std::abs(one.stress[i]) < 1e-4 * kModulus * kStrain);
            }
            CHECK(one.volume == 1);
            CHECK(one.sound);
        }
    }
    Material springs = material_of(Elasticity::hencky, 0.25);
    springs.mechanics = Mechanics::springs;
    for (const StressSample& one : bear(springs, stretch(1 + kStrain, 1 - 0.25 * kStrain))) {
        CHECK(one.stress[0] == Approx(kModulus * kStrain).epsilon(1e-4));
        CHECK(std::abs(one.stress[1]) < 1e-4 * kModulus * kStrain);
    }
}

TEST_CASE("far stretched matter bears Cauchy's stress of its own energy") {
    for (const double s : {0.7, 1.4}) {
        const double nu = 0.3, mu = kModulus / 2.6;
        const double lame = kModulus * nu / (1.3 * 0.4);
        const Mat3 f = stretch(s, std::pow(s, -nu));
        const double volume = f.determinant();
        // E ln s of the volume at rest; the series of the logarithm ends early.
        CHECK(bear(material_of(Elasticity::hencky, nu), f)[0].stress[0] ==
              Approx(kModulus * std::log(s) / volume).epsilon(2e-3));
        CHECK(bear(material_of(Elasticity::storakers, nu), f)[0].stress[0] ==
              Approx(mu * (s - std::pow(s, -1 - 2 * nu)) * std::pow(s, 2 * nu)).epsilon(1e-10));
        const auto rubber = bear(material_of(Elasticity::neo_hookean, nu), f)[0].stress;
        for (int i = 0; i < 2; ++i) {
            CHECK(rubber[i] ==
                  Approx(mu * f(i, i) * f(i, i) / volume + (lame + mu) * (volume - 1) - mu)
                      .epsilon(1e-10));
        }
    }
}

TEST_CASE("stress turns with the matter, and sheared matter bears no pressure") {
    Mat3 shear = Mat3::Identity();
    shear(0, 1) = 1e-4;
    const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(0.3, -0.5, 0.7).normalized()).matrix();
    for (const Elasticity elasticity : kElasticity) {
        const Material material = material_of(elasticity, 0.3);
        const auto still = bear(material, shear)[0].stress;
        const auto turned = bear(material, turn * shear)[0].stress;
        CHECK(still[3] == Approx(kModulus / 2.6 * 1e-4).epsilon(1e-3));
        CHECK(equivalent(still) == Approx(std::sqrt(3.0) * still[3]).epsilon(1e-4));
        CHECK(std::abs(still[0] + still[1] + still[2]) < 1e-3 * still[3]);
        for (int i = 0; i < 6; ++i) CHECK(std::abs(still[i] - turned[i]) < 1e-6 * still[3]);
    }
}

TEST_CASE("matter that yields bears no more than its yield stress") {
    Material metal = material_of(Elasticity::hencky, 0.3);
    metal.yield_stress = 2e6;
    for (const StressSample& one : bear(metal, stretch(1.01, 0.996))) {
        // Of the volume at rest (laws/cell.h), which is 0.2 % less.
        CHECK(equivalent(one.stress) * 1.01 * 0.996 * 0.996 == Approx(2e6).epsilon(1e-5));
        CHECK(one.yields_at == 2e6);
    }
}

TEST_CASE("springs are not told to bear less than they do where they have hardened by themselves") {
    Material metal = material_of(Elasticity::hencky, 0.25);
    metal.mechanics = Mechanics::springs;
    metal.yield_stress = 2e6;
    for (const StressSample& one : bear(metal, stretch(1.01, 0.996))) {
        CHECK(std::isinf(one.yields_at));
    }
}

TEST_CASE("parts of a severed cell bear what each of them holds, and no more") {
    const Material material = material_of(Elasticity::hencky, 0.25);
    Aggregate block = make_block(4, 2, 2, 0.01, material);
    test::sever_plane(block, Vec3(0.005, 0, 0), Vec3::UnitX());
    // The right side is pulled along y, the left lies still.
    deform(block, [](const Vec3& x) -> Vec3 {
        return x.x() > 0.005 ? Vec3(x.x() + 0.1, 1.001 * x.y(), x.z()) : x;
    });
    int parts = 0;
    for (const StressSample& one : stress_samples(block, all_of(block))) {
        if (one.sound) continue;
        ++parts;
        const bool right = one.corners & 2;
        CHECK(one.volume == 0.5);
        if (right) {
            CHECK(one.stress[1] > 0.3 * 0.001 * kModulus);
            CHECK(one.stress[1] < 1.2 * 0.001 * kModulus);
        } else {
            CHECK(equivalent(one.stress) < 1e-12 * kModulus);
        }
    }
    CHECK(parts == 8);
}

TEST_CASE("what has softened is told to bear no more pressure than its forces are") {
    Material material = material_of(Elasticity::hencky, 0.25);
    material.strength = 1e7;
    material.toughness = 1e4;
    Aggregate cell = make_block(1, 1, 1, 0.01, material);
    cell.cell_cracked.assign(1, 1);
    LatticeForces lattice(cell);
    for (const double size : {1.004, 0.995}) {
        deform(cell, [&](const Vec3& x) -> Vec3 { return size * x; });
        Vec3Array force;
        lattice.find(cell, Flow::trial, force);
        lattice.commit(cell, Forces::fresh);
        double virial = 0;
        for (std::size_t p = 0; p < force.size(); ++p) {
            virial -= force.x[p] * cell.particle_position.x[p];
        }
        REQUIRE(cell.connection[kEdgeCount].damage[0] > 0.1f);
        const std::vector<StressSample> told = stress_samples(cell, {0});
        REQUIRE(told.size() == 1);
        CHECK(told[0].stress[0] == Approx(virial / cell.lattice.cell_volume()).epsilon(1e-6));
    }
}

TEST_CASE("where matter with a back stress yields at the most is told with what is left of that") {
    Material metal = material_of(Elasticity::hencky, 0.3);
    metal.yield_stress = 1e6, metal.hardening = 2e7;
    metal.back_stress = 8e5, metal.back_strain = 0.01;
    Aggregate block = make_block(2, 2, 2, 0.01, metal);
    CHECK(stress_samples(block, {0})[0].yields_at == Approx(1.8e6));
    block.cell_history.assign(block.cell_fill.size());
    block.cell_history.hardening()[0] = 0.01f;
    CHECK(stress_samples(block, {0})[0].yields_at ==
          Approx(1e6 + 2e5 + 8e5 * std::exp(-1.0)).epsilon(1e-5));
}

TEST_CASE("springs of partly filled cells bear by what there is of them") {
    Material springs = material_of(Elasticity::hencky, 0.25);
    springs.mechanics = Mechanics::springs;
    Aggregate rod =
        test::make_matter(Vec3::Zero(), 0.01, Vec3i(3, 1, 1), {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                          {0.4f, 0.4f, 0.4f}, springs);
    constexpr double kStrain = 1e-5;
    deform(rod, [](const Vec3& x) -> Vec3 { return stretch(1 + kStrain, 1 - 0.25 * kStrain) * x; });
    for (const StressSample& one : stress_samples(rod, all_of(rod))) {
        CHECK(one.stress[0] == Approx(kModulus * kStrain).epsilon(1e-3));
    }
}

TEST_CASE("a cell that a blade has cut into bears its stress also where its own cannot break") {
    Material brittle = material_of(Elasticity::hencky, 0.25);
    brittle.strength = 1e7, brittle.toughness = 1e4;
    Aggregate block = make_block(6, 2, 2, 0.01, brittle);
    block.inset = {material_of(Elasticity::hencky, 0.25)};
    block.cell_material.assign(block.cell_fill.size(), 0);
    CellId cut = -1;
    for (const CellId cell : all_of(block)) {
        const Vec3i site = block.lattice.cell_site(cell);
        block.cell_material[cell] = site.x() >= 3;
        if (site == Vec3i(4, 0, 0)) cut = cell;
    }
    // One edge of it, across the pull.
    block.connection[1].weight.set(block.lattice.cell_corners(cut)[0], 0);
    constexpr double kStrain = 1e-5;
    deform(block,
           [](const Vec3& x) -> Vec3 { return stretch(1 + kStrain, 1 - 0.25 * kStrain) * x; });
    const StressSample one = stress_samples(block, {cut})[0];
    REQUIRE_FALSE(one.sound);
    CHECK(one.stress[0] == Approx(kModulus * kStrain).epsilon(0.1));
}

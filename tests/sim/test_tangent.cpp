// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include "sim/lattice_forces.h"
#include "sim/slab_cholesky.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/coarse_error.h"
#include "tests/sim/shake.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1;

// Random fills, centroids and positions; rows that are no multiple of a batch of lanes.
Aggregate shaken_block(const Material& material) {
    Aggregate m = make_block(11, 3, 4, kSpacing, material);
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> draw(-1, 1);
    for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
        m.cell_fill[c] = static_cast<float>(0.55 + 0.45 * draw(engine));
        Eigen::Vector3f centroid;
        for (int i = 0; i < 3; ++i) centroid[i] = static_cast<float>(0.3 * draw(engine));
        m.cell_centroid.set(c, centroid);
    }
    shake(m, 0.06 * kSpacing);
    return m;
}

double dot(const Vec3Array& a, const Vec3Array& b) {
    double sum = 0;
    for (std::size_t p = 0; p < a.size(); ++p) sum += a.at(p).dot(b.at(p));
    return sum;
}

const Material kMaterials[] = {
    {.young_modulus = 1e5, .poisson_ratio = 0.4},
    {.young_modulus = 1e5, .poisson_ratio = 0.3, .yield_stress = 2e3, .hardening = 1e4},
    // No cell comes to one of its points here, where the tangent jumps.
    {.young_modulus = 1e5,
     .poisson_ratio = 0.3,
     .yield_stress = 2e3,
     .flow_curve = {{0, 2e3}, {0.011, 4e3}, {0.023, 4e3}, {0.047, 4.5e3}, {0.3, 6e3}}},
    {.young_modulus = 1e5,
     .poisson_ratio = 0.3,
     .yield_stress = 2e3,
     .hardening = 1e4,
     .back_stress = 1.3e3,
     .back_strain = 0.03},
    {.elasticity = Elasticity::neo_hookean, .young_modulus = 1e5, .poisson_ratio = 0.45},
    {.elasticity = Elasticity::storakers, .young_modulus = 1e5, .poisson_ratio = 0.3},
};

}  // namespace

TEST_CASE("the tangent's product is how the forces change, flow included") {
    for (const Material& material : kMaterials) {
        Aggregate m = shaken_block(material);
        LatticeForces forces(m);
        if (std::isfinite(material.yield_stress)) forces.commit(m);  // and flow on from there
        shake(m, 0.01 * kSpacing, 5);
        const Vec3Array direction = random_direction(m.particle_count());
        CellTangent tangent(m, m.cell_fill);
        Vec3Array product;
        tangent.product(m, {}, direction, product);
        const Vec3Array here = m.particle_position;
        const double h = 1e-5 * kSpacing;
        Vec3Array f[4];
        const double at[4] = {-2 * h, -h, h, 2 * h};
        for (int n = 0; n < 4; ++n) {
            m.particle_position = here;
            for (std::size_t p = 0; p < here.size(); ++p) {
                m.particle_position.add(p, at[n] * direction.at(p));
            }
            forces.find(m, Flow::trial, f[n]);
        }
        double largest = 0, off = 0;
        for (std::size_t p = 0; p < here.size(); ++p) {
            const Vec3 slope =
                (8 * (f[2].at(p) - f[1].at(p)) - (f[3].at(p) - f[0].at(p))) / (12 * h);
            largest = std::max(largest, slope.norm());
            off = std::max(off, (slope + product.at(p)).norm());
        }
        CHECK(off < 1e-7 * largest);
    }
}

TEST_CASE("a turn of the whole strains nothing: without what turning does it meets no force") {
    const Vec3 axis(0.3, -0.5, 0.8);
    for (const Material& material : kMaterials) {
        Aggregate m = shaken_block(material);
        Vec3Array turn = m.particle_position, force, all, left;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            turn.set(p, axis.cross(m.particle_position.at(p)));
        }
        LatticeForces(m).find(m, Flow::trial, force);
        CellTangent tangent(m, m.cell_fill);
        tangent.product(m, {}, turn, all);
        tangent.product(m, {Flow::trial, 0}, turn, left);
        double largest = 0, off = 0, rest = 0;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            largest = std::max(largest, force.at(p).norm());
            off = std::max(off, (all.at(p) + axis.cross(force.at(p))).norm());
            rest = std::max(rest, left.at(p).norm());
        }
        CHECK(off < 1e-11 * largest);  // the forces turn with it
        CHECK(rest < 1e-11 * largest);
    }
}

TEST_CASE("what turning does is all that makes a pressed column of rubber or foam fall") {
    for (int kind : {4, 5}) {
        Aggregate m = make_block(18, 2, 2, kSpacing, kMaterials[kind]);
        const double wave = kPi / (18 * kSpacing * 0.6);
        Vec3Array bend = m.particle_position, product;
        for (std::size_t p = 0; p < bend.size(); ++p) {
            m.particle_position.x[p] *= 0.6;
            const Vec3 x = m.particle_position.at(p);
            bend.set(p, Vec3(x.y() * wave * std::sin(wave * x.x()), std::cos(wave * x.x()), 0));
        }
        CellTangent tangent(m, m.cell_fill);
        tangent.product(m, {}, bend, product);
        CHECK(dot(bend, product) < 0);
        tangent.product(m, {Flow::trial, 0}, bend, product);
        CHECK(dot(bend, product) > 0);
    }
}

TEST_CASE("what is crushed flat or inside out keeps its tangent finite without turning") {
    for (int kind : {4, 5}) {
        for (double left : {0.0, -0.5}) {
            Aggregate m = make_block(9, 1, 1, kSpacing, kMaterials[kind]);
            for (double& x : m.particle_position.x) x *= left;
            CellTangent tangent(m, m.cell_fill);
            Vec3Array product;
            tangent.product(m, {Flow::trial, 0}, random_direction(m.particle_count()), product);
            for (std::size_t p = 0; p < product.size(); ++p) CHECK(product.at(p).allFinite());
        }
    }
}

TEST_CASE("coarse matrices are the tangent seen through the coarse corners, at any ratio") {
    for (const Material& material : kMaterials) {
        Aggregate m = shaken_block(material);
        for (const Vec3i& ratio :
             {Vec3i(1, 1, 1), Vec3i(2, 1, 2), Vec3i(2, 2, 2), Vec3i(4, 3, 1)}) {
            for (double geometric : {1.0, 0.0}) {
                CHECK(coarse_error(m, ratio, {Flow::trial, geometric}) < 1e-12);
            }
        }
    }
}

TEST_CASE("restriction is the transpose of prolongation") {
    const Aggregate m = make_block(13, 5, 6, kSpacing, kMaterials[0]);
    for (const Vec3i& ratio : {Vec3i(2, 2, 2), Vec3i(3, 1, 2)}) {
        const Lattice coarse = coarse_lattice(m.lattice, ratio);
        const LatticeTransfer transfer(m.lattice, coarse, ratio);
        const Vec3Array u = random_direction(particle_count(coarse));
        const Vec3Array f = random_direction(m.particle_count());
        Vec3Array up = f, down;
        transfer.add_prolonged(u, up);
        transfer.restricted(f, down);
        CHECK(dot(f, up) - dot(f, f) == Approx(dot(u, down)));
    }
}

namespace {

// The stiffness of the body as molded, each particle held by a spring.
NodeStiffness held_stiffness(const Aggregate& m) {
    CellTangent tangent(m, m.cell_fill);
    NodeStiffness matrix(m.lattice);
    matrix.add_cells(m.lattice, tangent.coarse_cells(m, {}, m.lattice, Vec3i::Ones()));
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        matrix.add_diagonal(static_cast<ParticleId>(p), 1);
    }
    return matrix;
}

void check_solves(const Aggregate& m, const NodeStiffness& matrix) {
    SlabCholesky direct(m.lattice);
    REQUIRE(direct.factor(matrix));
    const Vec3Array x = random_direction(m.particle_count());
    Vec3Array b, got;
    matrix.product(x, b);
    direct.solve(b, got);
    for (std::size_t p = 0; p < x.size(); ++p) CHECK((got.at(p) - x.at(p)).norm() < 1e-8);
}

}  // namespace

TEST_CASE("the slabs' factor solves what the matrix multiplies, and refuses what is indefinite") {
    Aggregate m = shaken_block(kMaterials[0]);
    m.particle_position = m.particle_reference.all();
    NodeStiffness matrix = held_stiffness(m);
    check_solves(m, matrix);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        matrix.add_diagonal(static_cast<ParticleId>(p), -100);
    }
    CHECK_FALSE(SlabCholesky(m.lattice).factor(matrix));
}

TEST_CASE("the slabs' factor does not mind a gap between parts of a body") {
    std::vector<Vec3i> cells;
    for (int i : {0, 1, 4, 5, 6}) cells.push_back({i, 0, 0});
    const Aggregate m = make_matter(Vec3::Zero(), kSpacing, Vec3i(7, 1, 1), cells,
                                    std::vector<float>(cells.size(), 1.0f));
    check_solves(m, held_stiffness(m));
}

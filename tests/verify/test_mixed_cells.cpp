// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "base/parallel.h"
#include "geometry/box_mesh.h"
#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/cell_tangent.h"
#include "sim/lattice_forces.h"
#include "sim/material_laws.h"
#include "sim/mixed_cells.h"
#include "sim/strength_use.h"
#include "sim/vector_clones.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/coarse_error.h"
#include "tests/sim/force_checks.h"
#include "tests/sim/halved_cell.h"
#include "tests/sim/shake.h"
#include "tests/sim/steady_flow.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.25;

// A bar with an oblique ball of another material inside, half in, half out of many cells.
Aggregate bar_with_ball(const Material& outside, const Material& inside) {
    MoldSettings settings;
    settings.spacing = kSpacing;
    TriMesh bar =
        make_shape("bar", {{"length", 2}, {"height", 1}, {"width", 1}, {"rounding", 0}}).mesh;
    TriMesh ball = make_shape("sphere", {{"diameter", 0.8}, {"division", 24}}).mesh;
    const Box a = box_of(bar.position), b = box_of(ball.position);
    for (Vec3& p : ball.position) p += a.center() - b.center() + Vec3(0.07, 0.03, -0.04);
    return mold(bar, outside, settings, {{ball, inside}});
}

Material soft() { return {.young_modulus = 1e5, .poisson_ratio = 0.3}; }
Material stiff() { return {.young_modulus = 1e7, .poisson_ratio = 0.2}; }
Material rubber() {
    Material m = soft();
    m.elasticity = Elasticity::neo_hookean;
    m.poisson_ratio = 0.45;
    return m;
}

}  // namespace

TEST_CASE("cells of two materials push by minus the gradient of their energy") {
    for (const Material& outside : {soft(), rubber()}) {
        Aggregate m = bar_with_ball(outside, stiff());
        REQUIRE(m.mixed_cell.size() > 20);
        test::shake(m, 0.05 * kSpacing);
        LatticeForces forces(m);
        Vec3Array f;
        forces.find(m, Flow::trial, f);
        double largest = 0;
        Vec3 sum = Vec3::Zero();
        for (std::size_t p = 0; p < f.size(); ++p) {
            largest = std::max(largest, f.at(p).norm());
            sum += f.at(p);
        }
        CHECK(sum.norm() < 1e-10 * largest);
        const double h = 1e-4 * kSpacing;
        for (std::size_t p = 0; p < m.particle_count(); p += 7) {
            const double slope = test::energy_slope(forces, m, p, 1, h);
            CHECK(std::abs(f.y[p] + slope) < 1e-7 * largest);
        }
    }
}

TEST_CASE("what flows far in cells of two materials is booked as it pushed") {
    // Clay round tin, pressed to two thirds and bulged meanwhile.
    Material clay{.young_modulus = 5e6, .poisson_ratio = 0.45, .yield_stress = 3e4};
    Material tin{.young_modulus = 5e10, .poisson_ratio = 0.36, .yield_stress = 1.5e7};
    Aggregate m = bar_with_ball(clay, tin);
    LatticeForces forces(m);
    const int steps = 200;
    Vec3Array f, before;
    double work = 0, plastic = 0, most = 0;
    for (int n = 0; n <= steps; ++n) {
        const double e = 0.4 * n / steps;
        const Vec3Array from = m.particle_position;
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3& x = m.particle_reference.at(p);
            const double wave = 0.3 * e * kSpacing * std::sin(7 * x.x() + 3 * x.y());
            m.particle_position.set(p, {std::exp(0.5 * e) * x.x() + wave, std::exp(-e) * x.y(),
                                        std::exp(0.5 * e) * x.z() - wave});
        }
        forces.find(m, Flow::trial, f);
        for (std::size_t p = 0; n > 0 && p < f.size(); ++p) {
            work -= 0.5 * (f.at(p) + before.at(p)).dot(m.particle_position.at(p) - from.at(p));
        }
        before = f;
        plastic += forces.commit(m, Forces::fresh).plastic;
        most = std::max(most, std::abs(forces.elastic_energy(m) + plastic - work));
    }
    CHECK(plastic > 0);
    CHECK(most < 0.02 * work);
}

TEST_CASE("elastic cells of two materials push as they are strained, whatever they went through") {
    Aggregate m = bar_with_ball(soft(), stiff());
    LatticeForces forces(m);
    const auto press = [&](Aggregate& at, double by) {
        test::deform(at, [&](const Vec3& x) -> Vec3 {
            const double wave = 0.3 * by * kSpacing * std::sin(7 * x.x() + 3 * x.y());
            return {x.x() + wave, (1 - by) * x.y(), x.z() - wave};
        });
    };
    Vec3Array f, expected;
    for (double by : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.4, 0.2, 0.02}) {
        press(m, by);
        forces.find(m, Flow::trial, f);
        forces.commit(m, Forces::fresh);
    }
    Aggregate fresh = bar_with_ball(soft(), stiff());
    press(fresh, 0.02);
    LatticeForces unstrained(fresh);
    unstrained.find(fresh, Flow::trial, expected);
    CHECK(f.x == expected.x);
    CHECK(f.y == expected.y);
    CHECK(forces.elastic_energy(m) == unstrained.elastic_energy(fresh));
}

TEST_CASE("all that is told of a cell of two materials is of the jump that it pushes with") {
    // One of clay and tin, drawn on in 50 increments to a strain at which there are other jumps.
    Material clay{.young_modulus = 5e6, .poisson_ratio = 0.45, .yield_stress = 3e4};
    const Material tin{.young_modulus = 5e10, .poisson_ratio = 0.36, .yield_stress = 1.5e7};
    std::mt19937 engine(5);
    std::normal_distribution<double> draw;
    std::uniform_real_distribution<double> place(-0.35, 0.35);
    const auto any = [&] { return Vec3(draw(engine), draw(engine), draw(engine)).normalized(); };
    for (int round = 0; round < 10; ++round) {
        Mat3 rate;
        for (int n = 0; n < 9; ++n) rate(n / 3, n % 3) = draw(engine);
        rate = (rate + rate.transpose() - 2 * rate.trace() / 3 * Mat3::Identity()).eval();
        rate.normalize();
        const Mat3 turn = Eigen::AngleAxisd(2, any()).toRotationMatrix();
        Aggregate m = test::make_block(1, 1, 1, 0.01, clay);
        m.inset.push_back(tin);
        m.mixed_cell.push_back(test::divided_cell(0, any(), place(engine)));
        m.cell_material.push_back(m.mixed_cell[0].fill[1] > 0.5f);
        const MixedCell& cell = m.mixed_cell[0];
        LatticeForces forces(m);
        Vec3Array force;
        const int steps = 50;
        const Mat3 half = 0.5 * 0.4 / steps * rate, unit = Mat3::Identity();
        const Mat3 on = (unit - half).inverse() * (unit + half);
        for (int n = 0; n < steps; ++n) {
            for (int p = 0; p < 8; ++p) {
                m.particle_position.set(p, on * m.particle_position.at(p));
            }
            forces.find(m, Flow::trial, force);
            forces.commit(m, Forces::fresh);
        }
        INFO("round " << round);
        // Strained on, its stress does the work of its forces.
        const std::vector<MaterialLaw> laws = material_laws(m);
        const std::array<PartStress, 2> part = part_stresses(m, laws, cell);
        Mat3 gradient = Mat3::Zero();
        for (int p : {0, 1}) gradient += cell.fill[p] * part[p].gradient;
        double work = 0, all = 0, largest = 0;
        for (int p = 0; p < 8; ++p) {
            const Vec3 way = rate * m.particle_position.at(p);
            work -= force.at(p).dot(way);
            all += force.at(p).norm() * way.norm();
            largest = std::max(largest, force.at(p).norm());
        }
        for (int p : {0, 1}) {
            work -= m.lattice.cell_volume() * cell.fill[p] *
                    part[p].stress.cwiseProduct(rate * gradient).sum();
        }
        CHECK(std::abs(work) < 2e-4 * all);  // history is kept as floats
        const Vec3 normal = cell.normal.cast<double>();
        CHECK((part[0].stress * normal - part[1].stress * normal).norm() <
              1e-5 * (part[0].stress * normal).norm());
        // It is within what it yields at, and strained no further than that.
        const std::array<double, 2> share = part_yield_shares(m, laws, cell);
        CHECK(std::max(share[0], share[1]) == Approx(1).epsilon(1e-3));
        const std::array<double, 2> strain = largest_strains(m, laws, cell);
        for (int p : {0, 1}) {
            const Material& of = m.material_at(cell.material[p]);
            CHECK(strain[p] < 20 * of.yield_stress / of.young_modulus);
        }
        // Forces begun anew, and those of the cell turned as a whole, are as they were.
        Vec3Array anew;
        LatticeForces(m).find(m, Flow::trial, anew);
        Aggregate turned = m;
        for (int p = 0; p < 8; ++p) {
            turned.particle_position.set(p, turn * m.particle_position.at(p));
        }
        Vec3Array along;
        forces.find(turned, Flow::trial, along);
        for (int p = 0; p < 8; ++p) {
            CHECK((anew.at(p) - force.at(p)).norm() < 2e-4 * largest);
            CHECK((along.at(p) - turn * anew.at(p)).norm() < 1e-6 * largest);
        }
        // And the tangent is how they change, where it is strained on.
        for (int p = 0; p < 8; ++p) {
            m.particle_position.add(p, 1e-3 * (rate * m.particle_position.at(p)));
        }
        const Vec3Array way = test::random_direction(8), here = m.particle_position;
        Vec3Array product, f[2];
        CellTangent(m, m.cell_fill).product(m, {}, way, product);
        const double h = 1e-8 * m.lattice.spacing;
        for (int n : {0, 1}) {
            m.particle_position = here;
            for (int p = 0; p < 8; ++p) m.particle_position.add(p, (n == 0 ? -h : h) * way.at(p));
            forces.find(m, Flow::trial, f[n]);
        }
        double off = 0, most = 0;
        for (int p = 0; p < 8; ++p) {
            most = std::max(most, product.at(p).norm());
            off = std::max(off, (product.at(p) - (f[0].at(p) - f[1].at(p)) / (2 * h)).norm());
        }
        CHECK(off < 1e-3 * most);
    }
}

TEST_CASE("the tangent of cells of two materials is how their forces change, flow included") {
    Material yields = stiff(), curved = stiff(), rubbery = rubber();
    yields.yield_stress = 3e4, yields.hardening = 1e5;
    curved.flow_along({{0, 3e4}, {3e-3, 4e4}, {6e-3, 4e4}, {0.02, 5e4}, {0.1, 6e4}});
    for (const Material& outside : {soft(), yields, curved, rubbery}) {
        for (const Material& inside : {stiff(), yields, curved}) {
            Aggregate m = bar_with_ball(outside, inside);
            test::shake(m, 0.02 * kSpacing);
            LatticeForces forces(m);
            forces.commit(m);
            test::shake(m, 0.005 * kSpacing, 5);
            const Vec3Array way = test::random_direction(m.particle_count());
            CellTangent tangent(m, m.cell_fill);
            Vec3Array product;
            tangent.product(m, {}, way, product);
            // The matrices are the same tangent.
            NodeStiffness fine(m.lattice);
            fine.add_cells(m.lattice, tangent.coarse_cells(m, {}, m.lattice, Vec3i::Ones()));
            Vec3Array other;
            fine.product(way, other);
            const std::vector<Mat3> own = tangent.own_blocks(m, {});
            double largest = 0, wrong = 0, blocks = 0;
            for (std::size_t p = 0; p < way.size(); ++p) {
                largest = std::max(largest, product.at(p).norm());
                wrong = std::max(wrong, (product.at(p) - other.at(p)).norm());
                blocks =
                    std::max(blocks, (own[p] - fine.block(static_cast<ParticleId>(p), 13)).norm());
            }
            CHECK(wrong < 1e-7 * largest);  // history is kept as floats
            CHECK(blocks < 1e-7 * largest);
            const Vec3Array here = m.particle_position;
            const double h = 1e-6 * kSpacing;
            Vec3Array f[2];
            for (int n : {0, 1}) {
                m.particle_position = here;
                for (std::size_t p = 0; p < here.size(); ++p) {
                    m.particle_position.add(p, (n == 0 ? -h : h) * way.at(p));
                }
                forces.find(m, Flow::trial, f[n]);
            }
            double slope = 0;
            for (std::size_t p = 0; p < way.size(); ++p) {
                slope =
                    std::max(slope, (product.at(p) - (f[0].at(p) - f[1].at(p)) / (2 * h)).norm());
            }
            CHECK(slope < 2e-4 * largest);
            // Without what turning does no way is soft.
            m.particle_position = here;
            tangent.product(m, {Flow::trial, 0}, way, product);
            double work = 0;
            for (std::size_t p = 0; p < way.size(); ++p) work += way.at(p).dot(product.at(p));
            CHECK(work > 0);
            // Nor does a turn of the whole, which strains nothing, meet a force.
            Vec3Array turn = here;
            const Vec3 axis(0.3, -0.5, 0.8);
            for (std::size_t p = 0; p < way.size(); ++p) turn.set(p, axis.cross(here.at(p)));
            tangent.product(m, {Flow::trial, 0}, turn, product);
            double left = 0;
            for (std::size_t p = 0; p < way.size(); ++p) {
                left = std::max(left, product.at(p).norm());
            }
            CHECK(left < 1e-7 * largest * longest_of(turn));
        }
    }
}

TEST_CASE("coarse cells of two materials are their tangent seen through the coarse corners") {
    Aggregate m = bar_with_ball(soft(), stiff());
    test::shake(m, 0.02 * kSpacing);
    for (const Vec3i& ratio : {Vec3i(2, 1, 2), Vec3i(2, 2, 2), Vec3i(4, 3, 1)}) {
        CHECK(test::coarse_error(m, ratio) < 1e-10);
    }
}

TEST_CASE("an inset of the same material changes nothing but by what shares leave of the modes") {
    Aggregate one = bar_with_ball(soft(), soft());
    Aggregate plain = one;
    plain.inset.clear(), plain.cell_material.clear(), plain.mixed_cell.clear();
    // Uniform strain has no modes.
    for (Aggregate* m : {&one, &plain}) {
        for (std::size_t p = 0; p < m->particle_count(); ++p) {
            const Vec3 x = m->particle_reference.at(p);
            m->particle_position.set(p, Vec3(1.01 * x.x() + 0.01 * x.y(), 0.98 * x.y(), x.z()));
        }
    }
    Vec3Array a, b;
    LatticeForces(one).find(one, Flow::trial, a);
    LatticeForces(plain).find(plain, Flow::trial, b);
    double largest = 0;
    for (std::size_t p = 0; p < a.size(); ++p) largest = std::max(largest, b.at(p).norm());
    for (std::size_t p = 0; p < a.size(); ++p) {
        CHECK((a.at(p) - b.at(p)).norm() < 1e-6 * largest);
    }
}

TEST_CASE("a body of two materials has its mass, its volume, and the same bits in every way") {
    Material light = soft(), heavy = stiff();
    light.density = 1000, heavy.density = 8000;
    heavy.yield_stress = 3e4, heavy.hardening = 1e5;
    Aggregate m = bar_with_ball(light, heavy);
    const double ball = 0.8 * 0.8 * 0.8 * std::numbers::pi / 6;
    CHECK(m.volume() == Approx(2).epsilon(1e-6));
    CHECK(m.mass() == Approx(2 * 1000 + 7000 * ball).epsilon(0.01));
    test::shake(m, 0.05 * kSpacing);
    LatticeForces forces(m);
    CHECK(forces.commit(m).plastic > 0);
    test::shake(m, 0.02 * kSpacing, 5);
    Vec3Array expected;
    forces.find(m, Flow::trial, expected);
    for (int threads : {1, 3}) {
        set_thread_count(threads);
        for (int width : {8, 4, 2}) {
            limit_vector_width(width);
            Vec3Array f;
            forces.find(m, Flow::trial, f);
            CHECK(f.x == expected.x);
            CHECK(f.y == expected.y);
        }
    }
    limit_vector_width(0);
    set_thread_count(0);
}

TEST_CASE("no place at which forces were asked for leaves a trace in the jumps of others") {
    Material light = soft(), heavy = stiff();
    light.yield_stress = 1e3, heavy.yield_stress = 3e4, heavy.hardening = 1e5;
    const Aggregate start = bar_with_ball(light, heavy);
    // Forces at some places in turn, the last of them anew too.
    const auto forces_along = [&](bool anew) {
        Aggregate m = start;
        LatticeForces forces(m);
        Vec3Array f;
        for (int seed : {3, 5, 8}) {
            test::shake(m, 0.01 * kSpacing, seed);
            if (seed == 3) forces.commit(m);
            if (anew) {
                LatticeForces(m).find(m, Flow::trial, f);
            } else {
                forces.find(m, Flow::trial, f);
            }
        }
        return f;
    };
    const Vec3Array expected = forces_along(true);
    for (int threads : {1, 3}) {
        set_thread_count(threads);
        for (int width : {8, 4, 2}) {
            limit_vector_width(width);
            const Vec3Array f = forces_along(false);
            CHECK(f.x == expected.x);
            CHECK(f.y == expected.y);
        }
    }
    limit_vector_width(0);
    set_thread_count(0);
}

TEST_CASE("a cell of two materials uses as much as the one of them that is nearer to its end") {
    Material weak{.young_modulus = 1e6, .poisson_ratio = 0.3, .yield_stress = 1e3};
    weak.strength = 2e3, weak.toughness = 100;
    Material firm = weak;
    firm.yield_stress = firm.strength = 1e5, firm.toughness = 1e4;
    MoldSettings settings;
    settings.across = 1;
    for (const bool body_is_weak : {false, true}) {
        Aggregate m = mold(box_mesh({0, 0, 0}, {4, 1, 1}), body_is_weak ? weak : firm, settings,
                           {{box_mesh({-1, 0.5, -1}, {5, 2, 2}), body_is_weak ? firm : weak}});
        REQUIRE(m.mixed_cell.size() == 4);
        const double strain = 0.5e-3, thin = 1 - 0.3 * strain;
        test::deform(
            m, [&](const Vec3& x) -> Vec3 { return x.cwiseProduct(Vec3(1 + strain, thin, thin)); });
        const StrengthUse::Most most = StrengthUse(m).beyond(m, 0, 0);
        INFO("weak body " << body_is_weak);
        CHECK(most.yield.share == Approx(0.5).epsilon(0.01));
        CHECK(most.strength.share == Approx(0.25).epsilon(0.02));
    }
}

TEST_CASE("damping does not hold what flows, of two materials neither") {
    Material outside = soft(), inside = stiff();
    outside.yield_stress = 1e3, inside.yield_stress = 1e5;
    outside.damping_ratio = 0.05, inside.damping_ratio = 0.02;
    Aggregate m = bar_with_ball(outside, inside);
    const test::SteadyFlow drawn = test::flow_steadily(m, 0.4, 4000);
    CHECK(drawn.plastic > 0);
    // Strained as far as the matter branches take 1.9 times what the flow does. Where both meet in
    // a cell they flow apart, and the length at rest is only one of both: 0.14.
    CHECK(drawn.given < 0.15 * drawn.plastic);
}

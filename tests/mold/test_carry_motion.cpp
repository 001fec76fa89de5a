// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_motion.h"

#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

template <typename Law>
void set_in_motion(Aggregate& m, const Law& law) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, law(m.particle_position.at(p)));
    }
}

struct Motion {
    Vec3 momentum = Vec3::Zero(), spin = Vec3::Zero();  // about the origin
    double energy = 0;
};
Motion motion_of(const Aggregate& m) {
    Motion sum;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_position.at(p), v = m.particle_velocity.at(p);
        sum.momentum += m.particle_mass[p] * v;
        sum.spin += m.particle_mass[p] * x.cross(v);
        sum.energy += 0.5 * m.particle_mass[p] * v.squaredNorm();
    }
    return sum;
}

}  // namespace

TEST_CASE("what is molded anew moves on, place by place, as the matter that was there") {
    Aggregate old = make_block(8, 4, 4, 0.1, Material{});
    deform(old, [](const Vec3& x) { return Vec3(1.25 * x.x(), 0.9 * x.y(), 0.9 * x.z()); });
    const auto tumbling = [](const Vec3& x) {
        return Vec3(Vec3(3, -1, 0.5) + Vec3(2, 5, -7).cross(x));
    };
    set_in_motion(old, tumbling);
    Aggregate anew = make_block(10, 4, 4, 0.09, Material{});
    carry_motion(old, anew);
    // Of one centre; that they turn alike is another matter where one is thicker.
    Aggregate as_thick = make_block(10, 4, 4, 0.1, Material{});
    for (std::size_t p = 0; p < as_thick.particle_count(); ++p) {
        const Vec3 x = as_thick.particle_position.at(p);
        as_thick.particle_position.set(p, Vec3(x.x(), 0.9 * x.y(), 0.9 * x.z()));
        as_thick.particle_mass[p] *= 0.8;
    }
    carry_motion(old, as_thick);
    for (std::size_t p = 0; p < as_thick.particle_count(); ++p) {
        const Vec3 wanted = tumbling(as_thick.particle_position.at(p));
        CHECK((as_thick.particle_velocity.at(p) - wanted).norm() < 0.05 * wanted.norm() + 0.05);
    }
    for (const Aggregate* one : {&anew, &as_thick}) {
        const Motion before = motion_of(old), after = motion_of(*one);
        CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
        CHECK((after.spin - before.spin).norm() < 1e-12 * before.spin.norm());
    }
}

TEST_CASE("what is molded anew about another centre keeps its angular momentum about the origin") {
    Aggregate old = make_block(8, 4, 4, 0.1, Material{}), anew = old;
    for (double& y : anew.particle_position.y) y += 0.03;
    set_in_motion(
        old, [](const Vec3& x) { return Vec3(Vec3(3, -1, 0.5) + Vec3(0.2, 0.5, -0.7).cross(x)); });
    carry_motion(old, anew);
    const Motion before = motion_of(old), after = motion_of(anew);
    CHECK((after.spin - before.spin).norm() < 1e-12 * before.momentum.norm());
}

TEST_CASE("a swing within a body is carried as it is") {
    Aggregate old = make_block(8, 4, 4, 0.1, Material{});
    set_in_motion(old, [](const Vec3& x) { return Vec3(0, std::cos(3 * x.x()), 0); });
    Aggregate anew = make_block(16, 8, 8, 0.05, Material{});
    carry_motion(old, anew);
    for (std::size_t p = 0; p < anew.particle_count(); ++p) {
        const Vec3 v = anew.particle_velocity.at(p);
        CHECK(std::abs(v.y() - std::cos(3 * anew.particle_position.at(p).x())) < 0.06);
        CHECK(std::abs(v.z()) < 1e-3);
    }
    CHECK(motion_of(anew).energy == Approx(motion_of(old).energy).epsilon(0.02));
}

TEST_CASE("shards that fly apart have no more energy once they are one") {
    Aggregate old = make_block(8, 4, 4, 0.1, Material{});
    const auto apart = [](const Vec3& x) {
        const auto side = [](double v, double n) { return std::sin(n * v + 0.3) > 0 ? 1.0 : -1.0; };
        return Vec3(2 + side(x.x(), 11) * side(x.y(), 17), side(x.y(), 23) * side(x.z(), 19),
                    side(x.z(), 13) * side(x.x(), 29));
    };
    set_in_motion(old, apart);
    deform(old, [](const Vec3& x) { return Vec3(0.6 * x); });
    for (Aggregate anew :
         {make_block(8, 4, 4, 0.1, Material{}), make_block(16, 8, 8, 0.05, Material{})}) {
        carry_motion(old, anew);
        const Motion before = motion_of(old), after = motion_of(anew);
        CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
        CHECK(after.energy < before.energy * 1.001);
    }
}

TEST_CASE("shards that fly apart keep all their energy where one body could have more") {
    // Layers that go to and fro, without momentum or spin; what sticks out would be far faster.
    Aggregate old = make_block(8, 4, 4, 0.1, Material{});
    set_in_motion(old, [](const Vec3& x) {
        const int layer = static_cast<int>(std::lround(x.x() / 0.1));
        return Vec3(layer == 0 ? 0 : (layer > 0) == (layer % 2 == 0) ? 1 : -1, 0, 0);
    });
    deform(old, [](const Vec3& x) { return Vec3(0.6 * x); });
    Aggregate anew = make_block(8, 4, 4, 0.1, Material{});
    carry_motion(old, anew);
    CHECK(motion_of(anew).energy == Approx(motion_of(old).energy).epsilon(1e-9));
}

TEST_CASE("what swings against itself within each cell is at rest once it is molded anew") {
    Aggregate old = make_block(8, 4, 4, 0.1, Material{});
    set_in_motion(old, [](const Vec3& x) {
        const double sites = std::round((x.x() + x.y() + x.z()) / 0.1);
        return Vec3(0, 0, std::fmod(std::abs(sites), 2) == 0 ? 1 : -1);
    });
    Aggregate anew = make_block(8, 4, 4, 0.1, Material{});
    carry_motion(old, anew);
    CHECK(motion_of(anew).energy < 1e-3 * motion_of(old).energy);
}

TEST_CASE("a cell that is pressed flat moves what is molded anew as it moves itself") {
    Aggregate old = make_block(4, 4, 4, 0.1, Material{});
    deform(old, [](const Vec3& x) {  // its two lowest layers
        return Vec3(x.x(), x.y(), std::max(x.z(), -1e-9 * x.x()));
    });
    set_in_motion(old, [](const Vec3& x) { return Vec3(2, 0.5 * x.x(), x.z() > 0.05 ? 1 : -1); });
    Aggregate anew = make_block(4, 4, 2, 0.1, {.density = 2000});  // of as much mass
    deform(anew, [](const Vec3& x) { return Vec3(x.x(), x.y(), x.z() + 0.1); });
    carry_motion(old, anew);
    const double energy = motion_of(old).energy / old.mass();
    CHECK(motion_of(anew).energy / anew.mass() < 1.5 * energy);
    double fastest = 0;
    for (std::size_t p = 0; p < anew.particle_count(); ++p) {
        fastest = std::max(fastest, anew.particle_velocity.at(p).norm());
    }
    CHECK(fastest < 4);
}

TEST_CASE("what rests is molded anew at rest") {
    const Aggregate old = make_block(2, 2, 2, 0.1, Material{});
    Aggregate anew = old;
    carry_motion(old, anew);
    CHECK(motion_of(anew).energy == 0);
}

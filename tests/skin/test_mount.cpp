// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/mount.h"

#include <cstring>
#include <random>

#include "base/parallel.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

std::vector<Vec3> places_in(const Vec3& low, const Vec3& high, int count) {
    std::mt19937 random(7);
    std::vector<Vec3> places;
    for (int n = 0; n < count; ++n) {
        Vec3 t;
        for (double& x : t) x = random() / double(std::mt19937::max());
        places.push_back(low + t.cwiseProduct(high - low));
    }
    places.push_back(low);
    places.push_back(high);
    places.push_back({-0.0, 0.0, -0.0});
    return places;
}

double largest_gap(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double gap = 0;
    for (std::size_t n = 0; n < a.size(); ++n) gap = std::max(gap, (a[n] - b[n]).norm());
    return gap;
}

double mount_error(const Aggregate& rest, const std::vector<Vec3>& places, SkinKind kind,
                   const std::function<Vec3(const Vec3&)>& map) {
    Aggregate matter = rest;
    const Mount mount = mount_mesh(places, matter, kind);
    test::deform(matter, map);
    std::vector<Vec3> is, should;
    skin_positions(mount, matter, is);
    for (const Vec3& p : places) should.push_back(map(p));
    return largest_gap(is, should);
}

// A bar of length 10 and section 1 along x, bent to the angle.
Vec3 bend(const Vec3& p, double angle) {
    const double kappa = angle / 10, t = kappa * p.x();
    const double r = 1 / kappa - p.y();
    return {r * std::sin(t), 1 / kappa - r * std::cos(t), p.z()};
}

const SkinKind kFollowing[] = {SkinKind::mount, SkinKind::frame4};

}  // namespace

TEST_CASE("matter at rest leaves the mesh as it was, to the bit") {
    const Aggregate matter = test::make_block(7, 3, 4, 0.1 / 3, Material{});
    const auto places = places_in({-.3, -.2, -.2}, {.3, .2, .2}, 2000);  // some outside
    for (SkinKind kind : kFollowing) {
        const Mount mount = mount_mesh(places, matter, kind);
        std::vector<Vec3> now;
        skin_positions(mount, matter, now);
        REQUIRE(now.size() == places.size());
        CHECK(std::memcmp(now.data(), places.data(), sizeof(Vec3) * now.size()) == 0);
    }
}

TEST_CASE("a rigid motion is followed exactly") {
    const double a = 0.05;
    Aggregate matter = test::make_shape([](const Vec3& p) { return p.norm() - 0.4; },
                                        Vec3::Constant(-.42), Vec3i::Constant(17), a);
    if (GENERATE(false, true)) test::sever_plane(matter, {0.013, 0, 0}, {1, .3, -.2});
    const Quat turn(Eigen::AngleAxisd(2.1, Vec3(1, -2, .5).normalized()));
    const auto map = [&](const Vec3& p) -> Vec3 { return turn * p + Vec3(3, -2, 5); };
    const auto places = places_in(Vec3::Constant(-.45), Vec3::Constant(.45), 3000);
    for (SkinKind kind : kFollowing) CHECK(mount_error(matter, places, kind, map) < 1e-12 * 10);
}

TEST_CASE("half frames are exact for quadratic fields wherever three particles stand in a row") {
    const Aggregate matter = test::make_block(6, 4, 5, 0.1, Material{});
    const auto places = places_in({-.3, -.2, -.25}, {.3, .2, .25}, 2000);
    const auto map = [](const Vec3& p) -> Vec3 {
        const double x = p.x(), y = p.y(), z = p.z();
        return p + Vec3(x * x - 2 * x * y + z, .5 * y * y + x * z, z * z + x * y - y * z + .3 * x);
    };
    CHECK(mount_error(matter, places, SkinKind::mount, map) < 1e-13);
    CHECK(mount_error(matter, places, SkinKind::frame4, map) > 1e-3);
}

TEST_CASE("a bent bar's skin is far nearer the truth than the cells are wide") {
    // Bars bent by 90 degrees; errors in thicknesses.
    for (const auto& [across, bar] :
         {std::pair(3, 4e-4), std::pair(7, 6e-5), std::pair(15, 1e-5)}) {
        Aggregate matter = test::make_block(10 * across, across, across, 1.0 / across, Material{});
        const auto places = places_in({-5, -.5, -.5}, {5, .5, .5}, 3000);
        const auto map = [](const Vec3& p) { return bend(p, kPi / 2); };
        CHECK(mount_error(matter, places, SkinKind::mount, map) < bar);
    }
}

TEST_CASE("a body one cell thick is followed without blowing up") {
    const Aggregate matter = test::make_block(10, 1, 1, 1.0, Material{});
    const auto places = places_in({-5, -.5, -.5}, {5, .5, .5}, 3000);
    const auto map = [](const Vec3& p) { return bend(p, kPi / 2); };
    CHECK(mount_error(matter, places, SkinKind::mount, map) < 0.01);
    const Aggregate single = test::make_block(1, 1, 1, 1.0, Material{});
    const auto stretch = [](const Vec3& p) -> Vec3 {
        return {1.2 * p.x() + .1 * p.y(), p.y(), p.z()};
    };
    CHECK(mount_error(single, places_in(Vec3::Constant(-.5), Vec3::Constant(.5), 100),
                      SkinKind::mount, stretch) < 1e-14);
}

TEST_CASE("severed matter is followed by each side on its own") {
    const double a = 0.1;
    Aggregate matter = test::make_block(10, 4, 4, a, Material{});
    const Vec3 normal = Vec3(1, .35, .2).normalized();
    test::sever_plane(matter, {0.0312, 0, 0}, normal);
    REQUIRE(find_pieces(matter).count == 2);
    const auto places = places_in({-.5, -.2, -.2}, {.5, .2, .2}, 4000);
    Mount mount = mount_mesh(places, matter, GENERATE(SkinKind::mount, SkinKind::frame4));
    const auto above = [&](const Vec3& p) { return normal.dot(p - Vec3(0.0312, 0, 0)) >= 0; };
    for (std::size_t v = 0; v < places.size(); ++v) {
        mount.side[v] = 0;
        const auto corner = matter.lattice.cell_corners(mount.cell[v]);
        for (int c = 0; c < 8; ++c) {
            const bool own = above(matter.particle_reference.at(corner[c])) == above(places[v]);
            mount.side[v] |= static_cast<CornerMask>(own << c);
        }
        if (mount.side[v] == 0) mount.side[v] = kAllCorners;
    }
    const Quat turn(Eigen::AngleAxisd(.7, Vec3::UnitZ()));
    const auto map = [&](const Vec3& p) -> Vec3 {
        return above(p) ? Vec3(turn * p + Vec3(2, 1, 0)) : p;
    };
    test::deform(matter, map);
    std::vector<Vec3> now;
    skin_positions(mount, matter, now);
    std::size_t wrong = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
        wrong += (now[v] - map(places[v])).norm() > 1e-12;
    }
    CHECK(wrong == 0);
}

TEST_CASE("a skin is held no farther off its matter than what flowed around may have left it") {
    const double a = 0.1;
    Aggregate matter = test::make_block(9, 3, 3, a, Material{});
    matter.cell_history.assign(matter.cell_fill.size());
    const auto cell_at = [&](int i) { return std::size_t(matter.lattice.cell_at(i, 1, 1)); };
    matter.cell_history.hardening()[cell_at(4)] = 0.01f;
    // In the cell that flowed, in one beside it, and two cells on.
    Mount mount = mount_mesh({{0, 0, 0}, {a, 0, 0}, {2 * a, 0, 0}}, matter, SkinKind::mount);
    const auto held = [&](double gap) {
        Mount own = mount;
        std::vector<Vec3> place, is;
        for (const Vec3& p : own.reference) place.push_back(p + Vec3(0, gap, 0));
        hold_places(own, matter, place);
        skin_positions(own, matter, is);
        std::vector<double> off;
        for (std::size_t v = 0; v < is.size(); ++v) off.push_back((is[v] - place[v]).norm() / a);
        return off;
    };
    const std::vector<double> near = held(0.04 * a), far = held(2 * a);
    for (int v : {0, 1}) {
        CHECK(near[v] == Approx(0).margin(1e-9));
        CHECK(far[v] == Approx(2 - 0.05).epsilon(1e-6));
    }
    CHECK(near[2] == Approx(0.04));
    CHECK(far[2] == Approx(2));
}

TEST_CASE("the skin is the same to the bit at any number of threads") {
    Aggregate matter = test::make_block(30, 8, 8, 0.1, Material{});
    const auto places = places_in({-1.5, -.4, -.4}, {1.5, .4, .4}, 20000);
    const Mount mount = mount_mesh(places, matter, SkinKind::mount);
    test::deform(matter, [](const Vec3& p) { return bend(p, .8); });
    std::vector<Vec3> one, many;
    set_thread_count(1);
    skin_positions(mount, matter, one);
    for (int threads : {2, 3, 8}) {
        set_thread_count(threads);
        skin_positions(mount, matter, many);
        CHECK(std::memcmp(one.data(), many.data(), sizeof(Vec3) * one.size()) == 0);
    }
    set_thread_count(0);
}

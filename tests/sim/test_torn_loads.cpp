// SPDX-License-Identifier: GPL-3.0-or-later
// Forces on the surface beside a cut.
#include "matter/connections.h"
#include "sim/load_set.h"
#include "sim/sever.h"
#include "tests/sim/loads_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

const Vec3 kPush(2, -3, 1);

// Of each side of the cut by x, from the left [N].
std::array<Vec3, 2> borne(const Aggregate& matter, const LoadSet& loads, const Drive& now) {
    Vec3Array force;
    force.resize(matter.particle_count());
    loads.add_forces(matter, now, force);
    const Pieces pieces = find_pieces(matter);
    REQUIRE(pieces.count == 2);
    std::array<Vec3, 2> sum{Vec3(Vec3::Zero()), Vec3(Vec3::Zero())};
    for (std::size_t p = 0; p < force.size(); ++p) {
        sum[pieces.particle_piece[p] != pieces.particle_piece[0]] += force.at(p);
    }
    return sum;
}

Apparatus pushed_above(const Aggregate& matter, double from, double to) {
    Apparatus apparatus;
    apparatus.load.push_back(force_on(
        matter,
        points_where(matter,
                     [&](const Vec3& x) { return x.y() > 0.1499 && x.x() > from && x.x() < to; }),
        kPush));
    return apparatus;
}

}  // namespace

TEST_CASE("a force on one side of a cut pulls at that side alone, and acts where it is told to") {
    Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    const Apparatus apparatus = pushed_above(matter, 0.013, 0.3);
    LoadSet loads(apparatus, {});
    const Drive now = drive_of(apparatus, 1, 1);
    sever_plane(matter, Vec3(0.013, 0, 0), Vec3::UnitX());
    loads.connections_changed(matter);
    const std::array<Vec3, 2> side = borne(matter, loads, now);
    CHECK(side[0].norm() < 1e-12);
    CHECK((side[1] - kPush).norm() < 1e-12);
    const LoadSum sum = loads.sums(matter, now).at(0);
    CHECK(sum.torque.norm() < 1e-12);
    CHECK(sum.centre.x() == Approx(0.15).epsilon(1e-6));  // of its patches
}

TEST_CASE("within a cell of a blade a force moves the side on which it lies, and that alone") {
    const double cut = GENERATE(0.02, 0.04, 0.06, 0.08);
    const bool is_left = GENERATE(true, false);
    CAPTURE(cut, is_left);
    Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    Apparatus apparatus;
    const double from = is_left ? 0 : cut, to = is_left ? cut : 0.1;
    const std::vector<int> pushed = points_where(
        matter, [&](const Vec3& x) { return x.y() > 0.1499 && x.x() > from && x.x() < to; });
    if (pushed.empty()) return;
    const Vec3 push = is_left ? Vec3(-2, -3, 1) : Vec3(2, -3, 1);  // away from the other
    apparatus.name = "cut and push";
    apparatus.load.push_back(force_on(matter, pushed, push));
    apparatus.blade.push_back({"blade", {Vec3(cut, 0, -1), Vec3(cut, 0, 1)}, {}});
    Vec3 moment = Vec3::Zero();
    for (std::size_t n = 0; n < pushed.size(); ++n) {
        moment +=
            matter.surface_reference(std::size_t(pushed[n])).cross(apparatus.load[0].force[n]);
    }
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.self_contact = false;
    const auto drive = [&](double time, double blade, double strength) {
        Drive d = drive_of(apparatus, time, strength);
        d.world_from_blade = {Pose{Quat::Identity(), Vec3(0, blade, 0)}};
        return d;
    };
    constexpr double kTime = 1e-3;
    Simulation simulation(matter, apparatus, settings);
    REQUIRE(simulation.advance(drive(0, 0.5, 1), drive(kTime, -0.5, 1)).pieces == 2);
    const Pieces pieces = find_pieces(matter);
    std::array<Vec3, 2> momentum{Vec3(Vec3::Zero()), Vec3(Vec3::Zero())}, turning = momentum;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const int side = pieces.particle_piece[p] != pieces.particle_piece[0];
        const Vec3 one = matter.particle_mass[p] * matter.particle_velocity.at(p);
        momentum[side] += one;
        turning[side] += matter.particle_reference.at(p).cross(one);
    }
    CHECK((momentum[is_left ? 0 : 1] - kTime * push).norm() < 1e-3 * kTime * push.norm());
    CHECK((turning[is_left ? 0 : 1] - kTime * moment).norm() < 1e-3 * kTime * push.norm() * 0.1);
    CHECK(momentum[is_left ? 1 : 0].norm() < 1e-9 * kTime * push.norm());
    // Another stage has its own loads, and knows the sides too.
    const std::array<Vec3, 2> side = [&] {
        LoadSet loads(apparatus, {});
        loads.connections_changed(matter);
        return borne(matter, loads, drive(0, 0, 1));
    }();
    CHECK((side[is_left ? 0 : 1] - push).norm() < 1e-9);
}

TEST_CASE("a box that ends at a cut loads one side alone, however little it leaves of a patch") {
    // A patch from 0.05 to 0.1: its middle lies on the left, and what is loaded on the right.
    Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    const double cut = 0.08;
    for (const bool presses : {false, true}) {
        Aggregate halved = matter;
        Apparatus apparatus = pushed_above(halved, 0.06, 0.3);
        Load& load = apparatus.load[0];
        if (presses) load.force.clear(), load.pressure = 100;
        for (int p : load.point) {
            const bool is_cut_off = halved.surface_reference(std::size_t(p)).x() < 0.1;
            load.share.push_back(is_cut_off ? 0.4 : 1);
        }
        LoadSet loads(apparatus, {});
        sever_plane(halved, Vec3(cut, 0, 0), Vec3::UnitX());
        loads.connections_changed(halved);
        const std::array<Vec3, 2> side = borne(halved, loads, drive_of(apparatus, 1, 1));
        CHECK(side[0].norm() < 1e-12);
        CHECK(side[1].norm() > 1);
    }
}

TEST_CASE(
    "beside a slanted cut a force and a pressure load their side alone, whichever way round") {
    constexpr double kCell = 0.1, kPatch = kCell / 2, kTop = 0.25;
    const double offset = GENERATE(-0.0282, 0.011, 0.037, 0.061, 0.093);
    const double tilt = GENERATE(-0.7, -0.4, -0.2, 0.2, 0.4, 0.7);
    const bool is_mirrored = GENERATE(false, true), is_upside_down = GENERATE(false, true);
    const bool presses = GENERATE(false, true);
    CAPTURE(offset, tilt, is_mirrored, is_upside_down, presses);
    const Vec3 flip(is_mirrored ? -1 : 1, is_upside_down ? -1 : 1, 1);
    Aggregate matter = make_block(8, 5, 3, kCell, kSoft);
    const Vec3 normal = flip.cwiseProduct(Vec3(std::cos(tilt), std::sin(tilt), 0));
    const double from = offset - kTop * std::tan(tilt) + 0.0115, to = from + 0.0725;
    Apparatus apparatus;
    std::vector<double> share;
    const std::vector<int> pushed = points_where(matter, [&](const Vec3& x) {
        const Vec3 at = flip.cwiseProduct(x);
        if (at.y() < kTop - 1e-6) return false;
        const double low = std::max(from, at.x() - kPatch / 2);
        const double high = std::min(to, at.x() + kPatch / 2);
        if (high < low + 1e-6) return false;
        share.push_back((high - low) / kPatch);
        return true;
    });
    Load& load = apparatus.load.emplace_back(force_on(matter, pushed, kPush));
    load.share = share;
    Vec3 all = Vec3::Zero();
    const Vec3 press = Vec3(0, is_upside_down ? 100 : -100, 0);
    for (std::size_t n = 0; n < pushed.size(); ++n) {
        load.force[n] = share[n] * kPush;
        all += presses ? Vec3(share[n] * kPatch * kPatch * press) : load.force[n];
    }
    if (presses) load.force.clear(), load.pressure = 100;
    LoadSet loads(apparatus, {});
    sever_plane(matter, flip.cwiseProduct(Vec3(offset, 0, 0)), normal);
    loads.connections_changed(matter);
    const std::array<Vec3, 2> side = borne(matter, loads, drive_of(apparatus, 1, 1));
    CHECK(side[is_mirrored].norm() < 1e-9 * all.norm());
    CHECK((side[!is_mirrored] - all).norm() < 1e-6 * all.norm());
}

TEST_CASE(
    "of a force across slanted cuts a slice so thin that no cell of it is whole bears its own") {
    constexpr double kCell = 0.1, kTop = 0.25;
    const double offset = GENERATE(-0.03, 0.011, 0.037, 0.061);
    const double width = GENERATE(0.09, 0.12, 0.14, 0.17, 0.2);
    const double tilt = GENERATE(-0.7, -0.4, -0.2, 0.2, 0.4, 0.7);
    const bool is_mirrored = GENERATE(false, true), is_upside_down = GENERATE(false, true);
    CAPTURE(offset, width, tilt, is_mirrored, is_upside_down);
    const Vec3 flip(is_mirrored ? -1 : 1, is_upside_down ? -1 : 1, 1);
    Aggregate matter = make_block(8, 5, 3, kCell, kSoft);
    const Vec3 normal = flip.cwiseProduct(Vec3(std::cos(tilt), std::sin(tilt), 0));
    Apparatus apparatus;
    const auto is_above = [&](const Vec3& x) { return flip.y() * x.y() > kTop - 1e-6; };
    const Load& load =
        apparatus.load.emplace_back(force_on(matter, points_where(matter, is_above), kPush));
    LoadSet loads(apparatus, {});
    for (const double x : {offset, offset + width}) {
        sever_plane(matter, flip.cwiseProduct(Vec3(x, 0, 0)), normal);
    }
    loads.connections_changed(matter);
    const auto is_slice = [&](const Vec3& x) {
        const double far = normal.dot(x - flip.cwiseProduct(Vec3(offset, 0, 0)));
        return far > 0 && far < width * std::cos(tilt);
    };
    Vec3Array force;
    force.resize(matter.particle_count());
    loads.add_forces(matter, drive_of(apparatus, 1, 1), force);
    Vec3 sum = Vec3::Zero(), own = Vec3::Zero();
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        if (is_slice(matter.surface_reference(std::size_t(load.point[n])))) own += load.force[n];
    }
    for (std::size_t p = 0; p < force.size(); ++p) {
        if (is_slice(matter.particle_reference.at(p))) sum += force.at(p);
    }
    CHECK((sum - own).norm() < 1e-6 * kPush.norm());
}

TEST_CASE("a pressure presses a side of a cut up to the cut, and not the other") {
    for (const double cut : {0.02, 0.05, 0.08}) {
        CAPTURE(cut);
        Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
        Apparatus apparatus;
        Load& load = apparatus.load.emplace_back();
        load.name = "gas";
        load.pressure = 100;
        load.point = points_where(
            matter, [&](const Vec3& x) { return x.y() > 0.1499 && x.x() > -0.2 && x.x() < cut; });
        LoadSet loads(apparatus, {});
        const Drive now = drive_of(apparatus, 1, 1);
        loads.start(matter, now);
        const LoadSum whole = loads.sums(matter, now).at(0);
        sever_plane(matter, Vec3(cut, 0, 0), Vec3::UnitX());
        loads.connections_changed(matter);
        const std::array<Vec3, 2> side = borne(matter, loads, now);
        CHECK((side[0] - whole.force).norm() < 1e-6 * whole.force.norm());
        CHECK(side[1].norm() < 1e-12);
        const LoadSum sum = loads.sums(matter, now).at(0);
        CHECK((sum.centre - whole.centre).norm() < 1e-6);
        CHECK(loads.size(matter, now) == Approx(whole.force.norm()));
        // A cut alone does no work.
        std::vector<double> work(1, 0.0);
        loads.commit(matter, now, work);
        CHECK(std::abs(work[0]) < 1e-6 * whole.force.norm() * 0.1);
        // It follows the side that it presses.
        const Quat turn(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
        const Pieces pieces = find_pieces(matter);
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            if (pieces.particle_piece[p] != pieces.particle_piece[0]) continue;
            matter.particle_position.set(p, turn * matter.particle_position.at(p));
        }
        CHECK((borne(matter, loads, now)[0] - turn * whole.force).norm() <
              1e-6 * whole.force.norm());
    }
}

TEST_CASE("beside a crack a force acts on the half of the cell that it lies in") {
    for (const int half : {0, 1}) {
        Aggregate matter = make_block(3, 6, 3, 0.1, kSoft);
        break_layer(matter, 3);  // y from 0 to 0.1
        Apparatus apparatus;
        apparatus.load.push_back(force_on(matter,
                                          points_where(matter,
                                                       [&](const Vec3& x) {
                                                           return x.x() > 0.1499 &&
                                                                  x.y() > 0.05 * half &&
                                                                  x.y() < 0.05 + 0.05 * half;
                                                       }),
                                          kPush));
        LoadSet loads(apparatus, {});
        const Drive now = drive_of(apparatus, 1, 1);
        loads.connections_changed(matter);
        const std::array<Vec3, 2> side = borne(matter, loads, now);
        CHECK((side[half] - kPush).norm() < 1e-9);
        CHECK(side[1 - half].norm() < 1e-12);
        CHECK(loads.sums(matter, now).at(0).centre.y() == Approx(0.025 + 0.05 * half));
    }
}

TEST_CASE("of a force across a cut each side bears what lies on it, all of it where all is torn") {
    for (const double reach : {0.3, 0.1}) {
        Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
        const Apparatus apparatus = pushed_above(matter, reach > 0.2 ? -reach : 0, reach);
        LoadSet loads(apparatus, {});
        sever_plane(matter, Vec3(0.05, 0, 0), Vec3::UnitX());
        loads.connections_changed(matter);
        const std::array<Vec3, 2> side = borne(matter, loads, drive_of(apparatus, 1, 1));
        CHECK((side[0] + side[1] - kPush).norm() < 1e-12);
        const double left = reach > 0.2 ? 0.35 / 0.6 : 0.5;
        CHECK((side[0] - left * kPush).norm() < 1e-6);
    }
}

TEST_CASE("a force does no work where a cut alone makes it act elsewhere, and all where it goes") {
    Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    const Apparatus apparatus = pushed_above(matter, -0.09, 0.3);
    LoadSet loads(apparatus, {});
    const Drive now = drive_of(apparatus, 1, 1);
    loads.start(matter, now);
    const Vec3 first(0.02, 0.01, 0), then(0, -0.2, 0.3);
    std::vector<double> work(1, 0.0);
    deform(matter, [&](const Vec3& x) { return Vec3(x + first); });
    sever_plane(matter, Vec3(0.013, 0, 0), Vec3::UnitX());
    loads.connections_changed(matter);
    loads.commit(matter, now, work);
    CHECK(work[0] == Approx(kPush.dot(first)).epsilon(1e-9));
    deform(matter, [&](const Vec3& x) { return Vec3(x + first + then); });
    loads.commit(matter, now, work);
    CHECK(work[0] == Approx(kPush.dot(first + then)).epsilon(1e-9));
}

TEST_CASE("a force is told to act where it does, wherever it has been spread unevenly") {
    const Aggregate matter = make_block(6, 3, 3, 0.1, kSoft);
    Apparatus apparatus = pushed_above(matter, -0.3, 0.3);
    Load& load = apparatus.load[0];
    Vec3 moment = Vec3::Zero();
    double all = 0;
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const Vec3 x = matter.surface_reference(std::size_t(load.point[n]));
        if (x.x() > 0) load.force[n] *= 3;
        moment += load.force[n].norm() * x;
        all += load.force[n].norm();
    }
    const LoadSum sum = LoadSet(apparatus, {}).sums(matter, drive_of(apparatus, 1, 1)).at(0);
    CHECK((sum.centre - moment / all).norm() < 1e-12);
    CHECK(sum.torque.norm() < 1e-12);
}

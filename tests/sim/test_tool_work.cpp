// SPDX-License-Identifier: GPL-3.0-or-later
// What tools do between equilibria that are far apart.
#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Worked {  // [J], while the plate goes
    double work = 0, remainder = 0;
    double by_hand = 0;  // force times way of the plate, by the trapezoid rule
    double anvil = 0;    // what stands did
    double stored = 0;   // before, in clay and contacts
    int contacts = 0;    // that are left
};

// A flat pad of clay, pressed hard in small moves. Between plates with friction it bears most in
// its middle and springs back crowned, so the plate leaves it point by point, in so many moves.
Worked press_and_leave(int moves, double up) {
    constexpr double kSide = 0.12, kDown = 0.35;
    const Material clay{
        .young_modulus = 3e6, .poisson_ratio = 0.45, .density = 1800, .yield_stress = 3e4};
    Aggregate pad = make_block(12, 2, 12, 0.01, clay);
    Apparatus apparatus;
    for (const char* name : {"anvil", "plate"}) {
        apparatus.tool.push_back({name, BoxShape{Vec3(3 * kSide, 0.04, 3 * kSide), 0.002}, 0.3});
        apparatus.tool.back().contact_stiffness = 20;
    }
    const auto at = [](double time, double down) {
        Drive d;
        d.time = time;
        d.world_from_tool = {{Quat::Identity(), Vec3(0, -0.03, 0)},
                             {Quat::Identity(), Vec3(0, 0.03 - 0.02 * down, 0)}};
        return d;
    };
    Simulation simulation(pad, apparatus, {.tolerance = 1e-3});
    Worked all;
    FrameReport r;
    constexpr int kPress = 20;
    for (int n = 0; n < kPress; ++n) {
        r = simulation.advance(at(n, kDown * n / kPress), at(n + 1, kDown * (n + 1) / kPress));
    }
    const FrameReport pressed = r;
    for (int n = 0; n < moves; ++n) {
        const double bore = r.load[1].force.y();
        r = simulation.advance(at(kPress + n, kDown - up * n / moves),
                               at(kPress + n + 1, kDown - up * (n + 1) / moves));
        all.by_hand += 0.5 * (bore + r.load[1].force.y()) * 0.02 * up / moves;
    }
    all.work = r.work - pressed.work;
    all.remainder = r.remainder - pressed.remainder;
    all.anvil = r.load[0].work;
    all.stored = pressed.elastic + pressed.contact;
    all.contacts = r.load[1].contacts;
    return all;
}

}  // namespace

TEST_CASE("a plate that leaves clay point by point takes back no more than the clay gives",
          "[stress]") {
    // Either the plate leaves a few points in the middle, or all.
    for (const double up : {0.015, 0.03}) {
        const Worked fine = press_and_leave(32, up);
        CHECK(fine.work == Approx(fine.by_hand).epsilon(0.005));
        for (const int moves : {1, 2, 4, 32}) {
            const Worked coarse = press_and_leave(moves, up);
            INFO(up << ", " << moves << " moves: work " << coarse.work << " J, by hand "
                    << coarse.by_hand << ", remainder " << coarse.remainder << " of "
                    << coarse.stored);
            CHECK(coarse.stored > 0.3);
            CHECK((coarse.contacts > 0) == (up < 0.02));
            CHECK(coarse.anvil == 0);
            CHECK(std::abs(coarse.remainder) < 0.005 * coarse.stored);
            CHECK(std::abs(coarse.work - fine.by_hand) < (moves < 4 ? 0.25 : 0.05) * coarse.stored);
        }
        CHECK(std::abs(fine.remainder) < 0.0005 * fine.stored);
    }
}
TEST_CASE("what comes to stand under a load takes little from the work of a grip beside it") {
    // A block that hangs is drawn down onto an anvil, as its grip sinks a little.
    const auto worked = [](int moves) {
        Aggregate block = make_block(4, 4, 4, 0.01, kSoft);
        Apparatus apparatus;
        apparatus.tool.push_back({"anvil", BoxShape{Vec3(0.2, 0.04, 0.2), 0.002}, 0});
        apparatus.grip = {
            hold(block, points_where(block, [](const Vec3& x) { return x.y() > 0.0199; }))};
        apparatus.load = {
            force_on(block, points_where(block, [](const Vec3& x) { return x.y() < -0.0199; }),
                     Vec3(0, -8, 0))};
        const auto at = [&](double t) {
            Drive d = drive_of(apparatus, t, t);
            d.world_from_tool = {{Quat::Identity(), Vec3(0, -0.04 - 1e-4, 0)}};
            d.world_from_grip[0].translation.y() -= 1e-5 * t;
            return d;
        };
        Simulation simulation(block, apparatus, {.tolerance = 1e-4});
        FrameReport r;
        for (int n = 0; n < moves; ++n) {
            r = simulation.advance(at(double(n) / moves), at(double(n + 1) / moves));
        }
        CHECK(r.load[0].contacts > 0);
        return r;
    };
    const FrameReport fine = worked(32), coarse = worked(1);
    INFO(fine.load[1].work << " " << coarse.load[1].work << " of " << coarse.load_work);
    CHECK(std::abs(fine.load[1].work) < 0.2 * fine.load_work);
    CHECK(coarse.load[1].work == Approx(fine.load[1].work).epsilon(0.35));
}

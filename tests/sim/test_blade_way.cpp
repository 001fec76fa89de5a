// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "sim/advance.h"
#include "sim/blade_way.h"
#include "tests/catch.h"
#include "tests/sim/flying_block.h"

using namespace swage;
using namespace swage::test;

namespace {

// Connections of a block of 6 x 6 x 2 cells that a plane across x parts.
constexpr std::size_t kAcross = 7 * 3 + 2 * (6 * 3 + 7 * 2);

// A blade comes down x = 0 at 1 m/s, at first 4 cm above a body of 12 cm that flies. It is looked
// for and planned as a stage does.
struct Passage {
    std::size_t severed = 0, planned = 0;
    int pieces = 0;
    std::vector<std::string> warning;
    std::size_t passed = 0;  // before there was a plan
    double severed_at = 0;   // the last [s]
};

Passage pass_slow_blade(const Vec3& speed, int frames, double duration, bool flies = true) {
    FlyingBlock flying(speed);
    auto& [block, apparatus] = flying;
    std::vector<Drive> way;
    for (int n = 0; n <= frames; ++n) {
        const double time = duration * n / frames;
        way.push_back(FlyingBlock::with_edge_at(0.1 - time, time));
    }
    const auto met = [&, &block = block, &apparatus = apparatus](std::size_t from,
                                                                 std::size_t count) {
        const auto part = std::span<const Drive>(way).subspan(from, count);
        return flies ? way_in_flight(block, apparatus, part, Vec3::Zero())
                     : std::vector<Drive>(part.begin(), part.end());
    };
    Simulation simulation(block, apparatus, motion_settings());
    Passage passage;
    bool is_planned = false;
    for (std::size_t n = 0; n + 1 < way.size(); ++n) {
        if (!is_planned && simulation.blades_reach(0, met(n, 2))) {
            is_planned = true;
            simulation.plan_cuts(0, met(n, way.size() - n), 1);
            passage.planned = block.connection_count() - simulation.planned(0).connection_count();
        }
        const Vec3Array before = block.particle_position;
        const FrameReport r = simulation.advance(way[n], way[n + 1]);
        if (!is_planned) {
            passage.passed += count_passed(block, before, apparatus, way[n], way[n + 1]);
        }
        if (r.severed > 0) passage.severed_at = way[n].time;
        passage.severed += std::size_t(r.severed);
        passage.pieces = r.pieces;
        passage.warning.insert(passage.warning.end(), r.warning.begin(), r.warning.end());
    }
    return passage;
}

}  // namespace

TEST_CASE(
    "what flies against a slow blade is cut as it passes, however fast and in how many frames") {
    const double speed = GENERATE(0.5, 2, 10, 50);
    const int frames = GENERATE(20, 60, 400);
    CAPTURE(speed, frames);
    const double duration = 0.2 / (1 + speed);  // it has left 0.04 m behind it then
    const Passage passage = pass_slow_blade(Vec3(0, speed, 0), frames, duration);
    CHECK(passage.planned == kAcross);
    CHECK(passage.severed == passage.planned);
    CHECK(passage.pieces == 2);
    CHECK(passage.passed == 0);
    CHECK(passage.warning.empty());
    // As its far side passes, and not when the blade alone would have come so far.
    CHECK(passage.severed_at < 0.17 / (1 + speed));
    CHECK(passage.severed_at > 0.13 / (1 + speed));
}

TEST_CASE("what is carried past a blade between two places of its way is counted") {
    // The blade sweeps 40 um a frame, and the body goes 2 mm.
    const Passage passage = pass_slow_blade(Vec3(0, 50, 0), 100, 0.004, false);
    CHECK(passage.passed > kAcross / 2);
    CHECK(passage.passed + passage.severed >= kAcross);
    // What stands has nothing pass it, though the blade goes through.
    CHECK(pass_slow_blade(Vec3::Zero(), 50, 0.18, false).passed == 0);
}

TEST_CASE(
    "what comes along with a blade or across it adds nothing to its way, nor to one at rest") {
    Aggregate block = make_block(2, 2, 2, 0.02, kSpringy);
    Apparatus apparatus;
    apparatus.blade.push_back({"blade", {Vec3(0, 0, -1), Vec3(0, 0, 1)}, {}});
    std::vector<Drive> way;
    for (const double y : {0.5, 0.4, 0.4, 0.3}) {
        way.push_back(still(0.1 * double(way.size())));
        way.back().world_from_blade = {Pose{Quat::Identity(), Vec3(0, y, 0)}};
    }
    const auto comes_to = [&](const Vec3& speed, const Vec3& gravity = Vec3::Zero()) {
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            block.particle_velocity.set(p, speed);
        }
        const Vec3 last =
            way_in_flight(block, apparatus, way, gravity).back().world_from_blade[0].translation;
        CHECK(std::abs(last.x()) < 1e-12);
        CHECK(std::abs(last.z()) < 1e-12);
        return last.y();
    };
    CHECK(comes_to(Vec3::Zero()) == 0.3);
    CHECK(comes_to(Vec3(5, 0, 7)) == Approx(0.3));
    CHECK(comes_to(Vec3(0, -0.5, 0)) == Approx(0.3));
    CHECK(comes_to(Vec3(1, 4, 0)) == Approx(0.3 - 2 * 0.1 * 4));
    // Gravity adds to it, but for the way that it goes while the blade rests.
    const double g = 10;
    CHECK(comes_to(Vec3(1, 4, 0), Vec3(0, g, 0)) ==
          Approx(0.3 - 2 * 0.1 * 4 - 0.5 * g * (0.1 * 0.1 + 0.3 * 0.3 - 0.2 * 0.2)));
    CHECK(comes_to(Vec3(1, 4, 0), Vec3(0, -40, 0)) == Approx(0.3 - (0.1 * 4 - 0.5 * 40 * 0.01)));
    for (std::size_t n = 0; n < way.size(); ++n) way[n].gravity_strength = 0.5;
    CHECK(comes_to(Vec3::Zero(), Vec3(0, g, 0)) == Approx(0.3 - 0.25 * g * 0.06));
}

namespace {

// Of two blades the first by number comes down x = 0.3 cm in 12 drives from when it reaches the
// body, of 12 cm; the second goes along `across` through it in 4, from the fourth on. Pieces after
// each drive.
std::vector<int> pieces_by_two(Solver solver, const Vec3& edge, const Vec3& across,
                               std::array<long, 2>& severed) {
    FlyingBlock at_rest(Vec3::Zero());
    auto& [block, apparatus] = at_rest;
    apparatus.blade.push_back({"second", {edge - Vec3::UnitZ(), edge + Vec3::UnitZ()}, {}});
    std::vector<Drive> way;
    for (int n = 0; n <= 16; ++n) {
        way.push_back(FlyingBlock::with_edge_at(0.065 - 0.01 * n, 1e-3 * n));
        const double gone = 0.05 * std::clamp(n - 3, 0, 4);
        way.back().world_from_blade.push_back({Quat::Identity(), gone * across});
    }
    Simulation simulation(block, apparatus, motion_settings(solver));
    std::vector<int> pieces;
    for (std::size_t n = 0; n + 1 < way.size(); ++n) {
        const std::span<const Drive> ahead = std::span<const Drive>(way).subspan(n);
        if (n == 0) simulation.plan_cuts(0, ahead, 1, {1, 0});
        if (n == 3) simulation.plan_cuts(0, ahead, 1, {0, 1});
        const FrameReport r = simulation.advance(way[n], way[n + 1]);
        CHECK(r.warning.empty());
        pieces.push_back(r.pieces);
        for (std::size_t b = 0; b < 2; ++b) severed[b] = r.load[b].severed;
    }
    return pieces;
}

}  // namespace

TEST_CASE("a blade that comes later and goes faster parts what another has yet to reach") {
    const Solver solver =
        GENERATE(Solver::explicit_steps, Solver::energy_stepped, Solver::quasistatic);
    std::array<long, 2> severed{};
    // Across the way of the first, below where that is by then.
    const std::vector<int> across =
        pieces_by_two(solver, Vec3(-0.1, -0.027, 0), Vec3::UnitX(), severed);
    CHECK(across[5] == 1);
    CHECK(across[6] == 2);
    CHECK(across.back() == 4);
    // Along it, from the other side.
    const std::vector<int> along =
        pieces_by_two(solver, Vec3(0.003, -0.1, 0), Vec3::UnitY(), severed);
    CHECK(along[6] == 2);
    CHECK(along.back() == 2);
    CHECK(std::size_t(severed[0] + severed[1]) == kAcross);
}

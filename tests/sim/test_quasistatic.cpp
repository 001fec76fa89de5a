// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "base/parallel.h"
#include "sim/cell_volume.h"
#include "sim/given_up.h"
#include "sim/quasistatic.h"
#include "tests/catch.h"
#include "tests/sim/loads_fixture.h"
#include "tests/sim/machines.h"

using namespace swage;
using namespace swage::test;

namespace {

const double kDegree = kPi / 180;
constexpr double kHeight = 0.1;

Bender bender(double friction, double radius = 2 * kHeight) {
    return {kHeight, radius, 1.2 * kHeight, 0.45 * kHeight, 90 * kDegree, friction};
}

struct Bent {
    Aggregate matter;
    std::vector<FrameReport> report;
    double pressed_angle;
};

Bent bend(const Material& material, const Bender& machine, int frames, int across = 4,
          int length = 10) {
    Bent bent{make_block(across * length, across, across, kHeight / across, material), {}, 0};
    const Apparatus apparatus = machine.apparatus();
    const SimSettings settings;
    Simulation simulation(bent.matter, apparatus, settings);
    for (int f = 0; f < frames; ++f) {
        bent.report.push_back(simulation.advance(machine.drive_at(double(f) / frames),
                                                 machine.drive_at(double(f + 1) / frames)));
        if (f + 1 == frames * 3 / 5) bent.pressed_angle = bend_angle(bent.matter);
    }
    return bent;
}

const Material kElastic{.young_modulus = 1e7};
const Material kPlastic{.young_modulus = 1e7, .yield_stress = 1e5, .hardening = 2e5};

}  // namespace

TEST_CASE("an elastic bar bent by 90 degrees takes the angle and springs back") {
    for (double friction : {0.05, 0.4}) {
        const Bent bent = bend(kElastic, bender(friction), 20);
        CHECK(bent.pressed_angle / kDegree == Approx(90).margin(3));
        CHECK(bend_angle(bent.matter) / kDegree == Approx(0).margin(1));
        for (const ToolLoad& load : bent.report.back().load) CHECK(load.contacts == 0);
    }
}

TEST_CASE("a bar bent past yield keeps a set and loses an elastic share") {
    const Bent bent = bend(kPlastic, bender(0.2), 20);
    const double kept = bend_angle(bent.matter) / kDegree;
    CHECK(kept > 75);
    CHECK(kept < bent.pressed_angle / kDegree - 3);
    CHECK(smallest_cell_volume(bent.matter) > 0.5);
    CHECK(bent.report.back().plastic > 0);
}

// Without any friction the bar's place between the tools is unstable and it slides out.
TEST_CASE(
    "an elastic bar stores the work that bends it and gives it back, but for friction's share") {
    const auto lost = [](double friction) {
        const Bent bent = bend(kElastic, bender(friction), 40);
        const FrameReport& pressed = bent.report[23];
        CHECK(pressed.work == Approx(pressed.elastic).epsilon(3 * friction));
        return bent.report.back().work / pressed.work;
    };
    const double little = lost(0.02), twice = lost(0.04);
    CHECK(little > 0);
    CHECK(little < 0.1);
    CHECK(twice / little == Approx(2).epsilon(0.15));
}

TEST_CASE("without friction all work is stored or flows") {
    for (int frames : {20, 40}) {
        const Bent bent = bend(kPlastic, bender(0.0), frames);
        const FrameReport& pressed = bent.report[frames * 3 / 5 - 1];
        CHECK(pressed.work == Approx(pressed.elastic + pressed.plastic).epsilon(0.08));
    }
}

TEST_CASE("friction takes work") {
    const double smooth = bend(kPlastic, bender(0.0), 20).report.back().work;
    CHECK(bend(kPlastic, bender(0.4), 20).report.back().work > 1.1 * smooth);
}

TEST_CASE("tool forces balance in every loaded frame") {
    const Bent bent = bend(kPlastic, bender(0.3), 20);
    double largest = 0;
    for (const FrameReport& r : bent.report) largest = std::max(largest, r.load[0].force.norm());
    for (const FrameReport& r : bent.report) {
        Vec3 sum = Vec3::Zero();
        for (const ToolLoad& load : r.load) sum += load.force;
        CHECK(sum.norm() < 0.02 * largest);
    }
}

TEST_CASE("the released angle hardly depends on the number of frames") {
    const double few = bend_angle(bend(kPlastic, bender(0.2), 10).matter);
    const double many = bend_angle(bend(kPlastic, bender(0.2), 40).matter);
    CHECK(std::abs(few - many) / kDegree < 1.5);
}

TEST_CASE("a bar too short to be held slips out of its tools, and this is reported") {
    const Bent bent = bend(kElastic, bender(0.0), 40, 4, 4);
    int slipped = 0;
    for (const FrameReport& r : bent.report) slipped += !r.warning.empty();
    CHECK(slipped > 0);
}

TEST_CASE("what a load has pressed onto a tool has not slipped off it once that eases") {
    Aggregate bar = make_block(12, 2, 2, 0.05, kSoft);
    Apparatus apparatus;
    apparatus.name = "rest";
    apparatus.grip.push_back(
        hold(bar, points_where(bar, [](const Vec3& x) { return x.x() < -0.299; })));
    apparatus.load.push_back(force_on(
        bar, points_where(bar, [](const Vec3& x) { return x.x() > 0.299; }), Vec3(0, -20, 0)));
    apparatus.tool.push_back({"rest", BoxShape{Vec3(0.1, 0.1, 0.4), 0.01}, 0.3});
    Simulation simulation(bar, apparatus, SimSettings{});
    const auto at = [&](double time, double strength) {
        Drive d = drive_of(apparatus, time, strength);
        d.world_from_tool.push_back({Quat::Identity(), Vec3(0.25, -0.101, 0)});
        return d;
    };
    const std::vector<double> strength = {0, 0.5, 1, 0.5, 0.1, 0};
    double most = 0, last = 0;
    for (std::size_t n = 1; n < strength.size(); ++n) {
        const FrameReport r =
            simulation.advance(at(n - 1.0, strength[n - 1]), at(double(n), strength[n]));
        last = r.load[0].force.norm();
        most = std::max(most, last);
        CHECK(r.warning.empty());
    }
    CHECK(most > 5);
    CHECK(last < 0.05 * most);  // it has been let go of
}

TEST_CASE("twisting a square bar takes the torque of Saint-Venant, from above as cells refine") {
    // T = 0.1406 G h^4 angle / L on the free length; springs alone are 8 % stiff at 7 cells.
    const double length = 1.0, grip = 0.1, angle = 5 * kDegree;
    const double shear = kElastic.young_modulus / 2.5;
    const double exact = 0.1406 * shear * std::pow(kHeight, 4) * angle / (length - 2 * grip);
    double last = 10;
    for (int across : {2, 4, 8}) {
        Aggregate bar = make_block(10 * across, across, across, kHeight / across, kElastic);
        const Twister twister(bar, length / 2, grip);
        SimSettings settings;
        settings.tolerance = 1e-3;
        Simulation simulation(bar, twister.apparatus, settings);
        const FrameReport r =
            simulation.advance(twister.drive_at(0, angle), twister.drive_at(1, angle));
        const double torque = r.load[1].torque.x();
        CHECK(r.load[0].torque.x() == Approx(-torque).epsilon(0.02));
        CHECK(r.work == Approx(0.5 * torque * angle).epsilon(0.02));
        CHECK(torque > 0.97 * exact);
        const double error = torque / exact - 1;
        CHECK(error < (across == 2 ? 1.5 : across == 4 ? 0.35 : 0.12));
        CHECK(error < last);
        last = error;
    }
}

// Ten times as far as it yields at: half its load times its way would be half the work.
TEST_CASE("the books of a bar that yields in a single move close") {
    const Material hard{.young_modulus = 1e8, .yield_stress = 1e5, .hardening = 2e5};
    for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        Material material = hard;
        material.mechanics = mechanics;
        Aggregate bar = make_block(10, 3, 3, kHeight / 3, material);
        const Twister twister(bar, kHeight * 10 / 6, kHeight / 2);
        SimSettings settings;
        settings.tolerance = 1e-3;
        Simulation simulation(bar, twister.apparatus, settings);
        Drive to = twister.drive_at(1, 0);
        to.world_from_grip[1].translation.x() += 0.01 * kHeight * 10 / 3;
        const FrameReport r = simulation.advance(twister.drive_at(0, 0), to);
        REQUIRE(r.plastic > 0.5 * r.work);
        CHECK(std::abs(r.remainder) < 0.05 * r.work);
        CHECK(r.increments <= 3);
    }
}

TEST_CASE("what yields takes the same work after a tool has crossed air, in one move or in many") {
    const Press press{kHeight};
    const auto work = [&](double gap, int moves) {
        Material lead = kPlastic;
        lead.yield_stress = 1e-4 * lead.young_modulus;
        Aggregate m = make_block(4, 4, 4, kHeight / 4, lead);
        const Apparatus apparatus = press.apparatus();
        SimSettings settings;
        settings.tolerance = 1e-3;
        Simulation simulation(m, apparatus, settings);
        const auto at = [&](int n) {
            return press.drive_at(double(n) / moves, -gap + (0.05 + gap) * n / moves);
        };
        FrameReport r;
        for (int n = 0; n < moves; ++n) r = simulation.advance(at(n), at(n + 1));
        REQUIRE(r.plastic > 0.8 * r.work);
        CHECK(std::abs(r.remainder) < 0.05 * r.work);
        return r.work;
    };
    const double wanted = work(0, 16);
    for (const double gap : {0.0, 0.05, 0.2}) {
        INFO(gap);
        CHECK(work(gap, 1) == Approx(wanted).epsilon(0.06));
        CHECK(work(gap, 3) == Approx(wanted).epsilon(0.06));
    }
}

// Its load grows with it, so that each part of the move seems to begin with next to none.
TEST_CASE("a move that yields is parted a few times and no more") {
    Material thin = kPlastic;
    thin.young_modulus = 1e8;
    Aggregate sheet = make_block(20, 2, 20, kHeight / 8, thin);
    const Press press{kHeight / 4};
    const SimSettings settings;
    Apparatus apparatus = press.apparatus();
    for (Tool& tool : apparatus.tool) tool.shape = BoxShape{Vec3(1, press.side, 1), 0};
    Simulation simulation(sheet, apparatus, settings);
    const FrameReport r = simulation.advance(press.drive_at(0, 0), press.drive_at(1, 0.3));
    CHECK(r.plastic > 0);
    CHECK(r.increments > 1);
    CHECK(r.increments <= 4);
}

TEST_CASE("half a turn of a soft bar converges and comes back") {
    Aggregate bar = make_block(40, 4, 4, kHeight / 4, kElastic);
    const Twister twister(bar, 0.5, 0.1);
    const SimSettings settings;
    Simulation simulation(bar, twister.apparatus, settings);
    const double angle = kPi;
    for (int f = 0; f < 16; ++f) {
        simulation.advance(twister.drive_at(f / 16.0, angle),
                           twister.drive_at((f + 1) / 16.0, angle));
    }
    CHECK(smallest_cell_volume(bar) > 0.5);
    FrameReport last;
    for (int f = 16; f > 0; --f) {
        last = simulation.advance(twister.drive_at(f / 16.0, angle),
                                  twister.drive_at((f - 1) / 16.0, angle));
    }
    for (std::size_t p = 0; p < bar.particle_count(); ++p) {
        CHECK((bar.particle_position.at(p) - bar.particle_reference.at(p)).norm() < 0.02 * kHeight);
    }
}

TEST_CASE("a mirrored body turns itself right side out") {
    Aggregate m = make_block(6, 3, 3, 0.1, kElastic);
    const Apparatus nothing;
    const SimSettings settings;
    for (double& x : m.particle_position.x) x = -0.2 * x;  // squeezed through itself
    Simulation simulation(m, nothing, settings);
    Drive rest;
    for (int f = 0; f < 5; ++f) {
        try {
            simulation.advance(rest, rest);
        } catch (const Error&) {
            break;
        }
    }
    CHECK(smallest_cell_volume(m) > 0.9);
}

TEST_CASE("what cannot converge stops with a sentence and leaves the matter as it was") {
    Aggregate bar = make_block(8, 2, 2, 0.05, kElastic);
    const Twister twister(bar, 0.2, 0.05);
    SimSettings settings;
    settings.iteration_limit = 20;
    settings.tolerance = 1e-16;  // less than round-off leaves
    Simulation simulation(bar, twister.apparatus, settings);
    const std::uint64_t before = state_hash(bar);
    try {
        simulation.advance(twister.drive_at(0, 1), twister.drive_at(1, 1));
        FAIL("it should not converge");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::stopped);
        CHECK(std::string(error.what()).find("tolerance") != std::string::npos);
    }
    CHECK(state_hash(bar) == before);
}

TEST_CASE("a move that is given up on its way is told of to where the matter was last at rest") {
    const Material flowing{.young_modulus = 1e7, .yield_stress = 1e5};
    Aggregate bar = make_block(8, 2, 2, 0.05, flowing);
    const auto end = [&](int side) {
        return points_where(bar, [&](const Vec3& x) { return side * x.x() > 0.19; });
    };
    Apparatus apparatus;
    apparatus.name = "pull";
    apparatus.grip.push_back(hold(bar, end(-1)));
    constexpr double kForce = 2000;  // twice what it can bear
    apparatus.load.push_back(force_on(bar, end(1), {kForce, 0, 0}));
    SimSettings settings;
    settings.iteration_limit = 1000;
    Simulation simulation(bar, apparatus, settings);
    try {
        simulation.advance(drive_of(apparatus, 0, 0), drive_of(apparatus, 1, 1));
        FAIL("it should flow");
    } catch (const GivenUp& given_up) {
        CHECK(given_up.code() == ExitCode::stopped);
        const FrameReport& r = given_up.report();
        INFO(given_up.what());
        CHECK(r.time > 0.2);
        CHECK(r.time < 0.6);
        CHECK(std::string(given_up.what()).find(fmt::format("rest at {:.4g} s", r.time)) !=
              std::string::npos);
        CHECK(r.load.back().force.x() == Approx(kForce * r.time));
        CHECK(r.load.back().work > 0);
        CHECK(r.load.back().work == r.load_work);
        CHECK(r.elastic == Approx(Simulation(bar, apparatus, settings).start().elastic));
        CHECK(std::abs(r.remainder) < 0.03 * r.load_work);
        CHECK(r.increments > 0);
        CHECK(r.iterations > settings.iteration_limit);
        CHECK(r.body.size() == 1);
        CHECK(r.pieces == 1);
    }
}

TEST_CASE("bending gives the same bits at any thread count") {
    std::uint64_t expected = 0;
    for (int threads : {1, 2, 3, 8}) {
        set_thread_count(threads);
        Aggregate bar = make_block(84, 14, 14, kHeight / 14, kPlastic);  // two slabs
        const Bender machine = bender(0.2);
        const Apparatus apparatus = machine.apparatus();
        SimSettings settings;
        settings.tolerance = 0.1;
        Simulation simulation(bar, apparatus, settings);
        simulation.advance(machine.drive_at(0), machine.drive_at(0.02));
        if (threads == 1) expected = state_hash(bar);
        CHECK(state_hash(bar) == expected);
    }
    set_thread_count(0);
}

TEST_CASE("a body that nothing holds any more lies where it was let go") {
    for (const Material& material : {kElastic, kPlastic}) {
        Aggregate m = make_block(6, 6, 6, kHeight / 6, material);
        const Press press{kHeight};
        const Apparatus apparatus = press.apparatus();
        Simulation simulation(m, apparatus, SimSettings{});
        const double down[] = {0, 0.1, 0.2, 0.3, 0.3, 0.15, 0, -0.2, -0.4};
        for (int n = 0; n + 1 < 9; ++n) {
            simulation.advance(press.drive_at(n, down[n]), press.drive_at(n + 1, down[n + 1]));
        }
        double low = 1;
        Vec3 center = Vec3::Zero();
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            low = std::min(low, m.particle_position.y[p]);
            center += m.particle_position.at(p) / double(m.particle_count());
        }
        CHECK(low == Approx(-kHeight / 2).margin(0.01 * kHeight));
        CHECK(std::hypot(center.x(), center.z()) < 0.01 * kHeight);
    }
}

// On a bar whose one end is of other matter, turned by 6 of 60 degrees: its grips' torques [N m].
std::array<double, 2> end_torques(double stiffer) {
    Aggregate bar = make_block(30, 3, 3, kHeight / 3, Material{.young_modulus = 2e6});
    bar.inset.push_back(bar.material);
    bar.inset[0].young_modulus *= stiffer;
    for (std::size_t c = 0; c < bar.cell_fill.size(); ++c) {
        bar.cell_material.push_back(bar.lattice.cell_site(CellId(c)).x() < 6);
    }
    const Twister machine(bar, 5 * kHeight, 1.2 * kHeight);
    Simulation simulation(bar, machine.apparatus, SimSettings());
    const FrameReport report =
        simulation.advance(machine.drive_at(0, 60 * kDegree), machine.drive_at(0.1, 60 * kDegree));
    return {report.load[0].torque.x(), report.load[1].torque.x()};
}

TEST_CASE("a stiff end leaves what holds a soft bar as exact as a less stiff one does") {
    const std::array<double, 2> soft = end_torques(100), stiff = end_torques(1e5);
    CHECK(stiff[0] == Approx(-stiff[1]).epsilon(0.02));
    CHECK(stiff[1] == Approx(soft[1]).epsilon(0.02));
}

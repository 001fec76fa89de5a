// SPDX-License-Identifier: GPL-3.0-or-later
// Stages of motion that follow one another: what touches goes on as it was.
#include "base/bytes.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kFrame = 1.0 / 1024;  // [s], so that stages' times are rounded alike

struct Stage {
    int frames;
    SimSettings settings;
};

struct Moved {
    std::vector<FrameReport> report;  // of each frame
    std::string bytes;                // places and speeds at the end
    std::string handed_on;
};

Moved moved(std::vector<Aggregate> bodies, const std::vector<Stage>& stages) {
    std::vector<Aggregate*> matter;
    for (Aggregate& one : bodies) matter.push_back(&one);
    const Apparatus nothing;
    Moved all;
    for (const auto& [frames, settings] : stages) {
        Simulation simulation(matter, nothing, settings);
        simulation.take_on(all.handed_on);
        for (int f = 0; f < frames; ++f) {
            all.report.push_back(simulation.advance(still(f * kFrame), still((f + 1) * kFrame)));
        }
        all.handed_on = simulation.hand_on();
    }
    ByteWriter end;
    for (const Aggregate& one : bodies) end(one.particle_position, one.particle_velocity);
    all.bytes = end.bytes();
    return all;
}

double held_at_start(const Books& books) {
    return books.kinetic_at_start + books.elastic_at_start + books.contact_at_start;
}

// Of two stages, whether the second begins with what the first, of so many frames, ended with. By
// other steps: explicit ones have (dt F)^2 / 8 m less of kinetic energy, and soften contacts.
void check_books_go_on(const Moved& parts, int frames, bool same_steps = true) {
    const Books &end = parts.report[std::size_t(frames) - 1],
                &next = parts.report[std::size_t(frames)];
    CHECK(next.elastic_at_start == Approx(end.elastic).epsilon(1e-9));
    CHECK(next.contact_at_start == Approx(end.contact).epsilon(same_steps ? 1e-9 : 1e-4));
    CHECK(next.kinetic_at_start == Approx(end.kinetic).epsilon(same_steps ? 1e-5 : 5e-3));
}

Material dull(double damping_ratio) {
    Material m{.young_modulus = 1e6, .poisson_ratio = 0.25, .density = 1000};
    m.damping_ratio = damping_ratio;
    m.friction = 0.3;
    m.restitution = 0.5;
    return m;
}

Material brittle() {
    Material m = dull(0.05);
    m.strength = 3e4;
    m.toughness = 5;
    return m;
}

// One comes down on another, aslant, which meets it from the first frame to the 34th.
std::vector<Aggregate> striking(double damping_ratio) {
    const Material m = dull(damping_ratio);
    std::vector<Aggregate> both{make_block(4, 4, 4, 0.1, m), make_block(5, 3, 5, 0.09, m)};
    place(both[0],
          {Quat(Eigen::AngleAxisd(0.05, Vec3(1, 0, 2).normalized())), Vec3(0.02, 0.36, 0.01)});
    for (std::size_t p = 0; p < both[0].particle_count(); ++p) {
        both[0].particle_velocity.set(p, Vec3(1.2, -4, 0));
    }
    return both;
}

// In two halves, of which the upper comes down on the lower.
std::vector<Aggregate> halved(const Material& material) {
    std::vector<Aggregate> one{make_block(6, 8, 6, 0.05, material)};
    break_layer(one[0], 3);
    for (std::size_t p = 0; p < one[0].particle_count(); ++p) {
        if (one[0].particle_reference.at(p).y() > 0) {
            one[0].particle_velocity.set(p, Vec3(0.6, -3, 0.3));
        }
    }
    return one;
}

SimSettings falling(Solver solver = Solver::explicit_steps) {
    SimSettings s = motion_settings(solver);
    s.self_contact = true;
    s.gravity = Vec3(0, -9.81, 0);
    return s;
}

}  // namespace

TEST_CASE(
    "a stage that ends in the middle of an impact and one that goes on are as one, to the byte") {
    const auto [name, bodies, settings] =
        GENERATE(table<std::string, std::vector<Aggregate>, SimSettings>({
            {"two bodies", striking(0), motion_settings()},
            {"damped", striking(0.05), motion_settings()},
            {"Euler", striking(0.5), motion_settings(Solver::euler)},
            {"halves of one", halved(dull(0.02)), falling()},
        }));
    INFO(name);
    const Moved whole = moved(bodies, {{24, settings}});
    for (int frames : {4, 8, 15, 20}) {
        const Moved parts = moved(bodies, {{frames, settings}, {24 - frames, settings}});
        INFO("after " << frames << " frames, which end with " << parts.report[frames - 1].contact);
        CHECK((parts.bytes == whole.bytes));
        check_books_go_on(parts, frames);
    }
}

TEST_CASE("what is pressed as a stage ends presses as hard in the next, whatever that is") {
    SimSettings soft = motion_settings(), by_energy = motion_settings(Solver::energy_stepped),
                alone = motion_settings();
    soft.contact_stiffness = 0.1;
    alone.self_contact = true;
    const SimSettings hard = motion_settings();
    const auto [name, first, second] = GENERATE_COPY(table<std::string, SimSettings, SimSettings>({
        {"by energy", by_energy, by_energy},
        {"then by energy", hard, by_energy},
        {"then explicit", by_energy, hard},
        {"then stiffer", soft, hard},
        {"then softer", hard, soft},
        {"then themselves too", hard, alone},
        {"then each other alone", alone, hard},
    }));
    INFO(name);
    const std::vector<Aggregate> bodies = striking(0.02);
    for (int frames : {8, 16, 24}) {
        const Moved parts = moved(bodies, {{frames, first}, {40 - frames, second}});
        INFO("after " << frames << " frames");
        CHECK(parts.report[frames - 1].contact > 2);
        check_books_go_on(parts, frames, first.solver == second.solver);
        const FrameReport& end = parts.report.back();
        INFO("of " << held_at_start(end) << " J " << end.remainder << " from nowhere");
        CHECK(std::abs(end.remainder) < 0.01 * held_at_start(end));
    }
}

TEST_CASE(
    "what longer steps soften as a stage begins is let go of once, and no more than it held") {
    SimSettings fine = motion_settings(), coarse = fine;
    fine.contact_stiffness = coarse.contact_stiffness = 20;
    fine.step_safety = 0.05;
    for (const double friction : {0.0, 0.3}) {
        Material m = dull(0);
        m.restitution = 1, m.friction = friction;
        std::vector<Aggregate> both{make_block(3, 3, 3, 0.1, m), make_block(3, 3, 3, 0.1, m)};
        place(both[1], {Quat::Identity(), Vec3(0.013, 0.301, 0.012)});
        for (std::size_t p = 0; p < both[1].particle_count(); ++p) {
            both[1].particle_velocity.set(p, Vec3(0.5, -3, 0));
        }
        for (int frames : {1, 6, 10, 15}) {
            const Moved parts = moved(both, {{frames, fine}, {4, coarse}});
            const Books &end = parts.report[std::size_t(frames) - 1],
                        &next = parts.report[std::size_t(frames)];
            INFO("friction " << friction << ", after " << frames << " frames");
            REQUIRE(end.contact > 1);
            CHECK(next.contact_at_start == Approx(end.contact).epsilon(1e-6));
            CHECK(next.damped > 0.5 * end.contact);
            CHECK(next.damped < end.contact);
            const FrameReport& last = parts.report.back();
            CHECK(std::abs(last.remainder) < 0.005 * held_at_start(last));
        }
    }
}

TEST_CASE("what has broken and lies on itself makes no energy where a stage begins", "[stress]") {
    Material weak = brittle();  // it breaks to pieces while these still meet
    weak.strength = 1e4;
    weak.toughness = 1;
    const std::vector<Aggregate> bodies = halved(weak);
    for (Solver solver : {Solver::explicit_steps, Solver::energy_stepped}) {
        const SimSettings s = falling(solver);
        for (int frames : {11, 12}) {
            const Moved parts = moved(bodies, {{frames, s}, {20, s}});
            const FrameReport& end = parts.report[std::size_t(frames) - 1];
            INFO(name_of(solver) << " after " << frames << " frames, " << end.pieces << " pieces");
            CHECK(end.pieces > 10);
            CHECK(end.contact > 0.05);
            check_books_go_on(parts, frames);
            const FrameReport& last = parts.report.back();
            CHECK(std::abs(last.remainder) < 0.01 * held_at_start(last));
        }
    }
}

TEST_CASE("what a stage hands on is what the next begins with") {
    const std::vector<Aggregate> bodies = halved(brittle());
    const Stage breaks{24, falling()}, none{0, falling()};
    const std::string once = moved(bodies, {breaks, none}).handed_on;
    CHECK(once.size() > 10000);
    CHECK((moved(bodies, {breaks, none, none}).handed_on == once));
    // Where nothing moves, or nothing meets, it begins.
    SimSettings meets_nothing = falling();
    meets_nothing.self_contact = false;
    for (const SimSettings& other : {falling(Solver::quasistatic), meets_nothing}) {
        CHECK((moved(bodies, {breaks, {0, other}}).handed_on.empty()));
    }
}

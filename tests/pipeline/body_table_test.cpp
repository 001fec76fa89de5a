// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_table.h"

#include <algorithm>

#include "base/text.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

const Vec3 kVelocity(3, -1, 2), kSpin(7, 20, -4);

// A bar that lies askew.
WorkPiece thrown_bar(const std::string& name, const Vec3& at) {
    InputMesh input;
    input.mesh = test::box_mesh({-0.2, -0.05, -0.1}, {0.2, 0.05, 0.1});
    BodySpec body;
    body.name = name;
    body.mold.across = 2;
    body.start.at = at;
    body.start.turn = Vec3(0.3, -0.4, 0.5);
    body.start.velocity = kVelocity;
    body.start.spin = kSpin;
    return make_work_piece(input, body, {});
}

FrameReport report_of(std::size_t bodies, double time) {
    FrameReport report;
    report.time = time;
    report.body.resize(bodies);
    return report;
}

}  // namespace

TEST_CASE("what turns as one has its own spin, and no part of its flight in it") {
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(5, -3, 2)}) {
        const WorkPiece bar = thrown_bar("bar", at);
        const BodyMotion motion = motion_of(bar.matter);
        CHECK((motion.centre - at).norm() < 1e-12);
        CHECK((motion.velocity - kVelocity).norm() < 1e-12);
        CHECK((motion.spin - kSpin).norm() < 1e-10 * kSpin.norm());
    }
}

TEST_CASE("momenta of bodies and of their particles are the same sums") {
    const std::vector<WorkPiece> bodies = {thrown_bar("a", {1, 0, 0}), thrown_bar("b", {0, 2, 0})};
    Vec3 momentum = Vec3::Zero(), turning = Vec3::Zero(), sum = Vec3::Zero(), spun = Vec3::Zero();
    for (const WorkPiece& body : bodies) {
        for (std::size_t p = 0; p < body.matter.particle_count(); ++p) {
            const Vec3 mv = body.matter.particle_mass[p] * body.matter.particle_velocity.at(p);
            momentum += mv;
            turning += body.matter.particle_position.at(p).cross(mv);
        }
        const BodyMotion motion = motion_of(body.matter);
        sum += body.matter.mass() * motion.velocity;
        spun += motion.angular_momentum + body.matter.mass() * motion.centre.cross(motion.velocity);
    }
    CHECK((sum - momentum).norm() < 1e-12 * momentum.norm());
    CHECK((spun - turning).norm() < 1e-12 * turning.norm());
}

TEST_CASE("a body in free flight keeps its angular momentum, and its table says so") {
    WorkPiece bar = thrown_bar("bar", {0, 0, 0});
    const Vec3 before = motion_of(bar.matter).angular_momentum;
    const Apparatus none;
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.gravity = Vec3(0, -9.81, 0);
    Simulation simulation(bar.matter, none, settings);
    const double frame = 2e-3;
    for (int n = 0; n < 5; ++n) {
        Drive from, to;
        from.time = n * frame, to.time = (n + 1) * frame;
        simulation.advance(from, to);
    }
    const BodyMotion motion = motion_of(bar.matter);
    CHECK((motion.angular_momentum - before).norm() < 1e-9 * before.norm());
    CHECK((motion.velocity - kVelocity - Vec3(0, -9.81 * 5 * frame, 0)).norm() < 1e-9);
}

TEST_CASE("bodies stand in their table a row each a frame, the start's first") {
    const std::vector<WorkPiece> bodies = {thrown_bar("a", {1, 0, 0}),
                                           thrown_bar("b,c", {0, 2, 0})};
    BodyTable table(1, bodies, report_of(2, 0));
    CHECK(table.csv_text().find("nan") == std::string::npos);
    FrameReport report = report_of(2, 0.25);
    report.body[1].contact_at_start = 0.125;
    report.body[1].contact = 0.5;
    report.body[1].passed = 0.75;
    table.add(2, bodies, report);
    const std::vector<std::string> lines = lines_of(table.csv_text());
    REQUIRE(lines.size() == 5);
    CHECK(lines[0].find("frame,time [s],body,x [m],y [m],z [m],velocity x [m/s]") == 0);
    CHECK(lines[1].find("1,0,a,1,") == 0);
    CHECK(lines[2].find("1,0,\"b,c\",") == 0);
    CHECK(lines[3].find("2,0.25,a,1,") == 0);
    CHECK(lines[2].find(",0,0,0.125,0,") != std::string::npos);  // contact at the start
    CHECK(lines[4].find(",0,0,0.5,0,") != std::string::npos);
    CHECK(lines[4].substr(lines[4].rfind(',')) == ",0.75");
    for (std::size_t row : {1, 3}) {
        CHECK(std::count(lines[row].begin(), lines[row].end(), ',') ==
              std::count(lines[0].begin(), lines[0].end(), ','));
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The shipped machines whose blades are bent: what they leave of a block.
#include "machines/legs.h"
#include "sim/sever.h"
#include "tests/scene/shipped_machines.h"
#include "tests/shared/block.h"

using namespace swage;
using test::at_bar;

namespace {

// Whether all particles on a side are of one piece, and the two sides of two. `beyond`: how far a
// place of the work frame lies beyond the edge, which is a line of many points.
void check_sides(Aggregate body, const Machine& machine, double duration,
                 const std::function<double(const Vec3&)>& beyond) {
    const std::vector<Drive> way =
        drives_of(machine, legs_of(machine, 40, duration, false).leg, duration, 1);
    sever(body, crossed_connections(body, swept_triangles(machine.apparatus, way)));
    const Pieces pieces = find_pieces(body);
    CHECK(pieces.count == 2);
    std::map<bool, int> piece;
    int odd = 0;
    for (std::size_t p = 0; p < body.particle_count(); ++p) {
        const int own = pieces.particle_piece[p];
        const Vec3 at = machine.frame.world_from_work.inverse() * body.particle_position.at(p);
        if (std::abs(beyond(at)) < 1e-3) continue;
        odd += piece.emplace(beyond(at) > 0, own).first->second != own;
    }
    CHECK(odd == 0);
    CHECK(piece[false] != piece[true]);
}

}  // namespace

TEST_CASE("the carver parts a bar along its bow or its waves") {
    // 1 x 0.3 x 0.3, 20 cells long.
    const Aggregate body = test::make_block(20, 6, 6, 0.05, Material{});
    for (const double waves : {0.0, 1.0, 2.0}) {
        for (const double bow : {-0.3, 0.0, 0.25}) {
            if (waves == 0 && bow == 0) continue;
            const double depth = waves > 0 ? 0.05 : 0, place = 0.0137;
            INFO(waves << " " << bow);
            const Machine machine =
                at_bar("carve",
                       {{"waves", waves}, {"bow", bow}, {"depth", depth}, {"place", place}}, body);
            CHECK(machine.notes.empty());
            check_sides(body, machine, 1, [&](const Vec3& p) {
                const double s = p.z() / 0.3;
                const double edge =
                    place + 0.3 * (bow * (1 - 4 * s * s) + depth * std::sin(2 * kPi * waves * s));
                return p.x() - edge;
            });
        }
    }
}

TEST_CASE("the corer cuts out a plug of its outline, and lifts it") {
    const Aggregate body = test::make_block(20, 4, 16, 0.05, Material{});
    for (const double petals : {0.0, 5.0}) {
        const double depth = petals > 0 ? 0.2 : 0;
        INFO(petals);
        const Machine machine = at_bar(
            "core", {{"petals", petals}, {"depth", depth}, {"radius", 0.2611}, {"place", 0.0137}},
            body);
        CHECK(machine.notes.empty());
        check_sides(body, machine, 1, [&](const Vec3& p) {
            const double x = p.x() - 0.0137, turn = std::atan2(p.z(), x);
            const double radius = 0.2611 * (1 + depth * std::cos(petals * turn));
            return std::hypot(x, p.z()) - radius;
        });
        const Pose plug = drive_at(machine, 1, 1).world_from_grip[2];
        const Pose start = drive_at(machine, 0, 1).world_from_grip[2];
        CHECK((plug.translation - start.translation).y() > 0.2);
    }
}

TEST_CASE("the carver tells of a bow that runs into a grip, on either side") {
    const Aggregate body = test::make_block(8, 6, 8, 0.05, Material{});
    for (const double bow : {-0.4, 0.4}) {
        const double grip = 0.2, room = 0.5 - grip - std::abs(bow);
        CHECK(!at_bar("carve", {{"bow", bow}, {"grip_length", grip}}, body).notes.empty());
        CHECK(room < 0);
        const double away = (bow < 0 ? 1 : -1) * 0.12;
        CHECK(at_bar("carve", {{"bow", bow}, {"grip_length", grip}, {"place", away}}, body)
                  .notes.empty());
    }
}

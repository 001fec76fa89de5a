// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/work_piece.h"

#include <Eigen/Geometry>

#include "geometry/make_shape.h"
#include "tests/catch.h"

using namespace swage;

namespace {

WorkPiece block(const StartSpec& start, SkinKind skin) {
    InputMesh input;
    input.mesh = make_shape("bar", {{"length", 0.4}, {"height", 0.1}, {"width", 0.2}}).mesh;
    BodySpec body;
    body.start = start;
    body.mold.across = 3;
    body.color = Vec3(0.5, 0, 0);
    return make_work_piece(input, body, skin);
}

struct Sums {
    double mass = 0;
    Vec3 centre = Vec3::Zero(), momentum = Vec3::Zero(), turning = Vec3::Zero();
};
Sums sums_of(const Aggregate& m) {
    Sums s;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        s.mass += m.particle_mass[p];
        s.centre += m.particle_mass[p] * m.particle_position.at(p);
        s.momentum += m.particle_mass[p] * m.particle_velocity.at(p);
    }
    s.centre /= s.mass;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        s.turning += m.particle_mass[p] *
                     (m.particle_position.at(p) - s.centre).cross(m.particle_velocity.at(p));
    }
    return s;
}

}  // namespace

TEST_CASE("a body starts where it is told to, turned about its middle, with its skin") {
    StartSpec start;
    start.at = Vec3(1, 2, 3);
    start.turn = {0, 0, kPi / 2};
    for (SkinKind skin : {SkinKind::mount, SkinKind::frame4, SkinKind::boundary}) {
        const WorkPiece piece = block(start, skin);
        const Box box = box_of(piece.position);
        const double slack = skin == SkinKind::boundary ? 0.05 : 1e-9;
        CHECK((box.center() - *start.at).norm() < slack);
        CHECK((box.size() - Vec3(0.1, 0.4, 0.2)).norm() < 2 * slack);
        REQUIRE(piece.skin.material.size() == 1);
        CHECK(piece.skin.material[0].color == Vec3(0.5, 0, 0));
        // Turned as a whole, so that nothing is strained: every edge of the lattice has its length.
        const Aggregate& m = piece.matter;
        double worst = 0;
        for (const Span& span : m.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                const double length = (m.particle_position.at(span.upper + n) -
                                       m.particle_position.at(span.lower + n))
                                          .norm();
                worst =
                    std::max(worst, std::abs(length - reference_length(m.lattice, span.direction)));
            }
        }
        CHECK(worst < 1e-12);
    }
}

TEST_CASE("a body that is told no start is left as it was molded") {
    const WorkPiece piece = block({}, SkinKind::mount);
    CHECK(piece.matter.particle_position.x == piece.matter.particle_reference.all().x);
    CHECK(piece.matter.particle_velocity.x ==
          std::vector<double>(piece.matter.particle_count(), 0.0));
}

TEST_CASE("matter molded anew keeps the size of its cells, whatever its box has become") {
    WorkPiece piece = block({}, SkinKind::mount);
    // Round a quarter of a ring: the box is as high as it is long then.
    Aggregate& m = piece.matter;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        const double turn = x.x() / 0.4 * kPi / 2, radius = 0.4 / (kPi / 2) + x.y();
        m.particle_position.set(p, {radius * std::sin(turn), radius * std::cos(turn), x.z()});
    }
    follow_matter(piece, SkinKind::mount);
    BodySpec body;
    body.mold.across = 3;
    const WorkPiece anew = mold_anew(piece, body, SkinKind::mount);
    CHECK(anew.matter.lattice.spacing == m.lattice.spacing);
    CHECK(anew.matter.volume() == Approx(0.008).epsilon(0.05));
}

TEST_CASE("velocity and spin at the start are those of the body's centre of mass") {
    StartSpec start;
    start.velocity = {1, -2, 0.5};
    start.spin = {0, 0, 7};
    const WorkPiece piece = block(start, SkinKind::mount);
    const Sums s = sums_of(piece.matter);
    CHECK((s.momentum - s.mass * start.velocity).norm() < 1e-12 * s.mass);
    // Of a block of 0.4 x 0.1 about its third axis, as far as its corners are not round.
    const double inertia = s.mass * (0.4 * 0.4 + 0.1 * 0.1) / 12;
    CHECK(std::abs(s.turning.z() / (7 * inertia) - 1) < 0.1);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Layers of what is molded anew: how stiff a bar of two materials then is, bars that have become
// thinner than a cell, and a skin that has left its matter.
#include <Eigen/Geometry>
#include <numeric>

#include "geometry/box.h"
#include "pipeline/work_piece.h"
#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;
using test::box_mesh;

namespace {

constexpr double kStiff = 100;
const Vec3 kSize(0.4, 0.1, 0.1);

// The stiff one has those shares of the bar's box.
BodySpec layered(const Vec3& from, const Vec3& to, int across) {
    BodySpec body;
    body.material.young_modulus = 1e6, body.material.poisson_ratio = 0;
    InsetSpec& stiff = body.inset.emplace_back();
    stiff.from = from, stiff.to = to;
    stiff.material = body.material;
    stiff.material.young_modulus *= kStiff;
    body.mold.across = across;
    return body;
}

// Force that draws the ends of the bar, which lies along `axis`, apart by a thousandth of it [N].
double pull(Aggregate matter, const Vec3& axis) {
    constexpr double kStrain = 1e-3;
    Apparatus apparatus;
    Drive rest;
    const SurfacePoints& surface = matter.surface;
    for (double side : {-1.0, 1.0}) {
        Grip grip;
        const Pose pose{Quat::Identity(), 0.5 * side * kSize.x() * axis};
        for (int p = 0; p < static_cast<int>(surface.size()); ++p) {
            const Vec3 at = matter.surface_position(p);
            if (surface.normal(p).dot(side * axis) < 0.9) continue;
            if (side * at.dot(axis) < 0.5 * kSize.x() - 1e-3 * matter.lattice.spacing) continue;
            grip.point.push_back(p);
            grip.anchor.push_back(at - pose.translation);
        }
        REQUIRE(grip.point.size() >= 4);
        apparatus.grip.push_back(std::move(grip));
        rest.world_from_grip.push_back(pose);
    }
    SimSettings settings;
    settings.tolerance = 1e-6;
    settings.grip_stiffness = 100;
    Drive drawn = rest;
    drawn.world_from_grip[1].translation += kStrain * kSize.x() * axis;
    Simulation simulation(matter, apparatus, settings);
    FrameReport report = simulation.advance(rest, drawn);
    for (int n = 0; n < 3; ++n) report = simulation.advance(drawn, drawn);
    return report.load[1].force.dot(axis);
}

}  // namespace

TEST_CASE("a layered bar that is molded anew unloaded is as stiff as it was, along and across") {
    InputMesh input;
    input.mesh = box_mesh(-0.5 * kSize, 0.5 * kSize);
    const Vec3 x = Vec3::UnitX();
    for (int across : {4, 8}) {
        const double f = 0.5 + 0.7 / across;  // no whole cells
        for (bool along : {true, false}) {
            const BodySpec body = along ? layered({0, f, 0}, {1, 1, 1}, across)
                                        : layered({0.33, 0, 0}, {0.33 + f / 2, 1, 1}, across);
            const double expected =
                1e-3 * 1e6 * kSize.y() * kSize.z() *
                (along ? f + (1 - f) * kStiff : 1 / (1 - f / 2 + f / 2 / kStiff));
            const WorkPiece piece = make_work_piece(input, body, {}, true);
            const double first = pull(piece.matter, x);
            const double anew = pull(mold_anew(piece, body, {}).matter, x);

            CHECK(anew == Approx(first).epsilon(1e-5));
            // Standing askew, in cells that the boundary crosses as it likes.
            StartSpec start;
            start.turn = Vec3(0.3, -0.2, 0.5);
            BodySpec askew = body;
            askew.start = start;
            const WorkPiece turned = make_work_piece(input, askew, {}, true);
            const double skew = pull(mold_anew(turned, body, {}).matter,
                                     turn_by(start.turn).toRotationMatrix() * x);

            CHECK(skew == Approx(expected).epsilon(0.05));
        }
    }
}

TEST_CASE("a bar of one or two cells is molded anew also once it is thinner than a cell was") {
    InputMesh input;
    input.mesh = box_mesh(-0.5 * kSize, 0.5 * kSize);
    for (const int across : {1, 2}) {
        for (const double high : {0.95, 0.6, 0.4}) {
            CAPTURE(across, high);
            BodySpec body;
            body.mold.across = across;
            WorkPiece piece = make_work_piece(input, body, {});
            const double mass = piece.matter.mass(), before = piece.matter.lattice.spacing;
            Vec3Array& x = piece.matter.particle_position;
            for (std::size_t p = 0; p < x.size(); ++p) {
                x.set(p, x.at(p).cwiseProduct(Vec3(1, high, 1)));
            }
            follow_matter(piece);
            const WorkPiece anew = mold_anew(piece, body, {});
            const double thin = box_of(piece.position).size().minCoeff();
            CHECK(anew.matter.lattice.spacing == Approx(std::min(before, thin)));
            CHECK(anew.matter.mass() == Approx(mass).epsilon(1e-6));
        }
    }
}

TEST_CASE("a skin that encloses more or less than its matter took up is told of as it is filled") {
    InputMesh input;
    input.mesh = box_mesh(-0.5 * kSize, 0.5 * kSize);
    BodySpec body;
    body.mold.across = 3;
    const auto told_of = [&](double wider) {
        WorkPiece piece = make_work_piece(input, body, {});
        for (Vec3& p : piece.position) p.y() *= wider;
        const std::vector<std::string> told = mold_anew(piece, body, {}).finding;
        return std::accumulate(told.begin(), told.end(), std::string());
    };
    CHECK(told_of(1.03).find("encloses 3 % more than the 0.004 m3 that its matter took up") !=
          std::string::npos);
    CHECK(told_of(1.03).find("0.971 times the density") != std::string::npos);
    CHECK(told_of(0.95).find("encloses 5 % less") != std::string::npos);
    CHECK(told_of(1.005).find("encloses") == std::string::npos);
}

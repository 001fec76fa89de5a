// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of which next to nothing lies in the body, where it flows far.
#include <algorithm>

#include "geometry/make_shape.h"
#include "pipeline/work_piece.h"
#include "sim/advance.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// The longest edge of all cells, in spacings.
double longest_edge(const Aggregate& matter) {
    double longest = 0;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        const auto corner = matter.lattice.cell_corners(static_cast<CellId>(c));
        for (int from = 0; from < 8; ++from) {
            for (int axis = 1; axis < 8; axis *= 2) {
                const Vec3 edge = matter.particle_position.at(std::size_t(corner[from ^ axis])) -
                                  matter.particle_position.at(std::size_t(corner[from]));
                longest = std::max(longest, edge.norm());
            }
        }
    }
    return longest / matter.lattice.spacing;
}

BodySpec ductile(int across, const Material& material) {
    BodySpec body;
    body.mold.across = across;
    body.material = material;
    return body;
}

}  // namespace

TEST_CASE("corners that slivers alone hold go along with matter that flows far") {
    InputMesh input;
    input.mesh = make_shape("rod", {{"length", 0.2}, {"diameter", 0.06}}).mesh;
    const Quat askew(Eigen::AngleAxisd(0.7, Vec3(0.5, 0.6, 0.4).normalized()));
    for (Vec3& p : input.mesh.position) p = askew * p;
    const BodySpec body = ductile(
        4, {.young_modulus = 2e8, .poisson_ratio = 0.4, .density = 900, .yield_stress = 1.5e6});
    WorkPiece piece = make_work_piece(input, body, {});
    Aggregate& matter = piece.matter;
    const Vec3 axis = askew * Vec3::UnitX();
    Apparatus apparatus;
    for (const double side : {-1.0, 1.0}) {
        Grip grip;
        for (std::size_t p = 0; p < matter.surface.size(); ++p) {
            const Vec3 x = matter.surface_position(p);
            if (side * x.dot(axis) < 0.085) continue;
            grip.point.push_back(static_cast<int>(p));
            grip.anchor.push_back(x);
        }
        REQUIRE(!grip.point.empty());
        apparatus.grip.push_back(grip);
    }
    constexpr int kFrames = 12;
    const auto at = [&](int f) {
        Drive drive;
        drive.time = f;
        drive.world_from_grip.push_back(Pose{Quat::Identity(), Vec3::Zero()});
        drive.world_from_grip.push_back(
            Pose{Quat(Eigen::AngleAxisd(kPi * f / kFrames, axis)), Vec3::Zero()});
        return drive;
    };
    Simulation simulation(matter, apparatus, {});
    for (int f = 0; f < kFrames; ++f) simulation.advance(at(f), at(f + 1));
    CHECK(longest_edge(matter) < 4);  // 6.8 where slivers flow as all of it does
}

namespace {

// What a plate bears that presses a tube of lead down by a fifth, its cells many times its wall
// [N].
double borne_by_tube(double wall) {
    constexpr double kDiameter = 0.03, kFar = 0.2 * kDiameter, kThick = 0.01;
    InputMesh input;
    input.mesh =
        make_shape("tube", {{"length", 0.04}, {"diameter", kDiameter}, {"wall", wall}}).mesh;
    const BodySpec body = ductile(
        6, {.young_modulus = 16e9, .poisson_ratio = 0.44, .density = 11340, .yield_stress = 8e6});
    WorkPiece piece = make_work_piece(input, body, {});
    Apparatus apparatus;
    Drive from;
    for (const double side : {-1.0, 1.0}) {
        apparatus.tool.push_back({"plate", BoxShape{Vec3(0.06, kThick, 0.06), 0.0}, 0.3});
        from.world_from_tool.push_back(
            {Quat::Identity(), Vec3(0, side * 0.5 * (kDiameter + kThick), 0)});
    }
    Simulation simulation(piece.matter, apparatus, {});
    constexpr int kFrames = 4;
    double borne = 0;
    for (int f = 0; f < kFrames; ++f) {
        Drive to = from;
        to.time += 1;
        to.world_from_tool[1].translation.y() -= kFar / kFrames;
        borne = std::abs(simulation.advance(from, to).load[1].force.y());
        from = to;
    }
    return borne;
}

}  // namespace

TEST_CASE("a wall of a twentieth of a cell bears by its thickness, as one of a tenth does") {
    const double thin = 0.2e-3, thick = 0.5e-3;
    CHECK(borne_by_tube(thin) / thin == Approx(borne_by_tube(thick) / thick).epsilon(0.1));
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Square bars of a material that yields and does not harden.
#include <cmath>

#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

// Held ends disturb the curvature of what flows far into the bar: at a length of 8 the middle of 4
// cells bends by 6 times first yield where 5 is asked for, at 12 by 5.0.
constexpr double kLength = 12, kYield = 0.002;  // over E
constexpr double kYieldCurvature = 2 * kYield;  // of a side of 1

Material yielding() {
    Material material = unit_material();
    material.yield_stress = kYield;
    return material;
}

// Moment over that of first yield, for sections that stay plane.
double plastic_share(double curvature) {
    const double y = kYieldCurvature / curvature;
    return y > 1 ? 1 / y : 1.5 * (1 - y * y / 3);
}

// Both end faces of a bar on one circle through the origin.
Drive bent(const Stand& stand, double curvature, double length = kLength) {
    Drive to = stand.drive;
    for (int side : {-1, 1}) {
        const double turn = 0.5 * side * curvature * length;
        to.world_from_grip[side > 0] = {Quat(Eigen::AngleAxisd(-turn, Vec3::UnitY())),
                                        Vec3(std::sin(turn), 0, 1 - std::cos(turn)) / curvature};
    }
    return to;
}

void plastic_bending(bool, Values& values) {
    struct Level {
        int across;
        double moment, springback;
    };
    constexpr double kTold = std::numeric_limits<double>::infinity();
    for (const auto& [across, moment, springback] :
         {Level{4, 0.06, kTold}, Level{8, 0.015, 0.01}}) {
        Stand stand(unit_bar(kLength, across, yielding()), 1e-5);
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.grip(end_face(stand.matter, Vec3::UnitX()));
        for (int half_yields = 1; half_yields <= 10; ++half_yields) {
            const double asked = 0.5 * half_yields * kYieldCurvature;
            stand.move(bent(stand, asked));
            if (half_yields != 6 && half_yields != 10) continue;
            const ToolLoad load = stand.settle().load[1];
            const Vec3 about_middle = load.torque + load.pose.translation.cross(load.force);
            // The curvature of the middle is not quite what the ends ask for.
            const double curvature = middle_curvature(stand.matter);
            const std::string at = half_yields == 6 ? ", 3 yields" : ", 5 yields";
            const double share = plastic_share(curvature);
            values.add(relative("moment / first yield" + at, across, share,
                                -about_middle.y() / (kYield / 6), moment));
            Stand free(stand.matter, 1e-5);
            free.settle();
            values.add(as_share("share sprung back" + at, across,
                                share * kYieldCurvature / curvature,
                                1 - middle_curvature(free.matter) / curvature, springback));
        }
    }
}

// Of the cells between -half and half along the axis, corner by corner: sums over points of Gauss
// are exact.
double volume_within(const Aggregate& matter, double half) {
    double sum = 0;
    const Lattice& lattice = matter.lattice;
    for (CellId cell = 0; cell < static_cast<CellId>(matter.cell_fill.size()); ++cell) {
        const auto corner = lattice.cell_corners(cell);
        const auto at_rest = [&](int c) { return matter.particle_reference.at(corner[c]).x(); };
        if (at_rest(0) < -half - 1e-9 || at_rest(7) > half + 1e-9) continue;
        for (int point = 0; point < 8; ++point) {
            Mat3 slope = Mat3::Zero();
            for (int c = 0; c < 8; ++c) {
                Vec3 weight, change;
                for (int axis = 0; axis < 3; ++axis) {
                    const double xi = 0.5 + (point >> axis & 1 ? 0.5 : -0.5) / std::sqrt(3.0);
                    weight[axis] = c >> axis & 1 ? xi : 1 - xi;
                    change[axis] = c >> axis & 1 ? 1 : -1;
                }
                const Vec3 x = matter.particle_position.at(corner[c]);
                slope.col(0) += change.x() * weight.y() * weight.z() * x;
                slope.col(1) += weight.x() * change.y() * weight.z() * x;
                slope.col(2) += weight.x() * weight.y() * change.z() * x;
            }
            sum += slope.determinant() / 8;
        }
    }
    return sum;
}

// To half a turn, a hundred and twenty-five times first yield.
void half_turn(bool, Values& values) {
    constexpr int kAcross = 8, kFrames = 30;
    constexpr double kBar = 6.25, kCurvature = 0.5, kMiddle = 1.5;
    Stand stand(unit_bar(kBar, kAcross, yielding()), 1e-4);
    stand.grip(end_face(stand.matter, -Vec3::UnitX()));
    stand.grip(end_face(stand.matter, Vec3::UnitX()));
    const double volume = volume_within(stand.matter, kMiddle);
    for (int frame = 1; frame <= kFrames; ++frame) {
        stand.move(bent(stand, kCurvature * frame / kFrames, kBar));
    }
    stand.settle();
    const double curvature = middle_curvature(stand.matter);
    values.add(relative("volume / at rest", kAcross, 1,
                        volume_within(stand.matter, kMiddle) / volume, 6e-4));
    Stand free(stand.matter, 1e-4);
    free.settle();
    // M_p / E I of a side of 1.
    values.add(relative("curvature sprung back", kAcross, 3 * kYield,
                        curvature - middle_curvature(free.matter), 0.06));
}

void plastic_torsion(bool, Values& values) {
    constexpr int kAcross = 8, kFrames = 10;
    constexpr double kTurn = 0.6;  // about ten times that of first yield
    Stand stand(unit_bar(kLength, kAcross, yielding()), 1e-4);
    stand.grip(end_face(stand.matter, -Vec3::UnitX()));
    stand.grip(end_face(stand.matter, Vec3::UnitX()));
    for (int frame = 1; frame <= kFrames; ++frame) {
        Drive to = stand.drive;
        to.world_from_grip[1].rotation =
            Quat(Eigen::AngleAxisd(kTurn * frame / kFrames, Vec3::UnitX()));
        stand.move(to);
    }
    const double shear_yield = kYield / std::sqrt(3.0);
    values.add(relative("torque / shear yield h^3", kAcross, 1.0 / 3,
                        stand.settle().load[1].torque.x() / shear_yield, 0.1));
}

}  // namespace

void add_plastic_cases(std::vector<Case>& cases) {
    cases.push_back({"plastic-bending", "a square bar bent past yield and let go", "plane sections",
                     0, false, plastic_bending});
    cases.push_back({"half-turn", "a square bar bent by half a turn and let go", "plane sections",
                     0, false, half_turn});
    cases.push_back({"plastic-torsion", "a square bar twisted until all of it flows", "sand hill",
                     0, false, plastic_torsion});
}

}  // namespace swage

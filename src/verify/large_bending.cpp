// SPDX-License-Identifier: GPL-3.0-or-later
// Slender bars far out of their shape.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

// The bar 1 x 0.1 x 0.1 m, E 1 MPa, 1000 kg/m3, in sides and moduli: a side's weight is 1e-4 of E.
// NOTE: at g = 9.81 strains are large enough for two laws of one modulus to differ. Finer lattices
// go to 0.66 % beyond CalculiX, whose law is Saint-Venant and Kirchhoff's (stress linear in F^T F);
// with that law in place of ours they went to 0.04 %.
void own_weight(bool brief, Values& values) {
    constexpr double kLength = 10, kWeight = 1e-4;
    struct Level {
        double g, tip;  // of CalculiX, over the length
    };
    for (const auto& [g, tip] : {Level{1, -0.1481}, Level{9.81, -0.7501}}) {
        if (brief && g > 1) break;
        Stand stand(unit_bar(kLength, 4, unit_material()), 1e-5, {0, 0, -g * kWeight});
        const std::vector<int> end = end_face(stand.matter, Vec3::UnitX());
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.settle();
        values.add(relative(g > 1 ? "tip / L, g 9.81" : "tip / L, g 1", 4, tip,
                            mean_move(stand.matter, end).z() / kLength, 0.01));
    }
}

// Bisshopp & Drucker 1945: alpha = P L^2 / E I, drop and shortening over the length.
struct Elastica {
    double alpha, drop, shortening;
};
constexpr std::array<Elastica, 5> kElastica = {{{0.25, .08275, .00412},
                                                {1, .30172, .05643},
                                                {2, .49346, .16064},
                                                {5, .71379, .38763},
                                                {10, .81061, .55500}}};

std::string number_name(double x) { return fmt::format("{:g}", x); }

// Each body starts from where the one before, half as fine, has come to rest.
void elastica(bool, Values& values) {
    constexpr double kLength = 20, kInertia = 1.0 / 12;
    constexpr double kTold = std::numeric_limits<double>::infinity();
    std::vector<std::unique_ptr<Stand>> stands;
    for (int across : {4, 8, 16}) {
        stands.push_back(std::make_unique<Stand>(unit_bar(kLength, across, unit_material()), 1e-5));
        Stand& stand = *stands.back();
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.load(end_face(stand.matter, Vec3::UnitX()), {0, 0, -kInertia / (kLength * kLength)});
        stand.drive.load_strength[0] = 0;
    }
    constexpr std::array<std::pair<int, double>, 3> kLevel = {{{4, kTold}, {8, 0.03}, {16, 0.01}}};
    for (const auto& [alpha, drop, shortening] : kElastica) {
        for (std::size_t n = 0; n < stands.size(); ++n) {
            Stand& stand = *stands[n];
            if (n > 0) stand.start_from(stands[n - 1]->matter);
            Drive to = stand.drive;
            to.load_strength[0] = alpha;
            stand.move(to);
            stand.settle();
            const Vec3 way =
                mean_move(stand.matter, end_face(stand.matter, Vec3::UnitX())) / kLength;
            const std::string at = ", alpha " + number_name(alpha);
            const auto& [across, bound] = kLevel[n];
            values.add(relative("drop / L" + at, across, drop, -way.z(), bound));
            values.add(relative("shortening / L" + at, across, shortening, -way.x(), bound));
        }
    }
}

// Where a moment alone that turns the end by t takes it: a circle through the root at -L / 2.
Vec3 circle_end(double length, double t) {
    return {length * (std::sin(t) / t - 0.5), 0, -length * (1 - std::cos(t)) / t};
}

// Move of the turned end over a force on it, its turn kept: of a circular arc of the bar.
Mat3 arc_compliance(double length, double t, double inertia) {
    constexpr int kSteps = 400;
    Vec3 mean = Vec3::Zero();
    Mat3 square = Mat3::Zero();
    for (int n = 0; n < kSteps; ++n) {
        const double share = (n + 0.5) / kSteps;
        const Vec3 way = share * (circle_end(length, share * t) + Vec3(0.5 * length, 0, 0));
        const Vec3 lever(-way.z(), 0, way.x());
        mean += lever / kSteps;
        square += lever * lever.transpose() / kSteps;
    }
    return length / inertia * (square - mean * mean.transpose()) + length * Mat3::Identity();
}

// A dead couple tips a bar out of its plane, so a grip turns the end, and goes where it pulls and
// pushes no more: what is left of it is the moment.
void ring(bool, Values& values) {
    constexpr double kLength = 20, kInertia = 1.0 / 12;
    constexpr int kFrames = 24, kAcross = 4, kRounds = 4;
    Stand stand(unit_bar(kLength, kAcross, unit_material()), 1e-5);
    stand.grip(end_face(stand.matter, -Vec3::UnitX()));
    stand.grip(end_face(stand.matter, Vec3::UnitX()));
    Vec3 aside = Vec3::Zero();  // of the circle
    for (int frame = 1; frame <= kFrames; ++frame) {
        const double t = 2 * kPi * frame / kFrames;
        const bool is_quarter = 4 * frame % kFrames == 0;
        FrameReport report;
        for (int round = 0; round < (is_quarter ? kRounds : 1); ++round) {
            Drive to = stand.drive;
            to.world_from_grip[1] = {Quat(Eigen::AngleAxisd(t, Vec3::UnitY())),
                                     circle_end(kLength, t) + aside};
            report = stand.move(to);
            if (!is_quarter) continue;
            report = stand.settle();
            if (round + 1 < kRounds) {
                aside -= arc_compliance(kLength, t, kInertia) * report.load[1].force;
            }
        }
        if (!is_quarter) continue;
        const std::string at = ", " + std::to_string(360 * frame / kFrames) + " degrees";
        values.add(
            as_share("end off the circle / L" + at, kAcross, 0, aside.norm() / kLength, 0.02));
        values.add(told("moment L / E I" + at, kAcross, t,
                        report.load[1].torque.y() * kLength / kInertia));
        values.add(absolute("force left L^2 / E I" + at, kAcross, 0,
                            report.load[1].force.norm() * kLength * kLength / kInertia,
                            std::numeric_limits<double>::infinity()));
    }
}

void large_twist(bool, Values& values) {
    constexpr double kLength = 10, kUnit = 1e6 * 0.1 * 0.1;  // of force [N]; a side is 0.1 m
    constexpr int kAcross = 8;
    Stand stand(unit_bar(kLength, kAcross, unit_material()), 1e-4);
    stand.grip(end_face(stand.matter, -Vec3::UnitX()));
    stand.grip(end_face(stand.matter, Vec3::UnitX()));
    for (int degrees = 15; degrees <= 90; degrees += 15) {
        Drive to = stand.drive;
        to.world_from_grip[1].rotation =
            Quat(Eigen::AngleAxisd(degrees * kPi / 180, Vec3::UnitX()));
        stand.move(to);
    }
    const ToolLoad load = stand.settle().load[1];
    values.add(relative("torque [N m]", kAcross, 8.865, load.torque.x() * kUnit * 0.1, 0.02));
    values.add(told("axial force [N]", kAcross, 13.79, load.force.x() * kUnit));
    values.add(
        told("turn of the middle [degrees]", kAcross, 44.98,
             180 / kPi * slice_of(stand.matter, Vec3::UnitX(), 0, 0.3, Vec3::UnitX()).angle));
}

}  // namespace

void add_large_bending_cases(std::vector<Case>& cases) {
    cases.push_back({"own-weight", "a bar held at one end sags under its weight",
                     "CalculiX C3D20R NLGEOM", 0, true, own_weight});
    cases.push_back({"elastica", "a slender bar with a dead load at its tip",
                     "Bisshopp & Drucker 1945", 0, false, elastica});
    cases.push_back(
        {"ring", "an end moment rolls a bar up until it closes", "Euler", 0, false, ring});
    cases.push_back({"twist", "one end turned by 90 degrees, ends held at their distance",
                     "CalculiX C3D20R NLGEOM", 0, false, large_twist});
}

}  // namespace swage

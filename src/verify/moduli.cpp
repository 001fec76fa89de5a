// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/moduli.h"

#include <cmath>

#include "verify/stand.h"

namespace swage {

namespace {

double half_length(const Aggregate& bar, const Vec3& along) {
    return along.dot(mean_position(bar, end_face(bar, along)));
}

}  // namespace

Stretch stretch(Aggregate bar, const Vec3& along, double section) {
    constexpr double kStress = 1e-3;
    const Vec3 force = kStress * section * along;
    const double half = half_length(bar, along);
    Stand stand(std::move(bar));
    stand.load(end_face(stand.matter, along), force);
    stand.load(end_face(stand.matter, -along), -force);
    stand.settle();
    const Mat3 f = mean_gradient(stand.matter, along, 0, 0.5 * half);
    const Vec3 y = along.unitOrthogonal(), z = along.cross(y);
    const double lengthened = along.dot(f * along);
    const double thinned = 0.5 * (y.dot(f * y) + z.dot(f * z));
    return {kStress * lengthened / std::log(lengthened), -std::log(thinned) / std::log(lengthened)};
}

double bending_compliance(Aggregate bar, const Vec3& along, const Vec3& across,
                          std::optional<Aggregate>& rested) {
    constexpr double kForce = 1e-5;  // the tip goes 0.4 % of ten sides
    Stand stand(std::move(bar));
    const std::vector<int> tip = end_face(stand.matter, along);
    stand.grip(end_face(stand.matter, -along));
    stand.load(tip, kForce * across);
    if (rested) stand.start_from(*rested);
    stand.settle();
    const double way = across.dot(mean_move(stand.matter, tip));
    rested = std::move(stand.matter);
    return way / kForce;
}

double torsion_stiffness(Aggregate bar, const Vec3& along) {
    constexpr double kTurn = 0.02;
    const double half = half_length(bar, along);
    Stand stand(std::move(bar));
    stand.grip(end_face(stand.matter, -along));
    stand.grip(end_face(stand.matter, along));
    Drive to = stand.drive;
    to.world_from_grip[1].rotation = Quat(Eigen::AngleAxisd(kTurn, along));
    stand.move(to);
    const FrameReport report = stand.settle();
    return along.dot(report.load[1].torque) /
           turn_rate(stand.matter, along, 0.5 * half, 0.1 * half, along);
}

}  // namespace swage

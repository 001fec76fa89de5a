// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/steadying.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/principal_axes.h"
#include "matter/carriage_of_held.h"
#include "sim/piece_sums.h"

namespace swage {

namespace {

// What of it is across all these axes, of which so many sum up to `axes`.
Vec3 across(const Mat3& axes, double count, const Vec3& push) {
    constexpr double kBarred = 1e-6;  // of all points: more than rounding
    if (!(count > 0)) return push;
    const PrincipalAxes along = principal_axes(axes / count);
    Vec3 left = Vec3::Zero();
    for (int n = 0; n < 3; ++n) {
        if (along.value[n] > kBarred) continue;
        const Vec3 way = along.axis.col(n);
        left += way.dot(push) * way;
    }
    return left;
}

// Of each piece, from the sum over its particles.
std::vector<Vec3> centres_of(const Pieces& pieces, const Aggregate& matter,
                             const std::vector<double>& mass) {
    auto centre = sums_of(pieces, Vec3(Vec3::Zero()), [&](std::size_t p) -> Vec3 {
        return matter.particle_mass[p] * matter.particle_position.at(p);
    });
    for (std::size_t n = 0; n < mass.size(); ++n) centre[n] /= mass[n];
    return centre;
}

std::vector<double> masses_of(const Pieces& pieces, const Aggregate& matter) {
    return sums_of(pieces, 0.0, [&](std::size_t p) { return matter.particle_mass[p]; });
}

}  // namespace

// (M + B) q = W, for each piece: q its shift and turn, W what pushes come to, B what grips bar, so
// stiff that it makes no difference to what they leave free.
std::vector<LeftFree> left_free(const Aggregate& matter, const Apparatus& apparatus,
                                const GrippedPieces& gripped, const Drive& now,
                                const Vec3Array& push) {
    constexpr double kBars = 1e9;  // of the piece's mass, all points of grips together
    using Vec6 = Eigen::Matrix<double, 6, 1>;
    using Mat6 = Eigen::Matrix<double, 6, 6>;
    const auto at = [&](std::size_t p) { return matter.particle_position.at(p); };
    const std::vector<double>& m = matter.particle_mass;
    const Pieces& pieces = gripped.pieces;
    const Vec3 none = Vec3::Zero();
    const std::vector<double> mass = masses_of(pieces, matter);
    const std::vector<Vec3> center = centres_of(pieces, matter, mass);
    const auto arm = [&](std::size_t p) -> Vec3 {
        return at(p) - center[std::size_t(pieces.particle_piece[p])];
    };
    const auto inertia = sums_of(pieces, Mat3(Mat3::Zero()), [&](std::size_t p) -> Mat3 {
        const Vec3 r = arm(p);
        return m[p] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    });
    const auto net = sums_of(pieces, none, [&](std::size_t p) { return push.at(p); });
    const auto torque =
        sums_of(pieces, none, [&](std::size_t p) -> Vec3 { return arm(p).cross(push.at(p)); });
    const auto size = sums_of(pieces, 0.0, [&](std::size_t p) { return push.at(p).norm(); });

    // Turns are counted by the way that they take what lies far out.
    std::vector<double> reach, barred(mass.size(), 0);
    std::vector<Mat6> bars(mass.size(), Mat6(Mat6::Zero()));
    std::vector<LeftFree> left(mass.size());
    for (std::size_t n = 0; n < mass.size(); ++n) {
        reach.push_back(std::sqrt(inertia[n].trace() / mass[n]));
        if (!(reach[n] > 0)) reach[n] = 1;  // a single particle: it has no turns
    }
    for (std::size_t g = 0; g < apparatus.grip.size(); ++g) {
        const Grip& grip = apparatus.grip[g];
        const Mat3 axes = now.world_from_grip[g].rotation.toRotationMatrix();
        for (std::size_t i = 0; i < grip.point.size(); ++i) {
            if (gripped.at[g][i] == GrippedPieces::kNone) continue;
            const auto n = std::size_t(gripped.at[g][i]);
            ++barred[n];
            const Vec3 r = position_of_held(matter, std::size_t(grip.point[i])) - center[n];
            for (int axis = 0; axis < 3; ++axis) {
                Vec6 way;
                way << axes.col(axis), r.cross(axes.col(axis)) / reach[n];
                bars[n] += grip.hold[axis] * way * way.transpose();
            }
        }
    }
    for (std::size_t n = 0; n < mass.size(); ++n) {
        left[n].size = size[n];
        left[n].push = across(bars[n].topLeftCorner<3, 3>(), barred[n], net[n]);
        Mat6 stiff = kBars * mass[n] / std::max(1.0, barred[n]) * bars[n];
        stiff.topLeftCorner<3, 3>() += mass[n] * Mat3::Identity();
        stiff.bottomRightCorner<3, 3>() += inertia[n].trace() > 0
                                               ? Mat3(inertia[n] / (reach[n] * reach[n]))
                                               : Mat3(mass[n] * Mat3::Identity());
        Vec6 wrench;
        wrench << net[n], torque[n] / reach[n];
        const Vec6 goes = stiff.llt().solve(wrench);
        left[n].shift = goes.head<3>();
        left[n].turn = goes.tail<3>() / reach[n];
        left[n].drive = mass[n] * goes.lpNorm<1>();
    }
    return left;
}

void add_steadying_forces(const Aggregate& matter, const Apparatus& apparatus,
                          const GrippedPieces& gripped, const Drive& now, const Vec3Array& push,
                          Vec3Array& force) {
    const Pieces& pieces = gripped.pieces;
    const std::vector<Vec3> center = centres_of(pieces, matter, masses_of(pieces, matter));
    std::vector<LeftFree> left = left_free(matter, apparatus, gripped, now, push);
    for (std::size_t n = 0; n < left.size(); ++n) {
        if (gripped.firm[n] || left[n].is_driven()) left[n] = {};
    }
    for (std::size_t p = 0; p < push.size(); ++p) {
        const auto n = std::size_t(pieces.particle_piece[p]);
        const Vec3 arm = matter.particle_position.at(p) - center[n];
        force.add(p, -matter.particle_mass[p] * (left[n].shift + left[n].turn.cross(arm)));
    }
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// A body that nothing holds any more can be at rest anywhere. It stays where it was let go, as near
// as tools leave it room.
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "sim/quasistatic.h"

namespace swage {

namespace {

constexpr int kHalvings = 8;

// Of the particles from one place to the other, by mass.
struct RigidMotion {
    Vec3 from, to;  // of the centre
    Mat3 turn;
};
RigidMotion rigid_motion(const Aggregate& matter, const Vec3Array& from, const Vec3Array& to) {
    RigidMotion r{Vec3::Zero(), Vec3::Zero(), Mat3::Identity()};
    double mass = 0;
    for (std::size_t p = 0; p < from.size(); ++p) {
        const double m = matter.particle_mass[p];
        mass += m;
        r.from += m * from.at(p);
        r.to += m * to.at(p);
    }
    r.from /= mass;
    r.to /= mass;
    Mat3 spread = Mat3::Zero();
    for (std::size_t p = 0; p < from.size(); ++p) {
        spread += matter.particle_mass[p] * (to.at(p) - r.to) * (from.at(p) - r.from).transpose();
    }
    const Eigen::JacobiSVD<Mat3> split(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 upright = Mat3::Identity();
    upright(2, 2) = (split.matrixU() * split.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    r.turn = split.matrixU() * upright * split.matrixV().transpose();
    return r;
}

}  // namespace

void QuasistaticSolver::stay(const Drive& to) {
    if (!apparatus_.grip.empty() || apparatus_.tool.empty() || pushes_.size(matter_, to) > 0) {
        return;
    }
    const auto is_free = [&] {
        contacts_.find_candidates(matter_, to);
        for (const LoadSum& load : contacts_.loads(matter_, to)) {
            if (load.size > 0) return false;
        }
        return true;
    };
    if (!is_free()) return;
    const Vec3Array free = matter_.particle_position;
    const RigidMotion gone = rigid_motion(matter_, start_, free);
    const Eigen::AngleAxisd turn(gone.turn);
    const auto go_back = [&](double share) {
        const Mat3 back = Eigen::AngleAxisd(-share * turn.angle(), turn.axis()).toRotationMatrix();
        const Vec3 center = gone.to + share * (gone.from - gone.to);
        for (std::size_t p = 0; p < free.size(); ++p) {
            matter_.particle_position.set(p, center + back * (free.at(p) - gone.to));
        }
    };
    double clear = 0, touches = 1;
    go_back(1);
    if (is_free()) return;
    for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (clear + touches);
        go_back(middle);
        (is_free() ? clear : touches) = middle;
    }
    go_back(clear);
    contacts_.find_candidates(matter_, to);
}

}  // namespace swage

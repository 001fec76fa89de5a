// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver does with what nothing holds: a body can then be at rest anywhere.
// It stays where it was let go, as near as tools leave it room.
#include <Eigen/Geometry>
#include <limits>

#include "sim/quasistatic.h"

namespace swage {

namespace {

constexpr int kHalvings = 8;

Eigen::Matrix3Xd columns(const Vec3Array& x) {
    Eigen::Matrix3Xd m(3, x.size());
    for (std::size_t p = 0; p < x.size(); ++p) m.col(Eigen::Index(p)) = x.at(p);
    return m;
}

}  // namespace

bool QuasistaticSolver::begins_to_fall(const Drive& to) {
    Vec3Array contact;
    contact.resize(matter_.particle_count());
    contacts_.add_forces(matter_, to, contact, std::numeric_limits<double>::infinity());
    self_.add_forces(contact);
    return free_.begins_to_fall(pushes_, to, contact);
}

int QuasistaticSolver::let_hang(const Drive& to) {
    Vec3Array own;
    own.resize(matter_.particle_count());
    self_.add_forces(own);
    return free_.let_hang(pushes_, to,
                          contacts_.held_points(matter_, to, ContactSet::Slipping::free), own);
}

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
    const Eigen::Matrix3Xd from = columns(start_), now = columns(free);
    if (from == now) return;
    const Vec3 start_center = from.rowwise().mean(), free_center = now.rowwise().mean();
    const Eigen::AngleAxisd turn(Mat3(Eigen::umeyama(from, now, false).topLeftCorner<3, 3>()));
    const auto go_back = [&](double share) {
        const Mat3 back = Eigen::AngleAxisd(-share * turn.angle(), turn.axis()).toRotationMatrix();
        const Vec3 center = free_center + share * (start_center - free_center);
        for (std::size_t p = 0; p < free.size(); ++p) {
            matter_.particle_position.set(p, center + back * (free.at(p) - free_center));
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

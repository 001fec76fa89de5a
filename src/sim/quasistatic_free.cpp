// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver does with what nothing holds: a body can then be at rest anywhere.
// It stays where it was let go, as near as tools leave it room.
#include <limits>

#include "sim/quasistatic.h"
#include "sim/relaxation_passes.h"
#include "sim/seating.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kHalvings = 8;
constexpr double kStill = 1e-9;        // spacings
constexpr double kLies = 0.5;          // of the loads: what tools carry of what lies on them
constexpr double kMoreThanLoads = 10;  // of them: what tools bear is not theirs
constexpr double kSeatDrag = 3e-10;    // of E a
constexpr double kSeatHeavy = 1e-4;    // of E a^2
constexpr double kSeatAccuracy = 0.1;  // of the tolerance

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
                          contacts_.held_points(matter_, to, RestingContacts::Slipping::free), own);
}

// What loads press onto tools goes to where it is in balance on them, as a rigid body: while they
// stand still, or before they move, unless it lies on them already. Returns how far any of it went
// [m].
double QuasistaticSolver::seat_pieces(const Drive& from, const Drive& to) {
    const double pushed = pushes_.size(matter_, to), a = matter_.lattice.spacing;
    if (!seats_ || apparatus_.tool.empty() || pushed == 0) return 0;
    if (settings_.self_contact && free_.are_several()) return 0;  // they may lie on each other
    if (measure_.carried() > kMoreThanLoads * pushed) return 0;
    const bool stand = contacts_.near_travel(from, to) <= kStill * a;
    if (!stand && measure_.carried() > kLies * pushed) return 0;
    const Drive& lie = stand ? to : from;
    Vec3Array& x = matter_.particle_position;
    const Vec3Array before = x;
    SeatProblem problem;
    problem.add_contacts = [&](Vec3Array& force) { contacts_.add_forces(matter_, lie, force); };
    problem.add_loads = [&](Vec3Array& force) {
        free_.add_loads(pushes_, lie, force);
        add_restraint(x, {x, drag_, 0, free_.heavy_mass(), pushes_.gravity(lie)}, force);
    };
    problem.held = [&] {
        return contacts_.held_points(matter_, lie, RestingContacts::Slipping::lawful);
    };
    problem.look_around = [&] { contacts_.find_candidates(matter_, lie); };
    problem.look_around();
    problem.drag = kSeatDrag * matter_.mean_modulus() * a;
    problem.heavy = std::max(1.0, kSeatHeavy * matter_.mean_modulus() * a * a / pushed);
    problem.enough = kSeatAccuracy * settings_.tolerance * pushed;
    problem.reach = body_size_;
    for (const std::vector<ParticleId>& piece : free_.loose_pieces()) {
        if (!seat(matter_, piece, problem)) seats_ = false;
    }
    if (!stand) contacts_.find_candidates(matter_, to);
    for (std::size_t p = 0; p < x.size(); ++p) rest_.add(p, x.at(p) - before.at(p));
    return farthest_move(x, before);
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
    const Mat3 spread = (now.colwise() - free_center) * (from.colwise() - start_center).transpose();
    const Vec3 turn = rotation_of(Quat(nearest_rotation(spread)));
    const auto go_back = [&](double share) {
        const Mat3 back = turn_by(-share * turn).toRotationMatrix();
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

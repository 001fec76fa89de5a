// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver does with what nothing holds: a body can then be at rest anywhere.
// It stays where it was let go, as near as tools leave it room.
#include "sim/quasistatic.h"
#include "sim/relaxation_passes.h"
#include "sim/seating.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kHalvings = 8;
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

// What loads press onto tools goes to where it is in balance on them, as a rigid body: while they
// stand still, or before they move, unless it lies on them already. Returns how far any of it went
// [m].
double QuasistaticSolver::seat_pieces(StaticMove& move) {
    const Drive& to = move.to;
    RestingContacts& contacts = forces_.contacts;
    const LoadSet& pushes = forces_.pushes;
    const FreePieces& free = forces_.free;
    const double pushed = pushes.size(matter_, to), a = matter_.lattice.spacing;
    if (!seats_ || apparatus_.tool.empty() || pushed == 0) return 0;
    if (settings_.self_contact && free.are_several()) return 0;  // they may lie on each other
    if (forces_.measure.carries() > kMoreThanLoads * pushed) return 0;
    const bool stand = contacts.stand_still(matter_, move.from, to);
    if (!stand && forces_.measure.carries() > kLies * pushed) return 0;
    const Drive& lie = stand ? to : move.from;
    Vec3Array& x = matter_.particle_position;
    const Vec3Array before = x;
    SeatProblem problem;
    problem.add_contacts = [&](Vec3Array& force) { contacts.add_forces(matter_, lie, force); };
    problem.add_loads = [&](Vec3Array& force) {
        pushes.add_forces(matter_, lie, force);
        add_restraint(x, {x, forces_.drag, 0, pushes.heavy_mass(matter_), pushes.gravity(lie)},
                      force);
    };
    problem.held = [&] {
        return contacts.held_points(matter_, lie, RestingContacts::Slipping::lawful);
    };
    problem.look_around = [&] { contacts.find_candidates(matter_, lie); };
    problem.look_around();
    problem.drag = kSeatDrag * matter_.mean_modulus() * a;
    problem.heavy = std::max(1.0, kSeatHeavy * matter_.mean_modulus() * a * a / pushed);
    problem.enough = kSeatAccuracy * settings_.tolerance * pushed;
    problem.reach = forces_.extent();
    for (const std::vector<ParticleId>& piece : free.loose_pieces()) {
        if (!seat(matter_, piece, problem)) seats_ = false;
    }
    if (!stand) contacts.find_candidates(matter_, to);
    for (std::size_t p = 0; p < x.size(); ++p) move.rest.add(p, x.at(p) - before.at(p));
    return farthest_move(x, before);
}

void QuasistaticSolver::stay(const StaticMove& move) {
    const Drive& to = move.to;
    RestingContacts& contacts = forces_.contacts;
    if (!apparatus_.grip.empty() || apparatus_.tool.empty() ||
        forces_.pushes.size(matter_, to) > 0) {
        return;
    }
    const auto is_free = [&] {
        contacts.find_candidates(matter_, to);
        for (const PartSum& load : contacts.loads(matter_, to)) {
            if (load.size > 0) return false;
        }
        return true;
    };
    if (!is_free()) return;
    const Vec3Array free = matter_.particle_position;
    const Eigen::Matrix3Xd from = columns(move.start), now = columns(free);
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
    contacts.find_candidates(matter_, to);
}

}  // namespace swage

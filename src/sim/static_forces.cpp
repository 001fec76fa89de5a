// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/static_forces.h"

#include <algorithm>
#include <cmath>

#include "sim/relaxation_passes.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kDrag = 3e-7;  // settles free modes, of E a; let go where it holds anything back
// Least push, over E a^2, that the residual is measured by: about a tenth of E I / L^2 of a bar 4
// cells thick and 10 times as long (an estimate). At the first touch of a slender body the true
// push is next to nothing. E is the softest matter's: what is stiffer bears no more than that
// gives.
constexpr double kLeastPush = 1e-3;
// Forces that rounded places leave in a body at rest add up to about this many times what each
// particle's stiffness makes of its own (measured).
constexpr double kRoundings = 16;

double least_modulus(const Aggregate& body) {
    double least = body.material.young_modulus;
    for (const Material& inset : body.inset) least = std::min(least, inset.young_modulus);
    return least;
}

}  // namespace

double least_push(const Aggregate& body) {
    return kLeastPush * least_modulus(body) * body.lattice.spacing * body.lattice.spacing;
}

StaticForces::StaticForces(Aggregate& body, const Apparatus& machine, const SimSettings& settings)
    : matter(body),
      apparatus(machine),
      may_touch_itself(settings.self_contact),
      lattice(body),
      contacts(body, machine, settings, 0),
      pushes(machine, settings, 0),
      self(body, settings),
      free(body, machine),
      measure(least_push(body)),
      tolerance_(settings.tolerance) {
    matter.branch_memory.clear();
    find_bounds();
    const double eps = std::numeric_limits<double>::epsilon();
    least_left_ = kRoundings * chunked_sum(stiffness_bound.size(), [&](std::size_t p) {
                      return stiffness_bound[p] * eps * matter.particle_position.at(p).norm();
                  });
}

void StaticForces::connections_changed() {
    contacts.connections_changed(matter);
    pushes.connections_changed(matter);
    self.connections_changed();
    free.connections_changed();
    find_bounds();
}

void StaticForces::find_bounds() {
    find_bound();
    find_drag();
}

void StaticForces::find_drag() {
    const double a = matter.lattice.spacing;
    const double full_mass = matter.material.density * a * a * a;
    drag.resize(matter.particle_count());
    const double modulus = matter.mean_modulus();
    for (std::size_t p = 0; p < drag.size(); ++p) {
        drag[p] = kDrag * modulus * a * matter.particle_mass[p] / full_mass;
    }
}

void StaticForces::find(const Drive& to, double moved) {
    mirrored = lattice.find(matter, Flow::trial, force);
    contacts.add_forces(matter, to, force, moved);
    pushes.add_forces(matter, to, force);
    if (!may_lie()) free.steady(pushes, to, force);
    add_restraint(matter.particle_position,
                  {held, drag, hold, pushes.heavy_mass(matter), pushes.gravity(to)}, force);
    self.add_forces(force);
}

double StaticForces::find_at_rest(const Drive& now) {
    held = matter.particle_position;
    find(now);
    return residual_of(force, now);
}

double StaticForces::push_measure(const Drive& to) const {
    const double asks = pushes.size(matter, to);
    const double push = measure.measure(asks, [&] { return contacts.loads(matter, to); });
    return measure.asked(asks) > 0 ? std::max(push, least_left_ / tolerance_) : push;
}

double StaticForces::rounded(const Drive& to) const {
    const bool asks = measure.asked(pushes.size(matter, to)) > 0;
    return asks && push_measure(to) <= least_left_ / tolerance_ ? least_left_ : 0;
}

double StaticForces::residual_of(const Vec3Array& left, const Drive& to) const {
    const Vec3Array& f = left;
    const double sum = chunked_sum(f.size(), [&](std::size_t p) {
        return std::sqrt(f.x[p] * f.x[p] + f.y[p] * f.y[p] + f.z[p] * f.z[p]);
    });
    return sum / push_measure(to);
}

bool StaticForces::begins_to_fall(const Drive& to) {
    Vec3Array contact;
    contact.resize(matter.particle_count());
    contacts.add_forces(matter, to, contact);
    self.add_forces(contact);
    return free.begins_to_fall(pushes, to, contact);
}

bool StaticForces::is_pushed_off(const Drive& to) {
    return !may_lie() && free.is_pushed_off(pushes, to) &&
           free.push_off(pushes, to).norm() > tolerance_ * push_measure(to);
}

int StaticForces::let_hang(const Drive& to) {
    Vec3Array own;
    own.resize(matter.particle_count());
    self.add_forces(own);
    return free.let_hang(pushes, to,
                         contacts.held_points(matter, to, RestingContacts::Slipping::free), own);
}

Stored StaticForces::stored(const Drive& now) {
    const double elastic = elastic_energy();
    return {0, elastic, contacts.stored_energy(matter, now) + self.sums().stored};
}

}  // namespace swage

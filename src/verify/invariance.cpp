// SPDX-License-Identifier: GPL-3.0-or-later
// What the forces inside the matter must keep whatever the shape: they are the slope of an energy,
// turn with the body, and neither push nor turn it as a whole.
#include <algorithm>
#include <cmath>

#include "base/noise.h"
#include "sim/lattice_forces.h"
#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr int kAcross = 3;
constexpr double kLength = 4;

Vec3Array forces_of(const Aggregate& matter) {
    Vec3Array force;
    force.resize(matter.particle_count());
    LatticeForces(matter).find(matter, Flow::trial, force);
    return force;
}

double largest(const Vec3Array& force) {
    double most = 0;
    for (std::size_t p = 0; p < force.size(); ++p) most = std::max(most, force.at(p).norm());
    return most;
}

template <typename Map>
void place(Aggregate& matter, const Map& map) {
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        matter.particle_position.set(p, map(matter.particle_position.at(p)));
    }
}

// Bent, twisted and stretched at once.
Aggregate bent_bar() {
    Aggregate bar = unit_bar(kLength, kAcross, unit_material(0.3));
    place(bar, [](const Vec3& x) -> Vec3 {
        const Vec3 twisted = Eigen::AngleAxisd(0.15 * x.x(), Vec3::UnitX()) * x;
        const double radius = 4 - twisted.z(), angle = 1.05 * twisted.x() / 4;
        return {radius * std::sin(angle), 1.02 * twisted.y(), 4 - radius * std::cos(angle)};
    });
    return bar;
}

const Quat kTurn(Eigen::AngleAxisd(2.1, Vec3(0.3, -0.8, 0.5).normalized()));

void invariance(bool, Values& values) {
    const Aggregate bent = bent_bar();
    const Vec3Array force = forces_of(bent);
    const double most = largest(force), a = bent.lattice.spacing;

    Aggregate moved = bent;
    place(moved, [](const Vec3& x) { return Vec3(kTurn * x + Vec3(1000, -500, 200)); });
    const Vec3Array turned_force = forces_of(moved);
    double off = 0;
    for (std::size_t p = 0; p < force.size(); ++p) {
        off = std::max(off, (turned_force.at(p) - kTurn * force.at(p)).norm());
    }
    values.add(absolute("forces of the bent bar turned and moved / largest", kAcross, 0, off / most,
                        1e-9));

    Aggregate rigid = unit_bar(kLength, kAcross, unit_material(0.3));
    place(rigid, [](const Vec3& x) { return Vec3(kTurn * x + Vec3(1, -0.5, 0.2)); });
    values.add(absolute("force of a rigid motion / E a^2", kAcross, 0,
                        largest(forces_of(rigid)) / (a * a), 1e-13));

    Vec3 push = Vec3::Zero(), torque = Vec3::Zero();
    double pushes = 0, torques = 0;
    for (std::size_t p = 0; p < force.size(); ++p) {
        const Vec3 x = bent.particle_position.at(p), f = force.at(p);
        push += f;
        torque += x.cross(f);
        pushes += f.norm();
        torques += x.norm() * f.norm();
    }
    values.add(absolute("sum of forces / sum of sizes", kAcross, 0, push.norm() / pushes, 1e-13));
    values.add(
        absolute("sum of torques / sum of sizes", kAcross, 0, torque.norm() / torques, 1e-13));
}

void energy_slope(bool, Values& values) {
    for (const auto& [elasticity, name] : {std::pair(Elasticity::hencky, "Hencky"),
                                           std::pair(Elasticity::neo_hookean, "neo-Hookean"),
                                           std::pair(Elasticity::storakers, "Storakers")}) {
        Material material = unit_material(0.3);
        material.elasticity = elasticity;
        Aggregate bar = unit_bar(2, kAcross, material);
        const double a = bar.lattice.spacing;
        std::size_t n = 0;
        place(bar, [&](const Vec3& x) {
            n += 3;
            return Vec3(x + 0.08 * a * Vec3(noise(n), noise(n + 1), noise(n + 2)));
        });
        const Vec3Array force = forces_of(bar);
        LatticeForces lattice(bar);
        const auto energy_at = [&](std::size_t p, int axis, double way) {
            Aggregate other = bar;
            Vec3 x = bar.particle_position.at(p);
            x[axis] += way;
            other.particle_position.set(p, x);
            return lattice.elastic_energy(other);
        };
        double off = 0;
        for (std::size_t p = 0; p < force.size(); ++p) {
            for (int axis = 0; axis < 3; ++axis) {
                // Central differences over one and two steps: what is left is of fourth order.
                const auto slope = [&](double h) {
                    return (energy_at(p, axis, h) - energy_at(p, axis, -h)) / (2 * h);
                };
                const double h = 1e-3 * a, got = (4 * slope(h) - slope(2 * h)) / 3;
                off = std::max(off, std::abs(got + force.at(p)[axis]));
            }
        }
        values.add(absolute(std::string("slope of the energy against the force / largest, ") + name,
                            kAcross, 0, off / largest(force), 1e-8));
    }
}

}  // namespace

void add_invariance_cases(std::vector<Case>& cases) {
    cases.push_back({"invariance", "forces inside a bent bar turn with it, and are in balance",
                     "exact", 0, true, invariance});
    cases.push_back({"energy", "forces of scattered particles are the slope of their energy",
                     "exact", 0, true, energy_slope});
}

}  // namespace swage

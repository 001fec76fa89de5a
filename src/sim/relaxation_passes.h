// SPDX-License-Identifier: GPL-3.0-or-later
// What a relaxation does to each particle in each iteration, in lanes and in fixed chunks: the same
// bits at any width and number of threads.
#pragma once

#include <vector>

#include "matter/aggregate.h"

namespace swage {

// force += mass g - share drag (x - back_to)
struct Restraint {
    const Vec3Array& back_to;
    const std::vector<double>& drag;  // [N/m]
    double share;
    const std::vector<double>& mass;  // [kg]
    Vec3 gravity;                     // [m/s2]
};
void add_restraint(const Vec3Array& position, const Restraint& restraint, Vec3Array& force);

struct RelaxationSums {
    double power = 0;   // v f
    double motion = 0;  // v m v
};
RelaxationSums relaxation_sums(const Vec3Array& velocity, const Vec3Array& force,
                               const std::vector<double>& mass);

// v = keep v + kick f / m,  x += step v, no component by more than `longest`. Returns the farthest
// that any component then is from `listed`.
struct RelaxationMove {
    double keep, kick, step, longest;
};
double move_on(const RelaxationMove& move, const Vec3Array& force,
               const std::vector<double>& inverse_mass, const Vec3Array& listed,
               Vec3Array& velocity, Vec3Array& position);

}  // namespace swage

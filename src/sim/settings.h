// SPDX-License-Identifier: GPL-3.0-or-later
// How the matter is moved on.
#pragma once

#include "base/math.h"
#include "laws/directional_drag.h"

namespace swage {

enum class Solver {
    quasistatic,     // each frame is an equilibrium, found by relaxation; no inertia
    explicit_steps,  // symplectic Euler with real masses and damping
    euler,           // explicit Euler, as the papers have it, for comparison
    energy_stepped,  // a step that the body's energy chooses
    implicit_steps,  // backward Euler
};

// Whether matter has speeds; else it rests at every frame.
constexpr bool in_motion(Solver solver) { return solver != Solver::quasistatic; }
// Whether it goes by explicit steps, of a length that the stiffest vibration allows.
constexpr bool is_explicit(Solver solver) {
    return solver == Solver::explicit_steps || solver == Solver::euler;
}
// Whether motion goes by all that materials and media say of it, as their damping; implicit steps
// damp by themselves.
constexpr bool follows_all_motion(Solver solver) {
    return in_motion(solver) && solver != Solver::implicit_steps;
}

// As a scene names it.
inline const char* name_of(Solver solver) {
    switch (solver) {
        case Solver::quasistatic:
            return "quasistatic";
        case Solver::explicit_steps:
            return "explicit";
        case Solver::euler:
            return "euler";
        case Solver::energy_stepped:
            return "energy-stepped";
        case Solver::implicit_steps:
            return "implicit";
    }
    return "";
}

struct SimSettings {
    Solver solver = Solver::quasistatic;

    // Quasi-static relaxation.
    double tolerance = 1e-2;     // residual (1-norm) over what sim/push_measure.h says; 1e-4 to 0.1
    int iteration_limit = 6000;  // a sub-increment that needs more is halved; 100 to 1e6
    int halving_limit = 4;       // 0 to 8
    // k_n = this * E * area / spacing, E of sim/surface_modulus.h; 0.01 to 100. 0: 2, or what a
    // tool says where nothing moves.
    double contact_stiffness = 0;
    double grip_stiffness = 20;  // the same for gripped points; 1 to 100
    bool self_contact = false;   // a body's surface meets what is not its neighbourhood in the
                                 // body; not in implicit steps

    // Motion by blocks of steps (sim/block_steps.h).
    double step_safety = 0.8;  // share of the stable step, 0 to 1; not implicit steps
    int retry_limit = 10;      // halvings of a step that goes wrong (sim/motion_guard.h); 0 to 20
    bool sleep = true;         // bodies that have come to rest cost nothing (sim/sleeping.h)

    // What the medium around does to the surface (laws/ambient_drag.h, laws/directional_drag.h);
    // in motion, but for implicit steps.
    double medium_density = 0;    // [kg/m3], >= 0; 0: none; air 1.2, water 1000
    double drag_coefficient = 1;  // >= 0, over a quarter of the surface: ball 0.5, cube 0.7, thin
                                  // plate face on 2.4
    double directional_drag = 0;  // [Pa s/m], >= 0; 0: none; what stops at v: weight over area v
    DragAlong directional_drag_along = DragAlong::motion;

    Vec3 gravity = Vec3::Zero();  // in the world [m/s2]

    // With a tool that says Tool::contact_stiffness, or without.
    double stiffness_of_contacts(double tool_says = 0) const {
        if (contact_stiffness > 0) return contact_stiffness;
        return tool_says > 0 && !in_motion(solver) ? tool_says : 2;
    }
};

}  // namespace swage

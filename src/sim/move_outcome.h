// SPDX-License-Identifier: GPL-3.0-or-later
// What a solver reports of one move of the drive.
#pragma once

#include <string>
#include <vector>

#include "sim/contact_set.h"

namespace swage {

// What one body went through in a move.
struct BodyOutcome {
    double plastic_work = 0;        // [J]
    double fracture_work = 0;       // [J]
    double set_free = 0;            // elastic energy that cracks let go of at a standing drive [J];
                                    // quasi-static only
    int broken = 0;                 // connections
    double damped_work = 0;         // [J]; explicit steps only
    std::vector<double> work;       // by tool, then grip [J]
    std::vector<double> push_work;  // by load, then gravity [J]
    std::vector<LoadSum> load;      // at the end, by tool, then grip

    BodyOutcome(const Apparatus& apparatus, std::size_t pushes)
        : work(apparatus.tool.size() + apparatus.grip.size(), 0.0), push_work(pushes, 0.0) {}
};

struct MoveOutcome {
    std::vector<BodyOutcome> body;
    int iterations = 0;
    int increments = 0;
    int halvings = 0;
    long steps = 0;                 // explicit steps only
    double residual = 0;            // of the last increment, over its reference force
    bool drag_held = false;         // was more than a step can follow; explicit steps only
    bool buckled = false;           // an equilibrium on the way was unstable, and left
    std::vector<std::string> lost;  // tools that the work-piece has slipped away from
};

// Work [J] that each tool and grip did while its pose went from one to another under these loads
// before and after: the trapezoid rule on force and torque of the pose's origin.
void add_work(const Drive& from, const Drive& to, const std::vector<LoadSum>& before,
              const std::vector<LoadSum>& after, std::vector<double>& work);

}  // namespace swage

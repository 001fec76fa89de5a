// SPDX-License-Identifier: GPL-3.0-or-later
// How long a run takes, from counts of steps and of what each of them goes over. Some of these are
// known before (particles, points of the surface, steps of an elastic body), some are not (what
// meets, breaks, flows or slips): a time is told from the least that these can make of it to the
// most, and nothing of the machine is measured, so that the same scene is told the same.
#pragma once

#include <vector>

#include "scene/spec.h"

namespace swage {

struct CostRange {
    double least = 0, most = 0;

    void add(const CostRange& other) { least += other.least, most += other.most; }
    CostRange times(double factor) const { return {least * factor, most * factor}; }
    // One number says as much.
    bool is_narrow() const { return most < 4.5 * least; }
    double middle() const;  // geometric
};

// Of all bodies together.
struct WorkLoad {
    double particles = 0, surface_points = 0;
    double longest = 0;           // cells along the longest way through the work-piece
    double thickness = 1;         // of it, or of its thin parts, in cells
    double steps_per_second = 0;  // explicit ones, of the body that needs the most
    double flight = 0;            // of a stage that they take no steps for, nothing being near [s]
    std::vector<double> leg{};    // of a stage, of which each takes whole steps [s]; empty: frames
};

struct StageTime {
    CostRange steps;    // or iterations
    CostRange seconds;  // on one core
};

// `equilibria`: of a quasi-static stage that is counted, else 0.
StageTime stage_time(const SceneSpec& scene, const StageSpec& stage, const WorkLoad& load,
                     long equilibria);

// Of a solver that takes far more than explicit steps, how many times as many, about.
double more_steps(const SceneSpec& scene, const StageSpec& stage);

// Skins that are made anew, and all files of a run but for pictures [byte].
CostRange writing_time(const SceneSpec& scene, double frames, const CostRange& bytes,
                       double particles);

// Of one core.
double drawing_time(const RenderSettings& render, double stills);

}  // namespace swage

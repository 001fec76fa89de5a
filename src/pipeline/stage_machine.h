// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "machines/legs.h"
#include "scene/spec.h"

namespace swage {

// Throws as place_work_frame(). `skin`: the box of the work-piece's.
WorkFrame stage_frame(const StageSpec& stage, const Aggregate& work_piece, const Box& skin);

// A stage's machine, set up at the work-piece as it is now. `beside`: the materials of the other
// bodies. `coarser`: as build_machine() has it. Throws SceneError where that throws.
Machine stage_machine(const StageSpec& stage, const Aggregate& work_piece,
                      const std::vector<Material>& beside, const Box& skin, double coarser = 1);

// What keeps the machines of all stages but the first from being set up at the work-piece as it is
// before the first; at that of then they may be.
std::vector<std::string> foreseen_mistakes(const SceneSpec& scene, const Aggregate& work_piece,
                                           const Box& skin, const std::vector<Material>& beside,
                                           double coarser = 1);

// Takes out what has been foreseen of a stage, which has been set up by now.
void forget_foreseen(std::vector<std::string>& warnings, const StageSpec& stage);

// Its way over so many frames, as straight as that spacing of its matter asks for [m], and its
// drives along it (machines/legs.h). Throw SceneError where an expression has no value at some
// time.
Legs stage_legs(const StageSpec& stage, const Machine& machine, int frames, double spacing,
                double begin = 0);
std::vector<Drive> stage_drives(const StageSpec& stage, const Machine& machine,
                                const std::vector<Leg>& legs, int steps);

}  // namespace swage

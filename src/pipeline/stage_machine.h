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
// bodies. Throws SceneError where build_machine throws.
Machine stage_machine(const StageSpec& stage, const Aggregate& work_piece,
                      const std::vector<Material>& beside, const Box& skin);

// What the machines of all stages but the first would say against their parameters, and how they
// are to stand, at the work-piece as it is before the first.
std::vector<std::string> foreseen_mistakes(const SceneSpec& scene, const Aggregate& work_piece,
                                           const Box& skin);

// Its way over so many frames, as straight as that spacing of its matter asks for [m], and its
// drives along it (machines/legs.h). Throw SceneError where an expression has no value at some
// time.
Legs stage_legs(const StageSpec& stage, const Machine& machine, int frames, double spacing,
                double begin = 0);
std::vector<Drive> stage_drives(const StageSpec& stage, const Machine& machine,
                                const std::vector<Leg>& legs, int steps);

}  // namespace swage

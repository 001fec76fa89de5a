// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of a stage are called in a run, without their endings.
#pragma once

#include <string>
#include <vector>

#include "scene/spec.h"

namespace swage {

// Of a body's meshes; those of every frame are in a folder of this name.
inline std::string mesh_name(const SceneSpec& scene, const StageSpec& stage, const BodySpec& body) {
    return scene.body.size() == 1 ? stage.name : stage.name + "-" + body.name;
}

inline std::string body_table_name(const StageSpec& stage) { return stage.name + "-bodies"; }

// Of all its tables: its curves', and of what moves its bodies'.
inline std::vector<std::string> table_names(const StageSpec& stage) {
    if (!in_motion(stage.sim.solver)) return {stage.name};
    return {stage.name, body_table_name(stage)};
}

}  // namespace swage

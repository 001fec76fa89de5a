// SPDX-License-Identifier: GPL-3.0-or-later
// What a run warns of before its first stage.
#pragma once

#include <string>
#include <vector>

#include "pipeline/named_matter.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

struct StartWarnings {
    std::vector<std::string> mesh;      // findings, told as the meshes are read
    std::vector<std::string> mold;      // findings, told as they are molded
    std::vector<std::string> strength;  // what breaks at another stress than its material says
    std::vector<std::string> bodies;    // how they lie, and what machines say against them

    std::vector<std::string> all() const;
};

std::vector<NamedMatter> named(const std::vector<WorkPiece>& bodies);

std::vector<std::string> body_names(const SceneSpec& scene);

// Findings of the meshes as they are read.
std::vector<std::string> warnings_of_meshes(const SceneSpec& scene,
                                            const std::vector<InputMesh>& input);

// Findings of a body's molding as warnings, with its name where it is one of several.
std::vector<std::string> warnings_of_mold(const std::string& body, bool is_one_of_several,
                                          const std::vector<std::string>& findings);

// Of bodies that lie in each other, and of what the machines of all stages but the first would say
// at the work-piece, which is the first, as it is now.
std::vector<std::string> warnings_of_bodies(const SceneSpec& scene,
                                            const std::vector<NamedMatter>& bodies);

}  // namespace swage

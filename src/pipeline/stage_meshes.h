// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes that a stage leaves of each body: at its end and, where the scene wants them, at each
// frame.
#pragma once

#include <filesystem>
#include <vector>

#include "matter/skin_field.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

class StageMeshes {
  public:
    // `root`: of the run directory. Keeps a reference to the scene.
    StageMeshes(const SceneSpec& scene, const StageSpec& stage, const std::filesystem::path& root);

    // Of frames, where these are wanted. The others throw Error(output).
    void make_folders() const;
    // Nothing where those of frames are not wanted. `values`: of each body's fields.
    void write_frame(int frame, const std::vector<WorkPiece>& bodies,
                     const std::vector<SkinFieldValues>& values) const;
    void write_end(std::size_t body, const WorkPiece& piece) const;

  private:
    const SceneSpec& scene_;
    std::vector<std::filesystem::path> stem_;  // of each body; those of frames stand in a folder
};

}  // namespace swage

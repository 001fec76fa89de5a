// SPDX-License-Identifier: GPL-3.0-or-later
// The folder that a run is drawn into once more: new, empty, or so drawn into before. What lies
// elsewhere is never drawn over.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/folder_lock.h"
#include "pipeline/made_folder.h"
#include "pipeline/run_directory.h"
#include "pipeline/run_options.h"

namespace swage {

class RenderDirectory {
  public:
    // Makes the folder, and those that it is to lie in, or enters it, and clears away what a
    // drawing that was killed left unfinished there. `in_run`: it is the run's own for this, which
    // may hold anything. Throws Error(foreign) where it is a run, holds what no drawing left or
    // another process draws there, Error(output) where it cannot be written.
    // `first_frame`: what the first is called now.
    RenderDirectory(const std::filesystem::path& root, bool in_run, int first_frame);
    ~RenderDirectory();  // where nothing was drawn, nothing is left of it
    RenderDirectory(const RenderDirectory&) = delete;
    RenderDirectory& operator=(const RenderDirectory&) = delete;

    DrawnFiles files() const { return {root_, first_frame_}; }
    // Of earlier drawings, and maybe of another camera: stills and passes beside these. Returns how
    // many files they were, with the film, which draw_run() takes away, where there is none now.
    int remove_others(const FrameRange& drawn, bool film,
                      const std::vector<PicturePass>& passes = {}) const;

  private:
    std::filesystem::path mark() const { return root_ / ".swage-render"; }

    std::filesystem::path root_;
    int first_frame_;
    MadeFolder folder_;
    std::optional<FolderLock> lock_;
    bool had_film_ = false;
};

}  // namespace swage

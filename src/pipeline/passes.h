// SPDX-License-Identifier: GPL-3.0-or-later
// Passes for compositing beside the stills: depth, mattes, normals.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/frame_store.h"
#include "pipeline/run_directory.h"
#include "pipeline/usd_machine.h"
#include "render/layers.h"

namespace swage {

// What is in the pictures, as the user calls it.
struct RunNames {
    std::vector<std::string> body;
    std::vector<UsdStage> stage;
    std::string scene = {};  // the file's
};

using MatteColor = std::array<std::uint8_t, 3>;
// Of so many, no two alike; the first is black.
std::vector<MatteColor> matte_colors(std::size_t count);

// Whose a pixel is has one number all through a run: 0 nothing, 1 the ground, then bodies, then
// tools, grips and blades, machine after machine.
class PassWriter {
  public:
    PassWriter(const FrameStore& store, const RenderSettings& settings, const DrawnFiles& files,
               const RunNames& names, const Quat& drawn_from_world);

    int number_of_body(std::size_t body) const { return 2 + static_cast<int>(body); }
    int number_of_part(int machine, std::size_t part) const;
    // Of the frame whose machine that is; `number`: of each of the picture's items.
    void write(int frame, int machine, const Layers& layers, const std::vector<int>& number);
    void finish() const;  // the table of mattes

  private:
    const FrameStore& store_;
    const RenderSettings& settings_;
    const DrawnFiles files_;
    const RunNames& names_;
    const Mat3 world_from_drawn_;
    std::size_t bodies_ = 0;
    std::vector<int> first_part_;  // of each machine
    std::vector<MatteColor> color_;
    std::map<int, int> first_frame_;  // of those machines that were in a frame
};

}  // namespace swage

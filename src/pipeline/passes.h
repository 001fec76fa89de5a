// SPDX-License-Identifier: GPL-3.0-or-later
// Passes for compositing beside the stills (PicturePass).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/frame_store.h"
#include "pipeline/machine_tracks.h"
#include "pipeline/piece_track.h"
#include "pipeline/run_directory.h"
#include "render/layers.h"

namespace swage {

// What is in the pictures, as the user calls it.
struct RunNames {
    std::vector<std::string> body;
    std::vector<StageFrames> stage;
    std::string scene = {};            // the file's
    std::vector<NamedPieces> piece{};  // after the last stage
};

using MatteColor = std::array<std::uint8_t, 3>;
// Of so many, no two alike; the first is black.
std::vector<MatteColor> matte_colors(std::size_t count);

// What the passes of one still are made of; `layers` is empty where there are none.
struct PassPicture {
    Layers layers;
    std::vector<int> number;              // of each of the picture's items, as PassWriter has them
    std::vector<std::vector<int>> piece;  // of each body's triangles, from 0 on
    std::vector<Eigen::Vector4f> motion;  // of each pixel, as motion_of() tells it
};

// Whose a pixel is has one number all through a run: 0 nothing, 1 the ground, then bodies, then
// tools, grips and blades, machine after machine, then pieces of bodies but for the first of each,
// which has its body's.
class PassWriter {
  public:
    PassWriter(const FrameStore& store, const RenderSettings& settings, const DrawnFiles& files,
               const RunNames& names, const Quat& drawn_from_world);

    int number_of_body(std::size_t body) const { return 2 + static_cast<int>(body); }
    int number_of_part(int machine, std::size_t part) const;
    // Of each triangle of that body's skin, where there is a pass of pieces.
    std::vector<int> pieces_of(std::size_t body, int skin, const TriMesh& mesh) const;
    // Of the frame whose machine that is.
    void write(int frame, int machine, const PassPicture& picture);
    void finish() const;  // the tables of what has colours

  private:
    int number_of_piece(std::size_t body, int piece) const;
    template <typename NumberOf>
    void write_colors(int frame, PicturePass pass, const Layers& layers,
                      const NumberOf& number_of) const;
    void write_table(PicturePass pass) const;

    const FrameStore& store_;
    const RenderSettings& settings_;
    const DrawnFiles files_;
    const RunNames& names_;
    const Mat3 world_from_drawn_;
    std::size_t bodies_ = 0;
    std::vector<int> first_part_;  // of each machine
    std::optional<PieceTrack> pieces_;
    std::vector<int> first_piece_;  // of each body, but for its own
    std::vector<MatteColor> color_;
    std::map<int, int> first_frame_;  // of those machines that were in a frame
};

}  // namespace swage

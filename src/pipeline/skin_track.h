// SPDX-License-Identifier: GPL-3.0-or-later
// What is to be known of a body's skins, in all frames, before they are exported as USD.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/frame_store.h"

namespace swage {

using Float3 = Eigen::Vector3f;

// Arrays have a value a frame.
struct SkinTrack {
    std::string name, identifier;
    std::vector<int> skin;
    std::vector<std::uint64_t> shape;  // hash of places and skin
    std::vector<std::array<Float3, 2>> extent;
    std::vector<std::vector<std::uint64_t>> field;  // hashes of each one's values and the skin
    std::vector<std::size_t> vertices, smooth_groups;
    double skin_bytes = 0;           // of all that is written once a skin
    std::vector<int> look;           // all that its polygons have
    std::vector<std::size_t> faces;  // of each of these
    bool all_have_looks = true, is_open = false, has_normals = true, has_uv = false,
         has_colors = false, has_corner_colors = false;

    void add(const StoredBody& body);  // in the next frame
    int main_look() const;             // of the most faces, -1: none
    bool changes_faces() const;        // in any of them
};

}  // namespace swage

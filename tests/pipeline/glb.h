// SPDX-License-Identifier: GPL-3.0-or-later
// Binary glTF as a reader has it: its document, its numbers, and what is where at a time.
#pragma once

#include "base/math.h"
#include "tests/shared/json.h"

namespace swage::test {

class Glb {
  public:
    explicit Glb(const std::string& bytes);  // checks how it is built

    Json document;

    std::vector<float> numbers(int accessor) const;
    std::vector<std::uint32_t> indices(int accessor) const;
    std::string view(int number) const;       // its bytes
    int node(const std::string& name) const;  // of that name; fails where there is none or several

    // Of a node as the animation has it, at a time [s].
    std::vector<float> value(int node, const std::string& path, double time) const;
    bool is_shown(int node, double time) const;  // it and all that it is in
    Eigen::Matrix4d world_from_node(int node, double time) const;
    // Corners of all triangles of a primitive, in the node's axes, or their normals.
    std::vector<Vec3> corners(int node, std::size_t primitive, const char* attribute,
                              double time) const;

  private:
    std::string binary_;
    std::vector<int> parent_;
};

}  // namespace swage::test

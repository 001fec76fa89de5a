// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>

#include "geometry/box_mesh.h"

namespace swage::test {

// A box as text of an OBJ file, after so many vertices of it; an object where it has a name.
inline std::string box_obj(const Vec3& low, const Vec3& high, int before = 0,
                           const std::string& name = {}) {
    const TriMesh box = box_mesh(low, high);
    std::string text = name.empty() ? "" : "o " + name + "\n";
    for (const Vec3& p : box.position) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    for (const Corners& t : box.triangle) {
        text +=
            fmt::format("f {} {} {}\n", t[0] + before + 1, t[1] + before + 1, t[2] + before + 1);
    }
    return text;
}

}  // namespace swage::test

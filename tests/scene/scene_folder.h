// SPDX-License-Identifier: GPL-3.0-or-later
// What scenes are read from in tests, and what is told of them.
#pragma once

#include <filesystem>
#include <string>

#include "scene/read_scene.h"
#include "tests/shared/scratch.h"

namespace swage::test {

// With a mesh that scenes may name.
class SceneFolder : public Scratch {
  public:
    SceneFolder() { write("bar.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); }
};

inline AssetPaths shipped() { return {{std::filesystem::path(SWAGE_SOURCE_DIR)}}; }

// All mistakes, one a line, without the folder in front.
inline std::string told(const std::vector<Mistake>& mistakes, const std::filesystem::path& folder) {
    std::string text;
    for (const Mistake& mistake : mistakes) {
        std::string line = mistake_text(mistake);
        const std::string front = folder.string() + "/";
        if (line.rfind(front, 0) == 0) line = line.substr(front.size());
        text += line + "\n";
    }
    return text;
}

}  // namespace swage::test

// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of its own for each test, gone at its end.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "scene/read_scene.h"

namespace swage::test {

class Scratch {
  public:
    Scratch() {
        char name[] = "/tmp/swage_scene_XXXXXX";
        if (::mkdtemp(name) == nullptr) throw std::runtime_error("no folder in /tmp");
        folder_ = name;
        write("bar.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    }
    ~Scratch() {
        std::error_code error;
        std::filesystem::remove_all(folder_, error);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = folder_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
        return file;
    }
    const std::filesystem::path& folder() const { return folder_; }

  private:
    std::filesystem::path folder_;
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

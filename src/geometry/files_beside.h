// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a mesh's own names: libraries of materials, images.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

// Files that go with a mesh. Those that were not there before go away with it, unless they are to
// stay, once the mesh itself stands.
class FilesBeside {
  public:
    FilesBeside() = default;
    ~FilesBeside();
    FilesBeside(const FilesBeside&) = delete;
    FilesBeside& operator=(const FilesBeside&) = delete;

    void write(const std::filesystem::path& file, const std::string& bytes);
    // A file of these bytes in the folder, under the wanted name or, where something else has that,
    // under one like it. Returns its name.
    std::string add(const std::filesystem::path& folder, const std::string& wanted,
                    const std::string& bytes);
    void stay() { made_.clear(); }

  private:
    std::vector<std::filesystem::path> made_;
};

// Puts each material's image beside `file`; returns the names, one word each, empty for no image.
// An equal file that stands there already is left alone, a different one of that name is not
// touched.
std::vector<std::string> copy_textures(const std::filesystem::path& file,
                                       const std::vector<SurfaceMaterial>& material,
                                       FilesBeside& beside);

// One word, for readers that end a name at a blank, of a file (MeshLab) as of a material.
std::string plain_name(const std::string& name, const char* otherwise);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes into files that other programs read. Files appear only when whole (base/atomic_file.h);
// all functions throw Error(output).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh_objects.h"
#include "geometry/trimesh.h"

namespace swage {

// Wavefront OBJ with everything the mesh holds: polygons, parts, materials, texture coordinates,
// normals by smooth group, colours as "v x y z r g b" (sRGB). Numbers are the shortest that read
// back to the same double. A part that is closed by itself is an object (o); those that bound
// something only together are groups (g) of one, which come first. With materials, writes the .mtl
// of the same name, without blanks, and copies of the textures beside it, so that the folder can be
// moved. `objects`: others than its parts, which are groups of these then.
void write_obj(const std::filesystem::path& file, const TriMesh& mesh,
               const MeshObjects& objects = {});

// A number for each vertex of a mesh.
struct VertexValues {
    std::string name;     // of the property
    std::string comment;  // in the file's header; empty: none
    const std::vector<float>* value;
};

// Binary little-endian PLY, places in double precision: polygons, normals where the whole surface
// is smooth (PLY has one a vertex), colours (8 bit sRGB), texture coordinates at vertices (s, t)
// when no seam forbids it, else at face corners (texcoord, an empty list where a face has none; in
// double precision beside polygons of more than three), names of textures and, where not all faces
// have the one there is, texnumber (-1: none). `values`: further numbers, one a vertex, as `float`.
void write_ply(const std::filesystem::path& file, const TriMesh& mesh,
               const std::vector<VertexValues>& values = {});

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

}  // namespace swage

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

// Where a mesh's library of materials (.mtl) would stand, another's may, and it takes another name
// then; or nothing does but what it was before.
enum class LibraryPlace { may_be_taken, is_its_own };

// Wavefront OBJ with everything the mesh holds: polygons, parts, materials, texture coordinates,
// normals by smooth group, colours as "v x y z r g b" (sRGB). Numbers are the shortest that read
// back to the same double. A part that is closed by itself is an object (o); those that bound
// something only together are groups (g) of one, which come first. With materials, writes a library
// of these and copies of the textures beside it, so that the folder can be moved. `objects`: others
// than its parts, which are groups of these then.
void write_obj(const std::filesystem::path& file, const TriMesh& mesh,
               const MeshObjects& objects = {}, LibraryPlace place = LibraryPlace::may_be_taken);

// Its library of materials: of the same name, which is one word.
std::filesystem::path library_of(const std::filesystem::path& obj);

// A number for each vertex of a mesh.
struct VertexValues {
    std::string name;     // of the property
    std::string comment;  // in the file's header; empty: none
    const std::vector<float>* value;
};

// Binary little-endian PLY, places in double precision: polygons, normals where the whole surface
// is smooth (PLY has one a vertex), colours where vertices have them (8 bit sRGB; materials' are in
// them, over the 0.8 that read_mesh() gives back; where only faces meet that take none it is
// theirs), texture coordinates at vertices (s, t) when no seam forbids it, else at face corners
// (texcoord, an empty list where a face has none; in double precision beside polygons of more than
// three), names of textures and, where not all faces have the one there is, texnumber (-1: none).
// `values`: further numbers, one a vertex, as `float`.
void write_ply(const std::filesystem::path& file, const TriMesh& mesh,
               const std::vector<VertexValues>& values = {});

// Throws where the ids of its corners are none of the mesh's.
void check_indices(const std::filesystem::path& file, const TriMesh& mesh);

}  // namespace swage

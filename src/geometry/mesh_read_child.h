// SPDX-License-Identifier: GPL-3.0-or-later
// The inner side of reading a mesh: what runs in the child process and what it hands back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_contents.h"
#include "geometry/trimesh.h"

namespace swage {

enum class MeshFormat { obj, ply, stl, off, gltf, glb, dae, tds, tmf };

// By the endings of files, in order of MeshFormat.
inline constexpr const char* kMeshEnding[] = {"obj", "ply", "stl", "off", "gltf",
                                              "glb", "dae", "3ds", "3mf"};

struct MeshSource {
    std::filesystem::path file;  // absolute
    MeshFormat format;
    std::string bytes;           // the file's contents
    std::uint64_t file_bytes;    // limit for each further file
    std::uint64_t memory_bytes;  // and for the whole reading
    bool looks;                  // whether its look counts
    std::vector<std::string> finding;

    // What a file has of its look and the mesh has not.
    void tell_of_look(std::string sentence) {
        if (looks) finding.push_back(std::move(sentence));
    }
};

// Colours here are linear RGB. A texture is either the path of a file or its contents.
struct RawMaterial {
    std::string name = {};
    Vec3 color = {0.8, 0.8, 0.8};
    double roughness = 0.55;
    double metallic = 0;
    std::string texture = {};
    std::string texture_bytes = {};
};

// Polygons as a file gives them; -1 for a corner without the attribute.
struct PolygonList {
    std::vector<int> first = {0};  // corners of polygon p: first[p] .. first[p + 1]
    std::vector<int> position, uv, normal;
    std::vector<int> material, part, line;  // one a polygon; line in the file or 0
    std::vector<int> smooth;                // likewise (RawMesh::triangle_smooth), or empty

    void add_corner(int p, int t, int n) {
        position.push_back(p);
        uv.push_back(t);
        normal.push_back(n);
    }
    void end_polygon(int material_id, int part_id, int line_number) {
        first.push_back(static_cast<int>(position.size()));
        material.push_back(material_id);
        part.push_back(part_id);
        line.push_back(line_number);
    }
    std::size_t size() const { return material.size(); }
};

// Plain arrays, as they cross the pipe.
struct RawMesh {
    std::vector<Vec3> position;
    std::vector<Eigen::Vector3f> color;  // empty or one a position
    std::vector<Vec2> uv;
    std::vector<Eigen::Vector3f> normal;
    std::vector<Corners> triangle, triangle_uv, triangle_normal;
    std::vector<int> polygon, triangle_material, triangle_part;
    // Faces of one number are smooth with each other, those of 0 with none. Empty: nobody said.
    // Normals, where a triangle's corners all have them, say more.
    std::vector<int> triangle_smooth;
    std::vector<RawMaterial> material;
    std::vector<std::string> part_name;
    std::vector<std::string> finding;
    int at_vertices = 0;  // 1: attributes belong to the file's vertices, which are split at seams
};

// Reads one format. Errors are swage::Error with a sentence that does not name the file.
RawMesh read_obj(MeshSource& source);
RawMesh read_ply(MeshSource& source);
RawMesh read_off(MeshSource& source);
RawMesh read_by_assimp(MeshSource& source);
RawMesh read_raw(MeshSource& source);  // whichever fits, with its textures looked up

// Rewrite a file's bytes where assimp would take them wrongly.
std::vector<Vec3> patch_stl(MeshSource& source);  // of a text the places of its facets' corners
void patch_gltf(MeshSource& source);
double patch_3mf(MeshSource& source);  // the unit of its lengths [m]

// What a file places anywhere by its number in a list, with all that it is made of.
struct PlacedPart {
    static constexpr double kNodeBytes = 1100;  // at least, of assimp's for each place
    static constexpr double kVertexBytes = 24, kTriangleBytes = 68;  // likewise, of ours

    double bytes = kNodeBytes;  // of it alone
    std::vector<std::size_t> child;
};
// Throws std::bad_alloc when `roots` would take more, with each part at all of its places. What is
// made of itself counts once.
void check_placed(const std::vector<PlacedPart>& parts, const std::vector<std::size_t>& roots,
                  std::uint64_t memory_bytes);

// Cuts the polygons into triangles and files them in `mesh`; checks every index. Polygons of fewer
// than three different corners are left out, with a finding.
void add_polygons(const PolygonList& polygons, RawMesh& mesh);

// To what the colours of a file are counted that does not say whether to 1 or to 255. `brightest`:
// their largest number. To 255 they would all but be black up to 2, and what is light goes a little
// above 1.
inline double counted_to(double brightest) { return brightest > 2 ? 255 : 1; }

// That `count` materials, of which one is called `name`, are drawn otherwise than they are meant;
// `by`: how the file says it.
enum class Unlike { clear, bright, clamped };
std::string unlike_sentence(Unlike how, std::size_t count, const std::string& name,
                            const std::string& by);

// "my%20image" is "my image".
std::string url_decoded(const std::string& text);

std::string to_bytes(const RawMesh& mesh);
// Throws Error(mesh) when the bytes are not a whole mesh.
RawMesh from_bytes(std::string_view bytes);

// Throws Error(mesh) on indices out of range, sizes that disagree, numbers that are not finite or
// of no sane magnitude.
void check_raw(const RawMesh& mesh);

// Welds equal positions and builds the value that the program works on. Takes the arrays out of
// `mesh`, adds to its findings.
TriMesh weld(RawMesh& mesh, double crease_angle);

}  // namespace swage

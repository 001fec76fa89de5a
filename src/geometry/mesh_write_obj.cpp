// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/compile.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/srgb.h"
#include "geometry/edges.h"
#include "geometry/files_beside.h"
#include "geometry/mesh_write.h"
#include "geometry/polygon.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// Appends text to one large string; fmt writes straight into it.
class Text {
  public:
    explicit Text(std::size_t expected) { bytes_.reserve(expected); }
    void put(std::string_view text) { bytes_.append(text); }
    void number(double value) {
        fmt::format_to(std::back_inserter(bytes_), FMT_COMPILE(" {}"), value + 0.0);  // no "-0"
    }
    void number(char before, int value) {
        bytes_.push_back(before);
        const fmt::format_int digits(value);
        bytes_.append(digits.data(), digits.size());
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

std::vector<std::string> unique_names(const std::vector<std::string>& wanted,
                                      const char* otherwise) {
    std::set<std::string> taken;
    std::vector<std::string> names;
    for (const std::string& name : wanted) {
        const std::string plain = plain_name(name, otherwise);
        std::string unique = plain;
        for (int n = 2; !taken.insert(unique).second; ++n) unique = fmt::format("{}.{}", plain, n);
        names.push_back(unique);
    }
    return names;
}

// Returns the name of the library beside `file`.
std::string write_mtl(const fs::path& file, const std::vector<SurfaceMaterial>& material,
                      const std::vector<std::string>& name, LibraryPlace place,
                      FilesBeside& beside) {
    const std::vector<std::string> image = copy_textures(file, material, beside);
    std::string text;
    for (std::size_t i = 0; i < material.size(); ++i) {
        const SurfaceMaterial& m = material[i];
        // Ns for programs without Pr: the Blinn exponent of that roughness.
        const double r2 = std::clamp(m.roughness * m.roughness, 1e-3, 1.0);
        text +=
            fmt::format("newmtl {}\nKd {} {} {}\nNs {:.6g}\nPr {}\nPm {}\n", name[i], m.color.x(),
                        m.color.y(), m.color.z(), 2 / r2 - 2, m.roughness, m.metallic);
        if (!image[i].empty()) text += "map_Kd " + image[i] + "\n";
        text += "\n";
    }
    const fs::path library = library_of(file);
    const std::string library_name = library.filename().string();
    // Another mesh may be called by that word.
    if (place == LibraryPlace::may_be_taken && library.stem() != file.stem()) {
        return beside.add(file.parent_path(), library_name, text);
    }
    beside.write(library, text);
    return library_name;
}

// sRGB, of seven digits.
double shown_color(float linear) {
    return std::round(srgb_from_linear(std::clamp<double>(linear, 0, 1)) * 1e7) / 1e7;
}

// Of the values that corners have, each one's number from 1 on; 0: no corner has it.
std::vector<int> numbers_of_used(const std::vector<Corners>& ids, std::size_t count) {
    std::vector<int> number(count, 0);
    for (const Corners& c : ids)
        for (const int i : c)
            if (i >= 0) number[i] = 1;
    int last = 0;
    for (int& n : number)
        if (n > 0) n = ++last;
    return number;
}

// Of each part, whether it makes a surface only with others, along edges that it shares with them.
std::vector<char> parts_of_one_surface(const TriMesh& mesh) {
    std::vector<char> joined(std::max<std::size_t>(1, mesh.part_name.size()), 0);
    if (mesh.triangle_part.empty() || joined.size() < 2) return joined;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        const auto part_of = [&](const EdgeUse& use) { return mesh.triangle_part[use.triangle]; };
        const int first = part_of(uses[0]);
        const auto is_other = [&](const EdgeUse& use) { return part_of(use) != first; };
        if (std::none_of(uses.begin(), uses.end(), is_other)) return;
        std::map<int, int> open;
        for (const EdgeUse& use : uses) open[part_of(use)] += use.forward ? 1 : -1;
        for (const auto& [part, sum] : open) joined.at(part) |= sum != 0;
    });
    return joined;
}

// Each object's polygons together, and in it each part's, the parts of one surface before all
// others: a reader that knows no objects yet (`o`) takes their groups (`g`) for one.
std::vector<std::size_t> in_order_of_parts(const TriMesh& mesh, const MeshObjects& objects,
                                           const PolygonCorners& polygons,
                                           const std::vector<char>& joined) {
    std::vector<std::size_t> order(polygons.count());
    std::iota(order.begin(), order.end(), 0);
    const auto value_of = [&](const std::vector<int>& of_triangle, std::size_t p) {
        return of_triangle.empty() ? 0 : of_triangle[polygons.corner[polygons.first[p]] / 3];
    };
    const auto part_of = [&](std::size_t p) { return value_of(mesh.triangle_part, p); };
    std::vector<int> place(joined.size(), -1);
    int next = 1;
    for (const std::size_t p : order)
        if (int& at = place.at(part_of(p)); at < 0) at = joined[part_of(p)] ? 0 : next++;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) {
        const int p_object = value_of(objects.triangle, p),
                  q_object = value_of(objects.triangle, q);
        return p_object != q_object ? p_object < q_object : place[part_of(p)] < place[part_of(q)];
    });
    return order;
}

}  // namespace

fs::path library_of(const fs::path& obj) {
    const fs::path own = fs::path(obj).replace_extension(".mtl");
    return own.parent_path() / plain_name(own.filename().string(), "material");
}

void write_obj(const fs::path& file, const TriMesh& mesh, const MeshObjects& objects,
               LibraryPlace place) {
    check_indices(file, mesh);
    const PolygonCorners polygons = rejoin_polygons(mesh);
    const bool has_uv = !mesh.triangle_uv.empty(), has_normal = !mesh.triangle_smooth.empty();
    Text text(64 * mesh.position.size() + 24 * mesh.uv.size() + 28 * mesh.smooth_group_count +
              10 * polygons.corner.size() * (1 + has_uv + has_normal) + 4096);

    FilesBeside beside;
    std::vector<std::string> material_name;
    if (!mesh.material.empty()) {
        for (const SurfaceMaterial& m : mesh.material) material_name.push_back(m.name);
        material_name = unique_names(material_name, "material");
        text.put("mtllib " + write_mtl(file, mesh.material, material_name, place, beside) + "\n");
    }
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
        text.put("v");
        for (int k = 0; k < 3; ++k) text.number(mesh.position[i][k]);
        if (!mesh.position_color.empty())
            for (int k = 0; k < 3; ++k) text.number(shown_color(mesh.position_color[i][k]));
        text.put("\n");
    }
    const std::vector<int> uv_number = numbers_of_used(mesh.triangle_uv, mesh.uv.size());
    const std::vector<int> normal_number =
        numbers_of_used(mesh.triangle_smooth, mesh.smooth_group_count);
    for (std::size_t i = 0; i < mesh.uv.size(); ++i) {
        if (uv_number[i] == 0) continue;
        text.put("vt");
        text.number(mesh.uv[i].x());
        text.number(mesh.uv[i].y());
        text.put("\n");
    }
    if (has_normal) {
        const std::vector<Vec3> normal = smooth_normals(mesh, mesh.position);
        for (std::size_t g = 0; g < normal.size(); ++g) {
            if (normal_number[g] == 0) continue;
            text.put("vn");
            for (int k = 0; k < 3; ++k) text.number(std::round(normal[g][k] * 1e5) / 1e5);
            text.put("\n");
        }
    }

    const std::vector<std::string> part_name = unique_names(mesh.part_name, "part");
    const std::vector<char> joined = parts_of_one_surface(mesh);
    const std::vector<std::string> object_name = unique_names(objects.name, "piece");
    const bool has_objects = !objects.triangle.empty();
    int object = -1, part = -1, material = -1;
    for (const std::size_t p : in_order_of_parts(mesh, objects, polygons, joined)) {
        const int t = polygons.corner[polygons.first[p]] / 3;
        if (has_objects && objects.triangle[t] != object) {
            object = objects.triangle[t];
            part = mesh.part_name.size() > 1 ? -1 : 0;
            text.put("o " + object_name.at(object) + "\n");
        }
        if (!mesh.triangle_part.empty() && mesh.triangle_part[t] != part) {
            part = mesh.triangle_part[t];
            text.put((has_objects || joined[part] ? "g " : "o ") + part_name.at(part) + "\n");
        }
        if (!mesh.triangle_material.empty() && mesh.triangle_material[t] != material) {
            material = mesh.triangle_material[t];
            text.put("usemtl " + material_name.at(material) + "\n");
        }
        text.put("f");
        for (std::size_t i = polygons.first[p]; i < polygons.first[p + 1]; ++i) {
            const int c = polygons.corner[i];
            text.number(' ', mesh.triangle[c / 3][c % 3] + 1);
            const int uv = has_uv ? mesh.triangle_uv[c / 3][c % 3] : -1;
            if (uv >= 0) text.number('/', uv_number[uv]);
            if (has_normal) {
                if (uv < 0) text.put("/");
                text.number('/', normal_number[mesh.triangle_smooth[c / 3][c % 3]]);
            }
        }
        text.put("\n");
    }
    write_file_whole(file, text.bytes());
    beside.stay();
}

}  // namespace swage

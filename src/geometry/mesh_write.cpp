// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh_write.h"

#include <fmt/compile.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_contents.h"
#include "base/srgb.h"
#include "geometry/edges.h"
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

// One word, for readers that end a name at a blank, of a file (MeshLab) as of a material.
std::string plain_name(const std::string& name, const char* otherwise) {
    std::string plain = name.empty() ? otherwise : name;
    for (char& c : plain)
        if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\' || c == '\x7f') c = '_';
    return plain;
}

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

std::string image_ending(std::string_view bytes) {
    if (bytes.starts_with("\x89PNG")) return ".png";
    if (bytes.starts_with("\xff\xd8\xff")) return ".jpg";
    if (bytes.starts_with("BM")) return ".bmp";
    if (bytes.starts_with("GIF8")) return ".gif";
    if (bytes.substr(0, 16).find("WEBP") != std::string_view::npos) return ".webp";
    return ".img";
}

// Returns the name of the library beside `file`: the file's own, but one word.
std::string write_mtl(const fs::path& file, const std::vector<SurfaceMaterial>& material,
                      const std::vector<std::string>& name, FilesBeside& beside) {
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
    const fs::path library = fs::path(file).replace_extension(".mtl");
    const std::string own = library.filename().string(), plain = plain_name(own, "material");
    // Another mesh may be called by that word.
    if (plain != own) return beside.add(file.parent_path(), plain, text);
    beside.write(library, text);
    return own;
}

void check_indices(const fs::path& file, const TriMesh& mesh) {
    const auto check = [&](const std::vector<Corners>& ids, std::size_t count, int least) {
        for (const Corners& c : ids)
            for (const int i : c)
                if (i < least || i >= static_cast<long long>(count))
                    fail(ExitCode::output, "{}: the mesh to be written has bad indices",
                         file.string());
        if (!ids.empty() && ids.size() != mesh.triangle.size())
            fail(ExitCode::output, "{}: the mesh to be written has uneven arrays", file.string());
    };
    check(mesh.triangle, mesh.position.size(), 0);
    check(mesh.triangle_uv, mesh.uv.size(), -1);
    check(mesh.triangle_smooth, static_cast<std::size_t>(mesh.smooth_group_count), 0);
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

double srgb(float linear) { return srgb_from_linear(std::clamp<double>(linear, 0, 1)); }

// Per-vertex texture coordinates, when every place has just one; empty otherwise.
std::vector<Vec2> uv_of_positions(const TriMesh& mesh) {
    if (mesh.triangle_uv.empty()) return {};
    std::vector<int> id(mesh.position.size(), -1);
    for (std::size_t t = 0; t < mesh.triangle_uv.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            int& known = id[mesh.triangle[t][k]];
            const int here = mesh.triangle_uv[t][k];
            if (here < 0 || (known >= 0 && mesh.uv[known] != mesh.uv[here])) return {};
            known = here;
        }
    std::vector<Vec2> uv;
    for (const int i : id) uv.push_back(i < 0 ? Vec2(Vec2::Zero()) : mesh.uv[i]);
    return uv;
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

// Where all corners at a place shade by one normal: that of each place. Empty otherwise, for one of
// several would round a sharp edge off.
std::vector<Vec3> normal_of_positions(const TriMesh& mesh) {
    constexpr double kOneNormal = 0.02;  // [rad]
    if (mesh.triangle_smooth.empty()) return {};
    const std::vector<Vec3> of_group = smooth_normals(mesh, mesh.position);
    std::vector<Vec3> normal(mesh.position.size(), Vec3::Zero());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            Vec3& known = normal[mesh.triangle[t][k]];
            const Vec3& here = of_group[mesh.triangle_smooth[t][k]];
            if (known.isZero()) known = here;
            if ((known - here).norm() > kOneNormal) return {};
        }
    for (Vec3& n : normal)
        if (n.isZero()) n = Vec3::UnitZ();  // no triangle there
    return normal;
}

template <typename T>
void pack(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
}

}  // namespace

FilesBeside::~FilesBeside() {
    std::error_code ignored;
    for (const fs::path& file : made_) fs::remove(file, ignored);
}

void FilesBeside::write(const fs::path& file, const std::string& bytes) {
    std::error_code ignored;
    const bool is_new = !fs::exists(file, ignored);
    write_file_whole(file, bytes);
    if (is_new) made_.push_back(file);
}

std::string FilesBeside::add(const fs::path& folder, const std::string& wanted,
                             const std::string& bytes) {
    std::string name = wanted;
    std::optional<std::string> there;
    for (int n = 2; (there = file_contents(folder / name)) && *there != bytes; ++n) {
        name = fmt::format("{}_{}{}", fs::path(wanted).stem().string(), n,
                           fs::path(wanted).extension().string());
    }
    if (!there) write(folder / name, bytes);
    return name;
}

std::vector<std::string> copy_textures(const fs::path& file,
                                       const std::vector<SurfaceMaterial>& material,
                                       FilesBeside& beside) {
    std::vector<std::string> names;
    for (const SurfaceMaterial& m : material) {
        std::string bytes, wanted;
        if (m.embedded_texture != nullptr) {
            bytes = *m.embedded_texture;
            wanted = plain_name(m.name, "texture") + image_ending(bytes);
            std::replace(wanted.begin(), wanted.end(), '/', '_');
        } else if (!m.texture.empty()) {
            std::optional<std::string> image = file_contents(m.texture);
            if (!image)
                fail(ExitCode::output, "{}: the texture {} cannot be read", file.string(),
                     m.texture.string());
            bytes = std::move(*image);
            wanted = plain_name(m.texture.filename().string(), "texture");
        } else {
            names.emplace_back();
            continue;
        }
        names.push_back(beside.add(file.parent_path(), wanted, bytes));
    }
    return names;
}

void write_obj(const fs::path& file, const TriMesh& mesh, const MeshObjects& objects) {
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
        text.put("mtllib " + write_mtl(file, mesh.material, material_name, beside) + "\n");
    }
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
        text.put("v");
        for (int k = 0; k < 3; ++k) text.number(mesh.position[i][k]);
        if (!mesh.position_color.empty())
            for (int k = 0; k < 3; ++k)
                text.number(std::round(srgb(mesh.position_color[i][k]) * 1e7) / 1e7);
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

void write_ply(const fs::path& file, const TriMesh& mesh, const std::vector<VertexValues>& values) {
    check_indices(file, mesh);
    const PolygonCorners polygons = rejoin_polygons(mesh);
    std::size_t most_corners = 0;
    for (std::size_t p = 0; p < polygons.count(); ++p)
        most_corners = std::max(most_corners, polygons.first[p + 1] - polygons.first[p]);
    const bool wide = 2 * most_corners > 255;  // lists count in a byte when they can
    const std::vector<Vec2> uv = uv_of_positions(mesh);
    const bool corner_uv = uv.empty() && !mesh.triangle_uv.empty();
    const std::vector<Vec3> normal = normal_of_positions(mesh);

    std::string bytes = "ply\nformat binary_little_endian 1.0\n";
    std::vector<int> image_of;  // of each material, -1: none
    int images = 0;
    FilesBeside beside;
    for (const std::string& image : copy_textures(file, mesh.material, beside)) {
        image_of.push_back(image.empty() ? -1 : images++);
        if (!image.empty()) bytes += "comment TextureFile " + image + "\n";
    }
    const auto has_uv = [&](std::size_t polygon) {
        bool all = true;
        for (std::size_t i = polygons.first[polygon]; i < polygons.first[polygon + 1]; ++i) {
            const int corner = polygons.corner[i];
            all = all && mesh.triangle_uv[corner / 3][corner % 3] >= 0;
        }
        return all;
    };
    // What has no coordinates among those that do has no place in an image.
    std::vector<int> face_image(polygons.count(), -1);
    for (std::size_t p = 0; p < polygons.count() && images > 0; ++p) {
        if (corner_uv && !has_uv(p)) continue;
        const int t = polygons.corner[polygons.first[p]] / 3;
        face_image[p] = image_of[mesh.triangle_material.empty() ? 0 : mesh.triangle_material[t]];
    }
    const bool chosen =
        images > 1 || (images == 1 && std::count(face_image.begin(), face_image.end(), -1) > 0);
    for (const VertexValues& one : values) {
        if (one.value->size() != mesh.position.size())
            fail(ExitCode::output, "{}: {} values of {} for {} vertices", file.string(),
                 one.value->size(), one.name, mesh.position.size());
        if (!one.comment.empty()) bytes += "comment " + one.comment + "\n";
    }
    bytes +=
        fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
                    mesh.position.size());
    if (!normal.empty()) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
    // Not `double`, which MeshLab passes over.
    if (!uv.empty()) bytes += "property float s\nproperty float t\n";
    if (!mesh.position_color.empty())
        bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    for (const VertexValues& one : values) bytes += "property float " + one.name + "\n";
    const char* count_type = wide ? "uint" : "uchar";
    bytes += fmt::format("element face {}\nproperty list {} int vertex_indices\n", polygons.count(),
                         count_type);
    // A whole file of polygons with `float` there MeshLab refuses.
    const bool single = most_corners <= 3;
    if (corner_uv)
        bytes +=
            fmt::format("property list {} {} texcoord\n", count_type, single ? "float" : "double");
    if (chosen) bytes += "property int texnumber\n";
    bytes += "end_header\n";

    bytes.reserve(bytes.size() + (47 + 4 * values.size()) * mesh.position.size() +
                  8 * polygons.count() + (corner_uv ? 20 : 4) * polygons.corner.size());
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
        for (int k = 0; k < 3; ++k) pack(bytes, mesh.position[i][k]);
        for (int k = 0; k < 3 && !normal.empty(); ++k)
            pack(bytes, static_cast<float>(normal[i][k]));
        for (int k = 0; k < 2 && !uv.empty(); ++k) pack(bytes, static_cast<float>(uv[i][k]));
        if (!mesh.position_color.empty())
            for (int k = 0; k < 3; ++k)
                pack(bytes,
                     static_cast<std::uint8_t>(std::lround(255 * srgb(mesh.position_color[i][k]))));
        for (const VertexValues& one : values) pack(bytes, (*one.value)[i]);
    }
    const auto put_count = [&](std::size_t count) {
        if (wide)
            pack(bytes, static_cast<std::uint32_t>(count));
        else
            pack(bytes, static_cast<std::uint8_t>(count));
    };
    for (std::size_t p = 0; p < polygons.count(); ++p) {
        const std::size_t begin = polygons.first[p], end = polygons.first[p + 1];
        put_count(end - begin);
        for (std::size_t i = begin; i < end; ++i)
            pack(bytes, static_cast<std::int32_t>(
                            mesh.triangle[polygons.corner[i] / 3][polygons.corner[i] % 3]));
        if (corner_uv) {
            const bool given = has_uv(p);
            put_count(given ? 2 * (end - begin) : 0);
            for (std::size_t i = begin; i < end && given; ++i) {
                const Vec2& at =
                    mesh.uv[mesh.triangle_uv[polygons.corner[i] / 3][polygons.corner[i] % 3]];
                for (int k = 0; k < 2; ++k) {
                    if (single)
                        pack(bytes, static_cast<float>(at[k]));
                    else
                        pack(bytes, at[k]);
                }
            }
        }
        if (chosen) pack(bytes, std::int32_t{face_image[p]});
    }
    write_file_whole(file, bytes);
    beside.stay();
}

}  // namespace swage

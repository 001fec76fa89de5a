// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/srgb.h"
#include "geometry/files_beside.h"
#include "geometry/mesh_write.h"
#include "geometry/polygon.h"
#include "geometry/shown_color.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

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

// What of the mesh goes into the file, and its bytes.
class PlyFile {
  public:
    PlyFile(const TriMesh& mesh, const std::vector<VertexValues>& values,
            const std::vector<std::string>& image_of_material)
        : mesh_(mesh),
          values_(values),
          polygons_(rejoin_polygons(mesh)),
          uv_(uv_of_positions(mesh)),
          normal_(normal_of_positions(mesh)),
          corner_uv_(uv_.empty() && !mesh.triangle_uv.empty()) {
        for (std::size_t p = 0; p < polygons_.count(); ++p)
            most_corners_ = std::max(most_corners_, polygons_.first[p + 1] - polygons_.first[p]);
        number_images(image_of_material);
        if (!mesh.position_color.empty()) color_vertices();
    }

    std::string bytes() {
        put_header();
        bytes_.reserve(bytes_.size() + (47 + 4 * values_.size()) * mesh_.position.size() +
                       8 * polygons_.count() + (corner_uv_ ? 20 : 4) * polygons_.corner.size());
        for (std::size_t i = 0; i < mesh_.position.size(); ++i) put_vertex(i);
        for (std::size_t p = 0; p < polygons_.count(); ++p) put_face(p);
        return std::move(bytes_);
    }

  private:
    void number_images(const std::vector<std::string>& image_of_material) {
        std::vector<int> number;  // of each material's, -1: none
        for (const std::string& image : image_of_material) {
            number.push_back(image.empty() ? -1 : static_cast<int>(image_.size()));
            if (!image.empty()) image_.push_back(image);
        }
        // What has no coordinates among those that do has no place in an image.
        face_image_.assign(polygons_.count(), -1);
        for (std::size_t p = 0; p < polygons_.count() && !image_.empty(); ++p) {
            if (corner_uv_ && !has_uv(p)) continue;
            const int t = polygons_.corner[polygons_.first[p]] / 3;
            face_image_[p] =
                number[mesh_.triangle_material.empty() ? 0 : mesh_.triangle_material[t]];
        }
        const bool some_have_none =
            std::find(face_image_.begin(), face_image_.end(), -1) != face_image_.end();
        images_differ_ = image_.size() > 1 || (image_.size() == 1 && some_have_none);
    }

    // Each as it is drawn, but for what readers, swage among them, make of it: they have no
    // material but that of an image, which is white, and the default one. Where several meet, it is
    // that of the first which takes colours; where none does, as inside of a cut face, their own.
    void color_vertices() {
        const Eigen::Array3f plain = SurfaceMaterial().color.cast<float>();
        enum : char { none, own, taken };
        std::vector<char> from(mesh_.position.size(), none);
        color_ = mesh_.position_color;
        for (std::size_t i = 0, p = 0; i < polygons_.corner.size(); ++i) {
            if (i == polygons_.first[p + 1]) ++p;
            const std::size_t t = std::size_t(polygons_.corner[i] / 3);
            const int v = mesh_.triangle[t][polygons_.corner[i] % 3];
            const char here = material_of(mesh_, t).takes_colors ? taken : own;
            if (from[v] >= here) continue;
            from[v] = here;
            color_[v] = shown_color(mesh_, t, v);
            if (face_image_[p] < 0) color_[v].array() /= plain;
        }
    }

    bool has_uv(std::size_t polygon) const {
        return std::all_of(polygons_.corner.begin() + polygons_.first[polygon],
                           polygons_.corner.begin() + polygons_.first[polygon + 1],
                           [&](int c) { return mesh_.triangle_uv[c / 3][c % 3] >= 0; });
    }

    // Lists count in a byte when they can.
    bool is_wide() const { return 2 * most_corners_ > 255; }
    // A whole file of polygons with `float` coordinates MeshLab refuses.
    bool has_single_uv() const { return most_corners_ <= 3; }

    void put_header() {
        bytes_ = "ply\nformat binary_little_endian 1.0\n";
        for (const std::string& image : image_) bytes_ += "comment TextureFile " + image + "\n";
        for (const VertexValues& one : values_)
            if (!one.comment.empty()) bytes_ += "comment " + one.comment + "\n";
        bytes_ += fmt::format("element vertex {}\n", mesh_.position.size());
        bytes_ += "property double x\nproperty double y\nproperty double z\n";
        if (!normal_.empty()) bytes_ += "property float nx\nproperty float ny\nproperty float nz\n";
        // Not `double`, which MeshLab passes over.
        if (!uv_.empty()) bytes_ += "property float s\nproperty float t\n";
        if (!mesh_.position_color.empty())
            bytes_ += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        for (const VertexValues& one : values_) bytes_ += "property float " + one.name + "\n";
        const char* count = is_wide() ? "uint" : "uchar";
        bytes_ += fmt::format("element face {}\nproperty list {} int vertex_indices\n",
                              polygons_.count(), count);
        if (corner_uv_)
            bytes_ += fmt::format("property list {} {} texcoord\n", count,
                                  has_single_uv() ? "float" : "double");
        if (images_differ_) bytes_ += "property int texnumber\n";
        bytes_ += "end_header\n";
    }

    void put_vertex(std::size_t i) {
        for (int k = 0; k < 3; ++k) pack(bytes_, mesh_.position[i][k]);
        for (int k = 0; k < 3 && !normal_.empty(); ++k)
            pack(bytes_, static_cast<float>(normal_[i][k]));
        for (int k = 0; k < 2 && !uv_.empty(); ++k) pack(bytes_, static_cast<float>(uv_[i][k]));
        for (int k = 0; k < 3 && !color_.empty(); ++k) {
            const double linear = std::clamp<double>(color_[i][k], 0, 1);
            pack(bytes_, static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(linear))));
        }
        for (const VertexValues& one : values_) pack(bytes_, (*one.value)[i]);
    }

    void put_face(std::size_t p) {
        const std::size_t begin = polygons_.first[p], end = polygons_.first[p + 1];
        put_count(end - begin);
        for (std::size_t i = begin; i < end; ++i) {
            const int c = polygons_.corner[i];
            pack(bytes_, std::int32_t{mesh_.triangle[c / 3][c % 3]});
        }
        if (corner_uv_) {
            const bool given = has_uv(p);
            put_count(given ? 2 * (end - begin) : 0);
            for (std::size_t i = begin; i < end && given; ++i) put_uv(polygons_.corner[i]);
        }
        if (images_differ_) pack(bytes_, std::int32_t{face_image_[p]});
    }

    void put_count(std::size_t count) {
        if (is_wide())
            pack(bytes_, static_cast<std::uint32_t>(count));
        else
            pack(bytes_, static_cast<std::uint8_t>(count));
    }

    void put_uv(int corner) {
        const Vec2& at = mesh_.uv[mesh_.triangle_uv[corner / 3][corner % 3]];
        for (int k = 0; k < 2; ++k) {
            if (has_single_uv())
                pack(bytes_, static_cast<float>(at[k]));
            else
                pack(bytes_, at[k]);
        }
    }

    const TriMesh& mesh_;
    const std::vector<VertexValues>& values_;
    const PolygonCorners polygons_;
    const std::vector<Vec2> uv_;      // of each vertex; empty: none, or those of corners
    const std::vector<Vec3> normal_;  // likewise
    std::vector<Eigen::Vector3f> color_;
    const bool corner_uv_;
    std::size_t most_corners_ = 0;
    std::vector<std::string> image_;
    std::vector<int> face_image_;  // of each polygon, -1: none
    bool images_differ_ = false;
    std::string bytes_;
};

}  // namespace

void write_ply(const fs::path& file, const TriMesh& mesh, const std::vector<VertexValues>& values) {
    check_indices(file, mesh);
    for (const VertexValues& one : values)
        if (one.value->size() != mesh.position.size())
            fail(ExitCode::output, "{}: {} values of {} for {} vertices", file.string(),
                 one.value->size(), one.name, mesh.position.size());
    FilesBeside beside;
    const std::vector<std::string> image = copy_textures(file, mesh.material, beside);
    write_file_whole(file, PlyFile(mesh, values, image).bytes());
    beside.stay();
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/glb_skin.h"

#include <algorithm>
#include <map>

#include "geometry/edges.h"
#include "pipeline/json.h"

namespace swage {

namespace {

std::vector<int> looks_of_triangles(const TriMesh& mesh, MeshLooks& looks) {
    PolygonCorners triangles;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int side = 0; side < 3; ++side) {
            triangles.corner.push_back(static_cast<int>(3 * t) + side);
        }
        triangles.first.push_back(triangles.corner.size());
    }
    std::vector<int> look = looks.of_polygons(mesh, triangles);
    for (int& own : look) {
        if (own < 0) own = looks.of_plain({}, !mesh.position_color.empty());
    }
    return look;
}

}  // namespace

GlbSurface::GlbSurface(const TriMesh& mesh, MeshLooks& looks)
    : GlbSurface(mesh, looks_of_triangles(mesh, looks)) {}

GlbSurface::GlbSurface(TriMesh mesh, const std::vector<int>& look)
    : mesh_(std::move(mesh)),
      has_normals_(mesh_.triangle_smooth.size() == mesh_.triangle.size()),
      is_closed_(swage::is_closed(mesh_)) {
    std::map<Vertex, std::uint32_t> number;
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
        const auto own = std::size_t(look[t]);
        corner_.resize(std::max(corner_.size(), own + 1));
        for (std::size_t c = 0; c < 3; ++c) {
            const Vertex vertex = {mesh_.triangle[t][c],
                                   has_normals_ ? mesh_.triangle_smooth[t][c] : -1,
                                   mesh_.triangle_uv.empty() ? -1 : mesh_.triangle_uv[t][c]};
            const auto [at, is_new] =
                number.try_emplace(vertex, static_cast<std::uint32_t>(vertex_.size()));
            if (is_new) vertex_.push_back(vertex);
            corner_[own].push_back(at->second);
        }
    }
}

std::vector<Vec3> GlbSurface::places(const std::vector<Vec3>& position) const {
    std::vector<Vec3> all;
    all.reserve(count());
    for (const Vertex& v : vertex_) all.push_back(position[std::size_t(v.position)]);
    return all;
}

std::vector<Vec3> GlbSurface::normals(const std::vector<Vec3>& position) const {
    const std::vector<Vec3> of_group = smooth_normals(mesh_, position);
    std::vector<Vec3> all;
    all.reserve(count());
    for (const Vertex& v : vertex_) {
        const Vec3& normal = of_group[std::size_t(v.smooth)];
        all.push_back(normal.norm() > 0.5 ? normal.normalized() : Vec3::UnitY());
    }
    return all;
}

Json GlbSurface::primitives(GlbFile& file, const Json& attributes, const MeshLooks& looks) const {
    Json with_uv = attributes;
    if (!mesh_.triangle_uv.empty()) {
        std::vector<float> uv;
        for (const Vertex& v : vertex_) {  // downward there
            const Vec2 at = v.uv < 0 ? Vec2(0, 0) : mesh_.uv[std::size_t(v.uv)];
            uv.push_back(static_cast<float>(at.x()));
            uv.push_back(static_cast<float>(1 - at.y()));
        }
        with_uv["TEXCOORD_0"] = file.add_numbers(uv, 2, GlbFile::Use::vertices);
    }
    int colors = -1;
    const auto color_accessor = [&] {
        if (colors >= 0) return colors;
        std::vector<float> color;
        for (const Vertex& v : vertex_) {
            for (float c : mesh_.position_color[std::size_t(v.position)]) color.push_back(c);
        }
        return colors = file.add_numbers(color, 3, GlbFile::Use::vertices);
    };
    Json all = Json::array();
    for (std::size_t look = 0; look < corner_.size(); ++look) {
        if (corner_[look].empty()) continue;
        Json own = with_uv;
        if (looks.all()[look].reads_colors) own["COLOR_0"] = color_accessor();
        all.push_back({{"attributes", std::move(own)},
                       {"indices", file.add_indices(corner_[look])},
                       {"material", look}});
    }
    return all;
}

GlbBounds bounds_of(const std::vector<Vec3>& places) {
    Box box;
    for (const Vec3& p : places) box.grow(p.cast<float>().cast<double>());
    GlbBounds bounds;
    for (int axis = 0; axis < 3; ++axis) {
        bounds.low.push_back(static_cast<float>(box.low[axis]));
        bounds.high.push_back(static_cast<float>(box.high[axis]));
    }
    return bounds;
}

std::vector<Vec3> in_floats(const std::vector<Vec3>& from) {
    std::vector<Vec3> all;
    all.reserve(from.size());
    for (const Vec3& p : from) all.push_back(p.cast<float>().cast<double>());
    return all;
}

std::vector<Vec3> way(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
    std::vector<Vec3> all;
    all.reserve(from.size());
    for (std::size_t n = 0; n < from.size(); ++n) all.push_back(to[n] - from[n]);
    return all;
}

std::string glb_bytes(const std::vector<Vec3>& vectors) {
    std::vector<float> numbers;
    numbers.reserve(3 * vectors.size());
    for (const Vec3& v : vectors) {
        for (double c : v) numbers.push_back(static_cast<float>(c));
    }
    return glb_bytes(std::span<const float>(numbers));
}

}  // namespace swage

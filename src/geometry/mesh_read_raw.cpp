// SPDX-License-Identifier: GPL-3.0-or-later
// The plain arrays that cross the pipe between the reading process and its parent.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "geometry/mesh_read_child.h"
#include "geometry/polygon.h"

namespace swage {

namespace {

constexpr std::uint64_t kMagic = 0x3168'7365'6d77'7301;
constexpr double kLargest = 1e9;    // [m], coordinates
constexpr double kSmallest = 1e-9;  // [m], the box's diagonal

// One list of fields for both directions.
template <typename Mesh, typename F>
void each_field(Mesh& mesh, const F& f) {
    f(mesh.position);
    f(mesh.color);
    f(mesh.uv);
    f(mesh.normal);
    f(mesh.triangle);
    f(mesh.triangle_uv);
    f(mesh.triangle_normal);
    f(mesh.polygon);
    f(mesh.triangle_material);
    f(mesh.triangle_part);
    f(mesh.triangle_smooth);
    f(mesh.part_name);
    f(mesh.finding);
    f(mesh.at_vertices);
    f(mesh.material);
}

struct Packer {
    std::string& bytes;

    void raw(const void* data, std::size_t size) const {
        bytes.append(static_cast<const char*>(data), size);
    }
    void operator()(int value) const { raw(&value, sizeof value); }
    void operator()(double value) const { raw(&value, sizeof value); }
    void operator()(const std::string& text) const {
        count(text.size());
        raw(text.data(), text.size());
    }
    void operator()(const Vec3& v) const { raw(v.data(), sizeof v); }
    void operator()(const RawMaterial& m) const {
        (*this)(m.name);
        (*this)(m.color);
        (*this)(m.roughness);
        (*this)(m.metallic);
        (*this)(m.texture);
        (*this)(m.texture_bytes);
    }
    template <typename T>
    void operator()(const std::vector<T>& values) const {
        count(values.size());
        if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, RawMaterial>) {
            for (const T& value : values) (*this)(value);
        } else if (!values.empty()) {
            raw(values.data(), values.size() * sizeof(T));
        }
    }
    void count(std::uint64_t n) const { raw(&n, sizeof n); }
};

struct Unpacker {
    std::string_view& bytes;

    void raw(void* data, std::size_t size) const {
        if (size > bytes.size())
            fail(ExitCode::mesh, "the reading process sent an incomplete mesh");
        if (size > 0) std::memcpy(data, bytes.data(), size);
        bytes.remove_prefix(size);
    }
    void operator()(int& value) const { raw(&value, sizeof value); }
    void operator()(double& value) const { raw(&value, sizeof value); }
    void operator()(std::string& text) const {
        text.resize(count(1));
        raw(text.data(), text.size());
    }
    void operator()(Vec3& v) const { raw(v.data(), sizeof v); }
    void operator()(RawMaterial& m) const {
        (*this)(m.name);
        (*this)(m.color);
        (*this)(m.roughness);
        (*this)(m.metallic);
        (*this)(m.texture);
        (*this)(m.texture_bytes);
    }
    template <typename T>
    void operator()(std::vector<T>& values) const {
        if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, RawMaterial>) {
            values.resize(count(sizeof(std::uint64_t)));
            for (T& value : values) (*this)(value);
        } else {
            values.resize(count(sizeof(T)));
            raw(values.data(), values.size() * sizeof(T));
        }
    }
    std::size_t count(std::size_t item_bytes) const {
        std::uint64_t n = 0;
        raw(&n, sizeof n);
        if (n > bytes.size() / item_bytes)
            fail(ExitCode::mesh, "the reading process sent an incomplete mesh");
        return n;
    }
};

void check_indices(const std::vector<Corners>& corners, std::size_t count, int least,
                   const char* what) {
    for (const Corners& c : corners)
        for (const int i : c)
            if (i < least || i >= static_cast<long long>(count))
                fail(ExitCode::mesh, "{} {} of {} does not exist", what, i, count);
}

void check_ids(const std::vector<int>& ids, std::size_t triangles, std::size_t count,
               const char* what) {
    if (ids.empty()) return;
    if (ids.size() != triangles) fail(ExitCode::mesh, "one {} a triangle was expected", what);
    for (const int i : ids)
        if (i < 0 || i >= static_cast<long long>(count))
            fail(ExitCode::mesh, "{} {} of {} does not exist", what, i, count);
}

}  // namespace

void add_polygons(const PolygonList& polygons, RawMesh& mesh) {
    const auto where = [&](std::size_t p) {
        return polygons.line[p] > 0 ? fmt::format("line {}", polygons.line[p])
                                    : fmt::format("face {}", p);
    };
    const auto check = [&](std::size_t p, int index, std::size_t count, const char* what) {
        if (index >= static_cast<long long>(count))
            fail(ExitCode::mesh, "{}: {} {} is used, there are only {}", where(p), what,
                 static_cast<long long>(index) + 1, count);
    };
    const auto any = [](const std::vector<int>& ids) {
        return std::any_of(ids.begin(), ids.end(), [](int i) { return i >= 0; });
    };
    const bool has_uv = any(polygons.uv), has_normal = any(polygons.normal);
    const bool has_material = any(polygons.material), has_part = any(polygons.part);
    const bool has_smooth = !polygons.smooth.empty();
    std::size_t thin = 0, crossed = 0;
    std::vector<int> corner;
    std::vector<Vec3> place;
    std::vector<Corners> cut;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        corner.clear();
        place.clear();
        cut.clear();
        for (int c = polygons.first[p]; c < polygons.first[p + 1]; ++c) {
            check(p, polygons.position[c], mesh.position.size(), "vertex");
            check(p, polygons.uv[c], mesh.uv.size(), "texture coordinate");
            check(p, polygons.normal[c], mesh.normal.size(), "normal");
            if (!corner.empty() && polygons.position[corner.back()] == polygons.position[c])
                continue;
            corner.push_back(c);
        }
        while (corner.size() > 1 &&
               polygons.position[corner.front()] == polygons.position[corner.back()])
            corner.pop_back();
        if (corner.size() < 3) {
            ++thin;
            continue;
        }
        for (const int c : corner) place.push_back(mesh.position[polygons.position[c]]);
        if (!cut_polygon(place, cut)) ++crossed;
        for (const Corners& t : cut) {
            const auto pick = [&](const std::vector<int>& ids) {
                return Corners{ids[corner[t[0]]], ids[corner[t[1]]], ids[corner[t[2]]]};
            };
            mesh.triangle.push_back(pick(polygons.position));
            if (has_uv) mesh.triangle_uv.push_back(pick(polygons.uv));
            if (has_normal) mesh.triangle_normal.push_back(pick(polygons.normal));
            mesh.polygon.push_back(static_cast<int>(p));
            if (has_material) mesh.triangle_material.push_back(polygons.material[p]);
            if (has_part) mesh.triangle_part.push_back(polygons.part[p]);
            if (has_smooth) mesh.triangle_smooth.push_back(polygons.smooth[p]);
        }
    }
    if (thin > 0)
        mesh.finding.push_back(
            fmt::format("{} faces of fewer than three different corners were left out", thin));
    if (crossed > 0)
        mesh.finding.push_back(fmt::format(
            "{} polygons cross themselves; they were cut into triangles as well as may be",
            crossed));
}

std::string to_bytes(const RawMesh& mesh) {
    std::string bytes;
    const Packer pack{bytes};
    pack.count(kMagic);
    each_field(mesh, pack);
    return bytes;
}

RawMesh from_bytes(std::string_view bytes) {
    RawMesh mesh;
    const Unpacker unpack{bytes};
    std::uint64_t magic = 0;
    unpack.raw(&magic, sizeof magic);
    if (magic != kMagic) fail(ExitCode::mesh, "the reading process sent no mesh");
    each_field(mesh, unpack);
    return mesh;
}

void check_raw(const RawMesh& mesh) {
    const std::size_t count = mesh.triangle.size();
    if (count == 0) fail(ExitCode::mesh, "no triangles");
    constexpr std::size_t kMost = 0x7fffffff / 3;  // ids of corners are ints
    if (count > kMost || mesh.position.size() > kMost)
        fail(ExitCode::mesh, "{} vertices and {} triangles are more than can be handled",
             mesh.position.size(), count);
    check_indices(mesh.triangle, mesh.position.size(), 0, "vertex");
    check_indices(mesh.triangle_uv, mesh.uv.size(), -1, "texture coordinate");
    check_indices(mesh.triangle_normal, mesh.normal.size(), -1, "normal");
    for (const std::size_t n : {mesh.triangle_uv.size(), mesh.triangle_normal.size()})
        if (n != 0 && n != count) fail(ExitCode::mesh, "attributes do not fit the triangles");
    if (!mesh.color.empty() && mesh.color.size() != mesh.position.size())
        fail(ExitCode::mesh, "vertex colours do not fit the vertices");
    if (!mesh.triangle_smooth.empty() && mesh.triangle_smooth.size() != count)
        fail(ExitCode::mesh, "smoothing does not fit the triangles");
    if (mesh.polygon.size() != count) fail(ExitCode::mesh, "polygons do not fit the triangles");
    check_ids(mesh.triangle_material, count, mesh.material.size(), "material");
    check_ids(mesh.triangle_part, count, mesh.part_name.size(), "part");

    Box box;  // of what is used: a stray vertex does no harm
    for (const Corners& t : mesh.triangle)
        for (const int i : t) {
            const Vec3& p = mesh.position[i];
            if (!p.allFinite())
                fail(ExitCode::mesh, "vertex {} has coordinates that are not finite", i);
            box.grow(p);
        }
    const double largest = std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
    if (largest > kLargest)
        fail(ExitCode::mesh, "a coordinate of {:g} m is beyond all sense", largest);
    if (box.size().norm() < kSmallest)
        fail(ExitCode::mesh, "the whole mesh is only {:g} m large", box.size().norm());
    // Of normals only those that are numbers count.
    for (const Vec2& t : mesh.uv)
        if (!t.allFinite()) fail(ExitCode::mesh, "a texture coordinate is not finite");
    for (const auto& c : mesh.color)
        if (!c.allFinite()) fail(ExitCode::mesh, "a vertex colour is not finite");
    for (const auto& m : mesh.material)
        if (!m.color.allFinite() || !std::isfinite(m.roughness) || !std::isfinite(m.metallic))
            fail(ExitCode::mesh, "the material '{}' has values that are not finite", m.name);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// From the arrays of a file to the mesh the program works on: equal positions become one, what may
// jump across an edge stays with the corners.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/srgb.h"
#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"
#include "geometry/mesh_read_child.h"

namespace swage {

namespace {

// Gives equal keys equal numbers, in the order of their first appearance. An open-addressed table;
// its order never shows in the result.
template <typename Key>
std::vector<int> number_equal(const std::vector<Key>& key, int& count) {
    std::vector<int> table(std::bit_ceil(2 * key.size() + 2), -1);
    std::vector<int> number(key.size());
    count = 0;
    const auto hash = [](const Key& k) {
        std::uint64_t h = 0x9e3779b97f4a7c15;
        for (const auto value : k) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof value);
            h = (h ^ bits) * 0xff51afd7ed558ccd;
            h ^= h >> 32;
        }
        return h;
    };
    for (std::size_t i = 0; i < key.size(); ++i) {
        std::size_t slot = hash(key[i]) & (table.size() - 1);
        while (table[slot] >= 0 && key[table[slot]] != key[i])
            slot = (slot + 1) & (table.size() - 1);
        if (table[slot] < 0) {
            table[slot] = static_cast<int>(i);
            number[i] = count++;
        } else {
            number[i] = number[table[slot]];
        }
    }
    return number;
}

constexpr double kSameNormal = 2e-4;  // apart at most: files round to four places
constexpr double kOwnNormal = 1e-3;   // apart at least, from what the faces tell: about 0.06 deg
constexpr double kMostTurnedAway = 0.25;  // of the corners of a surface, or its normals are junk

// Of the corners of a triangle; false where one has none, or zero, or no number.
bool take_normals(const RawMesh& raw, std::size_t t, std::array<Vec3, 3>& normal) {
    for (int k = 0; k < 3; ++k) {
        const int n = raw.triangle_normal[t][k];
        if (n < 0) return false;
        normal[k] = raw.normal[n].cast<double>().stableNormalized();
        if (!(normal[k].squaredNorm() > 0.5)) return false;
    }
    return true;
}

// Across an edge normals may differ by rounding, and have fallen to either side of a step of it.
void unite_by_normals(TriMesh& mesh, const std::vector<Vec3>& normal) {
    DisjointSets sets(normal.size());
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        for (std::size_t i = 1; i < uses.size(); ++i)
            for (const bool low : {true, false}) {
                const auto group_of = [&](const EdgeUse& use) {
                    const int k = use.forward == low ? use.side : (use.side + 1) % 3;
                    return mesh.triangle_smooth[use.triangle][k];
                };
                const int a = group_of(uses[i - 1]), b = group_of(uses[i]);
                if (a != b && !normal[a].isZero() && (normal[a] - normal[b]).norm() < kSameNormal)
                    sets.unite(a, b);
            }
    });
    std::vector<int> group;
    mesh.smooth_group_count = sets.number_sets(group);
    for (Corners& c : mesh.triangle_smooth)
        for (int& g : c) g = group[g];
}

// What a file's normals are (one a group, zero for none) stays, unless it is what the faces tell
// anyhow. None that looks into its faces, and none of a surface of which many do.
void keep_own_normals(TriMesh& mesh, const std::vector<Vec3>& given) {
    const std::vector<Vec3> made = smooth_normals(mesh, mesh.position);
    const Components surface = surface_components(mesh);
    std::vector<std::size_t> corners(surface.count, 0), away(surface.count, 0);
    const auto each_corner = [&](const auto& act) {
        for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
            for (const int g : mesh.triangle_smooth[t])
                if (given[g] != Vec3::Zero()) act(g, surface.triangle_component[t]);
    };
    each_corner([&](int g, int s) {
        ++corners[s];
        away[s] += given[g].dot(made[g]) <= 0;
    });
    std::vector<Vec3> own(given.size(), Vec3::Zero());
    bool any = false;
    each_corner([&](int g, int s) {
        if (given[g].dot(made[g]) <= 0 ||
            static_cast<double>(away[s]) > kMostTurnedAway * static_cast<double>(corners[s]))
            return;
        own[g] = given[g];
        any = any || (given[g] - made[g]).norm() > kOwnNormal;
    });
    if (any) mesh.smooth_normal = std::move(own);
}

// Corners at one place whose normals agree share a group. Triangles without normals have it as they
// would in a file that gives none.
void smooth(const RawMesh& raw, double crease_angle, TriMesh& mesh) {
    const std::size_t count = raw.triangle_normal.size();
    std::vector<std::array<Vec3, 3>> normal(count);
    std::vector<char> has_normals(mesh.triangle.size(), 0);
    for (std::size_t t = 0; t < count; ++t) has_normals[t] = take_normals(raw, t, normal[t]);
    const auto with = std::count(has_normals.begin(), has_normals.end(), 1);
    if (with < static_cast<std::ptrdiff_t>(mesh.triangle.size())) {
        if (raw.triangle_smooth.empty()) {
            smooth_by_crease_angle(mesh, crease_angle);
        } else {
            smooth_by_face_groups(mesh, raw.triangle_smooth);
        }
    }
    if (with == 0) return;
    std::vector<std::array<int, 4>> key;
    key.reserve(3 * mesh.triangle.size());
    mesh.triangle_smooth.resize(mesh.triangle.size());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            if (!has_normals[t]) {
                key.push_back({-1, mesh.triangle_smooth[t][k], 0, 0});
                continue;
            }
            const auto step = [&](int axis) {
                return static_cast<int>(std::lround(normal[t][k][axis] * 1000));
            };
            key.push_back({mesh.triangle[t][k], step(0), step(1), step(2)});
        }
    const std::vector<int> group = number_equal(key, mesh.smooth_group_count);
    std::vector<Vec3> given(mesh.smooth_group_count, Vec3::Zero());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        mesh.triangle_smooth[t] = {group[3 * t], group[3 * t + 1], group[3 * t + 2]};
        for (int k = 0; k < 3 && has_normals[t]; ++k) given[group[3 * t + k]] = normal[t][k];
    }
    unite_by_normals(mesh, given);
    given.assign(mesh.smooth_group_count, Vec3::Zero());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3 && has_normals[t]; ++k)
            given[mesh.triangle_smooth[t][k]] += normal[t][k];
    for (Vec3& n : given) n = n.stableNormalized();
    keep_own_normals(mesh, given);
}

// Texture coordinates of split vertices: corners at one place with equal values share an entry.
void weld_uv(TriMesh& mesh) {
    std::vector<std::array<double, 3>> key;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.triangle_uv[t][k];
            if (i >= 0)
                key.push_back({static_cast<double>(mesh.triangle[t][k]), mesh.uv[i].x() + 0.0,
                               mesh.uv[i].y() + 0.0});
        }
    int count = 0;
    const std::vector<int> number = number_equal(key, count);
    mesh.uv.resize(count);
    for (std::size_t i = 0; i < key.size(); ++i) mesh.uv[number[i]] = {key[i][1], key[i][2]};
    std::size_t next = 0;
    for (Corners& corners : mesh.triangle_uv)
        for (int& i : corners)
            if (i >= 0) i = number[next++];
}

// Where faces of different colours meet, no colour of a place can be right for all: each colour
// becomes a material. False where colours change within faces, or there are too many of them.
bool paint_by_faces(RawMesh& raw) {
    constexpr int kMostPaints = 256;
    const std::size_t count = raw.triangle.size();
    std::vector<std::array<double, 4>> key(count);
    for (std::size_t t = 0; t < count; ++t) {
        const auto& corner = raw.triangle[t];
        const Eigen::Vector3f& color = raw.color[corner[0]];
        if (raw.color[corner[1]] != color || raw.color[corner[2]] != color) return false;
        key[t] = {raw.triangle_material.empty() ? -1.0 : raw.triangle_material[t], color.x() + 0.0,
                  color.y() + 0.0, color.z() + 0.0};
    }
    int paints = 0;
    std::vector<int> paint = number_equal(key, paints);
    if (paints > kMostPaints) return false;
    std::vector<std::size_t> first;  // triangle of each paint
    for (std::size_t t = 0; t < count; ++t)
        if (paint[t] == static_cast<int>(first.size())) first.push_back(t);
    const bool has_material = !raw.triangle_material.empty();
    std::vector<int> paints_of(raw.material.size(), 0);
    for (const std::size_t t : first)
        if (has_material) ++paints_of[raw.triangle_material[t]];
    std::vector<RawMaterial> material;
    for (const std::size_t t : first) {
        const Vec3 color(key[t][1], key[t][2], key[t][3]);
        RawMaterial painted{.name = {}, .color = Vec3::Ones()};
        bool is_itself = false;  // a material without colours, or of one alone
        if (has_material) {
            const int number = raw.triangle_material[t];
            painted = raw.material[number];
            is_itself = color == Vec3::Ones() || paints_of[number] == 1;
        }
        painted.color = painted.color.cwiseProduct(color);
        const auto byte = [&](int c) {
            return std::lround(255 * srgb_from_linear(std::clamp(color[c], 0.0, 1.0)));
        };
        if (painted.name.empty()) {
            painted.name = "paint";
            is_itself = false;
        }
        if (!is_itself)
            painted.name += fmt::format("_{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2));
        material.push_back(std::move(painted));
    }
    raw.material = std::move(material);
    raw.triangle_material = std::move(paint);
    raw.color.clear();
    return true;
}

// Of each material, whether any of its corners has a colour: where a file gives them to some of its
// surfaces alone, the corners of the others are white.
std::vector<char> takes_colors(const RawMesh& raw) {
    std::vector<char> takes(raw.material.size(), 0);
    for (std::size_t t = 0; t < raw.triangle_material.size(); ++t)
        for (const int i : raw.triangle[t])
            takes[raw.triangle_material[t]] |= raw.color[i] != Eigen::Vector3f::Ones();
    return takes;
}

// Polygons numbered from 0 without gaps, in order.
std::vector<int> renumbered(std::vector<int> polygon) {
    int next = -1, last = -1;
    for (int& p : polygon) {
        if (next < 0 || p != last) ++next;
        last = p;
        p = next;
    }
    return polygon;
}

// The vertices that faces use, strays would spoil the box; and the places that they lie at.
struct Places {
    std::vector<int> vertex;     // in the file's order
    std::vector<int> of_vertex;  // the place of each of these
    std::vector<Vec3> position;  // of each place
};

Places places_of(const RawMesh& raw) {
    std::vector<char> used(raw.position.size(), 0);
    for (const Corners& t : raw.triangle)
        for (const int i : t) used[i] = 1;
    Places places;
    std::vector<std::array<double, 3>> key;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        places.vertex.push_back(static_cast<int>(i));
        const Vec3& p = raw.position[i];
        key.push_back({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0});  // -0 becomes 0
    }
    int count = 0;
    places.of_vertex = number_equal(key, count);
    places.position.resize(count);
    for (std::size_t i = 0; i < key.size(); ++i) {
        places.position[places.of_vertex[i]] = {key[i][0], key[i][1], key[i][2]};
    }
    return places;
}

// The colour of each place: of its first vertex, where surfaces with and without colours meet of
// the first that has them. Where no colour of a place can be right for all, colours become
// materials if they can, and none is left.
std::vector<Eigen::Vector3f> colors_of(const Places& places, const std::vector<char>& takes,
                                       RawMesh& raw) {
    std::vector<char> counts(raw.position.size(), raw.triangle_material.empty());
    for (std::size_t t = 0; t < raw.triangle_material.size(); ++t)
        if (takes[raw.triangle_material[t]])
            for (const int i : raw.triangle[t]) counts[i] = 1;
    const std::size_t count = places.position.size();
    std::vector<int> first(count, -1);
    std::vector<char> differs(count, 0), jumps(count, 0);
    for (const bool counting : {true, false})
        for (std::size_t i = 0; i < places.vertex.size(); ++i) {
            const int vertex = places.vertex[i], place = places.of_vertex[i];
            if (counts[vertex] != counting) continue;
            int& known = first[place];
            if (known < 0) known = vertex;
            differs[place] |= raw.color[known] != raw.color[vertex];
            if (counting) jumps[place] = differs[place];
        }
    if (std::count(differs.begin(), differs.end(), 1) > 0 && paint_by_faces(raw)) return {};
    if (const auto changed = std::count(jumps.begin(), jumps.end(), 1); changed > 0)
        raw.finding.push_back(fmt::format(
            "at {} of {} vertices the colours of adjacent faces differ: one of them was taken",
            changed, count));
    std::vector<Eigen::Vector3f> color;
    for (const int i : first) color.push_back(raw.color[i]);
    return color;
}

SurfaceMaterial surface_material(RawMaterial& raw, bool takes_colors) {
    SurfaceMaterial material;
    material.takes_colors = takes_colors;
    material.name = std::move(raw.name);
    material.color = raw.color;
    material.roughness = raw.roughness;
    material.metallic = raw.metallic;
    material.texture = std::move(raw.texture);
    if (!raw.texture_bytes.empty())
        material.embedded_texture =
            std::make_shared<const std::string>(std::move(raw.texture_bytes));
    return material;
}

}  // namespace

TriMesh weld(RawMesh& raw, double crease_angle) {
    TriMesh mesh;
    Places places = places_of(raw);
    const std::size_t vertices = raw.position.size();
    if (const std::size_t strays = vertices - places.vertex.size(); strays > 0)
        raw.finding.push_back(
            fmt::format("{} of {} vertices belong to no face and were left out", strays, vertices));
    std::vector<char> takes;
    if (!raw.color.empty()) {
        takes = takes_colors(raw);
        mesh.position_color = colors_of(places, takes, raw);
        if (mesh.position_color.empty()) takes.clear();
    }
    std::vector<int> place(vertices, -1);
    for (std::size_t i = 0; i < places.vertex.size(); ++i) {
        place[places.vertex[i]] = places.of_vertex[i];
    }
    mesh.position = std::move(places.position);
    mesh.triangle = std::move(raw.triangle);
    for (Corners& t : mesh.triangle)
        for (int& i : t) i = place[i];

    if (!raw.triangle_uv.empty()) {
        mesh.uv = std::move(raw.uv);
        mesh.triangle_uv = std::move(raw.triangle_uv);
        if (raw.at_vertices) weld_uv(mesh);
    }
    mesh.triangle_polygon = renumbered(std::move(raw.polygon));
    mesh.triangle_material = std::move(raw.triangle_material);
    mesh.triangle_part = std::move(raw.triangle_part);
    mesh.part_name = std::move(raw.part_name);
    for (std::size_t i = 0; i < raw.material.size(); ++i) {
        mesh.material.push_back(surface_material(raw.material[i], takes.empty() || takes[i]));
    }
    smooth(raw, crease_angle, mesh);
    return mesh;
}

}  // namespace swage

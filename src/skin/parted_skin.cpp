// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/parted_skin.h"

#include <algorithm>
#include <cmath>

#include "geometry/disjoint_sets.h"
#include "geometry/edges.h"

namespace swage {

namespace {

std::uint64_t key_of(const Vec3i& site, int axis) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i + (1 << 19)) & 0xFFFFF; };
    return part(site.x()) | part(site.y()) << 20 | part(site.z()) << 40 |
           static_cast<std::uint64_t>(axis) << 60;
}

}  // namespace

bool is_cut(const Mount& mount) {
    return std::any_of(mount.side.begin(), mount.side.end(),
                       [](CornerMask side) { return side != kAllCorners; });
}

std::vector<BrokenFace> broken_faces(const Aggregate& matter) {
    std::vector<BrokenFace> faces;
    if (matter.connection[0].damage.empty()) return faces;
    for (const ParticleRun& run : matter.lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) {
            for (int axis = 0; axis < kEdgeCount; ++axis) {
                const ConnectionArrays& all = matter.connection[axis];
                const ParticleId lower = run.first + n;
                if (all.damage[lower] >= 1 && all.weight[lower] <= 0) {
                    faces.push_back({{run.i + n, run.j, run.k}, axis});
                }
            }
        }
    }
    return faces;
}

std::vector<BrokenFace> faces_to_part(const Aggregate& matter, const Mount& mount) {
    std::vector<BrokenFace> faces = broken_faces(matter);
    if (!is_cut(mount)) return faces;
    std::unordered_set<std::uint64_t> known;
    for (const BrokenFace& face : faces) known.insert(key_of(face.site, face.axis));
    const auto add = [&](const Vec3i& site, int axis) {
        if (known.insert(key_of(site, axis)).second) faces.push_back({site, axis});
    };
    const std::size_t broken = faces.size();
    for (std::size_t f = 0; f < broken; ++f) {
        const BrokenFace face = faces[f];
        const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3, end = 1 << face.axis;
        for (int own = 0; own < 4; ++own) {  // the connection's place in a cell around it
            const auto corner = [&](int at) { return (at & 1) << a | (at >> 1) << b; };
            const Vec3i low = face.site - corner_step(corner(own));
            const CellId cell = matter.lattice.cell_at(low);
            if (cell < 0) continue;
            const CornerGroups group =
                corner_groups_of_cut(matter, matter.lattice.cell_corners(cell));
            if (group[0] == kAllCorners) continue;
            for (int at = 0; at < 4; ++at) {
                const bool here = group[corner(own)] >> corner(at) & 1 &&
                                  group[corner(own) | end] >> (corner(at) | end) & 1;
                if (!here) add(low + corner_step(corner(at)), face.axis);
            }
        }
    }
    return faces;
}

void part_around_mixed(const Aggregate& matter, std::vector<BrokenFace>& faces) {
    std::unordered_set<std::uint64_t> known;
    for (const BrokenFace& face : faces) known.insert(key_of(face.site, face.axis));
    const auto add = [&](const Vec3i& site, int axis) {
        if (known.insert(key_of(site, axis)).second) faces.push_back({site, axis});
    };
    const std::vector<int> piece = find_pieces(matter).particle_piece;
    const CellId count = static_cast<CellId>(matter.cell_fill.size());
    for (CellId cell = 0; cell < count; ++cell) {
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        const CornerGroups side = corner_groups_of_cut(matter, corner);
        if (side[0] == kAllCorners) continue;
        const auto is_mixed = [&](int own) {
            for (int c = 0; c < 8; ++c) {
                if (side[own] >> c & 1 && piece[corner[c]] != piece[corner[own]]) return true;
            }
            return false;
        };
        for (int own = 0; own < 8; ++own) {
            if (!is_mixed(own)) continue;
            for (int c = 0; c < 8; ++c) {
                if (side[own] >> c & 1) continue;
                const Vec3i site = matter.lattice.cell_site(cell) + corner_step(c);
                for (int axis = 0; axis < 3; ++axis) {
                    add(site, axis), add(site - Vec3i::Unit(axis), axis);
                }
            }
        }
    }
}

namespace {

Aggregate without_cracks(const Aggregate& cracked) {
    Aggregate matter = cracked;
    for (ConnectionArrays& all : matter.connection) {
        for (std::size_t p = 0; p < all.damage.size(); ++p) {
            if (all.damage[p] >= 1) all.weight.set(p, 1);
        }
    }
    return matter;
}

}  // namespace

PartedSkin::Uncracked::Uncracked(const Aggregate& cracked)
    : matter(without_cracks(cracked)), pieces(matter) {}

PartedSkin::PartedSkin(const TriMesh& whole, const Mount& whole_mount, const Aggregate& matter,
                       const std::vector<BrokenFace>& faces, const Warp& warp)
    : matter_(matter), is_rough_(!warp.is_none()) {
    std::unordered_set<std::uint64_t> beside;  // cubes at broken faces
    for (const BrokenFace& face : faces) {
        broken_.insert(key_of(face.site, face.axis));
        Vec3i upper = face.site;
        ++upper[face.axis];
        beside.insert({key_of(face.site, 0), key_of(upper, 0)});
    }
    diced_ = dice_skin(whole, matter.lattice, warp,
                       [&](const Vec3i& site) { return beside.contains(key_of(site, 0)); });
    mesh = diced_.mesh;
    plane_ = diced_.plane;
    straight_ = diced_.straight;
    site_ = diced_.site;
    mount.kind = whole_mount.kind;
    if (is_cut(whole_mount)) uncracked_ = std::make_unique<Uncracked>(matter);
    const std::size_t old = whole_mount.reference.size();
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
        const Vec3& at = mesh.position[v];
        source_.push_back(static_cast<int>(v));
        if (v < old) {
            mount.add({at, whole_mount.cell[v], whole_mount.side[v], whole_mount.hold[v]});
        } else {
            const Corners& c = whole.triangle[diced_.on_triangle[v - old]];
            const std::array<BodyPlace, 3> corner = {mount.place(c[0]), mount.place(c[1]),
                                                     mount.place(c[2])};
            mount_beside(at, corner);
        }
    }
    part_vertices();
}

void PartedSkin::mount_beside(const Vec3& place, std::span<const BodyPlace> others) {
    if (uncracked_) return mount.add(uncracked_->pieces.beside(place, others));
    mount.add({place, carrying_cell(matter_, place), kAllCorners, hold_between(place, others)});
}

bool PartedSkin::joined(const Vec3i& lower, int axis) const {
    return !broken_.contains(key_of(lower, axis));
}

// The cubes around the vertex that hang together there with the one at `site`.
PartedSkin::Mask PartedSkin::group_of(int v, const Vec3i& site) const {
    const std::array<int, 3>& plane = plane_[v];
    Vec3i low = site;
    int way = 0, own = 0;
    for (int d = 0; d < 3; ++d) {
        if (plane[d] == kNoPlane) continue;
        low[d] = plane[d];
        way |= 1 << d;
        own |= (site[d] > plane[d]) << d;
    }
    Mask group = static_cast<Mask>(1 << own), before = 0;
    while (group != before) {
        before = group;
        for (int c = 0; c < 8; ++c) {
            if (!(group >> c & 1)) continue;
            for (int d = 0; d < 3; ++d) {
                if (!(way >> d & 1)) continue;
                Vec3i at = low + corner_step(c);
                at[d] = low[d];
                if (joined(at, d)) group |= static_cast<Mask>(1 << (c ^ 1 << d));
            }
        }
    }
    return group;
}

PartedSkin::Mask PartedSkin::all_around(const std::array<int, 3>& plane) {
    Mask all = 0;
    for (int c = 0; c < 8; ++c) {
        bool is = true;
        for (int d = 0; d < 3; ++d) is = is && (plane[d] != kNoPlane || !(c >> d & 1));
        all |= static_cast<Mask>(is << c);
    }
    return all;
}

int PartedSkin::copy_of(int v, const Vec3i& site) {
    const Mask group = group_of(v, site);
    if (group == all_around(plane_[v])) {
        if (!used_[v]) take_sides(v, v, site, group);
        used_[v] = 1;
        return v;
    }
    const auto known = taken_.find({v, group});
    if (known != taken_.end()) return known->second;
    int copy = v;
    if (used_[v]) {
        copy = static_cast<int>(mesh.position.size());
        mesh.position.push_back(mesh.position[v]);
        if (!mesh.position_color.empty()) {
            const Eigen::Vector3f color = mesh.position_color[v];
            mesh.position_color.push_back(color);
        }
        mount.add({mesh.position[v], whole_cell_[v], whole_side_[v], mount.hold[v]});
        source_.push_back(v);
    }
    used_[v] = 1;
    take_sides(copy, v, site, group);
    taken_[{v, group}] = copy;
    return copy;
}

// Of a vertex of a triangle that was left whole: the cube that it lies in. It may be nearer to
// another's particle.
Vec3i PartedSkin::cube_around(int v) const {
    const MiddlePlanes& planes = diced_.planes;
    Vec3i site;
    for (int d = 0; d < 3; ++d) {
        const double at = straight_[v][d];
        site[d] = static_cast<int>(
            std::lround((at - matter_.lattice.origin[d]) / matter_.lattice.spacing));
        while (planes.at(d, site[d]) <= at) ++site[d];
        while (planes.at(d, site[d] - 1) > at) --site[d];
    }
    return site;
}

// It follows the corners of its cell that hang together with its group.
void PartedSkin::take_sides(int copy, int v, const Vec3i& site, Mask group) {
    if (is_rough_ && site == kNoSite) return take_sides(copy, v, cube_around(v), group);
    const Vec3i cell = matter_.lattice.cell_site(mount.cell[copy]);
    Vec3i low = site;
    for (int d = 0; d < 3; ++d) {
        if (plane_[v][d] != kNoPlane) low[d] = plane_[v][d];
    }
    int side = 0;
    for (int c = 0; c < 8; ++c) {
        if (!(group >> c & 1)) continue;
        const Vec3i at = low + corner_step(c) - cell;
        if ((at.array() < 0).any() || (at.array() > 1).any()) continue;
        side |= 1 << (at.x() + 2 * at.y() + 4 * at.z());
    }
    for (int before = 0; side != before;) {
        before = side;
        for (int c = 0; c < 8; ++c) {
            for (int d = 0; d < 3 && side >> c & 1; ++d) {
                Vec3i at = cell + corner_step(c);
                at[d] = cell[d];
                if (joined(at, d)) side |= 1 << (c ^ 1 << d);
            }
        }
    }
    side &= whole_side_[v];
    if (side == 0) {
        if (uncracked_ || is_rough_) change_cell(copy, v, site, group);
        return;
    }
    if (uncracked_) {  // cracks that go on through the other side of a cut part nothing there
        const CornerGroups held =
            corner_groups(matter_, matter_.lattice.cell_corners(mount.cell[copy]));
        int with = 0;
        for (int c = 0; c < 8; ++c) with |= side >> c & 1 ? held[c] : 0;
        side |= with & whole_side_[v];
    }
    mount.side[copy] = static_cast<CornerMask>(side);
}

// None of the cell's corners is both with the group and on the vertex's side of a blade's cut: the
// nearest of the cells around takes the copy that has one which is.
void PartedSkin::change_cell(int copy, int v, const Vec3i& site, Mask group) {
    const Lattice& lattice = matter_.lattice;
    const Vec3i low =
        lattice.cell_site(mount.cell[copy]) - Vec3i::Ones();  // of four sites each way
    const auto number = [&](const Vec3i& at) {
        const Vec3i n = at - low;
        return (n.array() < 0).any() || (n.array() > 3).any() ? -1 : n[0] + 4 * (n[1] + 4 * n[2]);
    };
    DisjointSets uncracked(64), uncut(64);
    lattice.for_each_cell_around(low + Vec3i::Ones(), [&](CellId cell, const Vec3i& at) {
        const std::array<ParticleId, 8> corner = lattice.cell_corners(cell);
        for (int c = 0; c < 8; ++c) {
            for (int d = 0; d < 3; ++d) {
                if (c >> d & 1) continue;
                const Vec3i lower = at + corner_step(c), upper = lower + Vec3i::Unit(d);
                if (joined(lower, d)) uncracked.unite(number(lower), number(upper));
                if (!uncracked_ || uncracked_->matter.connection[d].weight[corner[c]] > 0) {
                    uncut.unite(number(lower), number(upper));
                }
            }
        }
    });
    std::array<char, 64> in_group{}, on_side{};
    Vec3i cube = site;
    for (int d = 0; d < 3; ++d) {
        if (plane_[v][d] != kNoPlane) cube[d] = plane_[v][d];
    }
    for (int c = 0; c < 8; ++c) {
        const int own = number(cube + corner_step(c));
        if (group >> c & 1 && own >= 0) in_group[uncracked.root(own)] = 1;
        if (whole_side_[v] >> c & 1) {
            on_side[uncut.root(number(low + Vec3i::Ones() + corner_step(c)))] = 1;
        }
    }
    const auto side_in = [&](CellId, const Vec3i& at) {
        CornerMask side = 0;
        for (int c = 0; c < 8; ++c) {
            const int own = number(at + corner_step(c));
            const bool is = in_group[uncracked.root(own)] && on_side[uncut.root(own)];
            side |= static_cast<CornerMask>(is << c);
        }
        return side;
    };
    const CellSide best = nearest_side(matter_, mount.cell[copy], mount.reference[copy], side_in);
    if (best.cell < 0) return;
    mount.cell[copy] = best.cell;
    mount.side[copy] = best.side;
}

void PartedSkin::part_vertices() {
    used_.assign(plane_.size(), 0);
    whole_side_ = mount.side;
    whole_cell_ = mount.cell;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (int& v : mesh.triangle[t]) v = copy_of(v, site_[t]);
    }
    PartedGroups groups(mesh);
    for (std::size_t t = 0; t < mesh.triangle_smooth.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            int& own = mesh.triangle_smooth[t][k];
            own = groups.at(own, mesh.triangle[t][k]);
        }
    }
}

int PartedSkin::add_vertex(const Place& place, const Eigen::Vector3f& color, int beside) {
    const std::size_t v = mesh.position.size();
    const Vec3& at = place.at_molding;
    mesh.position.push_back(at);
    if (!mesh.position_color.empty()) mesh.position_color.push_back(color);
    if (beside >= 0) {
        const int source = source_[beside];
        const BodyPlace near{mount.reference[beside], whole_cell_[source], whole_side_[source],
                             mount.hold[source]};
        mount_beside(at, {&near, 1});
    } else {
        mount.add({at, carrying_cell(matter_, at)});
    }
    source_.push_back(static_cast<int>(v));
    plane_.resize(v + 1, {kNoPlane, kNoPlane, kNoPlane});
    plane_[v] = place.plane;
    straight_.resize(v + 1);
    straight_[v] = place.straight;
    used_.resize(v + 1, 0);
    whole_side_.resize(v + 1, kAllCorners);
    whole_side_[v] = mount.side[v];
    whole_cell_.resize(v + 1, 0);
    whole_cell_[v] = mount.cell[v];
    return static_cast<int>(v);
}

void PartedSkin::part_touching_edges() {
    std::map<Segment, int> middle;  // of edges that touch, low number first
    bool any = false;
    bool again = true;
    for (int round = 0; again; ++round) {
        for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
            if (uses.size() <= 2 || round > 1) return;
            const auto plane = common_planes(uses[0].low, uses[0].high);
            const bool between = all_around(plane) != 1;  // cubes, so not the mesh's own doing
            if (between) middle.emplace(Segment{uses[0].low, uses[0].high}, -1);
        });
        again = false;
        const std::size_t count = mesh.triangle.size();
        for (std::size_t t = 0; t < count && !middle.empty(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] =
                    std::minmax(mesh.triangle[t][k], mesh.triangle[t][(k + 1) % 3]);
                const auto at = middle.find({low, high});
                if (at == middle.end()) continue;
                if (at->second < 0) at->second = half_way(low, high);
                bisect(t, k, at->second);
                any = again = true;
                break;
            }
        }
    }
    for (std::size_t t = 0; any && t < mesh.triangle_polygon.size(); ++t) {
        mesh.triangle_polygon[t] = static_cast<int>(t);
    }
}

std::array<int, 3> PartedSkin::common_planes(int v, int w) const {
    std::array<int, 3> plane = plane_[source_[v]];
    for (int d = 0; d < 3; ++d) {
        if (plane_[source_[w]][d] != plane[d]) plane[d] = kNoPlane;
    }
    return plane;
}

int PartedSkin::half_way(int low, int high) {
    const Vec3 &from = straight_[source_[low]], &to = straight_[source_[high]];
    return add_vertex({0.5 * (from + to), 0.5 * (mesh.position[low] + mesh.position[high]),
                       common_planes(low, high)},
                      halves_.color(low, high, 0.5), low);
}

void PartedSkin::bisect(std::size_t t, int k, int middle) {
    const Vec3i site = site_[t];
    const int v = copy_of(middle, site), next = (k + 1) % 3;
    const auto again = [t](auto& values) {
        if (values.empty()) return;
        const auto value = values[t];
        values.push_back(value);
    };
    for_each_triangle_array(again, mesh);
    site_.push_back(site);
    mesh.triangle[t][next] = mesh.triangle.back()[k] = v;
    const auto halve = [&](std::vector<Corners>& corner, auto make) {
        if (corner.empty()) return;
        const auto [low, high] = std::minmax(corner[t][k], corner[t][next]);
        corner[t][next] = corner.back()[k] = (halves_.*make)(v, low, high, 0.5);
    };
    halve(mesh.triangle_uv, &EdgeAttributes::uv);
    halve(mesh.triangle_smooth, &EdgeAttributes::smooth);
}

}  // namespace swage

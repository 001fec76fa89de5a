// SPDX-License-Identifier: GPL-3.0-or-later
// The vertices of a diced skin, parted where matter broke by load: a copy for each group of the
// cubes around a vertex, one around each particle, that hang together there.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_set>
#include <vector>

#include "geometry/edge_attributes.h"
#include "skin/diced_skin.h"
#include "skin/mount.h"
#include "skin/piece_map.h"

namespace swage {

// Between the cube around a site and the next one along the axis.
struct BrokenFace {
    Vec3i site;
    int axis;
};

bool is_cut(const Mount& mount);  // by a blade
// Where a connection along the lattice's axes broke by load.
std::vector<BrokenFace> broken_faces(const Aggregate& matter);
// And beside them in cells that a blade has severed. The surface of one side of its cut reaches
// into cubes of the other there: the crack goes on through these, so that this surface parts too;
// that of the other side is slit, its two faces staying together. `mount`: of the whole skin.
std::vector<BrokenFace> faces_to_part(const Aggregate& matter, const Mount& mount);
// And all around cubes into which the surface of one side reaches from cells in which that side is
// of several pieces: as one part it would hang on to all of these.
void part_around_mixed(const Aggregate& matter, std::vector<BrokenFace>& faces);

class PartedSkin {
  public:
    // `faces`: those of faces_to_part().
    PartedSkin(const TriMesh& whole, const Mount& whole_mount, const Aggregate& matter,
               const std::vector<BrokenFace>& faces, const Warp& warp);

    const DicedSkin& diced() const { return diced_; }
    bool joined(const Vec3i& lower, int axis) const;
    const std::array<int, 3>& plane(int v) const { return plane_[v]; }
    const Vec3& straight(int v) const { return straight_[v]; }

    // Where a new vertex is [m].
    struct Place {
        Vec3 straight, at_molding;
        std::array<int, 3> plane;
    };
    // Not yet parted. Where blades have cut it is on the side of vertex `beside`, if there is one.
    int add_vertex(const Place& place, const Eigen::Vector3f& color, int beside = -1);
    // The copy of a vertex that those have who hang together with the cube at `site`.
    int copy_of(int v, const Vec3i& site);
    // To be called for each triangle that is added to the mesh.
    void add_site(const Vec3i& site) { site_.push_back(site); }
    // To be called last. Both sides of a small crack may share the ends of an edge and not the
    // edge: it gets a vertex half-way, which parts.
    void part_touching_edges();

    TriMesh mesh;
    Mount mount;  // but for what finish_mount makes

  private:
    using Segment = std::array<int, 2>;
    using Mask = std::uint8_t;  // of the cubes around a vertex: a bit for each of the eight ways
                                // to take the upper one along the axes

    // The matter as if nothing had broken by load: tells the sides of a blade's cut.
    struct Uncracked {
        explicit Uncracked(const Aggregate& cracked);
        Aggregate matter;
        PieceMap pieces;
    };
    void mount_beside(const Vec3& place, std::span<const BodyPlace> others);
    Mask group_of(int v, const Vec3i& site) const;
    static Mask all_around(const std::array<int, 3>& plane);
    Vec3i cube_around(int v) const;
    void take_sides(int copy, int v, const Vec3i& site, Mask group);
    void change_cell(int copy, int v, const Vec3i& site, Mask group);
    void part_vertices();
    std::array<int, 3> common_planes(int v, int w) const;
    int half_way(int low, int high);
    void bisect(std::size_t t, int k, int middle);

    const Aggregate& matter_;
    const bool is_rough_;
    std::unique_ptr<Uncracked> uncracked_;      // where blades have cut
    std::unordered_set<std::uint64_t> broken_;  // faces; looked up only
    DicedSkin diced_;
    std::vector<std::array<int, 3>> plane_;  // of vertices, copies left out
    std::vector<Vec3> straight_;             // likewise
    std::vector<int> source_;                // of each copy the vertex
    std::vector<Vec3i> site_;                // a triangle each
    std::vector<char> used_;
    std::vector<CellId> whole_cell_;  // before it parted
    std::vector<CornerMask> whole_side_;
    std::map<std::pair<int, Mask>, int> taken_;
    EdgeAttributes halves_{mesh};  // so that this cannot be moved
};

}  // namespace swage

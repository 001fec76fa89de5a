// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: S2.11 (frame4). The default blends the affine frames of all eight corners of the cell;
// linear weights alone leave an error in the curvature f'' that the frames make again with opposite
// sign and twice the size, so half of each frame cancels it.
#include "skin/mount.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 256;  // cells
constexpr double kHeld = 1e-9;       // spacings; nearer a vertex is at its place
constexpr double kMostHeld = 5;      // spacings at a plastic strain of 1, uneven as flow is

Vec3 moved_by(const Vec3& place, const Vec3& u) {
    // A sum with zero would turn -0 into 0.
    return {u[0] == 0 ? place[0] : place[0] + u[0], u[1] == 0 ? place[1] : place[1] + u[1],
            u[2] == 0 ? place[2] : place[2] + u[2]};
}

// The paper's basis of four particles: o, the corner nearest to the vertex, and its three
// neighbours along the cell's edges, made orthonormal by Gram-Schmidt. An edge that is severed is
// replaced by the column of o's own frame.
Vec3 frame4_displacement(const Aggregate& matter, const std::array<ParticleId, 8>& corner,
                         const CellFrames& cell, const Carrier& carrier, CornerMask followed) {
    const int o = heaviest_corner(trilinear_weights(carrier.local), followed);
    const auto own = cell.corner.col(o);
    Mat3 basis;
    for (int axis = 0; axis < 3; ++axis) {
        const int next = o ^ 1 << axis;
        const double way = o >> axis & 1 ? -cell.size[axis] : cell.size[axis];
        const ParticleId lower = corner[o & ~(1 << axis)];
        const bool connected = matter.connection[axis].weight[lower] > 0;
        const Vec3 change = connected ? Vec3((cell.corner.col(next) - own).tail<3>() / way)
                                      : Vec3(own.segment<3>(3 * axis));
        basis.col(axis) = Vec3::Unit(axis) + change;
    }
    basis.col(0).normalize();
    basis.col(1) -= basis.col(0).dot(basis.col(1)) * basis.col(0);
    basis.col(1).normalize();
    basis.col(2) -= basis.col(0).dot(basis.col(2)) * basis.col(0);
    basis.col(2) -= basis.col(1).dot(basis.col(2)) * basis.col(1);
    basis.col(2).normalize();

    Vec3 from_o = carrier.arm + 0.5 * carrier.local.cwiseProduct(cell.size);
    for (int axis = 0; axis < 3; ++axis) from_o[axis] -= o >> axis & 1 ? cell.size[axis] : 0;
    return own.tail<3>() + (basis - Mat3::Identity()) * from_o;
}

}  // namespace

Mount mount_mesh(const std::vector<Vec3>& reference, const Aggregate& matter, SkinKind kind) {
    Mount mount;
    mount.kind = kind;
    mount.reference = reference;
    mount.cell.resize(reference.size());
    constexpr std::size_t kPlaces = 4096;
    parallel_each(reference.size(), kPlaces,
                  [&](std::size_t v) { mount.cell[v] = carrying_cell(matter, reference[v]); });
    mount.side.assign(reference.size(), kAllCorners);
    finish_mount(mount, matter);
    return mount;
}

void finish_mount(Mount& mount, const Aggregate& matter) {
    const std::size_t count = mount.reference.size();
    mount.vertex.resize(count);
    std::iota(mount.vertex.begin(), mount.vertex.end(), 0);
    std::sort(mount.vertex.begin(), mount.vertex.end(), [&](int a, int b) {
        return std::pair(mount.cell[a], a) < std::pair(mount.cell[b], b);
    });
    mount.group.clear();
    mount.hold.resize(count, Vec3::Zero());
    mount.carrier.resize(count);
    std::vector<ParticleId> used;
    CellBox box;
    for (std::size_t n = 0; n < count; ++n) {
        const int v = mount.vertex[n];
        if (n == 0 || mount.cell[v] != mount.group.back().cell) {
            mount.group.push_back({mount.cell[v], static_cast<int>(n), 0, {}});
            box = cell_box(matter, mount.cell[v]);
            const auto corner = matter.lattice.cell_corners(mount.cell[v]);
            used.insert(used.end(), corner.begin(), corner.end());
        }
        ++mount.group.back().count;
        mount.carrier[n] = carrier_in(box, mount.reference[v]);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<int> slot(matter.particle_count(), -1);
    for (std::size_t s = 0; s < used.size(); ++s) slot[used[s]] = static_cast<int>(s);
    for (Mount::CellGroup& group : mount.group) {
        const auto corner = matter.lattice.cell_corners(group.cell);
        for (int c = 0; c < 8; ++c) group.corner[c] = slot[corner[c]];
    }
    mount.particle = std::move(used);
    mount.stencil = make_frame_stencil(matter);
}

namespace {

// Calls visit(v, where it is, its cell, turn() of what carries it) with each vertex.
template <typename Visit>
void for_each_vertex(const Mount& mount, const Aggregate& matter, const Visit& visit) {
    std::vector<ParticleFrame> frame;
    particle_frames(matter, mount.stencil, mount.particle, frame);
    parallel_chunks(mount.group.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        std::vector<Vec3> moved;
        for (std::size_t g = begin; g < end; ++g) {
            const Mount::CellGroup& group = mount.group[g];
            std::array<ParticleId, 8> corner;
            CellFrames cell;
            for (int c = 0; c < 8; ++c) {
                corner[c] = mount.particle[group.corner[c]];
                cell.corner.col(c) = frame[group.corner[c]];
            }
            cell.size =
                matter.particle_reference.at(corner[7]) - matter.particle_reference.at(corner[0]);
            CornerMask turned = 0;  // which corners' turn is known
            Mat3 known = Mat3::Identity();
            const auto go_on = [&](int v, const Vec3& u, CornerMask followed) {
                const auto turn = [&]() -> const Mat3& {
                    if (turned != followed)
                        known = nearest_rotation(mean_slope(cell, turned = followed));
                    return known;
                };
                Vec3 at = moved_by(mount.reference[v], u);
                if (!mount.hold[v].isZero(0)) at += turn() * mount.hold[v];
                visit(v, at, group.cell, turn);
            };
            const bool whole = corners_hang_together(matter, corner);
            if (whole && mount.kind == SkinKind::mount) {
                moved.resize(static_cast<std::size_t>(group.count));
                whole_displacements(half_frames(cell), &mount.carrier[group.first], group.count,
                                    moved.data());
                for (int n = 0; n < group.count; ++n) {
                    go_on(mount.vertex[group.first + n], moved[n], kAllCorners);
                }
                continue;
            }
            CornerGroups groups;
            groups.fill(kAllCorners);
            if (!whole) groups = corner_groups(matter, corner);
            for (int n = group.first; n < group.first + group.count; ++n) {
                const int v = mount.vertex[n];
                const Carrier& carrier = mount.carrier[n];
                const CornerMask followed =
                    whole ? kAllCorners : followed_corners(groups, mount.side[v], carrier.local);
                const Vec3 u = mount.kind == SkinKind::frame4
                                   ? frame4_displacement(matter, corner, cell, carrier, followed)
                                   : part_displacement(cell, carrier, followed);
                go_on(v, u, followed);
            }
        }
    });
}

double flowed_around(const Aggregate& matter, CellId cell) {
    float most = 0;
    const Lattice& lattice = matter.lattice;
    lattice.for_each_cell_around(lattice.cell_site(cell), [&](CellId near, const Vec3i&) {
        most = std::max(most, matter.hardening_of(near));
    });
    return most;
}

}  // namespace

void skin_positions(const Mount& mount, const Aggregate& matter, std::vector<Vec3>& position) {
    position.resize(mount.reference.size());
    for_each_vertex(mount, matter,
                    [&](int v, const Vec3& at, CellId, const auto&) { position[v] = at; });
}

void hold_places(Mount& mount, const Aggregate& matter, const std::vector<Vec3>& place) {
    if (!matter.has_flowed()) return;
    const double a = matter.lattice.spacing;
    for_each_vertex(mount, matter, [&](int v, const Vec3& at, CellId cell, const auto& turn) {
        const Vec3 gap = place[v] - at;
        if (gap.norm() <= kHeld * a) return;
        const double most = kMostHeld * flowed_around(matter, cell) * a;
        if (most == 0) return;
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        if (corner_groups(matter, corner) != corner_groups_of_cut(matter, corner)) return;
        const Vec3 hold = mount.hold[v] + turn().transpose() * gap;
        mount.hold[v] = std::min(1.0, most / hold.norm()) * hold;
    });
}

}  // namespace swage

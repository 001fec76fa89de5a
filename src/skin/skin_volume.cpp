// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/skin_volume.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 256;  // cells
constexpr double kOneFace = 0.02;    // sin^2 of how far around a particle one face may be bent

using Weights = std::array<double, 8>;

// Whether each edge is gone along as often one way as the other: of a surface with a rim that sums
// up to nothing by a chance of 2^-64.
bool is_closed(const std::vector<Corners>& triangles) {
    std::uint64_t sum = 0;
    const auto add = [&](int from, int to) {
        std::uint64_t edge =
            std::uint64_t(std::min(from, to)) << 32 | std::uint32_t(std::max(from, to));
        edge = (edge ^ edge >> 30) * 0xbf58476d1ce4e5b9;  // the mixing of splitmix64
        edge = (edge ^ edge >> 27) * 0x94d049bb133111eb;
        edge ^= edge >> 31;
        sum += from < to ? edge : -edge;
    };
    for (const auto& [a, b, c] : triangles) add(a, b), add(b, c), add(c, a);
    return sum == 0;
}

// And each vertex's part of the area.
struct Surface {
    double volume = 0;
    std::vector<Vec3> area;

    Surface(const std::vector<Corners>& triangles, const std::vector<Vec3>& position)
        : area(position.size(), Vec3::Zero()) {
        for (const Corners& t : triangles) {
            const Vec3 twice = area_vector(position, t);
            volume += twice.dot(position[t[0]] - position[0]) / 6;
            for (int n = 0; n < 3; ++n) area[t[n]] += twice / 6;
        }
    }
};

// By how much half frames round each vertex [m], in the order of mount.carrier.
std::vector<Vec3> roundings(const Mount& mount, const Aggregate& matter) {
    std::vector<ParticleFrame> frame;
    particle_frames(matter, mount.stencil, mount.particle, frame);
    std::vector<Vec3> off(mount.carrier.size());
    parallel_each(mount.group.size(), kChunk, [&](std::size_t g) {
        const Mount::CellGroup& group = mount.group[g];
        const Vec3 size = cell_box(matter, group.cell).size;
        for (int n = group.first; n < group.first + group.count; ++n) {
            const Vec3& local = mount.carrier[n].local;
            const Weights weight = trilinear_weights(local);
            off[n] = Vec3::Zero();
            for (int c = 0; c < 8; ++c) {
                const auto& gradient = frame[group.corner[c]];
                for (int axis = 0; axis < 3; ++axis) {
                    const double way = (local[axis] - (c >> axis & 1)) * size[axis];
                    off[n] += 0.5 * weight[c] * way * gradient.segment<3>(3 * axis);
                }
            }
        }
    });
    return off;
}

// Calls visit(n, v, weights, slots of the corners) with each vertex, in the order of mount.carrier.
template <typename Visit>
void for_each_carrier(const Mount& mount, const Visit& visit) {
    for (const Mount::CellGroup& group : mount.group) {
        for (int n = group.first; n < group.first + group.count; ++n) {
            visit(n, mount.vertex[n], trilinear_weights(mount.carrier[n].local), group.corner);
        }
    }
}

// sum N_c h_c of each vertex.
std::vector<Vec3> ways_in(const Mount& mount, const Aggregate& matter, const Surface& surface) {
    const std::vector<Vec3> off = roundings(mount, matter);
    std::vector<Mat3> facing(mount.particle.size(), Mat3::Zero());  // sum N_c |A_v| n_v n_v^T
    std::vector<Vec3> h(facing.size(), Vec3::Zero());
    for_each_carrier(mount, [&](int n, int v, const Weights& weight, const auto& corner) {
        const Vec3& area = surface.area[v];
        const double size = area.norm();
        if (!(size > 0)) return;
        const Vec3 part = std::abs(off[n].dot(area)) / size * area;
        const Mat3 faces = area * (area / size).transpose();
        for (int c = 0; c < 8; ++c) {
            facing[corner[c]] += weight[c] * faces;
            h[corner[c]] += weight[c] * part;
        }
    });
    for (std::size_t c = 0; c < h.size(); ++c) {
        const double size = facing[c].trace();
        if (!(size > 0)) continue;
        facing[c].diagonal().array() += kOneFace * size;
        h[c] = facing[c].inverse() * h[c];
    }
    std::vector<Vec3> way(off.size(), Vec3::Zero());
    for_each_carrier(mount, [&](int, int v, const Weights& weight, const auto& corner) {
        for (int c = 0; c < 8; ++c) way[v] += weight[c] * h[corner[c]];
    });
    return way;
}

}  // namespace

std::optional<double> enclosed_volume(const TriMesh& skin, const std::vector<Vec3>& position) {
    if (position.empty() || !is_closed(skin.triangle)) return {};
    return Surface(skin.triangle, position).volume;
}

void enclose_volume(const TriMesh& skin, const Mount& mount, const Aggregate& matter, double volume,
                    std::vector<Vec3>& position) {
    if (mount.kind != SkinKind::mount || position.empty() || !is_closed(skin.triangle)) return;
    const Surface first(skin.triangle, position);
    const std::vector<Vec3> way = ways_in(mount, matter, first);
    const std::vector<Vec3> rounded = position;
    double share = 0;
    constexpr int kRounds = 2;  // what is left is of the third order in the way
    for (int round = 0; round < kRounds; ++round) {
        const Surface now(skin.triangle, position);
        double per_share = 0;
        for (std::size_t v = 0; v < way.size(); ++v) per_share += way[v].dot(now.area[v]);
        if (!(per_share > 0)) return;
        share = std::clamp(share + (now.volume - volume) / per_share, -1.0, 1.0);
        for (std::size_t v = 0; v < way.size(); ++v) position[v] = rounded[v] - share * way[v];
    }
}

}  // namespace swage

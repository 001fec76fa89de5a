// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/edge_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace swage {

namespace {

constexpr double kSameSide = 0.7;  // least cosine between normals of one side of an edge
constexpr double kNear = 0.6;      // an edge lies from its patches' middles, in spacings
constexpr double kEdge = 0.25;     // of a patch's area, that goes to an edge
constexpr double kCorner = 0.0625;

// In spacings.
struct Patch {
    Vec3 place, normal;
};

std::vector<Patch> patches_of(const SurfacePoints& points, const Aggregate& matter) {
    const Lattice& lattice = matter.lattice;
    std::vector<Patch> patch;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Vec3 at = points.reference(p, matter.particle_reference);
        patch.push_back({(at - lattice.origin) / lattice.spacing, points.normal(p)});
    }
    return patch;
}

bool meet_convex(const Patch& a, const Patch& b) {
    return a.normal.dot(b.normal) < kSameSide && a.normal.cross(b.normal).norm() > 0.5 &&
           (b.normal - a.normal).dot(b.place - a.place) > 0;
}

// The place on all their planes that is nearest to their middle.
Vec3 common_place(const std::vector<Patch>& patch) {
    Vec3 middle = Vec3::Zero();
    for (const Patch& p : patch) middle += p.place / double(patch.size());
    Mat3 sides = Mat3::Zero();  // rows of normals
    Vec3 off = Vec3::Zero();
    for (std::size_t n = 0; n < patch.size(); ++n) {
        sides.row(Eigen::Index(n)) = patch[n].normal;
        off[Eigen::Index(n)] = patch[n].normal.dot(patch[n].place - middle);
    }
    if (patch.size() == 2) sides.row(2) = patch[0].normal.cross(patch[1].normal);
    return middle + sides.inverse() * off;
}

// A new point on an edge or a corner, and what each patch gives it.
struct EdgePoint {
    Vec3 place;
    std::vector<int> patch;
    double share;
};

// Where these patches meet, unless that is far from them.
bool add_meeting(const std::vector<Patch>& patch, const std::vector<int>& which, double share,
                 std::vector<EdgePoint>& found) {
    std::vector<Patch> sides;
    for (int p : which) sides.push_back(patch[p]);
    const Vec3 place = common_place(sides);
    const double far = which.size() == 2 ? kNear : 1.5 * kNear;
    for (const Patch& side : sides) {
        if (!((place - side.place).norm() < far)) return false;
    }
    found.push_back({place, which, share});
    return true;
}

// Of patches in one bin, half a cell wide.
void add_meetings(const std::vector<Patch>& patch, const std::vector<int>& in,
                  std::vector<EdgePoint>& found) {
    std::vector<std::vector<int>> edges;
    for (std::size_t p = 0; p < in.size(); ++p) {
        for (std::size_t q = p + 1; q < in.size(); ++q) {
            if (meet_convex(patch[in[p]], patch[in[q]])) edges.push_back({in[p], in[q]});
        }
    }
    const bool is_corner = edges.size() == 3 && add_meeting(patch, in, kCorner, found);
    for (const std::vector<int>& edge : edges) {
        add_meeting(patch, edge, is_corner ? 0.75 * kEdge : kEdge, found);
    }
}

std::vector<EdgePoint> edge_points(const std::vector<Patch>& patch) {
    std::vector<std::array<int, 3>> bin;
    for (const Patch& p : patch) {
        const Vec3 inner = p.place - 1e-3 * p.normal;
        std::array<int, 3>& at = bin.emplace_back();
        for (int d = 0; d < 3; ++d) at[d] = static_cast<int>(std::floor(2 * inner[d]));
    }
    std::vector<int> order(patch.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int p, int q) { return bin[p] < bin[q]; });
    std::vector<EdgePoint> found;
    for (std::size_t begin = 0, end; begin < order.size(); begin = end) {
        for (end = begin + 1; end < order.size() && bin[order[end]] == bin[order[begin]];) ++end;
        if (end - begin < 2 || end - begin > 3) continue;  // slivers of several sheets
        add_meetings(patch,
                     {order.begin() + std::ptrdiff_t(begin), order.begin() + std::ptrdiff_t(end)},
                     found);
    }
    return found;
}

}  // namespace

std::vector<int> add_edge_points(const Aggregate& matter, SurfacePoints& points) {
    const std::size_t own = points.size();
    const std::vector<Patch> patch = patches_of(points, matter);
    std::vector<int> carried_by;
    std::vector<double> given(own, 0.0);          // of a patch's area
    std::vector<Vec3> moment(own, Vec3::Zero());  // about its middle
    for (const EdgePoint& edge : edge_points(patch)) {
        const int carrier = edge.patch[0];
        const Vec3 there = points.place(carrier) + edge.place - patch[carrier].place;
        if ((there.array() < -0.25).any() || (there.array() > 1.25).any()) continue;
        double sum = 0;
        Vec3 normal = Vec3::Zero();
        for (int p : edge.patch) {
            sum += edge.share * points.area(p) / double(edge.patch.size());
            normal += patch[p].normal;
            given[p] += edge.share;
            moment[p] += edge.share * (patch[p].place - edge.place);
        }
        points.add(points.row(carrier), there, sum, normal.normalized());
        carried_by.push_back(carrier);
    }
    for (std::size_t p = 0; p < own; ++p) {
        if (given[p] == 0) continue;
        const Vec3 inward = moment[p] / (1 - given[p]);
        points.move(p, points.place(p) + inward, (1 - given[p]) * points.area(p));
    }
    return carried_by;
}

}  // namespace swage

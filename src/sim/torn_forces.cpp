// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/torn_forces.h"

#include "base/parallel.h"
#include "matter/parted.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;
constexpr double kNear = 2;  // spacings, as molded

// Of the corners that carry the point, those that hang together in its cell and carry most.
CornerMask heaviest_group(const Aggregate& matter, std::size_t point) {
    const SurfacePoints::Carriers by = matter.surface.carriers(point);
    CornerMask heaviest = kAllCorners;
    double most = 0;
    for (CornerMask together : corner_groups(matter, by.corner)) {
        double sum = 0;
        for (int c = 0; c < 8; ++c) sum += together >> c & 1 ? by.weight[c] : 0;
        if (sum > most) most = sum, heaviest = together;
    }
    return heaviest;
}

}  // namespace

// What is torn stays so, and what bore a point before does so while it is whole.
std::vector<Bearer> bearers(const Load& load, const Aggregate& matter,
                            const std::vector<Bearer>& before) {
    const std::vector<int>& point = load.point;
    std::vector<char> torn(point.size());
    parallel_each(point.size(), kChunk,
                  [&](std::size_t n) { torn[n] = is_torn(matter, std::size_t(point[n])); });
    std::vector<Bearer> bearer;
    for (std::size_t n = 0; n < point.size(); ++n) {
        if (!torn[n]) continue;
        if (bearer.empty()) {
            for (int p : point) bearer.push_back({p, kAllCorners});
        }
        if (!before.empty() && before[n].point != point[n] &&
            !is_torn(matter, std::size_t(before[n].point))) {
            bearer[n] = before[n];
            continue;
        }
        const Vec3 at = matter.surface_reference(std::size_t(point[n]));
        double nearest = kNear * matter.lattice.spacing;
        for (std::size_t m = 0; m < point.size(); ++m) {
            if (torn[m]) continue;
            const double far = (matter.surface_reference(std::size_t(point[m])) - at).norm();
            if (far < nearest) nearest = far, bearer[n].point = point[m];
        }
        if (bearer[n].point == point[n]) {
            bearer[n].corners = heaviest_group(matter, std::size_t(point[n]));
        }
    }
    return bearer;
}

SurfacePoints::Carriers carriers_by(const Bearer& bearer, const Aggregate& matter) {
    SurfacePoints::Carriers by = matter.surface.carriers(std::size_t(bearer.point));
    if (bearer.corners == kAllCorners) return by;
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        if (!(bearer.corners >> c & 1)) by.weight[c] = 0;
        sum += by.weight[c];
    }
    for (double& weight : by.weight) weight /= sum;
    return by;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/cut_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "matter/bent_path.h"
#include "matter/broken_cells.h"

namespace swage {

namespace {

constexpr double kBeside = 1;  // cells
constexpr std::size_t kMost = 3;
constexpr double kAlong = 1e-3;  // of a normal that stands across a direction
constexpr double kOn = 1e-3;     // cells, of a plane that goes through the face itself

Vec3 in_doubles(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

double CutPlane::height(const Vec3& of) const {
    const Vec3 way = of - place;
    const double high = way.dot(normal);
    return is_flat ? high : high - 0.5 * way.dot(bend * way);
}

double CutPlane::distance(const Vec3& from) const {
    const Vec3 way = from - place;
    const double straight = way.dot(normal), across = std::abs(height(from));
    const double along = std::sqrt(std::max(0.0, way.squaredNorm() - straight * straight));
    const double past = std::max(0.0, along - kBeside);
    return std::sqrt(across * across + past * past);
}

CutPlanes::CutPlanes(const Aggregate& matter) : point_(matter.cut) {
    for (std::size_t n = 0; n < point_.size(); ++n) {
        const Vec3i bin = in_doubles(point_[n].place).array().floor().cast<int>();
        binned_.push_back({key_of(bin), static_cast<int>(n)});
    }
    std::sort(binned_.begin(), binned_.end(), [](const Binned& a, const Binned& b) {
        return std::tie(a.bin, a.point) < std::tie(b.bin, b.point);
    });
}

std::vector<CutPlane> CutPlanes::around(const Vec3& place, double reach) const {
    std::vector<std::pair<double, int>> near;  // by squared distance
    const Vec3i low = (place.array() - reach).floor().cast<int>(),
                high = (place.array() + reach).floor().cast<int>();
    for (int k = low.z(); k <= high.z(); ++k) {
        for (int j = low.y(); j <= high.y(); ++j) {
            for (int i = low.x(); i <= high.x(); ++i) {
                const std::uint64_t bin = key_of(Vec3i(i, j, k));
                auto at = std::lower_bound(
                    binned_.begin(), binned_.end(), bin,
                    [](const Binned& one, std::uint64_t key) { return one.bin < key; });
                for (; at != binned_.end() && at->bin == bin; ++at) {
                    const double far =
                        (in_doubles(point_[std::size_t(at->point)].place) - place).squaredNorm();
                    if (far < reach * reach) near.emplace_back(far, at->point);
                }
            }
        }
    }
    std::sort(near.begin(), near.end());
    std::vector<CutPlane> all, planes;
    all.reserve(near.size());
    for (const auto& [far, point] : near) {
        const CutPoint& cut = point_[std::size_t(point)];
        all.push_back({in_doubles(cut.place), in_doubles(cut.normal)});
    }
    for (const CutPlane& plane : all) {
        const bool is_new = std::ranges::none_of(planes, [&](const CutPlane& known) {
            return std::abs(known.normal.dot(plane.normal)) > kOneWay;
        });
        if (is_new) planes.push_back(plane);
        if (planes.size() == kMost) break;
    }
    return bends(planes, all) ? bent_paths(place, all, kMost) : planes;
}

std::optional<CutPlane> cut_before(const Aggregate& matter, const CutPlanes& cuts,
                                   const Vec3i& site, int face) {
    if (cuts.empty()) return {};
    const Vec3i out = (face & 1 ? 1 : -1) * Vec3i::Unit(face >> 1);
    const CellId beyond = matter.lattice.cell_at(site + out);
    if (any_damaged(matter) &&
        closes_as_crack(matter, matter.lattice.cell_row(beyond), face >> 1)) {
        return {};
    }
    const Vec3 middle = site.cast<double>() + Vec3::Constant(0.5) + 0.5 * out.cast<double>();
    // The first that the way out meets: a plane along it, as of a crossing cut, passes by.
    std::optional<CutPlane> first;
    double least = std::numeric_limits<double>::infinity();
    for (const CutPlane& plane : cuts.around(middle)) {
        const double along = plane.normal.dot(out.cast<double>());
        if (std::abs(along) < kAlong) continue;
        const double far = (plane.place - middle).dot(plane.normal) / along;
        if (!(far > -kOn && far < least)) continue;
        least = far;
        first = plane;
    }
    return first;
}

}  // namespace swage

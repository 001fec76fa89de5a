// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/thin_ends.h"

#include <algorithm>
#include <utility>

namespace swage {

namespace {

constexpr double kOn = 1e-3;     // cells that places may be off for being kept as floats
constexpr double kAlong = 1e-3;  // sine of the angle between a connection and a plane along it
constexpr int kWays = 27;

int way_number(const Vec3i& way) { return (way.x() + 1) + 3 * (way.y() + 1) + 9 * (way.z() + 1); }

// Any cell that holds both ends.
template <typename Visit>
void for_each_cell_along(const Lattice& lattice, const Vec3i& site, const Vec3i& way,
                         const Visit& visit) {
    for (int c = 0; c < 8; ++c) {
        const Vec3i low = site - corner_step(c), end = corner_step(c) + way;
        if ((end.array() < 0).any() || (end.array() > 1).any()) continue;
        const CellId cell = lattice.cell_at(low);
        if (cell >= 0) visit(cell, c);
    }
}

bool is_connection(const Lattice& lattice, const Vec3i& site, const Vec3i& way) {
    bool found = false;
    for_each_cell_along(lattice, site, way, [&](CellId, int) { found = true; });
    return found;
}

// Whether there is matter half-way along an axis.
bool is_within(const Lattice& lattice, const RestSurface& molded, const Vec3i& site,
               const Vec3i& way) {
    bool found = false;
    for_each_cell_along(lattice, site, way, [&](CellId cell, int c) {
        Vec3 place = (Vec3::Ones() + 2 * corner_step(c).cast<double>()) / 4;
        for (int d = 0; d < 3; ++d) {
            if (way[d] != 0) place[d] = 0.5;
        }
        found = found || !molded.is_rim(cell) || molded.at(cell, place).distance < 0;
    });
    return found;
}

}  // namespace

// NOTE: cut points do not say of which connection they are. Where a plane goes through a particle,
// which all connections from that meet at one place, its normal tells which of them are severed
// there. Two that cross are severed at their middle by one plane at most; the first one stays.
ThinEnds::ThinEnds(const Aggregate& of, const RestSurface& molded, const ThinNear& near,
                   const std::vector<Vec3i>& site,
                   const std::function<int(const Vec3i&)>& number_at)
    : site_(site) {
    const Lattice& lattice = of.lattice;
    const Vec3 reach = Vec3::Constant(1 + kOn);
    for (int c : near.cut.around(site, -2, 1)) {  // no farther than that from any
        const CutPoint& cut = of.cut[std::size_t(c)];
        const Vec3 place(cut.place[0], cut.place[1], cut.place[2]);
        const Vec3 normal(cut.normal[0], cut.normal[1], cut.normal[2]);
        const Vec3i from = (place - reach).array().ceil().cast<int>();
        for (int n = 0; n < kWays; ++n) {
            const Vec3i at = from + Vec3i::Ones() + neighbor_step(n);
            const int number = number_at(at);
            if (number < 0) continue;
            const Vec3 off = place - at.cast<double>();
            for (int m = 0; m < kWays; ++m) {
                const Vec3i way = neighbor_step(m);
                if (way.isZero()) continue;
                const Vec3 along = way.cast<double>();
                const double share = off.dot(along) / along.squaredNorm(),
                             out = normal.dot(along) / along.norm();
                const bool is_far = share > 0.5 + kOn || (share > 0.5 - kOn && out < 0);
                if (share < -kOn || share > 1 + kOn || (is_far ? -out : out) < kAlong ||
                    (off - share * along).cwiseAbs().maxCoeff() > kOn || number_at(at + way) >= 0 ||
                    !is_connection(lattice, at, way)) {
                    continue;
                }
                end_.push_back({kWays * number + m, {place, is_far ? -normal : normal}});
            }
        }
    }
    const auto in_order = [](const End& a, const End& b) { return a.key < b.key; };
    const auto is_same = [](const End& a, const End& b) { return a.key == b.key; };
    std::stable_sort(end_.begin(), end_.end(), in_order);
    end_.erase(std::unique(end_.begin(), end_.end(), is_same), end_.end());
    std::vector<End> half_way;
    for (std::size_t n = 0; n < site.size(); ++n) {
        for (int face = 0; face < 6; ++face) {
            const Vec3i way = (face & 1 ? 1 : -1) * Vec3i::Unit(face >> 1);
            if (number_at(site[n] + way) >= 0 || toward(int(n), way) != nullptr ||
                !is_within(lattice, molded, site[n], way)) {
                continue;
            }
            const Vec3 out = way.cast<double>();
            half_way.push_back(
                {kWays * int(n) + way_number(way), {site[n].cast<double>() + 0.5 * out, out}});
        }
    }
    end_.insert(end_.end(), half_way.begin(), half_way.end());
    std::stable_sort(end_.begin(), end_.end(), in_order);
}

const CutPlane* ThinEnds::toward(int number, const Vec3i& way) const {
    const int key = kWays * number + way_number(way);
    const auto at = std::lower_bound(end_.begin(), end_.end(), key,
                                     [](const End& one, int other) { return one.key < other; });
    return at != end_.end() && at->key == key ? &at->plane : nullptr;
}

std::pair<std::size_t, std::size_t> ThinEnds::range_of(int number) const {
    const auto begins = [&](int of) {
        const auto at = std::lower_bound(end_.begin(), end_.end(), kWays * of,
                                         [](const End& one, int key) { return one.key < key; });
        return std::size_t(at - end_.begin());
    };
    return {begins(number), begins(number + 1)};
}

std::vector<CutPlane> ThinEnds::of(int number) const {
    std::vector<CutPlane> planes;
    const auto [begin, end] = range_of(number);
    for (std::size_t n = begin; n < end; ++n) planes.push_back(end_[n].plane);
    return planes;
}

void ThinEnds::add_nearest(const Vec3& place, const std::vector<int>& numbers,
                           const std::vector<int>& own, std::vector<CutPlane>& planes) const {
    std::vector<std::pair<double, std::size_t>> near;
    for (int number : numbers) {
        const auto [begin, end] = range_of(number);
        for (std::size_t n = begin; n < end; ++n) {
            near.emplace_back((end_[n].plane.place - place).squaredNorm(), n);
        }
    }
    std::sort(near.begin(), near.end());
    for (const auto& [far, n] : near) {
        const CutPlane& plane = end_[n].plane;
        const bool is_known = std::ranges::any_of(planes, [&](const CutPlane& known) {
            return known.normal.dot(plane.normal) > kOneWay;
        });
        const bool goes_through = std::ranges::any_of(own, [&](int number) {
            const Vec3 at = site_[std::size_t(number)].cast<double>();
            return (at - plane.place).dot(plane.normal) > kOn;
        });
        if (!is_known && !goes_through) planes.push_back(plane);
    }
}

std::vector<CutPlane> ThinEnds::around(const Vec3& place, const std::vector<int>& own,
                                       const std::vector<int>& beside) const {
    std::vector<CutPlane> planes;
    add_nearest(place, own, own, planes);
    add_nearest(place, beside, own, planes);
    return planes;
}

}  // namespace swage

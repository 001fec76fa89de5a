// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/rest_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr int kRings = 2;               // cells around a surface point that are rim
constexpr double kReach = 1.0;          // of a point's weight along the surface
constexpr double kSameSide = 0.7;       // least cosine between normals of one side of an edge
constexpr double kInterpolates = 0.04;  // error of interpolated distances that serves
constexpr std::size_t kChunk = 256;

std::uint64_t key_of(const Vec3i& site) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i + (1 << 20)) & 0x1FFFFF; };
    return part(site.x()) | part(site.y()) << 21 | part(site.z()) << 42;
}

Vec3i floor_of(const Vec3& g) { return g.array().floor().cast<int>(); }

double weight_of(int corner, const Vec3& p) {
    double w = 1;
    for (int d = 0; d < 3; ++d) w *= corner >> d & 1 ? p[d] : 1 - p[d];
    return w;
}

}  // namespace

RestSurface::RestSurface(const Lattice& lattice, const SurfacePoints& surface) {
    const CellRun& last = lattice.cell_run.back();
    slot_.assign(last.first + last.count, -1);
    const double a = lattice.spacing;
    std::vector<Vec3> place;
    std::vector<std::uint64_t> key;
    for (const Vec3& x : surface.reference_position) {
        place.push_back((x - lattice.origin) / a);
        // A point on a face between bins belongs to the inner one.
        const Vec3 inner = place.back() - 1e-3 * surface.reference_normal[place.size() - 1];
        key.push_back(key_of(floor_of(inner)));
    }
    std::vector<int> order(place.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int p, int q) { return key[p] < key[q]; });
    for (int p : order) {
        if (bin_.empty() || bin_.back().key != key[p]) {
            bin_.push_back({key[p], static_cast<int>(point_.size()), 0});
        }
        ++bin_.back().count;
        point_.push_back(place[p]);
        normal_.push_back(surface.reference_normal[p]);
    }

    std::vector<CellId> rim;
    for (const Site& bin : bin_) {
        const Vec3i site = floor_of(point_[bin.first] - 1e-3 * normal_[bin.first]);
        for (int k = -kRings; k <= kRings; ++k) {
            for (int j = -kRings; j <= kRings; ++j) {
                for (int i = -kRings; i <= kRings; ++i) {
                    const CellId cell = lattice.cell_at(site.x() + i, site.y() + j, site.z() + k);
                    if (cell < 0 || slot_[cell] == 0) continue;
                    slot_[cell] = 0;
                    rim.push_back(cell);
                }
            }
        }
    }
    std::sort(rim.begin(), rim.end());
    for (std::size_t n = 0; n < rim.size(); ++n) slot_[rim[n]] = static_cast<int>(n);
    auto run = lattice.cell_run.begin();
    for (CellId cell : rim) {
        while (cell >= run->first + run->count) ++run;
        site_.emplace_back(run->i + cell - run->first, run->j, run->k);
    }
    measure();
    for (std::size_t n = 0; n < rim.size(); ++n) {
        const auto& c = corner_[n];
        const bool shallow = *std::max_element(c.begin(), c.end()) > -0.999f;
        if (shallow || list_begin_[n] < list_begin_[n + 1]) skin_.push_back(rim[n]);
    }
}

std::vector<int> RestSurface::points_near(const Vec3i& site, int rings) const {
    std::vector<int> found;
    for (int k = -rings; k <= rings; ++k) {
        for (int j = -rings; j <= rings; ++j) {
            for (int i = -rings; i <= rings; ++i) {
                const std::uint64_t key = key_of(site + Vec3i(i, j, k));
                const auto at = std::lower_bound(
                    bin_.begin(), bin_.end(), key,
                    [](const Site& s, std::uint64_t wanted) { return s.key < wanted; });
                if (at == bin_.end() || at->key != key) continue;
                for (int p = at->first; p < at->first + at->count; ++p) found.push_back(p);
            }
        }
    }
    return found;
}

RestSurface::Depth RestSurface::blend(const Vec3& g, int nearest, const int* begin,
                                      const int* end) const {
    const Vec3& side = normal_[nearest];
    double sum = 0, own = 0;
    Vec3 normal = Vec3::Zero(), arm = Vec3::Zero();
    for (const int* p = begin; p != end; ++p) {
        const Vec3& n = normal_[*p];
        if (n.dot(side) < kSameSide) continue;
        const Vec3 way = g - point_[*p];
        const double d = n.dot(way), along = 1 - (way.squaredNorm() - d * d) / (kReach * kReach);
        if (along <= 0) continue;
        const double w = along * along;
        sum += w;
        own += w * d;
        normal += w * n;
        arm += w * way;
    }
    const Vec3 way = g - point_[nearest];
    if (!(sum > 0)) return {side.dot(way), side};
    normal.normalize();
    return {0.5 * (own + normal.dot(arm)) / sum, normal};
}

RestSurface::Depth RestSurface::direct(const Vec3& g, const int* begin, const int* end) const {
    int nearest = *begin;
    double least = std::numeric_limits<double>::infinity();
    for (const int* p = begin; p != end; ++p) {
        const double far = (g - point_[*p]).squaredNorm();
        if (far < least) least = far, nearest = *p;
    }
    return blend(g, nearest, begin, end);
}

void RestSurface::measure() {
    const std::vector<Vec3i>& cells = site_;
    // Corners of the rim, each once.
    std::unordered_map<std::uint64_t, int> number;  // looked up only
    std::vector<Vec3i> corner;
    std::vector<std::array<int, 8>> of_cell(cells.size());
    for (std::size_t n = 0; n < cells.size(); ++n) {
        for (int c = 0; c < 8; ++c) {
            const Vec3i at = cells[n] + Vec3i(c & 1, c >> 1 & 1, c >> 2);
            const auto [entry, is_new] =
                number.try_emplace(key_of(at), static_cast<int>(corner.size()));
            if (is_new) corner.push_back(at);
            of_cell[n][c] = entry->second;
        }
    }
    std::vector<float> distance(corner.size());
    parallel_for((corner.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t stop = std::min(corner.size(), (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < stop; ++n) {
            const Vec3 g = corner[n].cast<double>();
            std::vector<int> near;
            for (int rings = 1; near.empty() && rings <= kRings + 2; ++rings) {
                near = points_near(corner[n], rings);
            }
            // The nearest first, then all around the foot that it leads to.
            const Depth rough = direct(g, near.data(), near.data() + near.size());
            const Vec3 foot = g - rough.distance * rough.gradient;
            for (int p : points_near(floor_of(foot), 1)) near.push_back(p);
            std::sort(near.begin(), near.end());
            near.erase(std::unique(near.begin(), near.end()), near.end());
            distance[n] =
                static_cast<float>(direct(g, near.data(), near.data() + near.size()).distance);
        }
    });
    corner_.resize(cells.size());
    std::vector<std::vector<int>> list(cells.size());
    parallel_for((cells.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t stop = std::min(cells.size(), (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < stop; ++n) {
            for (int c = 0; c < 8; ++c) corner_[n][c] = distance[of_cell[n][c]];
            const auto [low, high] = std::minmax_element(corner_[n].begin(), corner_[n].end());
            if (*high < -1 && *low > -4) continue;
            const std::vector<int> near = points_near(cells[n], 1);
            if (near.empty()) continue;
            bool serves = true;
            for (int s = 0; s < 9 && serves; ++s) {
                const Vec3 p =
                    s == 8 ? Vec3::Constant(0.5)
                           : Vec3(Vec3::Constant(0.2) + 0.6 * Vec3(s & 1, s >> 1 & 1, s >> 2));
                double mean = 0;
                for (int c = 0; c < 8; ++c) mean += weight_of(c, p) * corner_[n][c];
                const double exact =
                    direct(cells[n].cast<double>() + p, near.data(), near.data() + near.size())
                        .distance;
                serves = std::abs(mean - exact) < kInterpolates || (mean < -1 && exact < -1);
            }
            if (!serves) list[n] = near;
        }
    });
    list_begin_.push_back(0);
    for (const std::vector<int>& one : list) {
        list_.insert(list_.end(), one.begin(), one.end());
        list_begin_.push_back(static_cast<int>(list_.size()));
    }
}

RestSurface::Depth RestSurface::at(CellId cell, const Vec3& p) const {
    const int n = slot_[cell];
    const int *begin = list_.data() + list_begin_[n], *end = list_.data() + list_begin_[n + 1];
    if (begin != end) return direct(site_[n].cast<double>() + p, begin, end);
    const auto& d = corner_[n];
    const Vec3 q = Vec3::Ones() - p;
    const double d00 = q.x() * d[0] + p.x() * d[1], d10 = q.x() * d[2] + p.x() * d[3],
                 d01 = q.x() * d[4] + p.x() * d[5], d11 = q.x() * d[6] + p.x() * d[7];
    const double d0 = q.y() * d00 + p.y() * d10, d1 = q.y() * d01 + p.y() * d11;
    const double gx0 = q.y() * (d[1] - d[0]) + p.y() * (d[3] - d[2]),
                 gx1 = q.y() * (d[5] - d[4]) + p.y() * (d[7] - d[6]);
    return {q.z() * d0 + p.z() * d1,
            Vec3(q.z() * gx0 + p.z() * gx1, q.z() * (d10 - d00) + p.z() * (d11 - d01), d1 - d0)};
}

}  // namespace swage

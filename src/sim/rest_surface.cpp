// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/rest_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr int kRings = 2;               // cells around a surface point that are rim
constexpr double kReach = 1.0;          // of a point's weight along the surface
constexpr double kBeyond = 1.1;         // the nearest point, that points count
constexpr double kSupport = 0.6;        // from a place's foot to its side's nearest point
constexpr double kSameSide = 0.7;       // least cosine between normals of one side of an edge
constexpr double kInterpolates = 0.03;  // error of interpolated distances that serves
constexpr double kDeep = 0.999;         // nothing comes as deep: a spacing, but for round-off
constexpr double kEdge = 0.02;          // by how much the mean over an edge may lie outside
constexpr int kMostSides = 4;
constexpr std::size_t kChunk = 64;

// A distance where the cells end. What is deeper there lies beyond a sliver that is no cell; where
// parts are thinner than a cell it may be deep by what lies behind them, which is none of it.
double at_end(double distance) {
    const bool is_sliver = distance <= -kEdge && distance >= -kSliver;
    return distance < 0 && !is_sliver ? 0 : distance;
}

Vec3i floor_of(const Vec3& g) { return g.array().floor().cast<int>(); }

}  // namespace

SurfaceDepth interpolate_depth(const std::array<float, 8>& d, const Vec3& p) {
    const Vec3 q = Vec3::Ones() - p;
    const double d00 = q.x() * d[0] + p.x() * d[1], d10 = q.x() * d[2] + p.x() * d[3],
                 d01 = q.x() * d[4] + p.x() * d[5], d11 = q.x() * d[6] + p.x() * d[7];
    const double d0 = q.y() * d00 + p.y() * d10, d1 = q.y() * d01 + p.y() * d11;
    const double gx0 = q.y() * (d[1] - d[0]) + p.y() * (d[3] - d[2]),
                 gx1 = q.y() * (d[5] - d[4]) + p.y() * (d[7] - d[6]);
    return {q.z() * d0 + p.z() * d1,
            Vec3(q.z() * gx0 + p.z() * gx1, q.z() * (d10 - d00) + p.z() * (d11 - d01), d1 - d0)};
}

RestSurface::RestSurface(const Aggregate& matter, bool ends) : ends_(ends) {
    const Lattice& lattice = matter.lattice;
    bin_points(matter);
    std::vector<Vec3i> site_of_bin;
    for (const Site& bin : bin_) {
        site_of_bin.push_back(floor_of(point_[bin.first] - 1e-3 * normal_[bin.first]));
    }
    if (!bin_.empty()) index_rows(site_of_bin);
    const std::vector<CellId> rim = find_rim(lattice, site_of_bin);
    measure_corners(lattice);
    std::vector<char> is_fine(rim.size());
    find_fine(is_fine);
    measure_fine(lattice, is_fine);
    for (std::size_t n = 0; n < rim.size(); ++n) {
        const auto& c = corner_[n];
        const bool shallow = *std::max_element(c.begin(), c.end()) > -kDeep;
        if (shallow || is_fine[n]) skin_.push_back(rim[n]);
    }
}

bool RestSurface::is_shared(const Aggregate& a, const Aggregate& b) {
    const Lattice &la = a.lattice, &lb = b.lattice;
    const auto is_same = [](const CellRun& one, const CellRun& other) {
        return one.i == other.i && one.j == other.j && one.k == other.k &&
               one.first == other.first && one.count == other.count && one.row == other.row;
    };
    if (a.surface.size() != b.surface.size() || la.cell_run.size() != lb.cell_run.size() ||
        la.spacing != lb.spacing || la.origin != lb.origin || la.cell_count != lb.cell_count ||
        a.particle_count() != b.particle_count()) {
        return false;
    }
    const auto step = [](const Aggregate& matter) {
        return matter.particle_reference.in_cell(0, Vec3::Ones());
    };
    return a.particle_reference.at(0) == b.particle_reference.at(0) && step(a) == step(b) &&
           std::equal(la.cell_run.begin(), la.cell_run.end(), lb.cell_run.begin(), is_same) &&
           a.surface == b.surface;
}

void RestSurface::bin_points(const Aggregate& matter) {
    const Lattice& lattice = matter.lattice;
    const SurfacePoints& surface = matter.surface;
    std::vector<Vec3> place;
    std::vector<std::uint64_t> key;
    for (std::size_t p = 0; p < surface.size(); ++p) {
        place.push_back((matter.surface_reference(p) - lattice.origin) / lattice.spacing);
        // A point on a face between bins belongs to the inner one.
        const Vec3 inner = place.back() - 1e-3 * surface.normal(p);
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
        normal_.push_back(surface.normal(p));
    }
}

void RestSurface::index_rows(const std::vector<Vec3i>& site_of_bin) {
    Vec3i high = row_low_ = site_of_bin[0];
    for (const Vec3i& s : site_of_bin) {
        row_low_ = row_low_.cwiseMin(s);
        high = high.cwiseMax(s);
    }
    row_count_ = high - row_low_ + Vec3i::Ones();
    for (std::size_t n = 0; n < bin_.size(); ++n) {
        const Vec3i at = site_of_bin[n] - row_low_;
        row_.resize(std::size_t(at.z() * row_count_.y() + at.y() + 1), int(n));
    }
    row_.resize(std::size_t(row_count_.y() * row_count_.z() + 1), int(bin_.size()));
}

// The cells around the bins, in their order: each gets a slot.
std::vector<CellId> RestSurface::find_rim(const Lattice& lattice,
                                          const std::vector<Vec3i>& site_of_bin) {
    const CellRun& last = lattice.cell_run.back();
    slot_.assign(last.first + last.count, -1);
    std::vector<CellId> rim;
    for (const Vec3i& site : site_of_bin) {
        for (int k = -kRings; k <= kRings; ++k) {
            for (int j = -kRings; j <= kRings; ++j) {
                for (int i = -kRings; i <= kRings; ++i) {
                    const CellId cell = lattice.cell_at(site + Vec3i(i, j, k));
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
    return rim;
}

// Points within `reach` of the box.
void RestSurface::gather(const Vec3& low, const Vec3& high, double reach, Near& near) const {
    near.point.clear();
    near.reach = reach;
    const Vec3i from = floor_of(low - Vec3::Constant(reach)),
                to = floor_of(high + Vec3::Constant(reach)), first = (from - row_low_).cwiseMax(0),
                last = (to - row_low_).cwiseMin(row_count_ - Vec3i::Ones());
    for (int k = first.z(); k <= last.z(); ++k) {
        for (int j = first.y(); j <= last.y(); ++j) {
            const std::size_t row = std::size_t(k * row_count_.y() + j);
            const std::uint64_t stop = key_of({to.x(), j + row_low_.y(), k + row_low_.z()});
            const auto end = bin_.begin() + row_[row + 1];
            auto at =
                std::lower_bound(bin_.begin() + row_[row], end,
                                 key_of({from.x(), j + row_low_.y(), k + row_low_.z()}),
                                 [](const Site& s, std::uint64_t key) { return s.key < key; });
            for (; at != end && at->key <= stop; ++at) {
                for (int p = at->first; p < at->first + at->count; ++p) {
                    const Vec3 out = (low - point_[p]).cwiseMax(point_[p] - high).cwiseMax(0.0);
                    if (out.squaredNorm() <= reach * reach) near.point.push_back(p);
                }
            }
        }
    }
}

double RestSurface::distance(const Vec3& g, const Near& near) const {
    double least = std::numeric_limits<double>::infinity();
    for (int p : near.point) least = std::min(least, (g - point_[p]).squaredNorm());
    const double most = std::sqrt(least) + kBeyond;
    // A point lies within 0.001 of its bin.
    if (!(most <= near.reach - 0.01)) return std::numeric_limits<double>::quiet_NaN();
    struct Seen {
        int point, side;
        double far;
    };
    thread_local std::vector<Seen> seen;
    seen.clear();
    for (int p : near.point) {
        const double far = (g - point_[p]).squaredNorm();
        if (far < most * most) seen.push_back({p, -1, far});
    }
    double result = 0;
    int first = -1;
    for (int side = 0; side < kMostSides; ++side) {
        const Seen* nearest = nullptr;
        for (const Seen& s : seen) {
            if (s.side < 0 && (nearest == nullptr || s.far < nearest->far)) nearest = &s;
        }
        if (nearest == nullptr) break;
        const int begin = nearest->point;
        double sum = 0, own = 0, foot = std::numeric_limits<double>::infinity();
        Vec3 normal = Vec3::Zero(), arm = Vec3::Zero();
        for (Seen& s : seen) {
            const Vec3& n = normal_[s.point];
            if (n.dot(normal_[begin]) < kSameSide) continue;
            if (s.side < 0) s.side = side;
            const Vec3 way = g - point_[s.point];
            const double d = n.dot(way), along = s.far - d * d;
            foot = std::min(foot, along);
            if (along >= kReach * kReach) continue;
            const double w = (1 - along / (kReach * kReach)) * (1 - along / (kReach * kReach));
            sum += w;
            own += w * d;
            normal += w * n;
            arm += w * way;
        }
        const double d = sum > 0 ? 0.5 * (own + normal.normalized().dot(arm)) / sum
                                 : normal_[begin].dot(g - point_[begin]);
        if (side == 0) {
            first = begin;
            result = d;
            continue;
        }
        const double convex = (normal_[begin] - normal_[first]).dot(point_[begin] - point_[first]);
        if (convex < 0) {
            result = std::min(result, d);
        } else if (foot < kSupport * kSupport) {
            result = std::max(result, d);
        }
    }
    return result;
}

double RestSurface::distance(const Vec3& g) const {
    Near near;
    for (double reach = 2; reach < 1e6; reach *= 1.5) {
        gather(g, g, reach, near);
        const double d = distance(g, near);
        if (!std::isnan(d)) return d;
    }
    return -1e6;
}

void RestSurface::measure_corners(const Lattice& lattice) {
    // Corners of the rim, each once.
    std::unordered_map<std::uint64_t, int> number;  // looked up only
    std::vector<Vec3i> corner;
    std::vector<std::array<int, 8>> of_cell(site_.size());
    for (std::size_t n = 0; n < site_.size(); ++n) {
        for (int c = 0; c < 8; ++c) {
            const Vec3i at = site_[n] + corner_step(c);
            const auto [entry, is_new] =
                number.try_emplace(key_of(at), static_cast<int>(corner.size()));
            if (is_new) corner.push_back(at);
            of_cell[n][c] = entry->second;
        }
    }
    std::vector<float> value(corner.size());
    parallel_each(corner.size(), kChunk, [&](std::size_t n) {
        value[n] = static_cast<float>(distance(corner[n].cast<double>()));
        bool is_outer = false;
        for (int c = 0; c < 8; ++c) {
            is_outer = is_outer || lattice.cell_at(corner[n] - corner_step(c)) < 0;
        }
        if (is_outer && ends_) value[n] = static_cast<float>(at_end(value[n]));
    });
    corner_.resize(site_.size());
    for (std::size_t n = 0; n < site_.size(); ++n) {
        for (int c = 0; c < 8; ++c) corner_[n][c] = value[of_cell[n][c]];
    }
}

// Whether all that is near lies in a few planes, of which one is the nearest to all of the cell.
bool RestSurface::is_flat(int slot, const Near& near) const {
    constexpr double kSame = 1e-6, kRounds = 1e-5;
    std::array<int, kMostSides> plane;
    int planes = 0;
    for (int p : near.point) {
        const auto holds = [&](int q) {
            return (normal_[p] - normal_[q]).squaredNorm() < kSame * kSame &&
                   std::abs(normal_[q].dot(point_[p] - point_[q])) < kSame;
        };
        if (std::any_of(plane.begin(), plane.begin() + planes, holds)) continue;
        if (planes == kMostSides) return false;
        plane[planes++] = p;
    }
    bool found = false;
    for (int q = 0; q < planes; ++q) {
        bool is_this = true;
        for (int c = 0; c < 8; ++c) {
            const Vec3 at = (site_[slot] + corner_step(c)).cast<double>();
            const double off = normal_[plane[q]].dot(at - point_[plane[q]]) - corner_[slot][c];
            if (off > kRounds) return false;
            is_this = is_this && off > -kRounds;
        }
        found = found || is_this;
    }
    return found;
}

// Cells whose corners do not tell enough: a gentle error, but not in what lies deep.
void RestSurface::find_fine(std::vector<char>& is_fine) const {
    parallel_each(site_.size(), kChunk, [&](std::size_t n) {
        const auto [low, high] = std::minmax_element(corner_[n].begin(), corner_[n].end());
        if (*high < -kDeep && -4 < *low) return;
        const Vec3 site = site_[n].cast<double>();
        Near near;
        gather(site, site + Vec3::Ones(), 2.2, near);
        if (is_flat(static_cast<int>(n), near)) return;
        for (int s = 0; s < 9 && !is_fine[n]; ++s) {
            const Vec3 p = s == 8
                               ? Vec3::Constant(0.5)
                               : Vec3(Vec3::Constant(0.2) + 0.6 * Vec3(s & 1, s >> 1 & 1, s >> 2));
            const double mean = interpolate_depth(corner_[n], p).distance;
            double exact = distance(site + p, near);
            if (std::isnan(exact)) exact = distance(site + p);
            is_fine[n] =
                !(std::abs(mean - exact) < kInterpolates || (mean < -kDeep && exact < -kDeep));
        }
    });
}

void RestSurface::measure_fine(const Lattice& lattice, const std::vector<char>& is_fine) {
    fine_of_.assign(site_.size(), -1);
    std::vector<int> slot;
    for (std::size_t n = 0; n < site_.size(); ++n) {
        if (!is_fine[n]) continue;
        fine_of_[n] = static_cast<int>(slot.size());
        slot.push_back(static_cast<int>(n));
    }
    fine_.assign(slot.size(), {});
    parallel_each(slot.size(), kChunk, [&](std::size_t f) {
        const int n = slot[f];
        const Vec3 site = site_[n].cast<double>();
        // Neighbours that are sampled at their corners only.
        std::array<bool, 27> coarse, none;
        for (int m = 0; m < 27; ++m) {
            const CellId cell = lattice.cell_at(site_[n] + neighbor_step(m));
            none[m] = cell < 0;
            coarse[m] = cell >= 0 && slot_[cell] >= 0 && !is_fine[slot_[cell]];
        }
        for (int face = 0; face < 6; ++face) {
            const int d = face >> 1, u = 1 << (d + 1) % 3, v = 1 << (d + 2) % 3,
                      low = face & 1 ? 1 << d : 0;
            constexpr std::array<int, 3> kStep{1, 3, 9};
            if (!coarse[13 + (face & 1 ? 1 : -1) * kStep[d]]) continue;
            const auto& c = corner_[n];
            const double twist = double(c[low]) - c[low + u] - c[low + v] + c[low + u + v];
            fine_[f].twist[face] = twist;
            fine_[f].has_twist = fine_[f].has_twist || twist != 0;
        }
        Near near;
        gather(site, site + Vec3::Ones(), 2.2, near);
        for (int s = 0; s < kSamples; ++s) {
            const Vec3i at(s % (kFine + 1), s / (kFine + 1) % (kFine + 1),
                           s / (kFine + 1) / (kFine + 1));
            // The side of the cell that it lies on, of each axis.
            const auto side = [&](int d) { return at[d] == 0 ? -1 : at[d] == kFine ? 1 : 0; };
            const Vec3 p = at.cast<double>() / kFine;
            bool is_coarse = false, is_outer = false;
            for (int m = 0; m < 27; ++m) {
                const Vec3i to = neighbor_step(m);
                const bool shares = (to.x() == 0 || to.x() == side(0)) &&
                                    (to.y() == 0 || to.y() == side(1)) &&
                                    (to.z() == 0 || to.z() == side(2));
                is_coarse = is_coarse || (coarse[m] && shares);
                is_outer = is_outer || (none[m] && shares);
            }
            double& sample = fine_[f].sample[s];
            if (is_coarse || side(0) * side(1) * side(2) != 0) {
                sample = interpolate_depth(corner_[n], p).distance;
                continue;
            }
            sample = distance(site + p, near);
            if (std::isnan(sample)) sample = distance(site + p);
            if (is_outer && ends_) sample = at_end(sample);
        }
    });
}

RestSurface::Depth RestSurface::at_sliver(CellId cell, const Vec3& place) const {
    const Vec3 last = place.cwiseMax(0.0).cwiseMin(1.0), beyond = place - last;
    const Depth on = at(cell, place), end = at(cell, last);
    const Vec3 left = (1 - beyond.array().abs() / kSliver).max(0.0);
    const double share = left.prod();
    if (on.distance >= std::min(end.distance, 0.0) * share) return on;
    if (end.distance >= 0) return {0, end.gradient};
    Depth depth{end.distance * share, end.gradient * share};
    for (int d = 0; d < 3; ++d) {
        if (beyond[d] == 0) continue;
        const double others = left[(d + 1) % 3] * left[(d + 2) % 3];
        depth.gradient[d] = -end.distance * others * std::copysign(1 / kSliver, beyond[d]);
    }
    return depth;
}

RestSurface::Depth RestSurface::at(CellId cell, const Vec3& p) const {
    const int n = slot_[cell], f = fine_of_[n];
    if (f < 0) return interpolate_depth(corner_[n], p);
    const Fine& fine = fine_[f];
    // Of the six tetrahedra of the cube between samples, the one along whose edges the place lies.
    const Vec3i at = floor_of(kFine * p).cwiseMax(0).cwiseMin(kFine - 1);
    std::array<double, 3> along;
    std::array<int, 3> step{1, kFine + 1, (kFine + 1) * (kFine + 1)};
    std::array<int, 3> axis{0, 1, 2}, sign{kFine, kFine, kFine};
    int from = 0;
    for (int d = 0; d < 3; ++d) {
        along[d] = kFine * p[d] - at[d];
        from += at[d] * step[d];
        if (at[d] % 2 == 0) continue;
        from += step[d];
        along[d] = 1 - along[d];
        step[d] = -step[d];
        sign[d] = -kFine;
    }
    if (along[axis[0]] < along[axis[1]]) std::swap(axis[0], axis[1]);
    if (along[axis[1]] < along[axis[2]]) std::swap(axis[1], axis[2]);
    if (along[axis[0]] < along[axis[1]]) std::swap(axis[0], axis[1]);
    const double* sample = fine.sample.data() + from;
    double last = *sample;
    Depth depth{last, Vec3::Zero()};
    for (int d : axis) {
        sample += step[d];
        const double rise = *sample - last;
        last = *sample;
        depth.distance += along[d] * rise;
        depth.gradient[d] = sign[d] * rise;
    }
    if (!fine.has_twist) return depth;
    for (int face = 0; face < 6; ++face) {
        const int d = face >> 1, u = (d + 1) % 3, v = (d + 2) % 3;
        const double twist = fine.twist[face] * sign[u] * sign[v] / (kFine * kFine * kFine * kFine);
        const double near = face & 1 ? p[d] : 1 - p[d];
        const double a = along[u], b = along[v], bulge = a * b - std::min(a, b);
        depth.distance += near * twist * bulge;
        depth.gradient[d] += (face & 1 ? 1 : -1) * twist * bulge;
        depth.gradient[u] += near * twist * (b - (a < b)) * sign[u];
        depth.gradient[v] += near * twist * (a - (a >= b)) * sign[v];
    }
    return depth;
}

}  // namespace swage

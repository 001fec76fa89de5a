// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/voxel_crossings.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/box.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 128;  // faces
constexpr int kRounds = 24;
// Of the way from where the voxels have a point, after each time that its faces cross others.
constexpr std::array<double, 4> kLeft = {0.7, 0.4, 0.2, 0};
constexpr double kTouch = 1e-9;  // spacings: nearer is no crossing

struct Triangles {
    std::array<Corners, 6> triangle;
    int count = 0;
    void add(const Corners& corners) { triangle[count++] = corners; }
    const Corners* begin() const { return triangle.data(); }
    const Corners* end() const { return triangle.data() + count; }
};

// Where an edge goes through a triangle, away from the triangle's rim.
bool goes_through(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t, double touch) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double size = normal.norm();
    const double over = normal.dot(p - t[0]), under = normal.dot(q - t[0]);
    if ((over > -touch * size && under > -touch * size) ||
        (over < touch * size && under < touch * size)) {
        return false;
    }
    const Vec3 at = p + over / (over - under) * (q - p);
    for (int k = 0; k < 3; ++k) {
        const Vec3& a = t[k];
        if ((t[(k + 1) % 3] - a).cross(at - a).dot(normal) < kTouch * size * size) return false;
    }
    return true;
}

class Parting {
  public:
    Parting(const std::vector<Facet>& facet, const std::vector<Vec3>& start,
            const std::vector<char>& fixed, double spacing, std::vector<Vec3>& place)
        : facet_(facet), start_(start), fixed_(fixed), a_(spacing), place_(place) {}

    bool run() {
        std::vector<int> fresh;  // faces whose points have moved since they were looked at
        box_.resize(facet_.size());
        triangles_.resize(facet_.size());
        for (std::size_t f = 0; f < facet_.size(); ++f) {
            box_[f] = box_of(f);
            triangles_[f] = triangles_of(f);
            if (has_moved(f)) fresh.push_back(static_cast<int>(f));
        }
        if (fresh.empty()) return false;
        fill_bins();
        pulled_.assign(place_.size(), 0);
        far_ = place_;
        late_.assign(facet_.size(), 0);
        is_fresh_ = late_;
        for (int round = 0; round < kRounds; ++round) {
            std::vector<int> point = points_that_cross(fresh);
            std::erase_if(point, [&](int p) { return fixed_[p] || place_[p] == start_[p]; });
            if (point.empty()) return round > 0;
            fresh = pull_back(point);
        }
        return true;
    }

  private:
    template <typename Act>
    void for_each_point(std::size_t f, const Act& act) const {
        for (int p : facet_[f].corner) act(p);
        for (int p : facet_[f].middle) {
            if (p >= 0) act(p);
        }
    }
    Triangles triangles_of(std::size_t f) const {
        const Facet& facet = facet_[f];
        Triangles all;
        for (const Corners& half : halves_of(facet.corner, place_, facet.diagonal)) all.add(half);
        for (int k = 0; k < 4; ++k) {
            if (facet.middle[k] < 0) continue;
            const int from = facet.corner[k], to = facet.corner[(k + 1) % 4];
            for (int n = 0, end = all.count; n < end; ++n) {
                for (int side = 0; side < 3; ++side) {
                    Corners& own = all.triangle[n];
                    if (own[side] != from || own[(side + 1) % 3] != to) continue;
                    Corners other = own;
                    own[(side + 1) % 3] = other[side] = facet.middle[k];
                    all.add(other);
                }
            }
        }
        return all;
    }
    Box box_of(std::size_t f) const {
        Box box;
        for_each_point(f, [&](int p) { box.grow(place_[p]); });
        return box;
    }
    bool has_moved(std::size_t f) const {
        bool any = false;
        for_each_point(f, [&](int p) { any |= place_[p] != start_[p]; });
        return any;
    }

    // Faces lie in the bin of their low corner; those that are wider than a bin apart from them.
    void fill_bins() {
        Box all;
        for (const Box& box : box_) all.grow(box);
        low_ = all.low;
        const Vec3 size = all.high - all.low;
        width_ = a_;
        constexpr double kMostBins = 1 << 22;
        for (double bins = kMostBins + 1; bins > kMostBins; width_ *= 1.5) {
            bins = 1;
            for (int d = 0; d < 3; ++d) bins *= std::floor(size[d] / width_) + 1;
            if (bins <= kMostBins) break;
        }
        for (int d = 0; d < 3; ++d) count_[d] = static_cast<int>(size[d] / width_) + 1;
        first_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
        const auto is_wide = [&](const Box& box) {
            return (box.high - box.low).maxCoeff() > width_;
        };
        const auto bin = [&](const Box& box) {
            const std::array<int, 3> at = bin_of(box.low);
            return number_of(at[0], at[1], at[2]);
        };
        for (const Box& box : box_) {
            if (!is_wide(box)) ++first_[bin(box) + 1];
        }
        for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
        binned_.resize(first_.back());
        std::vector<int> next(first_.begin(), first_.end() - 1);
        for (std::size_t f = 0; f < box_.size(); ++f) {
            if (is_wide(box_[f])) {
                wide_.push_back(static_cast<int>(f));
            } else {
                binned_[next[bin(box_[f])]++] = static_cast<int>(f);
            }
        }
    }
    std::array<int, 3> bin_of(const Vec3& at) const {
        std::array<int, 3> bin;
        for (int d = 0; d < 3; ++d) {
            bin[d] = std::clamp(static_cast<int>((at[d] - low_[d]) / width_), 0, count_[d] - 1);
        }
        return bin;
    }
    std::size_t number_of(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * count_[1] + j) * count_[0] + i;
    }

    // Calls act(other) for faces whose boxes meet that of a fresh face, each once; of two that are
    // fresh, for the later one.
    template <typename Act>
    void for_each_near(int f, const Act& act) const {
        const Box& box = box_[f];
        const auto offer = [&](int g) {
            if ((g > f || !is_fresh_[g]) && g != f && box.overlaps(box_[g])) act(g);
        };
        const auto offer_early = [&](int g) {
            if (!late_[g]) offer(g);
        };
        const std::array<int, 3> from = bin_of(box.low - Vec3::Constant(width_));
        const std::array<int, 3> to = bin_of(box.high);
        for (int k = from[2]; k <= to[2]; ++k) {
            for (int j = from[1]; j <= to[1]; ++j) {
                const int end = first_[number_of(to[0], j, k) + 1];
                for (int n = first_[number_of(from[0], j, k)]; n < end; ++n) {
                    offer_early(binned_[n]);
                }
            }
        }
        for (int g : wide_) offer_early(g);
        for (int g : moved_) offer(g);
    }

    // Whether a triangle's corners that are not shared lie on one side of another's plane.
    bool is_beside(const Corners& s, const std::array<bool, 3>& is_shared, const Corners& t) const {
        const Vec3 &o = place_[t[0]], normal = (place_[t[1]] - o).cross(place_[t[2]] - o);
        const double touch = kTouch * a_ * normal.cwiseAbs().sum();
        bool over = false, under = false;
        for (int k = 0; k < 3; ++k) {
            if (is_shared[k]) continue;
            const double height = normal.dot(place_[s[k]] - o);
            over |= height > touch;
            under |= height < -touch;
        }
        return !(over && under);
    }

    bool cross(const Corners& s, const Corners& t) const {
        std::array<bool, 3> in_t{}, in_s{};
        int shared = 0;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                if (s[i] == t[j]) in_t[i] = in_s[j] = true, ++shared;
            }
        }
        if (shared > 1 || (is_beside(s, in_t, t) || is_beside(t, in_s, s))) return false;
        const auto pierces = [&](const Corners& own, const std::array<bool, 3>& is_shared,
                                 const Corners& other) {
            const std::array<Vec3, 3> at = {place_[other[0]], place_[other[1]], place_[other[2]]};
            for (int k = 0; k < 3; ++k) {
                const int m = (k + 1) % 3;
                if (is_shared[k] || is_shared[m]) continue;
                if (goes_through(place_[own[k]], place_[own[m]], at, kTouch * a_)) return true;
            }
            return false;
        };
        return pierces(s, in_t, t) || pierces(t, in_s, s);
    }

    // Of triangles that cross, each at least once; only pairs with a fresh face count.
    std::vector<int> points_that_cross(const std::vector<int>& fresh) {
        for (int f : fresh) is_fresh_[f] = 1;
        const auto find = [&](std::size_t begin, std::size_t end, std::vector<int>& found) {
            for (std::size_t n = begin; n < end; ++n) {
                const int f = fresh[n];
                const Triangles& own = triangles_[f];
                for_each_near(f, [&](int g) {
                    const Triangles& other = triangles_[g];
                    for (const Corners& s : own) {
                        for (const Corners& t : other) {
                            if (!cross(s, t)) continue;
                            found.insert(found.end(), s.begin(), s.end());
                            found.insert(found.end(), t.begin(), t.end());
                        }
                    }
                });
            }
        };
        std::vector<int> point = parallel_collect<int>(fresh.size(), kChunk, find);
        for (int f : fresh) is_fresh_[f] = 0;
        std::sort(point.begin(), point.end());
        point.erase(std::unique(point.begin(), point.end()), point.end());
        return point;
    }

    // Returns the faces of these points.
    std::vector<int> pull_back(const std::vector<int>& point) {
        std::vector<char> is_pulled(place_.size(), 0);
        for (int p : point) {
            is_pulled[p] = 1;
            const double left = kLeft[std::min<std::size_t>(pulled_[p]++, kLeft.size() - 1)];
            place_[p] = left > 0 ? Vec3(start_[p] + left * (far_[p] - start_[p])) : start_[p];
        }
        std::vector<int> fresh;
        for (std::size_t f = 0; f < facet_.size(); ++f) {
            bool any = false;
            for_each_point(f, [&](int p) { any |= is_pulled[p] != 0; });
            if (!any) continue;
            fresh.push_back(static_cast<int>(f));
            box_[f] = box_of(f);
            triangles_[f] = triangles_of(f);
            if (!late_[f]) late_[f] = 1, moved_.push_back(static_cast<int>(f));
        }
        return fresh;
    }

    const std::vector<Facet>& facet_;
    const std::vector<Vec3>& start_;
    const std::vector<char>& fixed_;
    const double a_;
    std::vector<Vec3>& place_;
    std::vector<Vec3> far_;              // where the points were
    std::vector<unsigned char> pulled_;  // how often each was
    std::vector<Box> box_;               // of each face
    std::vector<Triangles> triangles_;
    std::vector<int> moved_;             // faces that are no longer where the bins have them
    std::vector<char> late_, is_fresh_;  // of each face: whether it is one of those; is looked at
    Vec3 low_;
    double width_ = 0;
    std::array<int, 3> count_;
    std::vector<int> first_, binned_, wide_;  // of each bin, and the end; faces
};

}  // namespace

bool part_crossings(const std::vector<Facet>& facet, const std::vector<Vec3>& start,
                    const std::vector<char>& fixed, double spacing, std::vector<Vec3>& place) {
    return Parting(facet, start, fixed, spacing, place).run();
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Snapping as in snap rounding (Hobby, "Practical segment intersection with finite precision
// output", 1999), but to the points that are there instead of to a grid.
#include "skin/section_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "skin/flat_segment.h"

namespace swage {

namespace {

using Ends = std::pair<int, int>;

constexpr int kRounds = 12;  // until no line passes a point or another line; more are rare

// Of the first, where they cross inside of both.
std::optional<double> crossing(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const double at_a = cross(d - c, a - c), at_b = cross(d - c, b - c);
    const double at_c = cross(b - a, c - a), at_d = cross(b - a, d - a);
    if (!(at_a * at_b < 0) || !(at_c * at_d < 0)) return std::nullopt;
    return at_a / (at_a - at_b);
}

class Drawing {
  public:
    Drawing(const Section& section, double reach)
        : segment_(section.segment), reach_(reach), known_(section.point.size()) {
        for (const Vec2& p : section.point) add({-1, 0}, p);
    }

    void draw(const std::vector<std::array<Vec2, 2>>& lines) {
        for (const auto& [from, to] : lines) {
            const int a = point_at(from), b = point_at(to);
            if (a != b) line_.insert(std::minmax(a, b));
        }
        for (int round = 0; round < kRounds && divide_lines(); ++round) {
        }
        std::erase_if(line_, [&](const Ends& line) { return !is_inside(line); });
    }

    std::vector<LinePoint> hand_over(Section& section) const {
        std::vector<int> order;  // of the points that lines have
        std::vector<char> has(point_.size(), 0);
        for (const auto& [a, b] : line_) has[a] = has[b] = 1;
        for (std::size_t p = known_; p < point_.size(); ++p) {
            if (has[p]) order.push_back(static_cast<int>(p));
        }
        std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
            const LinePoint &one = on_[a], &other = on_[b];
            if (one.segment < 0 || other.segment < 0) return one.segment > other.segment;
            return std::pair(one.segment, one.share) < std::pair(other.segment, other.share);
        });
        std::vector<int> number(point_.size());
        for (std::size_t p = 0; p < known_; ++p) number[p] = static_cast<int>(p);
        std::vector<LinePoint> added;
        std::vector<int> last(segment_.size(), -1);
        for (const int p : order) {
            const int own = number[p] = static_cast<int>(section.point.size());
            section.point.push_back(point_[p]);
            added.push_back(on_[p]);
            const int s = on_[p].segment;
            if (s < 0) continue;
            // In place of the one that was: its first part; the last is what the others leave.
            if (last[s] < 0) last[s] = s;
            std::array<int, 2>& open = section.segment[last[s]];
            const int to = open[1];
            open[1] = own;
            last[s] = static_cast<int>(section.segment.size());
            section.segment.push_back({own, to});
        }
        for (const auto& [a, b] : line_) section.line.push_back({number[a], number[b]});
        return added;
    }

  private:
    using Square = std::pair<long, long>;
    Square square_of(const Vec2& p) const {
        return {std::lround(std::floor(p[0] / reach_)), std::lround(std::floor(p[1] / reach_))};
    }
    int add(const LinePoint& on, const Vec2& p) {
        const int number = static_cast<int>(point_.size());
        point_.push_back(p);
        on_.push_back(on);
        near_[square_of(p)].push_back(number);
        return number;
    }

    template <typename Test>
    int nearest(const Vec2& p, const Test& test) const {
        int found = -1;
        double least = reach_ * reach_;
        const auto [i, j] = square_of(p);
        for (long n = 0; n < 9; ++n) {
            const auto at = near_.find({i + n % 3 - 1, j + n / 3 - 1});
            if (at == near_.end()) continue;
            for (const int other : at->second) {
                const double d2 = (point_[other] - p).squaredNorm();
                if (d2 < least && test(other)) least = d2, found = other;
            }
        }
        return found;
    }
    bool is_on(int p, int segment) const {
        const auto& [a, b] = segment_[segment];
        return p == a || p == b || on_[p].segment == segment;
    }

    // One that is there, or a new one.
    int point_at(const Vec2& p) {
        const int known = nearest(p, [](int) { return true; });
        if (known >= 0) return known;
        int segment = -1;
        double least = reach_ * reach_;
        for (std::size_t s = 0; s < segment_.size(); ++s) {
            const Vec2 &a = point_[segment_[s][0]], &b = point_[segment_[s][1]];
            const double d2 = distance2_to_segment(p, a, b);
            if (d2 < least) least = d2, segment = static_cast<int>(s);
        }
        if (segment < 0) return add({-1, 0}, p);
        const Vec2 &a = point_[segment_[segment][0]], &b = point_[segment_[segment][1]];
        return point_on(segment, share_along(p, a, b));
    }
    int point_on(int segment, double share) {
        const auto& [from, to] = segment_[segment];
        const Vec2 p = point_[from] + share * (point_[to] - point_[from]);
        const int known = nearest(p, [&](int other) { return is_on(other, segment); });
        return known >= 0 ? known : add({segment, share}, p);
    }

    struct Box2 {
        Vec2 low, high;
    };
    Box2 box_of(int a, int b) const {
        const Vec2 margin(reach_, reach_);
        const Vec2 low = point_[a].cwiseMin(point_[b]) - margin;
        const Vec2 high = point_[a].cwiseMax(point_[b]) + margin;
        return {low, high};
    }
    static bool overlap(const Box2& a, const Box2& b) {
        return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
    }

    // At each point that a line passes by, and where it crosses another or a segment; false when
    // there was none.
    bool divide_lines() {
        const std::vector<Ends> line(line_.begin(), line_.end());
        std::vector<std::vector<int>> at(line.size());
        std::vector<Box2> box, around;
        for (const auto& [a, b] : line) box.push_back(box_of(a, b));
        for (const auto& [a, b] : segment_) around.push_back(box_of(a, b));
        const auto meet = [&](std::size_t n, int p) {
            if (p != line[n].first && p != line[n].second) at[n].push_back(p);
        };
        for (std::size_t n = 0; n < line.size(); ++n) {
            const auto [a, b] = line[n];
            for (std::size_t s = 0; s < segment_.size(); ++s) {
                if (!overlap(box[n], around[s])) continue;
                const auto& [c, d] = segment_[s];
                if (is_on(a, static_cast<int>(s)) || is_on(b, static_cast<int>(s))) continue;
                const auto share = crossing(point_[c], point_[d], point_[a], point_[b]);
                if (share) meet(n, point_on(static_cast<int>(s), *share));
            }
            for (std::size_t m = n + 1; m < line.size(); ++m) {
                if (!overlap(box[n], box[m])) continue;
                const auto [c, d] = line[m];
                if (a == c || a == d || b == c || b == d) continue;
                const auto share = crossing(point_[a], point_[b], point_[c], point_[d]);
                if (!share) continue;
                const Vec2 place = point_[a] + *share * (point_[b] - point_[a]);
                const int p = point_at(place);
                meet(n, p), meet(m, p);
            }
        }
        for (std::size_t n = 0; n < line.size(); ++n) {
            const Vec2 a = point_[line[n].first], b = point_[line[n].second];
            for (int p = 0; p < static_cast<int>(point_.size()); ++p) {
                const Vec2& at_p = point_[p];
                if ((at_p.array() < box[n].low.array()).any()) continue;
                if ((at_p.array() > box[n].high.array()).any()) continue;
                const double share = share_along(at_p, a, b);
                if (!(share > 0) || !(share < 1)) continue;
                if ((a + share * (b - a) - at_p).norm() < reach_) meet(n, p);
            }
        }
        bool any = false;
        line_.clear();
        for (std::size_t n = 0; n < line.size(); ++n) {
            const auto [a, b] = line[n];
            const Vec2 from = point_[a], to = point_[b];
            std::vector<int>& stop = at[n];
            any = any || !stop.empty();
            std::sort(stop.begin(), stop.end(), [&](int p, int q) {
                const double s = share_along(point_[p], from, to);
                const double t = share_along(point_[q], from, to);
                return std::pair(s, p) < std::pair(t, q);
            });
            stop.push_back(b);
            int last = a;
            for (const int p : stop) {
                if (p != last) line_.insert(std::minmax(last, p));
                last = p;
            }
        }
        return any;
    }

    // In the section, and not on its rim.
    bool is_inside(const Ends& line) const {
        const auto& [a, b] = line;
        const Vec2 middle = 0.5 * (point_[a] + point_[b]);
        bool inside = false;
        for (std::size_t s = 0; s < segment_.size(); ++s) {
            if (is_on(a, static_cast<int>(s)) && is_on(b, static_cast<int>(s))) return false;
            const Vec2 &c = point_[segment_[s][0]], &d = point_[segment_[s][1]];
            if ((c[1] > middle[1]) == (d[1] > middle[1])) continue;
            const double x = c[0] + (middle[1] - c[1]) / (d[1] - c[1]) * (d[0] - c[0]);
            if (x > middle[0]) inside = !inside;
        }
        return inside;
    }

    const std::vector<std::array<int, 2>> segment_;
    const double reach_;
    const std::size_t known_;  // points of the section
    std::vector<Vec2> point_;
    std::vector<LinePoint> on_;
    std::map<Square, std::vector<int>> near_;
    std::set<Ends> line_;
};

}  // namespace

std::vector<LinePoint> add_lines(const std::vector<std::array<Vec2, 2>>& lines, double reach,
                                 Section& section) {
    Drawing drawing(section, reach);
    drawing.draw(lines);
    return drawing.hand_over(section);
}

}  // namespace swage

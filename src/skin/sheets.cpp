// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swage {

namespace {

struct Loop {
    std::vector<int> segment;
    double area = 0;  // [m2], below 0 around a hole
};

// Segments in no closed loop go to `open`.
std::vector<Loop> find_loops(const Section& section, std::vector<int>& open) {
    std::vector<std::vector<int>> leaving(section.point.size());
    const int count = static_cast<int>(section.segment.size());
    for (int s = count; s-- > 0;) leaving[section.segment[s][0]].push_back(s);
    std::vector<char> taken(section.segment.size(), 0);
    std::vector<Loop> loops;
    for (int first = 0; first < count; ++first) {
        if (taken[first]) continue;
        Loop loop;
        for (int s = first; s >= 0;) {
            taken[s] = 1;
            loop.segment.push_back(s);
            const auto [a, b] = section.segment[s];
            const Vec2 &p = section.point[a], &q = section.point[b];
            loop.area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
            s = -1;
            if (b == section.segment[first][0]) break;
            while (!leaving[b].empty() && taken[leaving[b].back()]) leaving[b].pop_back();
            if (!leaving[b].empty()) s = leaving[b].back();
        }
        if (section.segment[loop.segment.back()][1] == section.segment[first][0]) {
            loops.push_back(std::move(loop));
        } else {
            open.insert(open.end(), loop.segment.begin(), loop.segment.end());
        }
    }
    return loops;
}

bool lies_in(const Section& section, const Loop& loop, const Vec2& at) {
    bool inside = false;
    for (int s : loop.segment) {
        const Vec2 p = section.point[section.segment[s][0]] - at;
        const Vec2 q = section.point[section.segment[s][1]] - at;
        if ((p[1] > 0) == (q[1] > 0)) continue;
        if ((p[0] * q[1] - p[1] * q[0] > 0) == (q[1] > p[1])) inside = !inside;
    }
    return inside;
}

// Most of it: where an earlier cut has been, points of a hole lie on the loop around it.
bool lies_in(const Section& section, const Loop& loop, const Loop& hole) {
    const auto inside = std::count_if(hole.segment.begin(), hole.segment.end(), [&](int s) {
        return lies_in(section, loop, section.point[section.segment[s][0]]);
    });
    return 2 * static_cast<std::size_t>(inside) > hole.segment.size();
}

double distance_at_rest(const Section& section, const Loop& a, const Loop& b) {
    double least = std::numeric_limits<double>::infinity();
    for (int s : a.segment) {
        const Vec3& p = section.at_rest[section.segment[s][0]];
        for (int t : b.segment) {
            least = std::min(least, (section.at_rest[section.segment[t][0]] - p).squaredNorm());
        }
    }
    return std::sqrt(least);
}

}  // namespace

std::vector<std::vector<int>> sheets_of(const Section& section) {
    std::vector<int> open;
    const std::vector<Loop> loops = find_loops(section, open);
    std::vector<int> sheet(loops.size(), -1);
    std::vector<std::vector<int>> sheets;
    for (std::size_t n = 0; n < loops.size(); ++n) {
        if (!(loops[n].area > 0)) continue;
        sheet[n] = static_cast<int>(sheets.size());
        sheets.push_back(loops[n].segment);
    }
    for (const Loop& hole : loops) {
        if (hole.area > 0) continue;
        const Loop* around = nullptr;
        double nearest = std::numeric_limits<double>::infinity();
        for (const Loop& loop : loops) {
            if (!(loop.area > 0) || !lies_in(section, loop, hole)) continue;
            const double distance = distance_at_rest(section, loop, hole);
            if (distance < nearest) nearest = distance, around = &loop;
        }
        std::vector<int>& to = around == nullptr ? open : sheets[sheet[around - loops.data()]];
        to.insert(to.end(), hole.segment.begin(), hole.segment.end());
    }
    if (!open.empty()) sheets.push_back(open);
    return sheets;
}

namespace {

constexpr int kRounds = 60;
constexpr double kSmallLobe = 1.0 / 3;  // of a loop's points
constexpr double kDrawn = 0.2;          // of the way, a round

double side_of(const Vec2& a, const Vec2& b, const Vec2& p) {
    const Vec2 along = b - a, to = p - a;
    return along[0] * to[1] - along[1] * to[0];
}

// Pairs of segments that cross or touch each other and do not follow each other.
std::vector<std::pair<int, int>> crossings(const Section& section) {
    struct Reach {
        double low, high;
        int segment;
    };
    std::vector<Reach> reach;
    for (std::size_t s = 0; s < section.segment.size(); ++s) {
        const auto [a, b] = section.segment[s];
        const double x = section.point[a][0], y = section.point[b][0];
        reach.push_back({std::min(x, y), std::max(x, y), static_cast<int>(s)});
    }
    std::sort(reach.begin(), reach.end(), [](const Reach& a, const Reach& b) {
        return std::pair(a.low, a.segment) < std::pair(b.low, b.segment);
    });
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t i = 0; i < reach.size(); ++i) {
        const auto [a, b] = section.segment[reach[i].segment];
        const Vec2 &p = section.point[a], &q = section.point[b];
        for (std::size_t j = i + 1; j < reach.size() && reach[j].low <= reach[i].high; ++j) {
            const auto [c, d] = section.segment[reach[j].segment];
            if (a == c || a == d || b == c || b == d) continue;
            const Vec2 &r = section.point[c], &s = section.point[d];
            if (side_of(p, q, r) * side_of(p, q, s) > 0) continue;
            if (side_of(r, s, p) * side_of(r, s, q) > 0) continue;
            if (std::max(p[1], q[1]) < std::min(r[1], s[1])) continue;
            if (std::max(r[1], s[1]) < std::min(p[1], q[1])) continue;
            pairs.push_back(std::minmax(reach[i].segment, reach[j].segment));
        }
    }
    return pairs;
}

}  // namespace

std::optional<Section> untangled(Section sheet) {
    std::vector<int> open;
    const std::vector<Loop> loops = find_loops(sheet, open);
    if (!open.empty()) return std::nullopt;
    struct At {
        int loop, place;
    };
    std::vector<At> at(sheet.segment.size());
    for (std::size_t n = 0; n < loops.size(); ++n) {
        for (std::size_t k = 0; k < loops[n].segment.size(); ++k) {
            at[loops[n].segment[k]] = {static_cast<int>(n), static_cast<int>(k)};
        }
    }
    for (int round = 0; round < kRounds; ++round) {
        const std::vector<std::pair<int, int>> pairs = crossings(sheet);
        if (pairs.empty()) return sheet;
        std::vector<Vec2> drawn = sheet.point;
        for (const auto& [s, t] : pairs) {
            if (at[s].loop != at[t].loop) return std::nullopt;
            const std::vector<int>& segment = loops[at[s].loop].segment;
            const int count = static_cast<int>(segment.size());
            const auto start = [&](int k) {
                return sheet.segment[segment[(k % count + count) % count]][0];
            };
            // The lobe is what lies between the two, the shorter way round.
            const auto [i, j] = std::minmax(at[s].place, at[t].place);
            int first = i + 1, last = j;
            if (2 * (j - i) > count) first = j + 1, last = i + count;
            // Wider each time: what crosses deep in a lobe does so until all of that is straight.
            first -= round / 4, last += round / 4;
            const int points = last - first + 1;
            if (points > kSmallLobe * count) return std::nullopt;
            const Vec2 &from = sheet.point[start(first - 1)], &to = sheet.point[start(last + 1)];
            for (int k = first; k <= last; ++k) {
                const double share = static_cast<double>(k - first + 1) / (points + 1);
                const Vec2 straight = from + share * (to - from);
                drawn[start(k)] += kDrawn * (straight - drawn[start(k)]);
            }
        }
        sheet.point = std::move(drawn);
    }
    return std::nullopt;
}

}  // namespace swage

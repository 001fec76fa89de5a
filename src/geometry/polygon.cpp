// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: ear clipping after G. H. Meisters, "Polygons have ears", 1975; polygon normal by
// Newell's sum.
#include "geometry/polygon.h"

#include <algorithm>

namespace swage {

namespace {

// Area over squared edges: 0 for a sliver, largest for an equilateral triangle, negative when the
// triangle faces against `normal`.
double quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
    const double edges = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
    return edges > 0 ? (b - a).cross(c - a).dot(normal) / edges : 0.0;
}

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

struct EarClipper {
    std::vector<Vec2> point;
    std::vector<int> before, after;
    double least_turn;  // below it three corners count as straight

    double turn_at(int i) const { return turn(point[before[i]], point[i], point[after[i]]); }

    bool is_ear(int i) const {
        if (turn_at(i) <= least_turn) return false;
        const int p = before[i], n = after[i];
        const Vec2 &a = point[p], &b = point[i], &c = point[n];
        for (int j = after[n]; j != p; j = after[j]) {
            const Vec2& q = point[j];
            if (q == a || q == b || q == c) continue;  // a corner visited twice (a keyhole)
            if (turn_at(j) > least_turn) continue;     // only reflex corners can be in the way
            if (turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0) return false;
        }
        return true;
    }
};

bool clip_ears(std::span<const Vec3> corner, const Vec3& normal, std::vector<Corners>& triangle) {
    const int count = static_cast<int>(corner.size());
    const Vec3 x = normal.unitOrthogonal();
    const Vec3 y = normal.cross(x);
    EarClipper ears;
    double extent = 0;
    for (const Vec3& p : corner) {
        const Vec3 q = p - corner[0];
        ears.point.emplace_back(q.dot(x), q.dot(y));
        extent = std::max(extent, ears.point.back().squaredNorm());
    }
    ears.least_turn = 1e-14 * extent;
    for (int i = 0; i < count; ++i) {
        ears.before.push_back((i + count - 1) % count);
        ears.after.push_back((i + 1) % count);
    }
    bool clean = true;
    int left = count, since_last_ear = 0, i = 0;
    while (left > 3) {
        if (!ears.is_ear(i)) {
            i = ears.after[i];
            if (++since_last_ear < left) continue;
            // No ear: straight corners only, or the outline crosses itself. Take the most convex.
            int best = i;
            for (int j = ears.after[i]; j != i; j = ears.after[j])
                if (ears.turn_at(j) > ears.turn_at(best)) best = j;
            clean = clean && ears.turn_at(best) > -ears.least_turn &&
                    ears.turn_at(best) <= ears.least_turn;
            i = best;
        }
        const int p = ears.before[i], n = ears.after[i];
        triangle.push_back({p, i, n});
        ears.after[p] = n;
        ears.before[n] = p;
        --left;
        since_last_ear = 0;
        i = ears.after[n];  // step over a corner: fans of slivers are avoided
    }
    triangle.push_back({ears.before[i], i, ears.after[i]});
    return clean;
}

// The outline of triangles begin .. end-1 as corners, from the first triangle's first corner on.
class Outline {
  public:
    explicit Outline(const TriMesh& mesh) : mesh_(mesh) {}

    bool trace(int begin, int end, std::vector<int>& corner) {
        const std::size_t wanted = static_cast<std::size_t>(end - begin) + 2;
        edge_.clear();
        for (int c = 3 * begin; c < 3 * end; ++c)
            edge_.push_back({place(c), place(c - c % 3 + (c + 1) % 3), c});
        std::sort(edge_.begin(), edge_.end());
        border_.clear();
        for (const Edge& e : edge_) {
            const auto twin = std::lower_bound(edge_.begin(), edge_.end(), Edge{e.to, e.from, -1});
            if (twin == edge_.end() || twin->from != e.to || twin->to != e.from)
                border_.push_back(e);
        }
        if (border_.size() != wanted) return false;
        for (std::size_t i = 1; i < border_.size(); ++i)
            if (border_[i].from == border_[i - 1].from) return false;  // touches itself
        // All corners at one place must look the same.
        for (std::size_t i = 1; i < edge_.size(); ++i)
            if (edge_[i].from == edge_[i - 1].from && !alike(edge_[i].corner, edge_[i - 1].corner))
                return false;
        const std::size_t old_size = corner.size();
        int at = place(3 * begin);
        do {
            const auto e = std::lower_bound(border_.begin(), border_.end(), Edge{at, -1, -1});
            if (e == border_.end() || e->from != at) break;
            corner.push_back(corner.size() == old_size ? 3 * begin : e->corner);
            at = e->to;
        } while (at != place(3 * begin) && corner.size() - old_size < wanted);
        if (corner.size() - old_size == wanted && at == place(3 * begin)) return true;
        corner.resize(old_size);
        return false;
    }

  private:
    struct Edge {
        int from, to, corner;
        auto operator<=>(const Edge&) const = default;
    };
    int place(int c) const { return mesh_.triangle[c / 3][c % 3]; }
    bool alike(int a, int b) const {
        const auto same = [&](const std::vector<Corners>& ids) {
            return ids.empty() || ids[a / 3][a % 3] == ids[b / 3][b % 3];
        };
        return same(mesh_.triangle_uv) && same(mesh_.triangle_smooth);
    }

    const TriMesh& mesh_;
    std::vector<Edge> edge_, border_;
};

}  // namespace

PolygonCorners rejoin_polygons(const TriMesh& mesh) {
    PolygonCorners result;
    const int count = static_cast<int>(mesh.triangle.size());
    result.first.reserve(mesh.triangle.size() + 1);
    result.corner.reserve(3 * mesh.triangle.size());
    Outline outline(mesh);
    const auto same = [](const std::vector<int>& ids, int a, int b) {
        return ids.empty() || ids[a] == ids[b];
    };
    for (int begin = 0, end; begin < count; begin = end) {
        end = begin + 1;
        while (!mesh.triangle_polygon.empty() && end < count &&
               mesh.triangle_polygon[end] == mesh.triangle_polygon[begin] &&
               same(mesh.triangle_material, begin, end) && same(mesh.triangle_part, begin, end))
            ++end;
        if (end - begin > 1 && outline.trace(begin, end, result.corner)) {
            result.first.push_back(result.corner.size());
            continue;
        }
        for (int c = 3 * begin; c < 3 * end; ++c) {
            result.corner.push_back(c);
            if (c % 3 == 2) result.first.push_back(result.corner.size());
        }
    }
    return result;
}

bool cut_polygon(std::span<const Vec3> corner, std::vector<Corners>& triangle) {
    const int count = static_cast<int>(corner.size());
    if (count < 3) return true;
    if (count == 3) {
        triangle.push_back({0, 1, 2});
        return true;
    }
    Vec3 normal = Vec3::Zero();
    for (int i = 1; i + 1 < count; ++i)
        normal += (corner[i] - corner[0]).cross(corner[i + 1] - corner[0]);
    normal.stableNormalize();
    if (!(normal.squaredNorm() > 0.5)) {  // no area: any cut will do
        for (int i = 1; i + 1 < count; ++i) triangle.push_back({0, i, i + 1});
        return true;
    }
    if (count == 4) {
        const auto& p = corner;
        const double even =
            std::min(quality(p[0], p[1], p[2], normal), quality(p[0], p[2], p[3], normal));
        const double odd =
            std::min(quality(p[0], p[1], p[3], normal), quality(p[1], p[2], p[3], normal));
        // A tie goes to the even diagonal whatever the rounding.
        const Diagonal by = even >= odd - 1e-12 ? Diagonal::first : Diagonal::second;
        for (const Corners& half : halves({0, 1, 2, 3}, by)) triangle.push_back(half);
        return std::max(even, odd) >= 0;
    }
    const std::size_t first = triangle.size();
    const bool clean = clip_ears(corner, normal, triangle);
    // A writer that rejoins the triangles starts at the first corner of the first one.
    for (std::size_t t = first; t < triangle.size(); ++t) {
        const auto zero = std::find(triangle[t].begin(), triangle[t].end(), 0);
        if (zero == triangle[t].end()) continue;
        std::rotate(triangle[t].begin(), zero, triangle[t].end());
        std::swap(triangle[first], triangle[t]);
        break;
    }
    return clean;
}

}  // namespace swage

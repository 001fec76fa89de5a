// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/action_box.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/math.h"
#include "base/portable_math.h"
#include "geometry/disjoint_sets.h"
#include "pipeline/part_look.h"

namespace swage {

namespace {

// The farthest points along many directions: what a camera has to keep in the picture.
class Outline {
  public:
    Outline() {
        // Evenly spread over the sphere by the golden angle.
        constexpr int kDirections = 96;
        for (int n = 0; n < kDirections; ++n) {
            const double y = 1 - (2 * n + 1.0) / kDirections, r = std::sqrt(1 - y * y);
            const double turn = n * kPi * (3 - std::sqrt(5.0));
            direction_.emplace_back(r * portable::cos(turn), y, r * portable::sin(turn));
        }
        reach_.assign(direction_.size(), -std::numeric_limits<double>::infinity());
        point_.resize(direction_.size());
    }
    void grow(const Vec3& p) {
        for (std::size_t d = 0; d < direction_.size(); ++d) {
            const double reach = direction_[d].dot(p);
            if (!(reach > reach_[d])) continue;
            reach_[d] = reach;
            point_[d] = p;
        }
    }
    void grow(const Outline& other) {
        for (std::size_t d = 0; d < direction_.size(); ++d) {
            if (!(other.reach_[d] > reach_[d])) continue;
            reach_[d] = other.reach_[d];
            point_[d] = other.point_[d];
        }
    }
    bool empty() const { return !(reach_.front() > -std::numeric_limits<double>::infinity()); }
    const std::vector<Vec3>& points() const { return point_; }

  private:
    std::vector<Vec3> direction_, point_;
    std::vector<double> reach_;
};

// The pieces of a skin, by the vertices that its triangles share.
struct SkinPieces {
    std::vector<int> of_vertex;
    std::vector<double> area;  // at rest [m2]
};

SkinPieces find_pieces_of(const TriMesh& skin) {
    DisjointSets sets(skin.position.size());
    for (const Corners& c : skin.triangle) sets.unite(c[0], c[1]), sets.unite(c[1], c[2]);
    SkinPieces pieces;
    pieces.area.resize(sets.number_sets(pieces.of_vertex));
    for (const Corners& c : skin.triangle) {
        pieces.area[pieces.of_vertex[c[0]]] += 0.5 * area_vector(skin.position, c).norm();
    }
    return pieces;
}

constexpr double kStray = 0.05;  // of the surface that may leave the picture
constexpr double kClose = 0.12;  // of the framed pieces' size: what lies as near is framed too
constexpr double kReach = 0.2;   // of the action's size, that tools near it may add
constexpr double kDeep = 1;      // of that size, that tools may reach below it and stand on ground

// Which pieces the picture frames: all but the farthest from the middle.
std::vector<char> framed(const SkinPieces& pieces, const std::vector<Vec3>& position) {
    const std::size_t count = pieces.area.size();
    std::vector<Vec3> middle(count, Vec3::Zero());
    std::vector<int> vertices(count, 0);
    for (std::size_t v = 0; v < position.size(); ++v) {
        middle[pieces.of_vertex[v]] += position[v];
        ++vertices[pieces.of_vertex[v]];
    }
    for (std::size_t p = 0; p < count; ++p) middle[p] /= vertices[p];
    const double all = std::accumulate(pieces.area.begin(), pieces.area.end(), 0.0);
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    const auto sort_by = [&](auto&& value) {
        std::sort(order.begin(), order.end(),
                  [&](int a, int b) { return std::pair(value(a), a) < std::pair(value(b), b); });
    };
    Vec3 centre;  // half of the surface on either side, by axis
    for (int d = 0; d < 3; ++d) {
        sort_by([&](int p) { return middle[p][d]; });
        double below = 0;
        for (std::size_t n = 0; n < count && below < 0.5 * all; ++n) {
            below += pieces.area[order[n]];
            centre[d] = middle[order[n]][d];
        }
    }
    sort_by([&](int p) { return (middle[p] - centre).norm(); });
    std::vector<char> is_framed(count, 1);
    double stray = 0;
    for (std::size_t n = count; n-- > 1;) {
        stray += pieces.area[order[n]];
        if (stray > kStray * all) break;
        is_framed[order[n]] = 0;
    }
    // What stays close is shown all the same.
    Box kept;
    for (std::size_t v = 0; v < position.size(); ++v) {
        if (is_framed[pieces.of_vertex[v]]) kept.grow(position[v]);
    }
    const Vec3 reach = Vec3::Constant(kClose * kept.size().maxCoeff());
    for (std::size_t p = 0; p < count; ++p) {
        const Vec3& m = middle[p];
        is_framed[p] |=
            ((m - kept.low + reach).minCoeff() > 0) && ((kept.high + reach - m).minCoeff() > 0);
    }
    return is_framed;
}

// The vertices of a frame that the picture is to show; frames in their order.
class FramedSkin {
  public:
    explicit FramedSkin(const FrameStore& store) : store_(store) {}

    template <class Use>
    void for_each(const StoredFrame& frame, Use&& use) {
        last_.resize(frame.body.size());
        for (std::size_t b = 0; b < frame.body.size(); ++b) {
            const StoredBody& body = frame.body[b];
            Last& last = last_[b];
            if (last.skin != body.skin) {
                last.pieces = find_pieces_of(store_.skin(body.skin));
                if (last.skin < 0) last.at_start = last.pieces.area.size();
                last.skin = body.skin;
            }
            const SkinPieces& own = last.pieces;
            // Parts that the mesh came in are no chips.
            const bool broke = own.area.size() > last.at_start;
            const std::vector<char> is_framed =
                broke ? framed(own, body.position) : std::vector<char>();
            for (std::size_t v = 0; v < body.position.size(); ++v) {
                if (!broke || is_framed[own.of_vertex[v]]) use(body.position[v]);
            }
        }
    }

  private:
    struct Last {
        int skin = -1;
        SkinPieces pieces;
        std::size_t at_start = 0;  // how many pieces there were
    };
    const FrameStore& store_;
    std::vector<Last> last_;  // a body each
};

// Where the bodies are in each frame, for a camera that goes along: the middle of what is framed,
// as a mean over three windows, which is nearly one weighted by a bell. Beyond its ends the way
// goes on mirrored in them, so that what flies evenly is gone along with all the time, and the
// bell is no longer than the film.
std::vector<Vec3> calm_way(const std::vector<Box>& skin, double calm) {
    constexpr int kPasses = 3;
    std::vector<Vec3> way;
    for (const Box& box : skin) {
        way.push_back(!box.empty() ? box.center() : way.empty() ? Vec3(0, 0, 0) : way.back());
    }
    const int last = static_cast<int>(way.size()) - 1;
    const int reach = std::min(static_cast<int>(std::lround(calm)), last / (2 * kPasses));
    for (int pass = 0; pass < kPasses; ++pass) {
        const std::vector<Vec3> before = way;
        const auto at = [&](int n) -> Vec3 {
            if (n < 0) return 2 * before.front() - before[-n];
            if (n > last) return 2 * before.back() - before[2 * last - n];
            return before[n];
        };
        for (int f = 0; f <= last; ++f) {
            way[f].setZero();
            for (int n = f - reach; n <= f + reach; ++n) way[f] += at(n);
            way[f] /= 2 * reach + 1;
        }
    }
    return way;
}

// What a picture of each frame has to show.
struct Extents {
    std::vector<Box> skin;
    std::vector<Outline> outline;                // of that
    std::vector<std::vector<Vec3>> tool_corner;  // of the boxes of all tools that are seen
};

Extents extents_of(const FrameStore& store, const RenderSettings& settings,
                   const Quat& drawn_from_world) {
    Extents extents;
    FramedSkin framed_skin(store);
    std::vector<std::vector<Box>> part_box;  // of each machine's parts, in their own frames
    for (int m = 0; m < store.machine_count(); ++m) {
        part_box.emplace_back();
        for (const DrawnPart& part : store.machine(m)) {
            // An endless floor has no corner that the picture would have to show.
            const bool frames = part.finish != Finish::endless && look_of(part, settings);
            part_box.back().push_back(frames ? box_of(part.surface.position) : Box());
        }
    }
    for (int f = 0; f < store.frame_count(); ++f) {
        const StoredFrame frame = store.frame(f);
        Box& skin = extents.skin.emplace_back();
        Outline& outline = extents.outline.emplace_back();
        framed_skin.for_each(frame, [&](const Vec3& world) {
            const Vec3 p = drawn_from_world * world;
            skin.grow(p);
            outline.grow(p);
        });
        std::vector<Vec3>& corners = extents.tool_corner.emplace_back();
        if (part_box.empty()) continue;  // no machine at all
        const std::vector<Box>& boxes = part_box.at(static_cast<std::size_t>(frame.machine));
        for (std::size_t b = 0; b < boxes.size() && b < frame.pose.size(); ++b) {
            if (boxes[b].empty()) continue;
            for (int corner = 0; corner < 8; ++corner) {
                corners.push_back(drawn_from_world * (frame.pose[b] * boxes[b].corner(corner)));
            }
        }
    }
    return extents;
}

// Seen from where the bodies are in each frame. Of tools as much counts as lies near them then.
FramedAction framed_along(const Extents& extents, double calm) {
    FramedAction framed;
    framed.way = calm_way(extents.skin, calm);
    Outline all;
    const auto add = [&](const Vec3& p) {
        framed.bounds.grow(p);
        all.grow(p);
    };
    for (std::size_t f = 0; f < framed.way.size(); ++f) {
        const Box& skin = extents.skin[f];
        if (skin.empty()) continue;
        for (const Vec3& p : extents.outline[f].points()) add(p - framed.way[f]);
        const Vec3 reach = Vec3::Constant(kReach * skin.size().maxCoeff());
        for (const Vec3& p : extents.tool_corner[f]) {
            const Vec3 near = p.cwiseMax(skin.low - reach).cwiseMin(skin.high + reach);
            add(near - framed.way[f]);
        }
    }
    if (!all.empty()) framed.outline = all.points();
    return framed;
}

}  // namespace

ActionBox find_action(const FrameStore& store, const RenderSettings& settings,
                      const Quat& drawn_from_world, double calm) {
    const Extents extents = extents_of(store, settings, drawn_from_world);
    Box skin, machines;
    Outline outline;
    for (const Box& one : extents.skin) skin.grow(one);
    for (const Outline& one : extents.outline) outline.grow(one);
    for (const std::vector<Vec3>& corners : extents.tool_corner) {
        for (const Vec3& corner : corners) machines.grow(corner);
    }
    ActionBox action{skin, skin.empty() ? 0 : skin.low.y(), {}};
    if (!machines.empty() && !skin.empty()) {
        // A tool that waits far away, or is very long, must not make the work-piece small.
        const Vec3 reach = Vec3::Constant(kReach * skin.size().maxCoeff());
        action.bounds.grow(machines.low.cwiseMax(skin.low - reach).cwiseMin(skin.high));
        action.bounds.grow(machines.high.cwiseMin(skin.high + reach).cwiseMax(skin.low));
        // The ground does not cut through what stands a little lower, seen or not.
        const double deep = skin.low.y() - kDeep * skin.size().maxCoeff();
        action.ground_height = machines.low.y() > deep ? std::min(machines.low.y(), skin.low.y())
                                                       : action.bounds.low.y();
        for (const std::vector<Vec3>& corners : extents.tool_corner) {
            for (const Vec3& corner : corners) {
                outline.grow(corner.cwiseMax(action.bounds.low).cwiseMin(action.bounds.high));
            }
        }
    }
    action.framed = {action.bounds, {}, {}};
    if (!outline.empty()) action.framed.outline = outline.points();
    if (calm > 0) action.framed = framed_along(extents, calm);
    return action;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The cut is settled first, on the path: every edge of the section that borders a kept cap
// triangle is a seam. Then corners are joined (skin/join_sides.h).
#include "skin/surface_split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "geometry/disjoint_sets.h"
#include "skin/cap_front.h"
#include "skin/join_sides.h"
#include "skin/section.h"
#include "skin/section_lines.h"
#include "skin/sheets.h"

namespace swage {

namespace {

// A vertex nearer to the path than this share of its shortest edge counts as lying on it, so that
// no slivers are cut off.
constexpr double kOnPath = 0.01;
// Vertices of one side, so few and so near to a path that bends, are told theirs by what is around
// them; nearness as a share of the shortest edge.
constexpr int kFew = 6;
constexpr double kLone = 0.5;
// Spacings, within which lines on the section are drawn to what is there.
constexpr double kDrawn = 0.02;
// Triangles around a path round an axis, at least: by their chords what lies inside
// loses 0.13 % then, and 0.3 % where lobes go out and in by a fifth.
constexpr double kSides = 72;

// One triangle of the old surface, or a part of one.
struct Part {
    Corners raw;
    int side;
    bool split;
};

struct Seam {
    int from, to;       // raw, the inside on the left seen against the normal
    int plus;           // old triangle on the positive side
    bool kept = false;  // cut along it
};

class Splitter {
  public:
    Splitter(const TriMesh& mesh, const std::vector<Vec3>& position, const BladePath& path,
             double spacing, const Insides& insides)
        : mesh_(mesh),
          position_(position),
          path_(path),
          spacing_(spacing),
          insides_(insides),
          line_(insides.lines_in(path)) {}

    SurfaceSplit run() {
        classify();
        find_section();
        cap_all();
        part_all();
        emit_surface();
        emit_caps();
        join();
        split_.seam_edges = static_cast<int>(
            wall_.size() + std::ranges::count_if(seam_, [](const Seam& s) { return s.kept; }));
        return std::move(split_);
    }

  private:
    int old_count() const { return static_cast<int>(position_.size()); }
    bool on_path(int raw) const { return raw >= old_count() || sign_[raw] == 0; }
    Vec3 place(int raw, const std::vector<Vec3>& position) const {
        if (raw < old_count()) return position[raw];
        const EdgeCut& cut = split_.cut[raw - old_count()];
        return position[cut.low] + cut.share * (position[cut.high] - position[cut.low]);
    }
    Vec3 place(int raw) const { return place(raw, position_); }
    Vec2 flat(int raw) const {
        const int inner = raw - old_count() - static_cast<int>(split_.cut.size());
        return path_.flat(inner < 0 ? place(raw) : split_.cap_point[inner]);
    }

    void classify() {
        std::vector<double> shortest(position_.size(), std::numeric_limits<double>::infinity());
        for (const Corners& t : mesh_.triangle) {
            for (int k = 0; k < 3; ++k) {
                const int a = t[k], b = t[(k + 1) % 3];
                const double length = (position_[a] - position_[b]).norm();
                shortest[a] = std::min(shortest[a], length);
                shortest[b] = std::min(shortest[b], length);
            }
        }
        height_.resize(position_.size());
        sign_.resize(position_.size());
        for (std::size_t v = 0; v < position_.size(); ++v) {
            height_[v] = path_.height(position_[v]);
            sign_[v] = std::abs(height_[v]) <= kOnPath * shortest[v] ? 0 : height_[v] > 0 ? 1 : -1;
        }
        if (path_.relief) join_lone(shortest);
        for (const Corners& t : mesh_.triangle) {
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = ends(t[k], t[(k + 1) % 3]);
                if (sign_[low] * sign_[high] >= 0) continue;
                if (!cut_id_.emplace(Ends(low, high), old_count() + split_.cut.size()).second) {
                    continue;
                }
                split_.cut.push_back({low, high, height_[low] / (height_[low] - height_[high])});
            }
        }
        used_.assign(split_.cut.size(), true);
    }

    // Few vertices near the path that hang together and whose neighbours are all on its other side,
    // as right under a ridge that the path has between them: around them there would be a section
    // of its own, of no area.
    void join_lone(const std::vector<double>& shortest) {
        DisjointSets like(sign_.size());
        std::vector<char> is_far(sign_.size(), 0);
        std::vector<int> count(sign_.size(), 0);
        for (const Corners& t : mesh_.triangle) {
            for (int k = 0; k < 3; ++k) {
                const int a = t[k], b = t[(k + 1) % 3];
                if (sign_[a] == sign_[b]) like.unite(a, b);
            }
        }
        for (std::size_t v = 0; v < sign_.size(); ++v) {
            const int set = like.root(static_cast<int>(v));
            ++count[set];
            if (std::abs(height_[v]) > kLone * path_.steepest * shortest[v]) is_far[set] = 1;
        }
        for (std::size_t v = 0; v < sign_.size(); ++v) {
            const int set = like.root(static_cast<int>(v));
            if (count[set] <= kFew && !is_far[set]) sign_[v] = -sign_[v];
        }
    }

    int side_of(const Corners& raw, int parent) const {
        int low = 0, high = 0;
        for (int r : raw) {
            if (r >= old_count()) continue;
            low = std::min(low, sign_[r]);
            high = std::max(high, sign_[r]);
        }
        if (low || high) return low + high;
        // It lies on the path: the body is behind it.
        const Corners& t = mesh_.triangle[parent];
        const Vec3 out =
            (position_[t[1]] - position_[t[0]]).cross(position_[t[2]] - position_[t[0]]);
        return out.dot(path_.rise(position_[t[0]])) > 0 ? -1 : 1;
    }

    // The parts of a triangle, cut at those of its cut points that are in use.
    template <typename F>
    void for_each_part(int t, const F& f) const {
        const Corners& corner = mesh_.triangle[t];
        std::array<int, 5> loop;
        std::array<int, 2> at;  // of cut points in the loop
        int count = 0, cuts = 0;
        for (int k = 0; k < 3; ++k) {
            loop[count++] = corner[k];
            const int next = corner[(k + 1) % 3];
            if (sign_[corner[k]] * sign_[next] >= 0) continue;
            const int cut = cut_id_.at(ends(corner[k], next));
            if (used_[cut - old_count()]) at[cuts++] = count, loop[count++] = cut;
        }
        const auto emit = [&](int a, int b, int c) {
            emit_fan({loop[a % count], loop[b % count], loop[c % count]}, t, cuts > 0, f);
        };
        if (cuts == 0) {
            emit(0, 1, 2);
        } else if (cuts == 1) {
            emit(at[0], at[0] + 1, at[0] + 2);
            emit(at[0] + 2, at[0] + 3, at[0]);
        } else {
            // The lone corner stands between the two cut points, on one way round or the other.
            const int first = at[1] - at[0] == 2 ? at[0] : at[1];
            emit(first, first + 1, first + 2);
            const auto length = [&](int a, int b) {
                return (place(loop[a % count]) - place(loop[b % count])).norm();
            };
            if (length(first + 2, first + 4) < length(first + 3, first)) {
                emit(first + 2, first + 3, first + 4);
                emit(first + 2, first + 4, first);
            } else {
                emit(first + 2, first + 3, first);
                emit(first + 3, first + 4, first);
            }
        }
    }

    // One part, or several where points lie on its edges.
    template <typename F>
    void emit_fan(const Corners& raw, int parent, bool is_split, const F& f) const {
        for (int k = 0; k < 3 && !rim_.empty(); ++k) {
            const int from = raw[k], to = raw[(k + 1) % 3], apex = raw[(k + 2) % 3];
            const auto at = rim_.find(ends(from, to));
            if (at == rim_.end()) continue;
            std::vector<int> stop = at->second;
            if (from > to) std::reverse(stop.begin(), stop.end());
            stop.push_back(to);
            int last = from;
            for (const int next : stop) {
                emit_fan({last, next, apex}, parent, true, f);
                last = next;
            }
            return;
        }
        f(Part{raw, side_of(raw, parent), is_split});
    }

    bool touches_path(int t) const {
        const Corners& c = mesh_.triangle[t];
        return !(sign_[c[0]] == sign_[c[1]] && sign_[c[1]] == sign_[c[2]] && sign_[c[0]] != 0);
    }

    // Edges on the path between a part above and a part below.
    void find_section() {
        struct Uses {
            int net = 0, plus = -1;
            bool minus = false;
        };
        std::map<Ends, Uses> edges;
        for (int t = 0; t < static_cast<int>(mesh_.triangle.size()); ++t) {
            if (!touches_path(t)) continue;
            for_each_part(t, [&](const Part& part) {
                for (int k = 0; k < 3; ++k) {
                    const int a = part.raw[k], b = part.raw[(k + 1) % 3];
                    if (!on_path(a) || !on_path(b)) continue;
                    Uses& uses = edges[ends(a, b)];
                    if (part.side > 0) {
                        uses.net += a < b ? 1 : -1;
                        if (uses.plus < 0) uses.plus = t;
                    } else {
                        uses.minus = true;
                    }
                }
            });
        }
        for (const auto& [edge, uses] : edges) {
            if (!uses.minus) continue;
            const auto [a, b] = edge;
            if (std::abs(uses.net) == 1) {
                seam_.push_back(uses.net > 0 ? Seam{a, b, uses.plus} : Seam{b, a, uses.plus});
            } else if (uses.net == 0 && uses.plus >= 0 &&
                       path_.covers(path_.middle(flat(a), flat(b)))) {
                wall_.push_back(edge);
            }
        }
    }

    void cap_all() {
        std::vector<int> all(seam_.size());
        std::iota(all.begin(), all.end(), 0);
        if (all.empty() || cap(all)) return;
        // A body that has gone into itself, or whose parts have: each sheet is filled by itself.
        Section section;
        std::vector<int> raw;
        add_segments(all, section, raw);
        for (const std::vector<int>& sheet : sheets_of(section)) {
            if (cap(sheet) || cap(sheet, true)) continue;
            ++split_.open_parts;
            for (int s : sheet) {
                const Vec3 middle = 0.5 * (place(seam_[s].from) + place(seam_[s].to));
                seam_[s].kept = path_.covers(path_.flat(middle));
            }
        }
    }

    // `raw`: of each of the section's points.
    void add_segments(const std::vector<int>& seams, Section& section, std::vector<int>& raw) {
        std::map<int, int> local;
        const auto point = [&](int r) {
            const auto [at, fresh] = local.emplace(r, static_cast<int>(raw.size()));
            if (fresh) {
                raw.push_back(r);
                section.point.push_back(path_.flat(place(r)));
                section.at_rest.push_back(place(r, mesh_.position));
            }
            return at->second;
        };
        for (int s : seams) section.segment.push_back({point(seam_[s].from), point(seam_[s].to)});
    }

    // Fills the section that these edges bound and keeps what the blade sweeps.
    bool cap(const std::vector<int>& seams, bool is_tangled = false) {
        Section section;
        section.spacing = spacing_;
        if (path_.radius > 0) {
            section.radius = std::max(path_.radius, kSides * spacing_ / (2 * kPi));
        }
        std::vector<int> raw;
        add_segments(seams, section, raw);
        if (is_tangled) {
            std::optional<Section> without = untangled(std::move(section));
            if (!without) return false;
            section = std::move(*without);
        }
        for (const auto& [a, b] : path_.outline) {
            const double length =
                path_.radius > 0 ? (path_.world(b) - path_.world(a)).norm() : (b - a).norm();
            const int steps = std::clamp(static_cast<int>(length / (0.5 * spacing_)), 1, 999);
            for (int n = 0; n < steps; ++n) section.wish.push_back(a + (b - a) * n / steps);
        }
        std::vector<int> edges = seams;
        std::optional<SectionTriangles> filled;
        if (!is_tangled && !line_.empty()) {
            Section drawn = section;
            const std::vector<LinePoint> point = add_lines(line_, kDrawn * spacing_, drawn);
            if (!drawn.line.empty()) filled = fill_section(drawn);
            if (filled) {
                section = std::move(drawn);
                divide_seams(point, edges, section, raw);
            }
        }
        if (!filled) filled = fill_section(section);
        if (!filled) return false;

        std::map<Ends, int> seam_at;
        for (int s : edges) seam_at[ends(seam_[s].from, seam_[s].to)] = s;
        std::vector<Vec2> point = section.point;
        point.insert(point.end(), filled->added.begin(), filled->added.end());
        raw.resize(point.size(), -1);
        for (const Corners& t : filled->triangle) {
            const Vec2 middle = path_.middle(point[t[0]], point[t[1]], point[t[2]]);
            if (!path_.covers(middle)) continue;
            Corners cap;
            for (int k = 0; k < 3; ++k) {
                int& id = raw[t[k]];
                if (id < 0) id = add_cap_point(point[t[k]]);
                cap[k] = id;
            }
            int neighbor = -1;
            for (int k = 0; k < 3; ++k) {
                const auto at = seam_at.find(ends(cap[k], cap[(k + 1) % 3]));
                if (at == seam_at.end()) continue;
                seam_[at->second].kept = true;
                neighbor = seam_[at->second].plus;
            }
            cap_.triangle.push_back(cap);
            cap_.neighbor.push_back(neighbor);
            cap_.inside.push_back(insides_.at(path_.world(middle)));
        }
        return true;
    }

    int add_cap_point(const Vec2& at) {
        split_.cap_point.push_back(path_.world(at));
        return old_count() + static_cast<int>(split_.cut.size() + split_.cap_point.size()) - 1;
    }

    // Where lines end on them. `point`: what the section has after its own; `edges`: the seams that
    // it is made of.
    void divide_seams(const std::vector<LinePoint>& point, std::vector<int>& edges,
                      const Section& section, std::vector<int>& raw) {
        const std::size_t known = raw.size();
        Seam whole{};
        int segment = -1, last = -1;
        for (std::size_t n = 0; n < point.size() && point[n].segment >= 0; ++n) {
            const auto& [on, share] = point[n];
            if (on != segment) segment = on, last = edges[on], whole = seam_[last];
            const int id = add_cap_point(section.point[known + n]);
            raw.push_back(id);
            const auto edge = ends(whole.from, whole.to);
            const bool is_up = whole.from == edge.first;
            std::vector<int>& all = rim_[edge];
            all.insert(is_up ? all.end() : all.begin(), id);
            split_.rim[id] = {edge.first, edge.second, is_up ? share : 1 - share};
            seam_[last].to = id;
            last = static_cast<int>(seam_.size());
            edges.push_back(last);
            seam_.push_back({id, whole.to, whole.plus});
        }
    }

    void part_all() {
        std::map<Ends, Seam*> kept;
        for (Seam& seam : seam_) {
            if (seam.kept) kept[ends(seam.from, seam.to)] = &seam;
        }
        const auto is_seam = [&](const Ends& edge) { return kept.count(edge) > 0; };
        const auto leave = [&](const Ends& edge) {
            kept.at(edge)->kept = false;
            kept.erase(edge);
        };
        const auto half_way = [&](const Ends& edge) {
            return add_cap_point(path_.middle(flat(edge.first), flat(edge.second)));
        };
        part_caps(cap_, is_seam, leave, half_way);
    }

    void emit_surface() {
        used_.assign(split_.cut.size(), false);
        const auto use = [&](int raw) {
            const int cut = raw - old_count();
            if (cut >= 0 && cut < static_cast<int>(used_.size())) used_[cut] = true;
        };
        for (const Seam& seam : seam_) {
            if (seam.kept) kept_.insert(ends(seam.from, seam.to));
        }
        kept_.insert(wall_.begin(), wall_.end());
        for (const auto& [a, b] : kept_) use(a), use(b);
        std::erase_if(rim_, [&](const auto& rim) { return !is_cut(rim.first, rim.second); });
        for (const auto& [edge, points] : rim_) use(edge.first), use(edge.second);
        for (int t = 0; t < static_cast<int>(mesh_.triangle.size()); ++t) {
            for_each_part(t, [&](const Part& part) {
                split_.triangle.push_back({part.raw, part.raw, t, part.split, part.side});
            });
        }
    }

    // Whether any part of an edge that these points divide is a seam.
    bool is_cut(const Ends& edge, const std::vector<int>& points) const {
        int last = edge.first;
        for (const int p : points) {
            if (kept_.count(ends(last, p))) return true;
            last = p;
        }
        return kept_.count(ends(last, edge.second)) > 0;
    }

    // Both caps; those of one connected piece take the same neighbour.
    void emit_caps() {
        const std::size_t count = cap_.triangle.size();
        DisjointSets pieces(count);
        std::map<Ends, int> first;
        for (std::size_t c = 0; c < count; ++c) {
            const Corners& cap = cap_.triangle[c];
            for (int k = 0; k < 3; ++k) {
                const Ends edge = ends(cap[k], cap[(k + 1) % 3]);
                const auto [at, fresh] = first.emplace(edge, static_cast<int>(c));
                if (!fresh) pieces.unite(at->second, static_cast<int>(c));
            }
        }
        std::vector<int> neighbor(count, -1);
        for (std::size_t c = 0; c < count; ++c) {
            int& own = neighbor[pieces.root(static_cast<int>(c))];
            if (own < 0) own = cap_.neighbor[c];
        }
        for (int side : {1, -1}) {
            for (std::size_t c = 0; c < count; ++c) {
                Corners raw = cap_.triangle[c];
                if (side > 0) std::swap(raw[1], raw[2]);
                split_.triangle.push_back({raw, raw, -1, false, side,
                                           neighbor[pieces.root(static_cast<int>(c))],
                                           cap_.inside[c]});
            }
        }
    }

    void join() {
        std::set<int> parts;  // raw
        const auto add = [&](int raw) {
            if (raw >= old_count()) parts.insert(raw);
        };
        for (const auto& [a, b] : kept_) parts.insert({a, b});
        for (const auto& [edge, points] : rim_) {  // also of what is no seam
            add(edge.first), add(edge.second);
            parts.insert(points.begin(), points.end());
        }
        for (const Corners& cap : cap_.triangle) parts.insert(cap.begin(), cap.end());
        join_sides(parts, kept_, old_count(), split_);
    }

    const TriMesh& mesh_;
    const std::vector<Vec3>& position_;
    const BladePath& path_;
    const double spacing_;
    const Insides& insides_;
    const std::vector<std::array<Vec2, 2>> line_;  // of theirs
    SurfaceSplit split_;
    std::vector<double> height_;
    std::vector<int> sign_;
    std::map<Ends, int> cut_id_;
    std::vector<bool> used_;  // cut points
    std::vector<Seam> seam_;
    std::vector<Ends> wall_;  // cut along too, but inside: of sheets that lie back to back
    std::map<Ends, std::vector<int>> rim_;  // points on edges of the section, from the first end
    std::set<Ends> kept_;                   // seams and walls, in the end
    CutCaps cap_;                           // raw, seen against the normal
};

}  // namespace

SurfaceSplit split_surface(const TriMesh& mesh, const std::vector<Vec3>& position,
                           const BladePath& path, double spacing, const Insides& insides) {
    return Splitter(mesh, position, path, spacing, insides).run();
}

}  // namespace swage

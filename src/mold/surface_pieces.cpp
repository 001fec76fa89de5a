// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/surface_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "geometry/disjoint_sets.h"
#include "mold/clip.h"

namespace swage {

// Of a triangle, what lies in one cell.
struct CellPart {
    int cell, triangle;
    Vec3 area;  // along the normal [m2]
    Vec3 center;
};

namespace {

constexpr double kTouch = 1e-9;  // [cells]

int place_of(const std::vector<Vec3i>& cells, const Vec3i& cell) {
    const auto at = std::lower_bound(cells.begin(), cells.end(), cell, comes_before);
    return at != cells.end() && *at == cell ? static_cast<int>(at - cells.begin()) : -1;
}

std::vector<CellPart> cut_to_cells(const TriMesh& mesh, const MoldFrame& frame,
                                   const std::vector<Vec3>& at, const std::vector<Vec3i>& cells) {
    Box around;
    for (const Vec3i& c : cells) {
        around.grow(c.cast<double>());
        around.grow((c + Vec3i::Ones()).cast<double>());
    }
    std::array<BinRange, 3> only;
    for (int d = 0; d < 3; ++d) {
        only[d] = {static_cast<int>(around.low[d]), static_cast<int>(around.high[d]) - 1};
    }
    const Vec3i& count = frame.cell_count;
    std::vector<CellPart> parts;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        Box box;
        ClipPolygon triangle;
        for (int p : mesh.triangle[t]) box.grow(at[p]), triangle.add(at[p]);
        if (!box.widened(kTouch).overlaps(around)) continue;
        const Vec3 normal = area_vector(mesh.position, mesh.triangle[t]);
        const auto add = [&](const ClipPolygon& part, const Vec3i& cell) {
            const int place = place_of(cells, cell);
            if (place < 0) return;
            Vec3 area = Vec3::Zero(), moment = Vec3::Zero();
            double sum = 0;
            for (int n = 1; n + 1 < part.count; ++n) {
                const Vec3 &a = part.corner[0], &b = part.corner[n], &c = part.corner[n + 1];
                const Vec3 cross =
                    (b - a).cwiseProduct(frame.step).cross((c - a).cwiseProduct(frame.step));
                const double size = cross.norm();
                area += 0.5 * cross, moment += size / 3 * (a + b + c), sum += size;
            }
            parts.push_back(
                {place, static_cast<int>(t), area, sum > 0 ? Vec3(moment / sum) : part.corner[0]});
        };
        for_each_bin(triangle, 2, normal, count.z(), only[2], [&](int k, auto& slab) {
            for_each_bin(slab, 1, normal, count.y(), only[1], [&](int j, auto& bar) {
                for_each_bin(bar, 0, normal, count.x(), only[0], [&](int i, auto& part) {
                    add(part, {i, j, k});
                });
            });
        });
    }
    std::sort(parts.begin(), parts.end(), [](const CellPart& a, const CellPart& b) {
        return std::pair(a.cell, a.triangle) < std::pair(b.cell, b.triangle);
    });
    return parts;
}

// Of a line between two points, whether it meets the cell or its faces.
bool meets(const Vec3& from, const Vec3& to, const Vec3i& cell) {
    double first = 0, last = 1;
    for (int d = 0; d < 3; ++d) {
        const double low = cell[d] - kTouch, high = cell[d] + 1 + kTouch, way = to[d] - from[d];
        if (way == 0) {
            if (from[d] < low || from[d] > high) return false;
            continue;
        }
        const auto [in, out] = std::minmax({(low - from[d]) / way, (high - from[d]) / way});
        first = std::max(first, in), last = std::min(last, out);
    }
    return first <= last;
}

using Triangle = std::array<Vec3, 3>;

double volume_over(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
}

// Where the sides of one pass through the other, not only to it.
void add_crossings(const Triangle& one, const Triangle& other, std::vector<Vec3>& crossing) {
    for (int n = 0; n < 3; ++n) {
        const Vec3 &a = one[n], &b = one[(n + 1) % 3];
        const double below = volume_over(other[0], other[1], other[2], a),
                     above = volume_over(other[0], other[1], other[2], b);
        if (!(below * above < 0)) continue;
        bool left = false, right = false;
        for (int m = 0; m < 3; ++m) {
            const double v = volume_over(a, b, other[m], other[(m + 1) % 3]);
            left |= v > 0, right |= v < 0;
        }
        if (!(left && right)) crossing.push_back(a + below / (below - above) * (b - a));
    }
}

bool cross_in(const Vec3i& cell, const Triangle& one, const Triangle& other) {
    std::vector<Vec3> crossing;
    add_crossings(one, other, crossing);
    add_crossings(other, one, crossing);
    return !crossing.empty() && meets(crossing.front(), crossing.back(), cell);
}

Triangle corners_of(const TriMesh& mesh, const std::vector<Vec3>& at, int triangle) {
    const Corners& t = mesh.triangle[triangle];
    return {at[t[0]], at[t[1]], at[t[2]]};
}

// Parts that cross each other hold together there.
void join_crossing(const TriMesh& mesh, const std::vector<Vec3>& at, const Vec3i& cell,
                   const CellPart* part, int count, DisjointSets& sets) {
    std::vector<int> number;
    if (sets.number_sets(number) < 2) return;
    std::vector<Triangle> triangle;
    std::vector<Box> box(count);
    std::vector<int> order(count);
    const Vec3 low = cell.cast<double>(), high = low + Vec3::Ones();
    for (int n = 0; n < count; ++n) {
        triangle.push_back(corners_of(mesh, at, part[n].triangle));
        for (const Vec3& p : triangle[n]) box[n].grow(p);
        box[n] = {box[n].low.cwiseMax(low), box[n].high.cwiseMin(high)};
        order[n] = n;
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return box[a].low.x() < box[b].low.x(); });
    for (int n = 0; n < count; ++n) {
        const int a = order[n];
        for (int m = n + 1; m < count && box[order[m]].low.x() <= box[a].high.x(); ++m) {
            const int b = order[m];
            if (number[a] != number[b] && box[a].overlaps(box[b]) &&
                cross_in(cell, triangle[a], triangle[b])) {
                sets.unite(a, b);
            }
        }
    }
}

// Of 26: walls that meet at an edge go about different ways.
int way_of(const Vec3& normal) {
    const double most = normal.cwiseAbs().maxCoeff();
    int way = 0;
    for (int d = 0; d < 3; ++d) way = 3 * way + 1 + static_cast<int>(std::round(normal[d] / most));
    return way;
}

}  // namespace

bool comes_before(const Vec3i& a, const Vec3i& b) {
    return std::tuple(a.z(), a.y(), a.x()) < std::tuple(b.z(), b.y(), b.x());
}

SurfacePieces::SurfacePieces(const TriMesh& mesh, const MoldFrame& frame,
                             const std::vector<Vec3i>& cells)
    : cells_(cells) {
    std::vector<Vec3> at;
    at.reserve(mesh.position.size());
    for (const Vec3& p : mesh.position) at.push_back(0.5 * frame.bins(p));
    const std::vector<CellPart> parts = cut_to_cells(mesh, frame, at, cells);
    const CellPart *next = parts.data(), *const end = next + parts.size();
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        first_element_.push_back(element_.size());
        const CellPart* const first = next;
        while (next != end && next->cell == static_cast<int>(c)) ++next;
        if (next != first) add_cell(mesh, at, first, next, static_cast<int>(c));
    }
    first_element_.push_back(element_.size());
    link_neighbours();
}

void SurfacePieces::add_cell(const TriMesh& mesh, const std::vector<Vec3>& at,
                             const CellPart* first, const CellPart* last, int cell) {
    const int count = static_cast<int>(last - first);
    struct Side {
        std::uint64_t key;
        int part;
    };
    std::vector<Side> sides;
    for (int n = 0; n < count; ++n) {
        const Corners& t = mesh.triangle[first[n].triangle];
        for (int s = 0; s < 3; ++s) {
            const auto [low, high] = std::minmax({t[s], t[(s + 1) % 3]});
            if (!meets(at[low], at[high], cells_[cell])) continue;
            const auto key = static_cast<std::uint64_t>(low) << 31 | static_cast<unsigned>(high);
            sides.push_back({key | std::uint64_t{1} << 63, n});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::pair(a.key, a.part) < std::pair(b.key, b.part);
    });
    DisjointSets sets(count);
    for (std::size_t s = 1; s < sides.size(); ++s) {
        if (sides[s].key == sides[s - 1].key) sets.unite(sides[s].part, sides[s - 1].part);
    }
    join_crossing(mesh, at, cells_[cell], first, count, sets);
    std::vector<int> piece;
    const int known = static_cast<int>(cell_of_piece_.size());
    cell_of_piece_.resize(known + sets.number_sets(piece), cell);
    for (int n = 0; n < count; ++n) {
        element_.push_back({static_cast<std::uint64_t>(first[n].triangle), known + piece[n]});
    }
    for (std::size_t s = 0; s < sides.size(); ++s) {
        if (s > 0 && sides[s].key == sides[s - 1].key) continue;
        element_.push_back({sides[s].key, known + piece[sides[s].part]});
    }
    std::map<std::pair<int, int>, FacingPatch> facing;
    for (int n = 0; n < count; ++n) {
        const double size = first[n].area.norm();
        if (!(size > 0)) continue;
        const FacingPatch none{known + piece[n], Vec3::Zero(), Vec3::Zero(), 0};
        FacingPatch& patch =
            facing.try_emplace({piece[n], way_of(first[n].area)}, none).first->second;
        patch.area += size, patch.center += size * first[n].center, patch.normal += first[n].area;
    }
    for (auto& [key, patch] : facing) {
        patch.center /= patch.area;
        patch.normal.normalize();
        patch_.push_back(patch);
    }
}

void SurfacePieces::link_neighbours() {
    next_.resize(cell_of_piece_.size());
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        for (int n = 14; n < 27; ++n) {  // the later half of those around
            const Vec3i around(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
            const int other = place_of(cells_, cells_[c] + around);
            if (other < 0) continue;
            std::size_t a = first_element_[c], b = first_element_[other];
            while (a < first_element_[c + 1] && b < first_element_[other + 1]) {
                const Element &one = element_[a], &two = element_[b];
                if (one.key == two.key) {
                    std::vector<int>& known = next_[one.piece];
                    if (known.empty() || known.back() != two.piece) {
                        known.push_back(two.piece);
                        next_[two.piece].push_back(one.piece);
                    }
                }
                if (one.key <= two.key) ++a;
                if (two.key <= one.key) ++b;
            }
        }
    }
}

std::vector<int> SurfacePieces::joined_around(int piece) const {
    const Vec3i& middle = cells_[cell_of_piece_[piece]];
    std::vector<int> found = {piece};
    for (std::size_t n = 0; n < found.size(); ++n) {
        for (int next : next_[found[n]]) {
            const Vec3i& cell = cells_[cell_of_piece_[next]];
            if ((cell - middle).cwiseAbs().maxCoeff() > 1) continue;
            if (std::find(found.begin(), found.end(), next) == found.end()) found.push_back(next);
        }
    }
    return found;
}

}  // namespace swage

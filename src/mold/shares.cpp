// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: the divergence theorem along x; exact moments of polyhedra by their faces, B. Mirtich,
// "Fast and accurate computation of polyhedral mass properties", 1996.
//
// A patch of surface with outward area s along x bounds the material on its low side: within its
// own row of cells it adds the volume between its cell's low face and itself to its own cell, and
// s to each cell before. So one pass over the patches, and one sum along each row from its high
// end, give every cell's volume and first moments. No cell is asked whether it is inside.
#include "mold/shares.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mold/clip.h"

namespace swage {

namespace {

constexpr double kRoundOff = 1e-12;  // [cells], of a fill
// Where a surface crosses itself a little, a cell may hold that much less than nothing or more than
// all. Such shares are kept, for the total's sake; the negative ones go with the slivers.
constexpr double kWrinkle = 0.05;

// What the surface inside one cell says about its row, lengths in cells; y and z from the
// cell's centre, x from its low face.
struct RowTerms {
    double area = 0, area_y = 0, area_z = 0;              // integrals of n_x (1, y, z)
    double fill = 0, fill_x = 0, fill_y = 0, fill_z = 0;  // of n_x (x, (x2 - x)/2, xy, xz)
    int first_patch = -1;
};

struct RawPatch {
    int key;   // bin of the cell, then direction of the normal
    int next;  // of the same cell
    double area = 0;
    Vec3 moment = Vec3::Zero();  // area times centre [bins]
    Vec3 normal = Vec3::Zero();  // times area
};

int direction_of(const Vec3& normal) {
    int axis;
    normal.cwiseAbs().maxCoeff(&axis);
    return 2 * axis + (normal[axis] < 0);
}

class LayerSharer {
  public:
    LayerSharer(const MoldFrame& frame, int k) : frame_(frame), k_(k) {
        const std::size_t columns =
            static_cast<std::size_t>(frame.cell_count.x()) * frame.cell_count.y();
        term_of_column_.assign(columns, -1);
    }

    // Corners in bins; `normal` and `area` [m2] are the triangle's own.
    void add_triangle(const std::array<Vec3, 3>& corner, const Vec3& normal, double area) {
        ClipPolygon triangle;
        for (const Vec3& p : corner) triangle.add(p);
        const Vec3 cross = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        const double square = cross.squaredNorm();
        if (!(square > 0)) return;
        // Shares of area are the same in bins and in space.
        const Vec3 area_of_cross = cross * (area / square);
        const Vec3 end = 2 * frame_.cell_count.cast<double>();
        const auto inside = [&](const Vec3& p) {
            return (p.array() >= 0).all() && (p.array() <= end.array()).all();
        };
        if (std::all_of(corner.begin(), corner.end(), inside)) {
            add_polygon(triangle, area_of_cross, normal);
            return;
        }
        // What reaches out of the box tells of the cells only where it lies beyond the high ends of
        // their rows: seen along x, it is the face that the box cuts there.
        ClipPolygon before, rest, beyond;
        for (int d : {2, 1, 0}) {
            split(triangle, d, 0, before, rest);
            split(rest, d, end[d], triangle, beyond);
        }
        double farthest = 0;
        for (int n = 0; n < beyond.count; ++n) {
            farthest = std::max(farthest, beyond.corner[n].x());
            beyond.corner[n].x() = end.x();
        }
        add_polygon(triangle, area_of_cross, normal);
        if (farthest <= end.x()) return;  // it lies in the end itself
        const Vec3 side = std::copysign(1.0, normal.x()) * Vec3::UnitX();
        add_polygon(beyond, frame_.step.y() * frame_.step.z() / 8 * side, side);
    }

    CellLayer finish() {
        CellLayer layer;
        for (int j = 0; j < frame_.cell_count.y(); ++j) {
            finish_row(j, layer);
            for (int i = 0; i < frame_.cell_count.x(); ++i) {
                const int t = term_of_column_[column(i, j)];
                if (t >= 0) finish_patches(i, j, term_[t], layer);
            }
        }
        return layer;
    }

  private:
    // In the box. Used up.
    void add_polygon(ClipPolygon& polygon, const Vec3& area_of_cross, const Vec3& normal) {
        const int direction = direction_of(normal);
        const Vec3i bins = 2 * frame_.cell_count;
        const BinRange all{0, std::numeric_limits<int>::max()};
        for_each_bin(polygon, 2, normal, bins.z(), {2 * k_, 2 * k_ + 1}, [&](int bz, auto& slab) {
            for_each_bin(slab, 1, normal, bins.y(), all, [&](int by, auto& bar) {
                for_each_bin(bar, 0, normal, bins.x(), all, [&](int bx, auto& part) {
                    add_part(part, {bx, by, bz}, area_of_cross, normal, direction);
                });
            });
        });
    }

    std::size_t column(int i, int j) const {
        return i + static_cast<std::size_t>(frame_.cell_count.x()) * j;
    }

    void add_part(const ClipPolygon& part, const Vec3i& bin, const Vec3& area_of_cross,
                  const Vec3& normal, int direction) {
        const Vec3i cell(bin.x() >> 1, bin.y() >> 1, bin.z() >> 1);
        const Vec3 low = cell.cast<double>() + Vec3(0, 0.5, 0.5);
        double area = 0;
        Vec3 moment = Vec3::Zero();
        RowTerms sum;
        const Vec3& a = part.corner[0];
        const Vec3 ua = 0.5 * a - low;
        for (int n = 1; n + 1 < part.count; ++n) {
            const Vec3& b = part.corner[n];
            const Vec3& c = part.corner[n + 1];
            const Vec3 cross = (b - a).cross(c - a);
            const double piece = cross.dot(area_of_cross);
            area += piece;
            moment += piece / 3 * (a + b + c);
            const double s = cross.x() / 8;  // half, and two bins a cell
            if (s == 0) continue;
            const Vec3 ub = 0.5 * b - low, uc = 0.5 * c - low;
            const Vec3 total = ua + ub + uc;
            // Means over a triangle of x, y, z and of their products with x, times 3 and 12.
            const Vec3 product = ua.x() * ua + ub.x() * ub + uc.x() * uc + total.x() * total;
            sum.area += s;
            sum.area_y += s / 3 * total.y();
            sum.area_z += s / 3 * total.z();
            sum.fill += s / 3 * total.x();
            sum.fill_x += s * (product.x() / 24 - total.x() / 6);
            sum.fill_y += s / 12 * product.y();
            sum.fill_z += s / 12 * product.z();
        }
        if (!(area > 0)) return;
        int& t = term_of_column_[column(cell.x(), cell.y())];
        if (t < 0) {
            t = static_cast<int>(term_.size());
            term_.emplace_back();
        }
        RowTerms& term = term_[t];
        term.area += sum.area, term.area_y += sum.area_y, term.area_z += sum.area_z;
        term.fill += sum.fill, term.fill_x += sum.fill_x;
        term.fill_y += sum.fill_y, term.fill_z += sum.fill_z;

        const int octant = (bin.x() & 1) + 2 * (bin.y() & 1) + 4 * (bin.z() & 1);
        RawPatch& patch = patch_at(term, 6 * octant + direction);
        patch.area += area;
        patch.moment += moment;
        patch.normal += area * normal;
    }

    RawPatch& patch_at(RowTerms& term, int key) {
        for (int p = term.first_patch; p >= 0; p = patch_[p].next) {
            if (patch_[p].key == key) return patch_[p];
        }
        RawPatch patch;
        patch.key = key;
        patch.next = term.first_patch;
        term.first_patch = static_cast<int>(patch_.size());
        return patch_.emplace_back(patch);
    }

    void finish_row(int j, CellLayer& layer) {
        const std::size_t begin = layer.share.size();
        double area = 0, area_y = 0, area_z = 0;  // of all surface at higher x
        for (int i = frame_.cell_count.x() - 1; i >= 0; --i) {
            const int t = term_of_column_[column(i, j)];
            if (t < 0) {  // all inside or all outside
                add_share({i, j, std::round(area), Vec3::Zero()}, layer);
                continue;
            }
            const RowTerms& term = term_[t];
            const Vec3 moment(term.fill_x, term.fill_y + area_y, term.fill_z + area_z);
            add_share({i, j, term.fill + area, moment}, layer);
            area += term.area, area_y += term.area_y, area_z += term.area_z;
        }
        std::reverse(layer.share.begin() + begin, layer.share.end());
    }

    static void add_share(CellFill share, CellLayer& layer) {
        if (std::abs(share.fill) < kRoundOff) return;
        if (share.fill < -kWrinkle) {
            layer.deficit -= share.fill;
            return;
        }
        if (share.fill > 1 + kWrinkle) {
            layer.surplus += share.fill - 1;
            share = {share.i, share.j, 1, Vec3::Zero()};
        }
        if (std::abs(share.fill - 1) < kRoundOff) share = {share.i, share.j, 1, Vec3::Zero()};
        layer.share.push_back(share);
    }

    // Patches that are small beside a quarter of a cell's face go to the largest of their
    // direction: each point costs contact the same, whatever its area.
    void finish_patches(int i, int j, const RowTerms& term, CellLayer& layer) {
        const double small = 0.25 * (frame_.spacing * frame_.spacing / 4);
        order_.clear();
        std::array<int, 6> largest;
        largest.fill(-1);
        for (int p = term.first_patch; p >= 0; p = patch_[p].next) {
            int& best = largest[patch_[p].key % 6];
            const auto rank = [&](int q) { return std::pair(patch_[q].area, -patch_[q].key); };
            if (best < 0 || rank(p) > rank(best)) best = p;
        }
        for (int p = term.first_patch; p >= 0; p = patch_[p].next) {
            const int best = largest[patch_[p].key % 6];
            if (patch_[p].area < small && best != p) {
                patch_[best].area += patch_[p].area;
                patch_[best].moment += patch_[p].moment;
                patch_[best].normal += patch_[p].normal;
            } else {
                order_.push_back(p);
            }
        }
        std::sort(order_.begin(), order_.end(),
                  [&](int a, int b) { return patch_[a].key < patch_[b].key; });
        for (int p : order_) {
            const RawPatch& raw = patch_[p];
            layer.patch.push_back({i, j, raw.moment / raw.area, raw.normal.normalized(), raw.area});
        }
    }

    const MoldFrame& frame_;
    int k_;
    std::vector<int> term_of_column_;  // -1 where no surface passes
    std::vector<RowTerms> term_;
    std::vector<RawPatch> patch_;
    std::vector<int> order_;
};

}  // namespace

std::vector<CellLayer> share_cells(const TriMesh& mesh, const MoldFrame& frame) {
    std::vector<Vec3> bins(mesh.position.size());
    for (std::size_t p = 0; p < bins.size(); ++p) bins[p] = frame.bins(mesh.position[p]);

    // Triangles of each layer of cells, in their order.
    const int layer_count = frame.cell_count.z();
    const auto layers_of = [&](const Corners& t) -> BinRange {
        const auto [low, high] = std::minmax({bins[t[0]].z(), bins[t[1]].z(), bins[t[2]].z()});
        const double normal =
            (bins[t[1]] - bins[t[0]])
                .head<2>()
                .dot(Vec2((bins[t[2]] - bins[t[0]]).y(), -(bins[t[2]] - bins[t[0]]).x()));
        const BinRange range = bins_between(low, high, normal, 2 * layer_count);
        return {range.first >> 1, range.last >> 1};
    };
    std::vector<std::size_t> begin(layer_count + 1, 0);
    for (const Corners& t : mesh.triangle) {
        const BinRange range = layers_of(t);
        for (int k = range.first; k <= range.last; ++k) ++begin[k + 1];
    }
    for (int k = 0; k < layer_count; ++k) begin[k + 1] += begin[k];
    std::vector<int> member(begin.back());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        const BinRange range = layers_of(mesh.triangle[t]);
        for (int k = range.first; k <= range.last; ++k) member[next[k]++] = static_cast<int>(t);
    }

    std::vector<CellLayer> layers(layer_count);
    parallel_for(layer_count, [&](std::size_t k) {
        LayerSharer sharer(frame, static_cast<int>(k));
        for (std::size_t m = begin[k]; m < begin[k + 1]; ++m) {
            const Corners& t = mesh.triangle[member[m]];
            const Vec3 cross = area_vector(mesh.position, t);
            const double length = cross.norm();
            if (!(length > 0)) continue;
            sharer.add_triangle({bins[t[0]], bins[t[1]], bins[t[2]]}, cross / length, length / 2);
        }
        layers[k] = sharer.finish();
    });
    return layers;
}

}  // namespace swage

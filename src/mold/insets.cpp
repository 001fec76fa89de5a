// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/insets.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "mold/overhang.h"
#include "mold/prepare.h"

namespace swage {

namespace {

constexpr double kPure = 1e-3;  // share of a cell's matter that is taken for nothing
// Shares of an inset that may go unmentioned: outside, as a box does at rounded edges, and too
// thin.
constexpr double kOutside = 0.03, kSlight = 1e-3;

// What one material has of a cell; fill times centroid; area times the outward normal of the
// insets' surface in the cell.
struct Part {
    double fill = 0;
    Vec3 moment = Vec3::Zero();
    Vec3 outward = Vec3::Zero();
};
using CellParts = std::map<int, Part>;  // by material

void refuse_unfit(const Inset& inset, std::size_t n) {
    if (signed_volume(inset.solid) > 0) return;
    throw InsetError(
        n, fmt::format("cannot mold: inset {} encloses no volume, or is turned inside out", n + 1));
}

// Those that the body's own surface runs through.
std::set<CellId> surface_cells(const std::vector<CellLayer>& layers, const Lattice& lattice) {
    std::set<CellId> cells;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const SurfacePatch& patch : layers[k].patch) {
            cells.insert(lattice.cell_at(patch.i, patch.j, static_cast<int>(k)));
        }
    }
    return cells;
}

// What an inset has of a cell; what was there makes room for it.
void add_part(int material, double fill, const Vec3& centroid, double whole, CellParts& parts) {
    const double left = whole - fill;
    double had = 0;
    for (const auto& [other, part] : parts) had += part.fill;
    for (auto& [other, part] : parts) {
        const double keep = had > left ? left / had : 1;
        part.fill *= keep, part.moment *= keep;
    }
    parts[material].fill = fill;
    parts[material].moment = fill * centroid;
}

// The cells that any inset reaches, one inset after the other.
class InsetParts {
  public:
    // `body`: whose insets may reach out; null: as they are.
    InsetParts(const std::vector<CellLayer>& layers, const MoldFrame& frame,
               const Aggregate& matter, const TriMesh* body)
        : frame_(frame), matter_(matter), surface_(surface_cells(layers, matter.lattice)) {
        if (body != nullptr) body_.emplace(*body);
    }

    // In cells: what of it is in the body, what would be were it more of its cells, and all of it.
    struct Volume {
        double inside, slight, all;
    };
    Volume add(const Inset& inset, int material) {
        Volume volume{0, 0, signed_volume(inset.solid) / frame_.cell_volume()};
        std::vector<CellLayer> layers = share_cells(inset.solid, frame_);
        if (body_) leave_out_overhang(inset.solid, layers);
        for (int k = 0; k < static_cast<int>(layers.size()); ++k) {
            const CellLayer& layer = layers[static_cast<std::size_t>(k)];
            volume.all += layer.deficit - layer.surplus;
            for (const CellFill& share : layer.share) add(share, k, material, volume);
            for (const SurfacePatch& patch : layer.patch) add(patch, k, material);
        }
        return volume;
    }
    std::map<CellId, CellParts>& all() { return parts_; }

  private:
    // Of cells that the body fills in part, and where the inset ends in them.
    void leave_out_overhang(const TriMesh& solid, std::vector<CellLayer>& layers) const {
        const Overhang overhang(*body_, solid, frame_);
        struct Found {
            CellFill* share;
            int k;
            double whole;
        };
        std::vector<Found> crossed;
        for (int k = 0; k < static_cast<int>(layers.size()); ++k) {
            CellLayer& layer = layers[static_cast<std::size_t>(k)];
            std::set<CellId> ends;
            for (const SurfacePatch& patch : layer.patch) {
                ends.insert(matter_.lattice.cell_at(patch.i, patch.j, k));
            }
            for (CellFill& share : layer.share) {
                const CellId cell = matter_.lattice.cell_at(share.i, share.j, k);
                if (cell < 0 || !ends.contains(cell) || !surface_.contains(cell)) continue;
                const double whole = matter_.cell_fill[cell];
                if (whole < 1 - kPure) crossed.push_back({&share, k, whole});
            }
        }
        parallel_each(crossed.size(), 16, [&](std::size_t n) {
            const Found& at = crossed[n];
            *at.share = overhang.within(*at.share, at.k, at.whole);
        });
    }
    void add(const CellFill& share, int k, int material, Volume& volume) {
        const CellId cell = matter_.lattice.cell_at(share.i, share.j, k);
        if (cell < 0) return;
        const double whole = matter_.cell_fill[cell];
        const double fill = std::clamp(share.fill, 0.0, whole);
        if (fill < kPure * whole) {
            volume.slight += fill;
            return;
        }
        volume.inside += fill;
        const Vec3 centroid = whole - fill < kPure * whole
                                  ? Vec3(matter_.cell_centroid[cell].cast<double>())
                                  : Vec3(share.moment / share.fill);
        add_part(material, fill, centroid, whole, parts_[cell]);
    }
    // Where the body has its own surface, an inset's may be the same and tell nothing.
    void add(const SurfacePatch& patch, int k, int material) {
        const CellId cell = matter_.lattice.cell_at(patch.i, patch.j, k);
        if (cell < 0 || surface_.contains(cell)) return;
        const auto parts = parts_.find(cell);
        if (parts == parts_.end() || !parts->second.contains(material)) return;
        parts->second[material].outward += patch.area * patch.normal;
    }

    const MoldFrame& frame_;
    const Aggregate& matter_;
    std::set<CellId> surface_;
    std::optional<TriangleTree> body_;
    std::map<CellId, CellParts> parts_;
};

// The body's own material has what the insets leave of a cell.
void add_rest(double whole, const Vec3& centroid, CellParts& parts) {
    Part& rest = parts[0];
    rest.fill = whole, rest.moment = whole * centroid;
    for (const auto& [material, part] : parts) {
        if (material != 0) rest.fill -= part.fill, rest.moment -= part.moment;
    }
}

// The materials of a cell, what has most of it first.
std::vector<int> by_fill(const CellParts& parts) {
    std::vector<int> order;
    for (const auto& [material, part] : parts) order.push_back(material);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return parts.at(a).fill > parts.at(b).fill; });
    return order;
}

// Of the two that have most of a cell, as if there were no others.
MixedCell mixed_cell(CellId cell, double whole, int most, int next, const CellParts& parts,
                     double spacing) {
    const Part &one = parts.at(most), &other = parts.at(next);
    const double kept = one.fill + other.fill;
    MixedCell mixed{};
    mixed.cell = cell;
    for (int m : {0, 1}) {
        const Part& part = m == 0 ? one : other;
        mixed.material[m] = static_cast<std::uint8_t>(m == 0 ? most : next);
        mixed.fill[m] = static_cast<float>(part.fill * whole / kept);
        mixed.centroid[m] =
            Vec3(part.moment / part.fill).cwiseMax(-0.5).cwiseMin(0.5).cast<float>();
    }
    // The boundary's own surface tells where it looks; where none was seen, the centroids.
    Vec3 normal = one.outward - other.outward;
    if (most != 0 && next != 0) normal = parts.at(std::max(most, next)).outward;
    if (!(normal.norm() > 1e-6 * spacing * spacing)) {
        normal = (mixed.centroid[1] - mixed.centroid[0]).cast<double>();
    }
    if (!(normal.norm() > 0)) normal = Vec3::UnitX();
    mixed.normal = normal.normalized().cast<float>();
    return mixed;
}

}  // namespace

void place_insets(const std::vector<Inset>& insets, const std::vector<CellLayer>& layers,
                  const MoldFrame& frame, Aggregate& matter, std::vector<std::string>& findings,
                  const TriMesh* body) {
    if (insets.empty()) return;
    InsetParts parts(layers, frame, matter, body);
    for (std::size_t n = 0; n < insets.size(); ++n) {
        refuse_unfit(insets[n], n);
        matter.inset.push_back(insets[n].material);
        const auto [inside, slight, all] = parts.add(insets[n], static_cast<int>(n) + 1);
        if (inside == 0) {
            throw InsetError(
                n, fmt::format("cannot mold: inset {} {}", n + 1,
                               slight > 0 ? "is less than a thousandth of each cell that it lies in"
                                          : "lies outside the work-piece"));
        }
        const auto find = [&](double share, const char* why) {
            findings.push_back(
                fmt::format("{:.3g} % of inset {} {} and is left out", 100 * share, n + 1, why));
        };
        if (body == nullptr && inside + slight < (1 - kOutside) * all) {
            find(1 - (inside + slight) / all, "lies outside the work-piece");
        }
        if (slight > kSlight * all) find(slight / all, "is less than a thousandth of its cell");
    }
    matter.cell_material.assign(matter.cell_fill.size(), 0);
    for (auto& [cell, of] : parts.all()) {
        const double whole = matter.cell_fill[cell];
        add_rest(whole, matter.cell_centroid[cell].cast<double>(), of);
        const std::vector<int> order = by_fill(of);
        matter.cell_material[cell] = static_cast<std::uint8_t>(order[0]);
        if (order.size() < 2 || of[order[1]].fill < kPure * whole) continue;
        matter.mixed_cell.push_back(mixed_cell(cell, whole, order[0], order[1], of, frame.spacing));
    }
    if (matter.material_count() > 200) fail(ExitCode::scene, "more than 200 materials in one body");
}

}  // namespace swage

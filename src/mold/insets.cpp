// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/insets.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "mold/prepare.h"

namespace swage {

namespace {

constexpr double kPure = 1e-3;     // share of a cell's matter that is taken for nothing
constexpr double kOutside = 1e-3;  // share of an inset that may lie outside unmentioned

// What one material has of a cell; fill times centroid; area times the outward normal of the
// insets' surface in the cell.
struct Part {
    double fill = 0;
    Vec3 moment = Vec3::Zero();
    Vec3 outward = Vec3::Zero();
};

void refuse_unfit(const Inset& inset, std::size_t n) {
    if (signed_volume(inset.solid) > 0) return;
    throw InsetError(
        n, fmt::format("cannot mold: inset {} encloses no volume, or is turned inside out", n + 1));
}

}  // namespace

void place_insets(const std::vector<Inset>& insets, const std::vector<CellLayer>& layers,
                  const MoldFrame& frame, Aggregate& matter, std::vector<std::string>& findings) {
    if (insets.empty()) return;
    // Where the body has its own surface, an inset's may be the same and tell nothing.
    std::set<CellId> skin;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const SurfacePatch& patch : layers[k].patch) {
            skin.insert(matter.lattice.cell_at(patch.i, patch.j, static_cast<int>(k)));
        }
    }
    // Of each cell that any inset reaches, the parts by material.
    std::map<CellId, std::map<int, Part>> parts;
    for (std::size_t n = 0; n < insets.size(); ++n) {
        refuse_unfit(insets[n], n);
        const int material = static_cast<int>(n) + 1;
        matter.inset.push_back(insets[n].material);
        double inside = 0, all = signed_volume(insets[n].solid) / frame.cell_volume();
        const std::vector<CellLayer> own = share_cells(insets[n].solid, frame);
        for (std::size_t k = 0; k < own.size(); ++k) {
            all += own[k].deficit - own[k].surplus;
            for (const CellFill& s : own[k].share) {
                const CellId cell = matter.lattice.cell_at(s.i, s.j, static_cast<int>(k));
                if (cell < 0) continue;
                const double whole = matter.cell_fill[cell];
                const double fill = std::clamp(s.fill, 0.0, whole);
                if (fill < kPure * whole) continue;
                inside += fill;
                auto& of = parts[cell];
                const Vec3 centroid = whole - fill < kPure * whole
                                          ? Vec3(matter.cell_centroid[cell].cast<double>())
                                          : Vec3(s.moment / s.fill);
                // What comes later takes its room from what was there.
                double left = whole - fill, had = 0;
                for (auto& [other, part] : of) had += part.fill;
                for (auto& [other, part] : of) {
                    const double keep = had > left ? left / had : 1;
                    part.fill *= keep, part.moment *= keep;
                }
                of[material].fill = fill;
                of[material].moment = fill * centroid;
            }
            for (const SurfacePatch& patch : own[k].patch) {
                const CellId cell = matter.lattice.cell_at(patch.i, patch.j, static_cast<int>(k));
                if (cell >= 0 && !skin.contains(cell) && parts.count(cell) &&
                    parts[cell].count(material)) {
                    parts[cell][material].outward += patch.area * patch.normal;
                }
            }
        }
        if (inside == 0) {
            throw InsetError(
                n, fmt::format("cannot mold: inset {} lies outside the work-piece", n + 1));
        }
        if (inside < (1 - kOutside) * all) {
            findings.push_back(
                fmt::format("{:.3g} % of inset {} lies outside the work-piece and is left out",
                            100 * (1 - inside / all), material));
        }
    }
    matter.cell_material.assign(matter.cell_fill.size(), 0);
    for (auto& [cell, of] : parts) {
        const double whole = matter.cell_fill[cell];
        const Vec3 all = whole * matter.cell_centroid[cell].cast<double>();
        Part& rest = of[0];
        rest.fill = whole, rest.moment = all;
        for (const auto& [material, part] : of) {
            if (material != 0) rest.fill -= part.fill, rest.moment -= part.moment;
        }
        std::vector<int> order;
        for (const auto& [material, part] : of) order.push_back(material);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return of[a].fill > of[b].fill; });
        matter.cell_material[cell] = static_cast<std::uint8_t>(order[0]);
        if (order.size() < 2 || of[order[1]].fill < kPure * whole) continue;
        const double kept = of[order[0]].fill + of[order[1]].fill;
        MixedCell mixed{};
        mixed.cell = cell;
        for (int m : {0, 1}) {
            const Part& part = of[order[m]];
            mixed.material[m] = static_cast<std::uint8_t>(order[m]);
            mixed.fill[m] = static_cast<float>(part.fill * whole / kept);
            mixed.centroid[m] =
                Vec3(part.moment / part.fill).cwiseMax(-0.5).cwiseMin(0.5).cast<float>();
        }
        // The boundary's own surface tells where it looks; where none was seen, the centroids.
        Vec3 normal = of[order[0]].outward - of[order[1]].outward;
        if (order[0] != 0 && order[1] != 0) normal = of[std::max(order[0], order[1])].outward;
        if (!(normal.norm() > 1e-6 * frame.spacing * frame.spacing)) {
            normal = (mixed.centroid[1] - mixed.centroid[0]).cast<double>();
        }
        if (!(normal.norm() > 0)) normal = Vec3::UnitX();
        mixed.normal = normal.normalized().cast<float>();
        matter.mixed_cell.push_back(mixed);
    }
    if (matter.material_count() > 200) fail(ExitCode::scene, "more than 200 materials in one body");
}

}  // namespace swage

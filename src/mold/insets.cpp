// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/insets.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "mold/inset_regions.h"
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

// The cells that any inset reaches, one inset after the other.
class InsetParts {
  public:
    InsetParts(const std::vector<Inset>& insets, const MoldedSurface& body, const MoldFrame& frame,
               const Aggregate& matter)
        : insets_(insets),
          body_(body),
          frame_(frame),
          matter_(matter),
          surface_(surface_cells(body.layers, matter.lattice)),
          regions_(body.mesh, insets) {}

    // In cells: what of it is in the body, what would be were it more of its cells, and all of it.
    struct Volume {
        double inside, slight, all;
    };
    Volume add(int inset) {
        const TriMesh& solid = insets_[inset].solid;
        Volume volume{0, 0, signed_volume(solid) / frame_.cell_volume()};
        std::vector<CellLayer> layers = share_cells(solid, frame_);
        keep_to_body(inset, layers);
        std::vector<Taken> taken;
        for (int k = 0; k < static_cast<int>(layers.size()); ++k) {
            const CellLayer& layer = layers[static_cast<std::size_t>(k)];
            volume.all += layer.deficit - layer.surplus;
            for (const CellFill& share : layer.share) add(share, k, taken, volume);
        }
        make_room(inset, taken);
        const int material = inset + 1;
        for (const Taken& cell : taken) parts_[cell.at][material] = cell.part;
        for (int k = 0; k < static_cast<int>(layers.size()); ++k) {
            for (const SurfacePatch& patch : layers[static_cast<std::size_t>(k)].patch) {
                add(patch, k, material);
            }
        }
        return volume;
    }
    std::map<CellId, CellParts>& all() { return parts_; }

  private:
    // What an inset has of a cell.
    struct Taken {
        CellId at;
        Vec3i site;
        double whole;
        Part part;
        bool is_whole() const { return whole - part.fill < kPure * whole; }
    };

    // Of cells that the body fills in part, and where the inset ends in them, it has what lies in
    // both.
    void keep_to_body(int inset, std::vector<CellLayer>& layers) {
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
                if (cell < 0 || !ends.contains(cell)) continue;
                const double whole = matter_.cell_fill[cell];
                if (whole < 1 - kPure) crossed.push_back({&share, k, whole});
            }
        }
        regions_.add(inset, crossed.empty());
        if (crossed.empty()) return;
        if (const std::optional<TriMesh> both = regions_.in_body()) {
            const std::vector<CellLayer> exact = shares_of(*both);
            for (const Found& at : crossed) {
                const CellFill* share = share_of(exact, at.share->i, at.share->j, at.k);
                if (share == nullptr) {
                    at.share->fill = 0, at.share->moment.setZero();
                } else if (share->fill < at.share->fill) {  // more: the body overlaps itself there
                    *at.share = *share;
                }
            }
            return;
        }
        if (!body_tree_) body_tree_.emplace(body_.mesh);
        const Overhang overhang(*body_tree_, insets_[inset].solid, frame_);
        parallel_each(crossed.size(), 16, [&](std::size_t n) {
            const Found& at = crossed[n];
            *at.share = overhang.within(*at.share, at.k, at.whole);
        });
    }
    std::vector<CellLayer> shares_of(const TriMesh& part) const {
        std::vector<CellLayer> layers = share_cells(part, frame_);
        move_slivers(body_.moves, layers);
        return layers;
    }
    void add(const CellFill& share, int k, std::vector<Taken>& taken, Volume& volume) const {
        const CellId cell = matter_.lattice.cell_at(share.i, share.j, k);
        if (cell < 0) return;
        const double whole = matter_.cell_fill[cell];
        const double fill = std::clamp(share.fill, 0.0, whole);
        if (fill < kPure * whole) {
            volume.slight += fill;
            return;
        }
        volume.inside += fill;
        Taken& has = taken.emplace_back(Taken{cell, {share.i, share.j, k}, whole, {}});
        has.part.fill = fill;
        const Vec3 centroid = has.is_whole() ? Vec3(matter_.cell_centroid[cell].cast<double>())
                                             : Vec3(share.moment / share.fill);
        has.part.moment = fill * centroid;
    }
    // Takes from those that were there what the inset has now.
    void make_room(int inset, const std::vector<Taken>& taken) {
        std::vector<std::vector<const Taken*>> shared(inset);  // with each of the others
        for (const Taken& cell : taken) {
            const auto parts = parts_.find(cell.at);
            if (parts == parts_.end() || cell.is_whole()) continue;
            for (const auto& [material, part] : parts->second) {
                const bool is_part = part.fill > 0 && part.fill < (1 - kPure) * cell.whole;
                if (is_part) shared[material - 1].push_back(&cell);
            }
        }
        // Elsewhere one of the two has all of the cell.
        for (int older = 0; older < inset; ++older) {
            if (!shared[older].empty()) take(older, shared[older]);
        }
        for (const Taken& cell : taken) {
            const auto parts = parts_.find(cell.at);
            if (parts != parts_.end()) fit(cell, parts->second);
        }
    }
    void take(int older, const std::vector<const Taken*>& cells) {
        const auto regions = regions_.taken_from(older);
        if (!regions) return;
        for (const auto& [mesh, sign] : *regions) {
            const std::vector<CellLayer> layers = shares_of(mesh);
            for (const Taken* cell : cells) {
                const Vec3i& site = cell->site;
                const CellFill* share = share_of(layers, site.x(), site.y(), site.z());
                if (share == nullptr) continue;
                Part& part = parts_.at(cell->at).at(older + 1);
                part.fill -= sign * share->fill;
                part.moment -= sign * share->moment;
            }
        }
    }
    // What is still too much lies where the inset does, and goes in equal shares.
    static void fit(const Taken& cell, CellParts& parts) {
        const double left = cell.whole - cell.part.fill;
        double had = 0;
        for (auto& [material, part] : parts) {
            if (!(part.fill > 0)) part.fill = 0, part.moment.setZero();
            had += part.fill;
        }
        if (!(had > left)) return;
        const double keep = cell.is_whole() ? 0 : left / had;
        const Vec3 centroid = cell.part.moment / cell.part.fill;
        for (auto& [material, part] : parts) {
            part.moment -= (1 - keep) * part.fill * centroid;
            part.fill *= keep;
        }
    }
    // Where the body has its own surface, an inset's may be the same and tell nothing.
    void add(const SurfacePatch& patch, int k, int material) {
        const CellId cell = matter_.lattice.cell_at(patch.i, patch.j, k);
        if (cell < 0 || surface_.contains(cell)) return;
        const auto parts = parts_.find(cell);
        if (parts == parts_.end() || !parts->second.contains(material)) return;
        parts->second[material].outward += patch.area * patch.normal;
    }

    const std::vector<Inset>& insets_;
    const MoldedSurface& body_;
    const MoldFrame& frame_;
    const Aggregate& matter_;
    std::set<CellId> surface_;
    InsetRegions regions_;
    std::optional<TriangleTree> body_tree_;
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

int parts_in(const CellParts& parts, double whole) {
    return static_cast<int>(std::ranges::count_if(
        parts, [&](const auto& of) { return of.second.fill >= kPure * whole; }));
}

bool is_same(const Material& a, const Material& b) {
    const auto numbers = [](const Material& of) {
        const auto& [name, mechanics, elasticity, young_modulus, poisson_ratio, density,
                     yield_stress, hardening, flow_curve, back_stress, back_strain, strength,
                     toughness, damping_ratio, friction, static_friction, restitution, stickiness] =
            of;
        return std::tie(mechanics, elasticity, young_modulus, poisson_ratio, density, yield_stress,
                        hardening, back_stress, back_strain, strength, toughness, damping_ratio,
                        friction, static_friction, restitution, stickiness);
    };
    const auto is_same_point = [](const FlowPoint& p, const FlowPoint& q) {
        return p.strain == q.strain && p.stress == q.stress;
    };
    return numbers(a) == numbers(b) &&
           std::ranges::equal(a.flow_curve, b.flow_curve, is_same_point);
}

// Where there are more than two parts, those of the same material become one: what lies between
// them, as a coat does, keeps its share.
void join_same(const Aggregate& matter, CellParts& parts) {
    const std::vector<int> order = by_fill(parts);
    for (std::size_t n = 1; n < order.size(); ++n) {
        Part& less = parts[order[n]];
        for (std::size_t m = 0; m < n && less.fill > 0; ++m) {
            if (!is_same(matter.material_at(order[m]), matter.material_at(order[n]))) continue;
            Part& more = parts[order[m]];
            more.fill += less.fill, more.moment += less.moment;
            less.fill = 0, less.moment.setZero();
        }
    }
}

// NOTE: what only rounding has left of a number goes by the order in which meshes were cut, which
// is not always the same; as a float it would keep all its digits, and all that follows show them.
Eigen::Vector3f without_rounding(const Vec3& v) {
    constexpr double kRounding = 1e-9;
    return Vec3((v.array().abs() < kRounding).select(0.0, v)).cast<float>();
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
            without_rounding((part.moment / part.fill).cwiseMax(-0.5).cwiseMin(0.5));
    }
    // The boundary's own surface tells where it looks; where none was seen, the centroids.
    Vec3 normal = one.outward - other.outward;
    if (most != 0 && next != 0) normal = parts.at(std::max(most, next)).outward;
    if (!(normal.norm() > 1e-6 * spacing * spacing)) {
        normal = (mixed.centroid[1] - mixed.centroid[0]).cast<double>();
    }
    if (!(normal.norm() > 0)) normal = Vec3::UnitX();
    mixed.normal = without_rounding(normal.normalized());
    return mixed;
}

// What materials gain and lose where a cell's third goes to the two that have most of it.
class Thirds {
  public:
    explicit Thirds(std::size_t materials) : had_(materials), has_(materials) {}
    void add(double whole, const std::vector<int>& order, int kept, const CellParts& parts) {
        double sum = 0;
        for (int n = 0; n < kept; ++n) sum += parts.at(order[n]).fill;
        for (int n = 0; n < static_cast<int>(order.size()); ++n) {
            const double fill = parts.at(order[n]).fill;
            had_[order[n]] += fill;
            if (n < kept) has_[order[n]] += fill * whole / sum;
        }
        for (std::size_t n = 2; n < order.size(); ++n) {
            if (parts.at(order[n]).fill < kPure * whole) break;
            if (parts_two(parts.at(order[0]), parts.at(order[n]), parts.at(order[1]))) {
                ++parting_[{order[n], std::minmax(order[0], order[1])}];
            }
        }
    }
    void tell(std::vector<std::string>& findings) const {
        const auto changes = [&](int m) {
            return m > 0 && std::abs(has_[m] - had_[m]) > kUntold * had_[m];
        };
        for (int m = 1; m < static_cast<int>(had_.size()); ++m) {
            if (!changes(m)) continue;
            const double change = has_[m] - had_[m];
            findings.push_back(
                fmt::format("inset {} has {:.3g} % {} than its volume: a cell holds two materials, "
                            "and what there is of a third goes to them; a smaller spacing avoids "
                            "this",
                            m, 100 * std::abs(change) / had_[m], change > 0 ? "more" : "less"));
        }
        for (const auto& [of, cells] : parting_) {
            const auto& [seam, beside] = of;
            if (changes(seam)) continue;
            findings.push_back(fmt::format(
                "{} between {} and {} goes to these in {}, for a cell holds two materials, and "
                "there they hold each other; a smaller spacing avoids this",
                name_of(seam), name_of(beside.first), name_of(beside.second),
                counted(cells, "cell", "cells")));
        }
    }

  private:
    static constexpr double kUntold = 0.01;

    static std::string name_of(int material) {
        return material == 0 ? "the work-piece's own matter" : fmt::format("inset {}", material);
    }
    // A seam lies between them, while where three meet along a line each lies beside the others.
    static bool parts_two(const Part& one, const Part& seam, const Part& other) {
        constexpr double kBeside = 0.25;  // of the way
        const Vec3 from = one.moment / one.fill, way = other.moment / other.fill - from,
                   at = seam.moment / seam.fill - from;
        const double share = at.dot(way) / way.squaredNorm();
        return share > 0 && share < 1 && (at - share * way).norm() < kBeside * way.norm();
    }

    std::vector<double> had_, has_;                                       // [cells]
    std::map<std::pair<int, std::pair<int, int>>, std::size_t> parting_;  // cells
};

}  // namespace

void place_insets(const std::vector<Inset>& insets, const MoldedSurface& body,
                  const MoldFrame& frame, Aggregate& matter, std::vector<std::string>& findings,
                  bool may_reach_out) {
    if (insets.empty()) return;
    InsetParts parts(insets, body, frame, matter);
    for (std::size_t n = 0; n < insets.size(); ++n) {
        refuse_unfit(insets[n], n);
        matter.inset.push_back(insets[n].material);
        const auto [inside, slight, all] = parts.add(static_cast<int>(n));
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
        if (!may_reach_out && inside + slight < (1 - kOutside) * all) {
            find(1 - (inside + slight) / all, "lies outside the work-piece");
        }
        if (slight > kSlight * all) find(slight / all, "is less than a thousandth of its cell");
    }
    matter.cell_material.assign(matter.cell_fill.size(), 0);
    Thirds thirds(insets.size() + 1);
    for (auto& [cell, of] : parts.all()) {
        const double whole = matter.cell_fill[cell];
        add_rest(whole, matter.cell_centroid[cell].cast<double>(), of);
        if (parts_in(of, whole) > 2) join_same(matter, of);
        const std::vector<int> order = by_fill(of);
        matter.cell_material[cell] = static_cast<std::uint8_t>(order[0]);
        const bool is_mixed = order.size() > 1 && of[order[1]].fill >= kPure * whole;
        if (is_mixed) {
            matter.mixed_cell.push_back(
                mixed_cell(cell, whole, order[0], order[1], of, frame.spacing));
        }
        thirds.add(whole, order, is_mixed ? 2 : 1, of);
    }
    if (!may_reach_out) thirds.tell(findings);
    if (matter.material_count() > 200) fail(ExitCode::scene, "more than 200 materials in one body");
}

}  // namespace swage

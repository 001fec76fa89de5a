// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: S2.12 and S2.16 for molds. Share weights make any union of cells pass the patch test:
// a cell's connections carry what its volume carries under uniform strain.
#include "mold/mold.h"

#include "base/error.h"
#include "geometry/box_mesh.h"
#include "geometry/mesh_check.h"
#include "matter/material_volumes.h"
#include "mold/caps.h"
#include "mold/filled_gaps.h"
#include "mold/gap_text.h"
#include "mold/insets.h"
#include "mold/moments.h"
#include "mold/prepare.h"
#include "mold/shares.h"
#include "mold/surface.h"
#include "mold/topology.h"

namespace swage {

namespace {

constexpr double kThinnest = 0.02;  // mean thickness, in cells
constexpr double kThin = 0.25;
constexpr double kOffCentre = 1e-3;  // [cells]

// The box, grown to whole cells about its centre (S2.16).
TriMesh block_around(const TriMesh& mesh, double spacing) {
    const Box box = surface_box(mesh);
    const Vec3 half = 0.5 * spacing * cells_over(box, spacing);
    Box block;
    block.grow(box.center() - half);
    block.grow(box.center() + half);
    return box_mesh(block);
}

void fill_cells(const std::vector<CellLayer>& layers, const MoldFrame& frame, Aggregate& matter) {
    std::vector<Vec3i> site;
    std::size_t count = 0;
    for (const CellLayer& layer : layers) count += layer.share.size();
    site.reserve(count);
    matter.cell_fill.reserve(count);
    matter.cell_centroid = SparseArray<Eigen::Vector3f>(count, Eigen::Vector3f::Zero());
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const CellFill& s : layers[k].share) {
            site.emplace_back(s.i, s.j, static_cast<int>(k));
            const Vec3 centroid = s.moment / s.fill;
            matter.cell_centroid.set(matter.cell_fill.size(),
                                     centroid.cwiseMax(-0.5).cwiseMin(0.5).cast<float>());
            matter.cell_fill.push_back(static_cast<float>(s.fill));
        }
    }
    matter.lattice = make_lattice(frame.lattice_origin(), frame.spacing, frame.cell_count, site);
}

void place_particles(Aggregate& matter) {
    std::size_t count = 0;
    for (const ParticleRun& run : matter.lattice.particle_run) count += run.count;
    const Lattice& lattice = matter.lattice;
    matter.particle_reference =
        ReferencePlaces(lattice.origin, Vec3::Constant(lattice.spacing), lattice);
    matter.particle_position = matter.particle_reference.all();
    matter.particle_velocity.resize(count);
    matter.particle_mass.assign(count, 0.0);
}

// Mean of what a cell of a body of several materials holds.
double density_of(const Aggregate& matter, CellId cell) {
    const MixedCell* mixed = matter.mixed_at(cell);
    if (mixed == nullptr) return matter.material_of(cell).density;
    double sum = 0, fill = 0;
    for (int m : {0, 1}) {
        sum += mixed->fill[m] * matter.material_at(mixed->material[m]).density;
        fill += mixed->fill[m];
    }
    return sum / fill;
}

// Each cell shares out its mass and its part of the connections along its edges and faces.
// Mass goes to the corners in equal parts, of which match_moments() leaves each enough that steps
// stay long.
void share_out(const std::vector<CellLayer>& layers, const MoldFrame& frame, Aggregate& matter) {
    const double corner_volume = frame.cell_volume() / 8;
    const double corner_mass = matter.material.density * corner_volume;
    std::array<std::vector<float>, kForwardCount> weight;
    for (std::vector<float>& w : weight) w.assign(matter.particle_count(), 0.0f);
    auto layer = layers.begin();
    std::size_t in_layer = 0;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n, ++in_layer) {
            while (in_layer == layer->share.size()) ++layer, in_layer = 0;
            const double fill = layer->share[in_layer].fill;
            const auto corner = [&](int c) { return run.corner(n, c); };
            const double own = matter.inset.empty()
                                   ? corner_mass * fill
                                   : corner_volume * fill * density_of(matter, run.first + n);
            for (int c = 0; c < 8; ++c) matter.particle_mass[corner(c)] += own;
            for (const auto& [direction, lower] : kCellConnection) {
                const float share = direction < kEdgeCount ? 0.25f : 0.5f;
                weight[direction][corner(lower)] += share * static_cast<float>(fill);
            }
        }
    }
    for (int d = 0; d < kForwardCount; ++d) {
        matter.connection[d].weight = SparseArray<float>(weight[d], 1.0f);
    }
}

double filled_cells(const std::vector<CellLayer>& layers) {
    double sum = 0;
    for (const CellLayer& layer : layers)
        for (const CellFill& s : layer.share) sum += s.fill;
    return sum;
}

// Everything about the result that a user would not expect.
void tell_findings(const TriMesh& mesh, const MoldFrame& frame, double volume,
                   const std::vector<CellLayer>& layers, double lost, double off_centre,
                   const Aggregate& matter, std::vector<std::string>& findings) {
    double surplus = 0, deficit = 0;
    for (const CellLayer& layer : layers) {
        surplus += layer.surplus, deficit += layer.deficit;
    }
    const double cell = frame.cell_volume();
    const double filled = filled_cells(layers) * cell;
    if (surplus * cell > 1e-6 * volume || deficit * cell > 1e-6 * volume) {
        findings.push_back(
            fmt::format("parts of the surface overlap or are inside out: {:.4g} m3 beyond full "
                        "cells and {:.4g} m3 filled negatively are left out, while what overlaps "
                        "within cells that are not full counts twice; the matter has {:.6g} m3, "
                        "the surface encloses {:.6g} m3",
                        surplus * cell, deficit * cell, filled, volume));
    }
    if (lost * cell > 1e-6 * volume) {
        findings.push_back(fmt::format("{} is lost in pieces too small for cells of {}",
                                       volume_text(lost * cell), length_text(frame.spacing)));
    }
    if (off_centre > kOffCentre) {
        findings.push_back(fmt::format(
            "the centre of mass lies {} from where the mesh has it: nearly all the mass lies on "
            "the outside of cells of {}; a smaller spacing avoids this",
            about(off_centre * frame.spacing, 2), length_text(frame.spacing)));
    }
    const double thickness = 2 * volume / surface_area(mesh);
    if (thickness < kThin * frame.spacing) {
        findings.push_back(
            fmt::format("the mesh is about {} thick, thinner than its cells of {}; sheets that "
                        "share a cell merge (spacing = \"{}\" keeps them apart)",
                        about(thickness, 3), length_text(frame.spacing), at_most(0.5 * thickness)));
    }
    // Separate bodies and handles tell of parts that melted together for want of room.
    const int bodies = count_bodies(mesh);
    const int pieces = find_pieces(matter).count;
    const std::optional<int> wanted = euler_inside(mesh);
    if (pieces < bodies) {
        findings.push_back(fmt::format(
            "{} separate bodies became {}: they share the corners of cells of {}, as "
            "those less than two cells ({}) apart may, or are too small for these; a "
            "smaller spacing keeps them apart",
            bodies, pieces, length_text(frame.spacing), length_text(2 * frame.spacing)));
    } else if (const std::vector<FilledGap> gaps = filled_gaps(mesh, layers, frame);
               !gaps.empty()) {
        findings.push_back(gap_text(gaps, frame.spacing));
    } else if (wanted && surplus * cell <= 1e-6 * volume && euler_of(matter) != *wanted) {
        findings.push_back(fmt::format(
            "with cells of {} the matter has other holes or handles than the mesh: parts "
            "closer than a cell merge, or thin ones separate; a smaller spacing avoids this",
            length_text(frame.spacing)));
    }
}

[[noreturn]] void refuse_thin(double thickness, double spacing) {
    throw FinenessError(
        ExitCode::mesh,
        fmt::format("cannot mold: the mesh is about {} thick and nearly vanishes in cells of {}; "
                    "use spacing = \"{}\" or less",
                    about(thickness, 3), length_text(spacing), at_most(thickness)));
}

// Of an inset that others have taken all of, nothing is left to be weighed.
void weigh_materials(const std::vector<double>& mass, Aggregate& matter) {
    const std::vector<double> volume = material_volumes(matter);
    for (std::size_t m = 0; m < volume.size(); ++m) {
        if (!(volume[m] > 0) || !(mass[m] > 0)) continue;
        (m == 0 ? matter.material : matter.inset[m - 1]).density = mass[m] / volume[m];
    }
}

Aggregate mold_surface(const TriMesh& mesh, const Material& material, double spacing,
                       const std::vector<Inset>& insets, std::vector<std::string>& findings,
                       const std::vector<double>* masses) {
    const double volume = signed_volume(mesh);
    const double area = surface_area(mesh);
    if (!(std::abs(volume) > 1e-9 * area * std::sqrt(area))) {
        fail(ExitCode::mesh,
             "cannot mold: the surface of {:.4g} m2 encloses no volume; give it thickness first",
             area);
    }
    if (volume < 0) {
        fail(ExitCode::mesh,
             "cannot mold: the surface is inside out (it encloses {:.4g} m3); its triangles must "
             "be counter-clockwise as seen from outside",
             volume);
    }
    if (2 * volume / area < kThinnest * spacing) refuse_thin(2 * volume / area, spacing);
    const MoldFrame frame = frame_over(surface_box(mesh), spacing);
    std::vector<CellLayer> layers = share_cells(mesh, frame);
    std::vector<SliverMove> moves;
    const double lost = drop_slivers(layers, &moves);
    Aggregate matter;
    matter.material = material;
    fill_cells(layers, frame, matter);
    if (matter.cell_fill.empty()) refuse_thin(2 * volume / area, spacing);
    place_particles(matter);
    place_insets(insets, {mesh, layers, moves}, frame, matter, findings, masses != nullptr);
    if (masses != nullptr) weigh_materials(*masses, matter);
    share_out(layers, frame, matter);
    const double off_centre = match_moments(matter);
    matter.surface = carry_patches(layers, matter.lattice, matter.cell_fill);
    tell_findings(mesh, frame, volume, layers, lost, off_centre, matter, findings);
    return matter;
}

}  // namespace

Aggregate mold(const TriMesh& mesh, const Material& material, const MoldSettings& settings,
               const std::vector<Inset>& insets, std::vector<std::string>* told,
               const std::vector<double>* masses) {
    std::vector<std::string> unread;
    std::vector<std::string>& findings = told != nullptr ? *told : unread;
    const double spacing = spacing_for(mesh, settings);
    refuse_too_many_cells(mesh, settings);
    if (settings.kind == MoldKind::block) {
        return mold_surface(block_around(mesh, spacing), material, spacing, insets, findings,
                            masses);
    }
    const HoleCaps caps = caps_over_holes(mesh);
    if (caps.apex.empty()) {
        return mold_surface(mesh, material, spacing, insets, findings, masses);
    }
    const TriMesh closed = with_caps(mesh, caps);
    findings.push_back(fmt::format(
        "the surface is open: {} closed by flat cones of {:.3g} % of its area",
        caps.apex.size() == 1 ? "one hole was" : fmt::format("{} holes were", caps.apex.size()),
        100 * (surface_area(closed) / surface_area(mesh) - 1)));
    return mold_surface(closed, material, spacing, insets, findings, masses);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "geometry/mesh_check.h"
#include "mold/prepare.h"

namespace swage {

Box surface_box(const TriMesh& mesh) {
    Box box;
    for (const Corners& t : mesh.triangle)
        for (int p : t) box.grow(mesh.position[p]);
    if (box.empty() || !box.low.allFinite() || !box.high.allFinite()) {
        fail(ExitCode::mesh, "cannot mold: the mesh has no surface");
    }
    return box;
}

double spacing_for(const TriMesh& mesh, const MoldSettings& settings) {
    const Vec3 size = surface_box(mesh).size();
    const double thinnest = size.minCoeff();
    if (settings.across.has_value() == settings.spacing.has_value()) {
        fail(ExitCode::scene, "[mold] needs either `across` or `spacing`, for example across = 6");
    }
    if (settings.spacing) {
        const double spacing = *settings.spacing;
        if (!(spacing > 0) || !std::isfinite(spacing)) {
            fail(ExitCode::scene, "[mold] spacing is {:g} m; it must be more than 0", spacing);
        }
        if (settings.kind == MoldKind::shape && spacing > thinnest * (1 + 1e-6)) {
            throw FinenessError(
                ExitCode::mesh,
                fmt::format("cannot mold: the mesh is {:.4g} m across at its thinnest side, less "
                            "than the spacing of {:.4g} m; use spacing = \"{:.4g} m\" or less, or "
                            "across = 1 or more",
                            thinnest, spacing, thinnest));
        }
        return spacing;
    }
    if (*settings.across < 1) {
        fail(ExitCode::scene, "[mold] across is {}; it must be at least 1", *settings.across);
    }
    if (!(thinnest > 1e-9 * size.maxCoeff())) {
        fail(ExitCode::mesh,
             "cannot mold: the mesh is flat ({:.4g} x {:.4g} x {:.4g} m), so it encloses nothing",
             size.x(), size.y(), size.z());
    }
    return thinnest / *settings.across;
}

namespace {

// Position, velocity and mass; of what is stored where it differs (base/sparse_array.h), where.
constexpr double kBytesParticle = 7 * 8 + kForwardCount * 4 / 8.0;
constexpr double kBytesCell = sizeof(float) + 4 / 8.0;
// Of a cell's face at the surface: its points, and the weights and centroids that differ there
// (235 to 320 of bars, balls and rings of 8 and 40 cells across).
constexpr double kBytesFace = 330;
// Of a particle, while it is made: cells with their moments, sites, weights of all directions.
constexpr double kBytesMaking = 150;
constexpr double kMostCells = 1e9;  // ids have 31 bits
constexpr double kTold = 1e15;      // counts beyond it

MoldEstimate block_estimate(double spacing, const Vec3& count) {
    MoldEstimate e{};
    e.spacing = spacing;
    const double x = count.x(), y = count.y(), z = count.z();
    e.active_cells = x * y * z;
    e.particles = (x + 1) * (y + 1) * (z + 1);
    const double edges = x * (y + 1) * (z + 1) + y * (x + 1) * (z + 1) + z * (x + 1) * (y + 1);
    const double faces = x * y * (z + 1) + y * z * (x + 1) + z * x * (y + 1);
    e.connections = edges + 2 * faces;
    e.bytes = kBytesParticle * e.particles + kBytesCell * e.active_cells +
              kBytesFace * 2 * (x * y + y * z + z * x);
    return e;
}

// Steiner's formula for cubes, exact on average for convex shapes at a random place: a surface
// counts with |n_x| + |n_y| + |n_z| cell faces per area of one.
MoldEstimate shape_estimate(const TriMesh& mesh, const MoldFrame& frame) {
    double crossed = 0, flush = 0;  // [cell faces]
    for (const Corners& t : mesh.triangle) {
        const Vec3 a = frame.bins(mesh.position[t[0]]), b = frame.bins(mesh.position[t[1]]),
                   c = frame.bins(mesh.position[t[2]]);
        const double area = (b - a).cross(c - a).lpNorm<1>() / 8;
        bool in_plane = false;
        for (int d = 0; d < 3; ++d) {
            in_plane |= a[d] == b[d] && b[d] == c[d] && std::fmod(a[d], 2.0) == 0;
        }
        (in_plane ? flush : crossed) += area;
    }
    const Vec3 count = frame.cell_count.cast<double>();
    const double faces = crossed + flush;
    const double full = std::abs(signed_volume(mesh)) / frame.cell_volume();
    const double wide = surface_box(mesh).size().cwiseQuotient(frame.step).sum();
    // Cells touched are the volume of the mesh dilated by a cube of half a cell; particles touched,
    // of a whole one. What is flush with cell faces is spared half a cell of that.
    const auto dilated = [&](double half_width) {
        const double w = 2 * half_width;
        return full + half_width * faces + w * w * wide + w * w * w;
    };
    const double off_plane = faces > 0 ? crossed / faces : 0;
    MoldEstimate e{};
    e.spacing = frame.spacing;
    e.active_cells = std::min(dilated(0.5 * off_plane), count.prod());
    e.particles = std::min(dilated(0.5 + 0.5 * off_plane), (count.array() + 1).prod());
    e.connections = 9 * e.active_cells + 4 * (e.particles - e.active_cells);
    e.bytes = kBytesParticle * e.particles + kBytesCell * e.active_cells + kBytesFace * faces;
    return e;
}

}  // namespace

MoldEstimate estimate_mold(const TriMesh& mesh, const MoldSettings& settings) {
    const Box box = surface_box(mesh);
    const double spacing = spacing_for(mesh, settings);
    const Vec3 count = cells_over(box, spacing);
    const bool countable = count.maxCoeff() < 1e9;
    MoldEstimate e = settings.kind == MoldKind::block || !countable
                         ? block_estimate(spacing, count)
                         : shape_estimate(mesh, frame_over(box, spacing));
    e.cell_count = count.cwiseMin(static_cast<double>(std::numeric_limits<int>::max())).cast<int>();
    return e;
}

void refuse_too_many_cells(const TriMesh& mesh, const MoldSettings& settings) {
    const MoldEstimate e = estimate_mold(mesh, settings);
    const Vec3 count = cells_over(surface_box(mesh), spacing_for(mesh, settings));
    const double cells = count.prod(), making = e.bytes + kBytesMaking * e.particles;
    const auto text = [](double n) {
        return n > kTold ? "over " + count_text(kTold) : count_text(n);
    };
    const auto refuse = [&](const std::string& sentence, bool is_limit = false) {
        throw FinenessError(ExitCode::resources,
                            fmt::format("refused to mold: {} x {} x {} = {} cells of {}{}",
                                        text(count.x()), text(count.y()), text(count.z()),
                                        text(cells), length_text(e.spacing), sentence),
                            is_limit);
    };
    if (cells > kMostCells) {
        refuse(fmt::format(" are more than the {} that a mold can have: use a larger spacing",
                           count_text(kMostCells)));
    }
    const double limit = static_cast<double>(settings.cell_limit);
    if (cells > limit) {
        refuse(fmt::format(", of which about {} hold matter and take {}, are more than [mold] "
                           "cell_limit = {}: use a larger spacing, or set cell_limit higher",
                           count_text(e.active_cells), bytes_text(making), count_text(limit)),
               true);
    }
    const double memory = whole_memory();
    if (making > memory) {
        refuse(
            fmt::format(" need about {}, more than the {} of memory that there is: use a larger "
                        "spacing",
                        bytes_text(making), bytes_text(memory)));
    }
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/carrier.h"

#include <algorithm>
#include <cstring>

#include "base/vector_targets.h"

namespace swage {

namespace {

// Places this far beyond a cell, in cells, still count as inside: the lattice's steps may differ
// from its spacing by the noise of single precision.
constexpr double kSlack = 1e-3;

// Squared distance from a place (in cells from the origin) to a run of cells.
double distance2(const CellRun& run, int first, int count, const Vec3& at) {
    const Vec3 low(run.i + first, run.j, run.k);
    const Vec3 high(run.i + first + count, run.j + 1, run.k + 1);
    return (at - at.cwiseMax(low).cwiseMin(high)).squaredNorm();
}

}  // namespace

CellBox cell_box(const Aggregate& matter, CellId cell) {
    const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
    const Vec3 low = matter.particle_reference.at(corner[0]);
    return {low, matter.particle_reference.at(corner[7]) - low};
}

CellId carrying_cell(const Aggregate& matter, const Vec3& place) {
    const Lattice& lattice = matter.lattice;
    const Vec3 at = (place - lattice.origin) / lattice.spacing;
    const Vec3 floor = at.array().floor().max(-1e9).min(1e9);
    const Vec3i site = floor.cast<int>();
    const CellId home = lattice.cell_at(site);
    if (home >= 0) return home;

    CellId nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    // On a tie the lowest cell, so that the choice does not hang on the order of the search.
    const auto offer = [&](CellId cell, double d) {
        if (d < least || (d == least && cell < nearest)) least = d, nearest = cell;
    };
    lattice.for_each_cell_around(site, [&](CellId cell, const Vec3i& next) {
        const Vec3 low = next.cast<double>(), high = low + Vec3::Ones();
        offer(cell, (at - at.cwiseMax(low).cwiseMin(high)).squaredNorm());
    });
    if (nearest >= 0 && least <= 1) return nearest;
    for (const CellRun& run : lattice.cell_run) {
        if (distance2(run, 0, run.count, at) > least) continue;
        const int n = std::clamp(site.x() - run.i, 0, run.count - 1);
        offer(run.first + n, distance2(run, n, 1, at));
    }
    return nearest;
}

Carrier carrier_in(const CellBox& box, const Vec3& place) {
    Carrier carrier;
    const Vec3 way = place - box.low;
    carrier.local = way.cwiseQuotient(box.size).cwiseMax(-kSlack).cwiseMin(1 + kSlack);
    carrier.arm = way - 0.5 * carrier.local.cwiseProduct(box.size);
    return carrier;
}

CornerMask followed_corners(const CornerGroups& groups, CornerMask side, const Vec3& local) {
    if (groups[0] == kAllCorners) return kAllCorners;
    const int heaviest = heaviest_corner(trilinear_weights(local), side);
    return heaviest < 0 ? kAllCorners : groups[heaviest] & side;
}

Carriage carriage_of(const Aggregate& matter, const BodyPlace& place) {
    const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(place.cell);
    const Carrier at = carrier_in(cell_box(matter, place.cell), place.reference);
    return {corner, at, followed_corners(corner_groups(matter, corner), place.side, at.local)};
}

CellFrames half_frames(const CellFrames& cell) {
    CellFrames half = cell;
    for (int c = 0; c < 8; ++c) {
        for (int axis = 0; axis < 3; ++axis) {
            if (c >> axis & 1) {
                half.corner.col(c).tail<3>() -=
                    0.5 * cell.size[axis] * cell.corner.col(c).segment<3>(3 * axis);
            }
        }
    }
    return half;
}

SWAGE_VECTOR_CLONES
void whole_displacements(const CellFrames& half, const Carrier* carrier, int count, Vec3* moved) {
    typedef double Four __attribute__((vector_size(32)));
    constexpr int kParts = 3;  // of a frame's twelve numbers
    for (int n = 0; n < count; ++n) {
        const Carrier& at = carrier[n];
        const double x1 = at.local[0], y1 = at.local[1], z1 = at.local[2];
        const double x0 = 1 - x1, y0 = 1 - y1, z0 = 1 - z1;
        const double a = y0 * z0, b = y1 * z0, c = y0 * z1, d = y1 * z1;
        const double weight[8] = {x0 * a, x1 * a, x0 * b, x1 * b, x0 * c, x1 * c, x0 * d, x1 * d};
        Four sum[kParts];
        for (int corner = 0; corner < 8; ++corner) {
            const double* const frame = half.corner.data() + 4 * kParts * corner;
            for (int part = 0; part < kParts; ++part) {
                Four numbers;
                std::memcpy(&numbers, frame + 4 * part, sizeof numbers);
                const Four share = weight[corner] * numbers;
                sum[part] = corner == 0 ? share : sum[part] + share;
            }
        }
        double s[4 * kParts];
        std::memcpy(s, sum, sizeof s);
        for (int i = 0; i < 3; ++i) {
            moved[n][i] = s[i] * at.arm[0] + s[3 + i] * at.arm[1] + s[6 + i] * at.arm[2] + s[9 + i];
        }
    }
}

Vec3 part_displacement(const CellFrames& cell, const Carrier& carrier, CornerMask followed) {
    const std::array<double, 8> weight = trilinear_weights(carrier.local);
    const Vec3 way = carrier.arm + 0.5 * carrier.local.cwiseProduct(cell.size);
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (int c = 0; c < 8; ++c) {
        if (!(followed >> c & 1)) continue;
        // Not zero anywhere: a place on the far face of the cell still has someone to follow.
        const double share = std::max(weight[c], 0.0) + 1e-3;
        const auto frame = cell.corner.col(c);
        Vec3 moved = frame.tail<3>();
        for (int axis = 0; axis < 3; ++axis) {
            const double from = c >> axis & 1 ? cell.size[axis] : 0;
            moved += frame.segment<3>(3 * axis) * (way[axis] - from);
        }
        sum += share * moved;
        total += share;
    }
    return sum / total;
}

Mat3 mean_slope(const CellFrames& cell, CornerMask corners) {
    Mat3 sum = Mat3::Zero();
    int used = 0;
    for (int c = 0; c < 8; ++c) {
        if (!(corners >> c & 1)) continue;
        sum += cell.corner.col(c).head<9>().reshaped(3, 3);
        ++used;
    }
    return Mat3::Identity() + sum / used;
}

}  // namespace swage

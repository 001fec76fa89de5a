// SPDX-License-Identifier: GPL-3.0-or-later
// A place goes where it is nearest to the tangent planes of the samples around it, in the
// least-squares sense: onto a smooth surface, and into the edge where two sides meet.
// Sources: the quadric of planes, T. Ju, F. Losasso, S. Schaefer and J. Warren, "Dual contouring of
// Hermite data", 2002.
#include "skin/surface_samples.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

#include "skin/carrier.h"

namespace swage {

SurfaceSamples::SurfaceSamples(const Aggregate& matter) : matter_(matter) {
    const std::size_t count = matter.surface.size();
    std::vector<CellId> cell(count);
    first_.assign(matter.cell_fill.size() + 1, 0);
    for (std::size_t s = 0; s < count; ++s) {
        cell[s] = carrying_cell(matter, matter.surface.reference_position[s]);
        ++first_[cell[s] + 1];
    }
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    sample_.resize(count);
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (std::size_t s = 0; s < count; ++s) sample_[next[cell[s]]++] = static_cast<int>(s);
}

bool SurfaceSamples::project(const Vec3& facing, Vec3& place, Vec3& normal) const {
    const Lattice& lattice = matter_.lattice;
    const double a = lattice.spacing;
    const Vec3 at = (place - lattice.origin) / a;
    const Vec3i site = Vec3(at.array().floor()).cast<int>();
    constexpr double kWidth = 0.45;  // of the kernel, in spacings
    double total = 0, nearest = 1.5 * 1.5;
    Mat3 quadric = Mat3::Zero();
    Vec3 pull = Vec3::Zero(), mean = Vec3::Zero(), nearest_normal = Vec3::Zero(),
         nearest_place = Vec3::Zero();
    for (int n = 0; n < 27; ++n) {
        const CellId cell =
            lattice.cell_at(site.x() + n % 3 - 1, site.y() + n / 3 % 3 - 1, site.z() + n / 9 - 1);
        if (cell < 0) continue;
        for (int k = first_[cell]; k < first_[cell + 1]; ++k) {
            const int s = sample_[k];
            const Vec3& out = matter_.surface.reference_normal[s];
            const double agreement = out.dot(facing);
            if (agreement <= 0.1) continue;
            const Vec3 way = (place - matter_.surface.reference_position[s]) / a;
            const double d2 = way.squaredNorm();
            if (d2 < nearest) {
                nearest = d2;
                nearest_normal = out;
                nearest_place = matter_.surface.reference_position[s];
            }
            const double weight = agreement * agreement * std::exp(-d2 / (kWidth * kWidth));
            total += weight;
            quadric += weight * out * out.transpose();
            pull -= weight * out.dot(way) * out;
            mean += weight * out;
        }
    }
    if (nearest >= 1.5 * 1.5) return false;
    if (total > 1e-3 && mean.norm() > 0.3 * total) {
        normal = mean.normalized();
        constexpr double kStay = 0.1;  // holds the place where no plane says anything
        quadric += kStay * total * Mat3::Identity();
        const Vec3 step = quadric.ldlt().solve(pull);
        place += a * step / std::max(1.0, step.norm());
    } else {  // too far away for the mean: first to the plane of the nearest
        normal = nearest_normal;
        place -= normal.dot(place - nearest_place) * normal;
    }
    return true;
}

}  // namespace swage

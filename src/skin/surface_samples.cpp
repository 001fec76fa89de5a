// SPDX-License-Identifier: GPL-3.0-or-later
// A place goes where it is nearest to the tangent planes of the samples around it, in the
// least-squares sense: onto a smooth surface, and into the edge where two sides meet.
// Sources: the quadric of planes, T. Ju, F. Losasso, S. Schaefer and J. Warren, "Dual contouring of
// Hermite data", 2002.
#include "skin/surface_samples.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "skin/carrier.h"

namespace swage {

SurfaceSamples::SurfaceSamples(const Aggregate& matter) : lattice_(matter.lattice) {
    const std::size_t count = matter.surface.size();
    std::vector<CellId> cell(count);
    first_.assign(matter.cell_fill.size() + 1, 0);
    for (std::size_t s = 0; s < count; ++s) {
        cell[s] = carrying_cell(matter, matter.surface_reference(s));
        ++first_[cell[s] + 1];
    }
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    sample_.resize(count);
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (std::size_t s = 0; s < count; ++s) {
        sample_[next[cell[s]]++] = {
            (matter.surface_reference(s) - lattice_.origin) / lattice_.spacing,
            matter.surface.normal(s)};
    }
}

template <typename F>
void SurfaceSamples::for_each_near(const Vec3& at, double reach, const F& f) const {
    const Vec3i site = Vec3(at.array().floor()).cast<int>();
    const Vec3 within = at - site.cast<double>();
    double gap2[3][3];  // to the cells below, here and above, along each axis
    for (int d = 0; d < 3; ++d) {
        gap2[d][0] = within[d] * within[d];
        gap2[d][1] = 0;
        gap2[d][2] = (1 - within[d]) * (1 - within[d]);
    }
    for (int n = 0; n < 27; ++n) {
        const int i = n % 3, j = n / 3 % 3, k = n / 9;
        if (gap2[0][i] + gap2[1][j] + gap2[2][k] > reach * reach) continue;
        const CellId cell = lattice_.cell_at(site + neighbor_step(n));
        if (cell < 0) continue;
        for (int s = first_[cell]; s < first_[cell + 1]; ++s) {
            const Vec3 way = at - sample_[s].place;
            const double d2 = way.squaredNorm();
            if (d2 < reach * reach) f(sample_[s], way, d2);
        }
    }
}

// What two planes with a convex edge hold is inside both; else inside one of them.
double SurfaceSamples::height(const Vec3& place, Vec3& normal) const {
    constexpr double kReach = -kNone, kBeside = 0.5;  // spacings
    const Vec3 at = (place - lattice_.origin) / lattice_.spacing;
    const Sample* nearest = nullptr;
    double least = kReach * kReach;
    for_each_near(at, kReach, [&](const Sample& sample, const Vec3&, double d2) {
        if (d2 < least) least = d2, nearest = &sample;
    });
    if (nearest == nullptr) return kNone;
    double height = nearest->normal.dot(at - nearest->place);
    normal = nearest->normal;
    const auto consider = [&](const Sample& sample, const Vec3& way, double) {
        const double own = sample.normal.dot(way);
        const double convex = (sample.normal - nearest->normal).dot(sample.place - nearest->place);
        if (!(convex > 0 ? own > height : convex < 0 && own < height)) return;
        height = own;
        normal = sample.normal;
    };
    for_each_near(at, std::sqrt(least) + kBeside, consider);
    return height;
}

double SurfaceSamples::height(const Vec3& place) const {
    Vec3 unused;
    return height(place, unused);
}

// NOTE: outside of an edge or a corner each of its planes has to be met.
void SurfaceSamples::lower(double most, Vec3& place) const {
    constexpr int kRounds = 6;
    constexpr double kClose = 1e-6;  // spacings
    Vec3 normal;
    for (int round = 0; round < kRounds; ++round) {
        const double over = height(place, normal) - most;
        if (over < kClose) return;
        place -= over * lattice_.spacing * normal;
    }
}

bool SurfaceSamples::project(const Vec3& facing, Vec3& place, Vec3& normal) const {
    constexpr double kWidth = 1.1;      // of the kernel, in spacings
    constexpr double kReach = 1.5;      // of the search when that finds too little
    constexpr double kAgreement = 0.1;  // least cosine with `facing`
    constexpr double kStay = 0.1;       // holds the place where no plane says anything
    const double a = lattice_.spacing;
    const Vec3 at = (place - lattice_.origin) / a;
    double total = 0;
    Mat3 quadric = Mat3::Zero();
    Vec3 pull = Vec3::Zero(), mean = Vec3::Zero();
    for_each_near(at, kWidth, [&](const Sample& sample, const Vec3& way, double d2) {
        const double agreement = sample.normal.dot(facing);
        if (agreement <= kAgreement) return;
        const double bell = 1 - d2 / (kWidth * kWidth), bell2 = bell * bell;
        const double weight = agreement * agreement * bell2 * bell2 * bell2;
        const Vec3 share = weight * sample.normal;
        quadric += share * sample.normal.transpose();
        pull -= sample.normal.dot(way) * share;
        mean += share;
        total += weight;
    });
    if (total > 1e-3 && mean.norm() > 0.3 * total) {
        normal = mean.normalized();
        quadric += kStay * total * Mat3::Identity();
        const Vec3 step = quadric.inverse() * pull;
        place += a * step / std::max(1.0, step.norm());
        return true;
    }
    const Sample* nearest = nullptr;
    double least = 1e300;
    for_each_near(at, kReach, [&](const Sample& sample, const Vec3&, double d2) {
        if (d2 >= least || sample.normal.dot(facing) <= kAgreement) return;
        least = d2;
        nearest = &sample;
    });
    if (!nearest) return false;
    normal = nearest->normal;
    place -= a * normal.dot(at - nearest->place) * normal;
    return true;
}

}  // namespace swage

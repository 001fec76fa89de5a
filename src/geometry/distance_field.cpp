// SPDX-License-Identifier: GPL-3.0-or-later
// Interpolation by cubic convolution: Keys, Cubic Convolution Interpolation for Digital Image
// Processing, 1981 (a = -1/2, third order, continuous first derivative).
#include "geometry/distance_field.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/mesh_check.h"
#include "geometry/triangle_tree.h"

namespace swage {

namespace {

constexpr int kDefaultDivisions = 80;
constexpr int kAcross = 3;   // spacings of what is thin
constexpr int kPadding = 4;  // samples beyond the mesh's box; the outermost only serve as stencil
constexpr int kRoundsOutside = 3;  // towards the nearest point; one alone errs by 5 %
constexpr double kMaxSamples = 1 << 27;
constexpr double kMostForThin = 1 << 22;  // 16 MiB, and seconds to compute
constexpr double kCoarser = 1.05;

struct Weights {
    std::array<double, 4> value, slope;
};
Weights cubic_weights(double t) {
    const double t2 = t * t, t3 = t2 * t;
    return {{0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
             0.5 * (t3 - t2)},
            {0.5 * (-3 * t2 + 4 * t - 1), 0.5 * (9 * t2 - 10 * t), 0.5 * (-9 * t2 + 8 * t + 1),
             0.5 * (3 * t2 - 2 * t)}};
}

Vec3 samples_along(const Box& box, double spacing) {
    return (box.size() / spacing).array().ceil() + 2 * kPadding + 1;
}

double usual_spacing(const TriMesh& mesh, const Box& box) {
    const double usual = box.size().maxCoeff() / kDefaultDivisions;
    if (!check_mesh(mesh).watertight) return usual;
    const double thickness = 2 * std::abs(signed_volume(mesh)) / surface_area(mesh);
    double fine = std::min(usual, thickness / kAcross);
    if (!(fine > 0)) return usual;
    while (fine < usual && samples_along(box, fine).prod() > kMostForThin) fine *= kCoarser;
    return std::min(fine, usual);
}

}  // namespace

DistanceField::DistanceField(const TriMesh& mesh, double spacing) : spacing_(spacing) {
    const TriangleTree tree(mesh);
    Box box;
    for (const Corners& corners : mesh.triangle) {
        for (int corner : corners) box.grow(mesh.position[corner]);
    }
    if (spacing_ == 0) spacing_ = usual_spacing(mesh, box);
    if (!(spacing_ > 0)) fail(ExitCode::mesh, "a surface without extent has no distance");
    const Vec3 sides = samples_along(box, spacing_);
    if (sides.prod() > kMaxSamples) {
        fail(ExitCode::resources, "a distance field of {:.0f} x {:.0f} x {:.0f} samples is too big",
             sides.x(), sides.y(), sides.z());
    }
    count_ = sides.cast<int>();
    origin_ = box.center() - 0.5 * spacing_ * (count_ - Vec3i::Ones()).cast<double>();
    sampled_.low = origin_ + Vec3::Constant(spacing_);
    sampled_.high = origin_ + spacing_ * (count_ - Vec3i::Constant(2)).cast<double>();

    sample_.resize(static_cast<std::size_t>(count_.x()) * count_.y() * count_.z());
    parallel_for(static_cast<std::size_t>(count_.y()) * count_.z(), [&](std::size_t row) {
        const double j = static_cast<double>(row % count_.y());
        const double k = static_cast<double>(row / count_.y());
        double known = 0;  // the sign is the same wherever this many spacings were to the surface
        bool inside = false;
        for (int i = 0; i < count_.x(); ++i) {
            const Vec3 point = origin_ + spacing_ * Vec3(i, j, k);
            const double distance = tree.distance(point);
            if (i == 0 || known <= spacing_) {
                inside = std::abs(tree.winding_number(point)) > 0.5;
            }
            known = distance;
            sample_[row * count_.x() + i] = static_cast<float>(inside ? -distance : distance);
        }
    });
    // Of a sheet that encloses nothing some samples may lie inside by rounding.
    const auto least = *std::min_element(sample_.begin(), sample_.end());
    has_inside_ = least < -1e-6 * spacing_;
}

Distance DistanceField::at(const Vec3& point) const {
    Vec3 seen_from = point.cwiseMax(sampled_.low).cwiseMin(sampled_.high);
    Distance there = interpolate(seen_from);
    if (seen_from == point) return there;
    // The border's own nearest point of the surface, then that of where the way to it enters.
    Vec3 foot = seen_from - there.value * there.normal;
    for (int round = 0; round < kRoundsOutside; ++round) {
        const Vec3 way = point - foot;
        double share = 1;  // of the way, from the foot, that lies within the samples
        for (int axis = 0; axis < 3; ++axis) {
            const double limit = (way[axis] > 0 ? sampled_.high : sampled_.low)[axis];
            if (way[axis] != 0) share = std::min(share, (limit - foot[axis]) / way[axis]);
        }
        seen_from = foot + std::max(share, 0.0) * way;
        there = interpolate(seen_from);
        foot = seen_from - there.value * there.normal;
    }
    const Vec3 away = point - foot;
    const double length = away.norm();
    return {length, away / length};
}

Distance DistanceField::interpolate(const Vec3& point) const {
    const Vec3 place = (point - origin_) / spacing_;
    std::array<int, 3> first;
    std::array<Weights, 3> weights;
    for (int axis = 0; axis < 3; ++axis) {
        const int cell = std::clamp(static_cast<int>(place[axis]), 1, count_[axis] - 3);
        first[axis] = cell - 1;
        weights[axis] = cubic_weights(place[axis] - cell);
    }
    double value = 0;
    Vec3 slope = Vec3::Zero();
    for (int k = 0; k < 4; ++k) {
        double plane = 0, plane_x = 0, plane_y = 0;
        for (int j = 0; j < 4; ++j) {
            const float* row =
                &sample_[(static_cast<std::size_t>(first[2] + k) * count_.y() + first[1] + j) *
                             count_.x() +
                         first[0]];
            double line = 0, line_x = 0;
            for (int i = 0; i < 4; ++i) {
                line += weights[0].value[i] * row[i];
                line_x += weights[0].slope[i] * row[i];
            }
            plane += weights[1].value[j] * line;
            plane_x += weights[1].value[j] * line_x;
            plane_y += weights[1].slope[j] * line;
        }
        value += weights[2].value[k] * plane;
        slope.x() += weights[2].value[k] * plane_x;
        slope.y() += weights[2].value[k] * plane_y;
        slope.z() += weights[2].slope[k] * plane;
    }
    const double length = slope.norm();
    return {value, length > 0 ? Vec3(slope / length) : Vec3::UnitX()};
}

}  // namespace swage

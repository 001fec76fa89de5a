// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/surface_drag.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;
constexpr double kMostShare = 0.25;  // of a carrier's speed that a step may take

}  // namespace

SurfaceDrag::SurfaceDrag(const Aggregate& matter, const SimSettings& settings, double step)
    : ambient_{settings.medium_density, settings.drag_coefficient},
      facing_{settings.directional_drag, settings.directional_drag_along} {
    if (!acts()) return;
    const std::size_t points = matter.surface.size();
    push_.resize(points);
    power_.resize(points);
    for (std::size_t p = 0; p < points; ++p) {
        most_.push_back(kMostShare * lightest_carrier(matter, p) / step);
    }
}

double SurfaceDrag::add_forces(const Aggregate& matter, Vec3Array& force) {
    const std::size_t points = push_.size(), chunks = (points + kChunk - 1) / kChunk;
    std::vector<char> held(chunks, 0);
    parallel_for(chunks, [&](std::size_t chunk) {
        const std::size_t end = std::min(points, (chunk + 1) * kChunk);
        for (std::size_t p = chunk * kChunk; p < end; ++p) {
            const Vec3 v = matter.surface_velocity(p);
            const Vec3 area_vector = surface_area_vector(matter, static_cast<int>(p));
            const double area = area_vector.norm(), speed = v.norm();
            Vec3 f = Vec3::Zero();
            if (area > 0 && speed > 0) {
                f = ambient_drag_force(ambient_, area, v) +
                    directional_drag_force<double>(facing_, area, v, area_vector / area);
                const double size = f.norm(), most = most_[p] * speed;
                if (size > most) {
                    f *= most / size;
                    held[chunk] = 1;
                }
            }
            push_[p] = f;
            power_[p] = -f.dot(v);
        }
    });
    for (char one : held) held_ = held_ || one;
    double power = 0;
    for (std::size_t p = 0; p < points; ++p) {
        spread(matter.surface, static_cast<int>(p), push_[p], force);
        power += power_[p];
    }
    return power;
}

}  // namespace swage

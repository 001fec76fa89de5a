// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/surface_drag.h"

#include <algorithm>

#include "base/parallel.h"
#include "matter/parted.h"
#include "sim/surface_forces.h"
#include "sim/vector_clones.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 256;  // cells
constexpr double kMostShare = 0.25;  // of a carrier's speed that a step may take

}  // namespace

SurfaceDrag::SurfaceDrag(const Aggregate& matter, const SimSettings& settings, double step)
    : ambient_{settings.medium_density, settings.drag_coefficient},
      facing_{settings.directional_drag, settings.directional_drag_along},
      step_(step) {
    if (!acts()) return;
    const SurfacePoints& surface = matter.surface;
    const double a = matter.lattice.spacing;
    for (std::size_t p = 0; p < surface.size(); ++p) {
        const SurfacePoints::Carriers by = surface.carriers(p);
        if (cell_.empty() || cell_.back().corner != by.corner) cell_.push_back({by.corner, p, p});
        ++cell_.back().end;
        Patch& patch = patch_.emplace_back();
        patch.place = vec4(surface.place(p), 0);  // find_limits()
        patch.area = vec4(surface.area(p) / (a * a) * surface.normal(p));
        patch.weight = by.weight;
    }
    find_limits(matter, step);
    push_.resize(cell_.size());
    chunk_.resize(chunks_of(cell_.size(), kChunk));
}

void SurfaceDrag::find_limits(const Aggregate& matter, double step) {
    if (!acts()) return;
    step_ = step;
    for (std::size_t p = 0; p < patch_.size(); ++p) {
        patch_[p].place[3] = kMostShare * lightest_carrier(matter, p) / step;
    }
    connections_changed(matter);
}

void SurfaceDrag::connections_changed(const Aggregate& matter) {
    if (!acts()) return;
    for (Cell& cell : cell_) cell.parted = is_parted(matter, cell.first);
    face_.clear();
    for (const OpenFace& open : laid_open(matter)) {
        double lightest = std::numeric_limits<double>::infinity();
        for (ParticleId p : open.corner) lightest = std::min(lightest, matter.particle_mass[p]);
        face_.push_back({open, kMostShare * lightest / step_});
    }
}

SWAGE_INLINE Vec3 SurfaceDrag::force_on(const Vec3& outward, const Vec3& velocity, double most,
                                        bool& bounded) const {
    const double area = outward.norm(), fast = velocity.norm();
    if (!(area > 0 && fast > 0)) return Vec3::Zero();
    Vec3 f = ambient_drag_force(ambient_, area, velocity);
    if (facing_.drag > 0) {
        f += directional_drag_force<double>(facing_, area, velocity, outward / area);
    }
    const double size = f.norm();
    if (size > most * fast) {
        f *= most * fast / size;
        bounded = true;
    }
    return f;
}

struct SurfaceDrag::Kernel {
    SurfaceDrag& drag;
    const Aggregate& matter;

    // The present area vector of a patch [m2].
    static SWAGE_INLINE Vec4 area_of(const Patch& patch, const Vec4* x) {
        const double px = patch.place[0], py = patch.place[1], pz = patch.place[2];
        const double qy = 1 - py, qz = 1 - pz;
        const Vec4 e0 = x[1] - x[0], e1 = x[3] - x[2], e2 = x[5] - x[4], e3 = x[7] - x[6];
        const Vec4 a0 = x[0] + px * e0, a1 = x[2] + px * e1, a2 = x[4] + px * e2,
                   a3 = x[6] + px * e3;
        const Vec4 along_x = qz * (qy * e0 + py * e1) + pz * (qy * e2 + py * e3),
                   along_y = qz * (a1 - a0) + pz * (a3 - a2),
                   along_z = (qy * a2 + py * a3) - (qy * a0 + py * a1);
        return patch.area[0] * cross(along_y, along_z) + patch.area[1] * cross(along_z, along_x) +
               patch.area[2] * cross(along_x, along_y);
    }

    SWAGE_INLINE void find(std::size_t chunk) const {
        Drag result;
        const std::size_t stop = std::min(drag.cell_.size(), (chunk + 1) * kChunk);
        const Vec3Array &place = matter.particle_position, &speed = matter.particle_velocity;
        for (std::size_t n = chunk * kChunk; n < stop; ++n) {
            const Cell& cell = drag.cell_[n];
            if (cell.parted) {
                drag.push_[n] = {};
                continue;
            }
            const auto of = [&](const Vec3Array& all, int c) __attribute__((always_inline)) {
                const ParticleId p = cell.corner[c];
                return Vec4{all.x[p], all.y[p], all.z[p], 0};
            };
            const Vec4 x[8]{of(place, 0), of(place, 1), of(place, 2), of(place, 3),
                            of(place, 4), of(place, 5), of(place, 6), of(place, 7)};
            const Vec4 v[8]{of(speed, 0), of(speed, 1), of(speed, 2), of(speed, 3),
                            of(speed, 4), of(speed, 5), of(speed, 6), of(speed, 7)};
            Vec4 push[8]{};
            for (std::size_t m = cell.first; m < cell.end; ++m) {
                const Patch& patch = drag.patch_[m];
                Vec4 now{};
                for (int c = 0; c < 8; ++c) now += patch.weight[c] * v[c];
                const Vec3 f = drag.force_on(vec3(area_of(patch, x)), vec3(now), patch.place[3],
                                             result.bounded);
                const Vec4 force = vec4(f);
                for (int c = 0; c < 8; ++c) push[c] += patch.weight[c] * force;
                result.power -= dot3(force, now);
            }
            std::copy(push, push + 8, drag.push_[n].begin());
        }
        drag.chunk_[chunk] = result;
    }
};

SurfaceDrag::Drag SurfaceDrag::add_forces(const Aggregate& matter, Vec3Array& force) {
    parallel_for(chunk_.size(), [&](std::size_t chunk) {
        by_fours([&]() __attribute__((always_inline)) { Kernel{*this, matter}.find(chunk); });
    });
    Drag sum;
    for (const Drag& one : chunk_) {
        sum.bounded = sum.bounded || one.bounded;
        sum.power += one.power;
    }
    set_zero(matter.particle_count(), given_);
    for (std::size_t n = 0; n < cell_.size(); ++n) {
        for (int c = 0; c < 8; ++c) {
            const Vec3 push = vec3(push_[n][c]);
            force.add(cell_[n].corner[c], push);
            given_.add(cell_[n].corner[c], push);
        }
    }
    add_open_forces(matter, force, sum);
    return sum;
}

double SurfaceDrag::power(const Aggregate& matter) const {
    return given_.size() == 0 ? 0 : -dot(given_, matter.particle_velocity);
}

void SurfaceDrag::add_open_forces(const Aggregate& matter, Vec3Array& force, Drag& sum) {
    double power = 0;
    for (const auto& [open, most] : face_) {
        const Vec3 now = open.mean(matter.particle_velocity);
        const Vec3 f = force_on(open.outward(matter.particle_position), now, most, sum.bounded);
        spread(open, f, force);
        spread(open, f, given_);
        power -= f.dot(now);
    }
    sum.power += power;
}

}  // namespace swage

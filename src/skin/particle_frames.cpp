// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/particle_frames.h"

#include "base/parallel.h"
#include "base/principal_axes.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // particles

// What frames are made of.
struct Field {
    const Aggregate& matter;
    const FrameStencil& stencil;
    std::vector<Vec3> loose;  // displacements of the loose particles

    Vec3 displacement(ParticleId p) const {
        if (!loose.empty() && stencil.loose.slot[p] >= 0) return loose[stencil.loose.slot[p]];
        return matter.particle_position.at(p) - stencil.reference.at(p);
    }
};

// Which of a particle's neighbours are still connected to it; -1 elsewhere.
std::array<ParticleId, 12> connected_on_axes(const Aggregate& matter, const FrameStencil& stencil,
                                             ParticleId p) {
    std::array<ParticleId, 12> axis = stencil.axis[p];
    for (int d = 0; d < kEdgeCount; ++d) {
        const SparseArray<float>& weight = matter.connection[d].weight;
        ParticleId* const line = axis.data() + 4 * d;
        if (line[1] >= 0 && weight[line[1]] <= 0) line[1] = -1;
        if (line[2] >= 0 && weight[p] <= 0) line[2] = -1;
        if (line[1] < 0 || (line[0] >= 0 && weight[line[0]] <= 0)) line[0] = -1;
        if (line[2] < 0 || (line[3] >= 0 && weight[line[2]] <= 0)) line[3] = -1;
    }
    return axis;
}

// Calls f with each neighbour, of 18, that is still connected.
template <typename F>
void for_each_connected(const Aggregate& matter, const FrameStencil& stencil, ParticleId p,
                        const F& f) {
    const std::array<ParticleId, 12> axis = connected_on_axes(matter, stencil, p);
    for (int d = 0; d < kEdgeCount; ++d) {
        if (axis[4 * d + 1] >= 0) f(axis[4 * d + 1]);
        if (axis[4 * d + 2] >= 0) f(axis[4 * d + 2]);
    }
    for (int d = kEdgeCount; d < kForwardCount; ++d) {
        const SparseArray<float>& weight = matter.connection[d].weight;
        const ParticleId upper = stencil.diagonal[p][d - 3], lower = stencil.diagonal[p][d + 3];
        if (upper >= 0 && weight[p] > 0) f(upper);
        if (lower >= 0 && weight[lower] > 0) f(lower);
    }
}

// F q for the directions q that nothing spans, which come first: the body is taken to turn there
// without stretch.
void complete_rigidly(const Mat3& direction, int known, Mat3& image) {
    if (known == 2) {
        const Vec3 normal = image.col(1).cross(image.col(2));
        const double sign = direction.col(1).cross(direction.col(2)).dot(direction.col(0));
        if (normal.norm() > 0) image.col(0) = sign * normal.normalized();
    } else if (known == 1 && image.col(2).norm() > 0) {
        const Quat turn = turn_onto(direction.col(2), image.col(2));
        image.col(0) = turn * direction.col(0);
        image.col(1) = turn * direction.col(1);
    }
}

// Sums for the least-squares fit of F - I around a particle.
struct Fit {
    Mat3 spread = Mat3::Zero(), change = Mat3::Zero();
};

// F - I from the fit; false where the neighbours do not span the space.
bool solve_fit(const Fit& fit, Mat3& gradient) {
    const PrincipalAxes principal = principal_axes(fit.spread);
    const Mat3& direction = principal.axis;
    Mat3 image = direction;  // F q
    int known = 0;
    for (int n = 0; n < 3; ++n) {
        if (principal.value[n] < 1e-3) continue;  // of whole lattice steps: 0, or about 1
        image.col(n) += fit.change * direction.col(n) / principal.value[n];
        ++known;
    }
    if (known < 3) complete_rigidly(direction, known, image);
    gradient = (image - direction) * direction.transpose();
    return known == 3;
}

Mat3 fitted_gradient(const Field& field, ParticleId p) {
    const auto& [matter, stencil, loose] = field;
    const Vec3 place = stencil.reference.at(p), moved = field.displacement(p);
    const double a = matter.lattice.spacing;
    Fit fit;
    const auto add = [&](ParticleId n) {
        const Vec3 way = (stencil.reference.at(n) - place) / a;
        fit.spread += way * way.transpose();
        fit.change += (field.displacement(n) - moved) / a * way.transpose();
    };
    Mat3 gradient;
    for_each_connected(matter, stencil, p, add);
    if (solve_fit(fit, gradient)) return gradient;
    for_each_connected(matter, stencil, p,
                       [&](ParticleId n) { for_each_connected(matter, stencil, n, add); });
    solve_fit(fit, gradient);
    return gradient;
}

ParticleFrame particle_frame(const Field& field, ParticleId p) {
    const auto& [matter, stencil, loose] = field;
    const std::array<ParticleId, 12> axis = connected_on_axes(matter, stencil, p);
    ParticleFrame frame;
    const Vec3 u = field.displacement(p);
    frame.tail<3>() = u;
    for (int d = 0; d < 3; ++d) {
        const ParticleId* const line = axis.data() + 4 * d;
        const auto at = [&](ParticleId n) { return stencil.reference.at(n)[d]; };
        Vec3 slope;
        if (line[1] >= 0 && line[2] >= 0) {
            slope = (field.displacement(line[2]) - field.displacement(line[1])) /
                    (at(line[2]) - at(line[1]));
        } else if (line[1] < 0 && line[2] < 0) {
            frame.head<9>() = fitted_gradient(field, p).reshaped();
            return frame;
        } else {
            const ParticleId one = line[2] >= 0 ? line[2] : line[1];
            const ParticleId two = line[2] >= 0 ? line[3] : line[0];
            const Vec3 first = field.displacement(one);
            if (two >= 0) {
                slope = (4 * first - 3 * u - field.displacement(two)) / (at(two) - at(p));
            } else {
                slope = (first - u) / (at(one) - at(p));
            }
        }
        frame.segment<3>(3 * d) = slope;
    }
    return frame;
}

}  // namespace

FrameStencil make_frame_stencil(const Aggregate& matter) {
    const std::size_t count = matter.particle_count();
    FrameStencil stencil;
    stencil.reference = matter.particle_reference.all();
    stencil.loose = find_loose(matter);
    std::array<ParticleId, 12> none;
    none.fill(-1);
    stencil.axis.assign(count, none);
    stencil.diagonal.assign(count, none);
    for (const Span& span : matter.lattice.span) {
        const int d = span.direction;
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if (d < kEdgeCount) {
                stencil.axis[lower][4 * d + 2] = upper;
                stencil.axis[upper][4 * d + 1] = lower;
            } else {
                stencil.diagonal[lower][d - 3] = upper;
                stencil.diagonal[upper][d + 3] = lower;
            }
        }
    }
    for (std::array<ParticleId, 12>& axis : stencil.axis) {
        for (int d = 0; d < kEdgeCount; ++d) {
            ParticleId* const line = axis.data() + 4 * d;
            if (line[1] >= 0) line[0] = stencil.axis[line[1]][4 * d + 1];
            if (line[2] >= 0) line[3] = stencil.axis[line[2]][4 * d + 2];
        }
    }
    return stencil;
}

void particle_frames(const Aggregate& matter, const FrameStencil& stencil,
                     const std::vector<ParticleId>& particle, std::vector<ParticleFrame>& frame) {
    frame.resize(particle.size());
    Field field{matter, stencil, {}};
    if (!stencil.loose.particle.empty()) {
        field.loose = loose_displacements(stencil.loose, matter, stencil.reference);
    }
    parallel_each(particle.size(), kChunk,
                  [&](std::size_t n) { frame[n] = particle_frame(field, particle[n]); });
}

}  // namespace swage

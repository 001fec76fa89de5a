// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/crack_strip.h"

#include <algorithm>
#include <cmath>

#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/sever.h"

namespace swage {

Material breaking(double reach) {
    Material material = unit_material(kCrackNu);
    material.strength = kCrackStrength;
    material.toughness = reach * kCrackStrength * kCrackStrength;
    return material;
}

Aggregate slice(double length, double height, double angle, const Material& material) {
    const TriMesh mesh = make_shape("bar", {{"length", length},
                                            {"height", height},
                                            {"width", 1},
                                            {"rounding", 0},
                                            {"division", 1}})
                             .mesh;
    MoldSettings settings;
    settings.spacing = 1;
    return mold(turned(mesh, Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))), material, settings);
}

void notch(Aggregate& matter, const Vec3& along, const Vec3& across, double end) {
    const auto at = [&](double x, double z) {
        return Vec3(1e-4 * across + x * along + z * Vec3::UnitZ());
    };
    const double far = -1e3;
    sever(matter, crossed_connections(matter, {{at(far, -9), at(end, -9), at(end, 9)},
                                               {at(far, -9), at(end, 9), at(far, 9)}}));
}

Tip tip_of(const Aggregate& m, const Vec3& along, const Vec3& across, double until) {
    Tip tip;
    for (const Span& span : m.lattice.span) {
        const std::vector<float>& damage = m.connection[span.direction].damage;
        if (damage.empty() || span.direction >= kEdgeCount) continue;
        for (int n = 0; n < span.count; ++n) {
            if (damage[span.lower + n] < 1) continue;
            const Vec3 middle = 0.5 * (m.particle_reference.at(span.lower + n) +
                                       m.particle_reference.at(span.upper + n));
            if (along.dot(middle) > until) continue;
            tip.ahead = std::max(tip.ahead, along.dot(middle));
            tip.off = std::max(tip.off, std::abs(across.dot(middle)));
        }
    }
    return tip;
}

std::vector<int> clamped(const Aggregate& matter, const Vec3& across, int side, double half) {
    std::vector<int> points;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        const Vec3& x = matter.surface_reference(p);
        if (side * across.dot(x) > half) points.push_back(static_cast<int>(p));
    }
    return points;
}

double strip_opening(double share, double half, const Material& material) {
    return 2 * std::sqrt(share * material.toughness * (1 - kCrackNu * kCrackNu) * half);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "geometry/calf.h"
#include "geometry/implicit.h"
#include "geometry/gradient_noise.h"

namespace swage {

namespace {

// 0 below `from`, 1 above `to`, smooth between; reversed when from > to.
double rise(double from, double to, double value) {
    const double s = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

Vec3 mix(const Vec3& a, const Vec3& b, double share) { return a + share * (b - a); }

const Vec3 kCream = {0.945, 0.905, 0.840};
const Vec3 kBrown = {0.205, 0.120, 0.080};
const Vec3 kPink = {0.900, 0.660, 0.610};
const Vec3 kHoof = {0.200, 0.165, 0.145};
const Vec3 kHorn = {0.720, 0.640, 0.520};

// 1 in the dark patches of the hide.
double patches(const Vec3& p, const Vec3& mirrored) {
    const Vec3 warp = {gradient_noise(4.5 * p, 168), gradient_noise(4.5 * p, 169),
                       gradient_noise(4.5 * p, 170)};
    const Vec3 at = p + 0.075 * warp;
    double v = layered_noise(Vec3(4.0, 3.4, 4.4).cwiseProduct(at) + Vec3(0.37, 0.11, 0.23), 2, 68);
    // White below the knees and on the belly; a dark head with a white blaze.
    v -= 0.9 * rise(0.30, 0.16, p.y()) + 0.25 * rise(0.40, 0.33, p.y());
    const double head = rise(0.66, 0.76, p.x() + 0.5 * p.y());
    const double blaze = mirrored.z() - 0.020 - 0.10 * rise(0.74, 0.64, p.y()) -
                         0.03 * rise(0.79, 0.84, p.y()) + 0.012 * gradient_noise(22 * p, 17);
    v = mix(Vec3::Constant(v), Vec3::Constant(14 * blaze), head).x();
    // The border is a fringe of hair.
    v += 0.022 * gradient_noise(Vec3(60, 90, 90).cwiseProduct(p), 21) +
         0.016 * gradient_noise(Vec3(140, 190, 190).cwiseProduct(p), 22);
    return rise(-0.03, 0.05, v + 0.055);
}

Vec3 hide(const Vec3& p, const Vec3& mirrored) {
    const double dark = patches(p, mirrored);
    // Hair lies backwards and down: noise drawn out along it.
    const Vec3 lie = Vec3(-0.8, -0.6, 0);
    const Vec3 drawn = p - 0.75 * p.dot(lie) * lie;
    const double hair = gradient_noise(210 * drawn, 31) + 0.6 * gradient_noise(420 * drawn, 32);
    const double cloud = gradient_noise(9 * p, 33);
    const Vec3 cream =
        mix(kCream, Vec3(0.86, 0.78, 0.67), std::clamp(0.25 + 0.4 * cloud, 0.0, 1.0));
    const Vec3 brown = mix(kBrown, Vec3(0.32, 0.19, 0.12), std::clamp(0.3 + 0.5 * cloud, 0.0, 1.0));
    return mix(cream * (1 + 0.022 * hair), brown * (1 + 0.11 * hair), dark);
}

void paint_muzzle(Vec3& color, const Vec3& p, const Vec3& mirrored) {
    const double edge = ellipsoid_distance(p - Vec3(0.585, 0.640, 0), {0.052, 0.048, 0.070}) +
                        0.004 * gradient_noise(40 * p, 41);
    const double mottle = 0.03 * gradient_noise(90 * p, 42);
    color = mix(color, kPink * (1 + mottle), rise(0.008, -0.008, edge));
    const double nostril = ellipsoid_distance(mirrored - kCalfNostril, {0.019, 0.012, 0.011});
    color = mix(color, Vec3(0.20, 0.09, 0.08), rise(0.003, -0.003, nostril));
    // The mouth is a line around the muzzle that climbs a little backwards.
    const double line =
        std::abs(p.y() - 0.6265 - 0.16 * (0.60 - p.x())) + 0.05 * std::max(0.0, 0.525 - p.x());
    const double mouth = p.y() < 0.66 && p.x() > 0.48 ? line - 0.0022 : 1.0;
    color = mix(color, Vec3(0.36, 0.17, 0.15), 0.85 * rise(0.0035, -0.001, mouth));
}

void paint_eye(Vec3& color, const Vec3& mirrored) {
    const Vec3 from = mirrored - kCalfEye;
    if (from.norm() > 2.5 * kCalfEyeRadius) return;
    // Looks outward and a little ahead; an almond, wider than high.
    const Vec3 axis = Vec3(0.50, 0.10, 0.86).normalized();
    const Vec3 along =
        (Vec3(0.86, -0.25, -0.40) - axis * axis.dot(Vec3(0.86, -0.25, -0.40))).normalized();
    const Vec3 up = axis.cross(along).y() > 0 ? axis.cross(along) : along.cross(axis);
    const Vec2 flat = Vec2(from.dot(along), from.dot(up)) / kCalfEyeRadius;
    if (from.dot(axis) < 0) return;
    const double lid = portable::hypot(flat.x() / 1.08, (flat.y() - 0.05) / 0.80);
    color = mix(color, Vec3(0.07, 0.045, 0.04), rise(1.28, 1.08, lid));
    const Vec3 iris =
        mix(Vec3(0.30, 0.17, 0.09), Vec3(0.12, 0.06, 0.04), rise(0.2, -0.6, -flat.y()));
    color = mix(color, iris, rise(0.99, 0.90, lid));
    color = mix(color, Vec3(0.02, 0.015, 0.015),
                rise(0.70, 0.58, portable::hypot(flat.x() / 1.1, flat.y() / 0.9)));
    color = mix(color, Vec3(0.98, 0.98, 1.0), rise(0.26, 0.18, (flat - Vec2(0.26, 0.36)).norm()));
    color = mix(color, Vec3(0.65, 0.68, 0.75),
                0.8 * rise(0.15, 0.07, (flat - Vec2(-0.32, -0.30)).norm()));
}

void paint_ear(Vec3& color, const Vec3& mirrored, const Vec3& normal) {
    const Vec3 along = kCalfEarTip - kCalfEarRoot;
    const double s = (mirrored - kCalfEarRoot).dot(along) / along.squaredNorm();
    const Vec3 off = mirrored - kCalfEarRoot - s * along;
    if (s < 0.05 || s > 1.1 || off.norm() > 0.06) return;
    const double hollow = portable::hypot((s - 0.52) / 0.42, off.y() / 0.030);
    color = mix(color, kPink * 0.92, rise(0.25, 0.6, normal.x()) * rise(1.1, 0.7, hollow));
}

// How open the surroundings are: 1 under a free sky, less in folds and between legs.
double openness(const Vec3& p, const Vec3& normal) {
    double closed = 0, weight = 1;
    for (const double reach : {0.012, 0.035, 0.09}) {
        closed += weight * std::max(0.0, reach - calf_distance(p + reach * normal)) / reach;
        weight *= 0.6;
    }
    return 1 - std::clamp(closed / 1.96, 0.0, 1.0);
}

}  // namespace

Vec3 calf_color(const Vec3& p, const Vec3& normal) {
    const Vec3 mirrored = {p.x(), p.y(), std::abs(p.z())};
    Vec3 color = hide(p, mirrored);
    // Udder, tuft of the tail, horns, hooves.
    color = mix(color, kPink,
                0.75 * rise(0.010, -0.004,
                            ellipsoid_distance(p - Vec3(-0.175, 0.318, 0), {0.070, 0.040, 0.050})));
    if (p.x() < -0.44 && mirrored.z() < 0.05)
        color =
            mix(color, kBrown * (1 + 0.2 * gradient_noise(Vec3(90, 25, 90).cwiseProduct(p), 51)),
                rise(0.385, 0.350, p.y() + 0.02 * gradient_noise(50 * p, 52)));
    const double horn = (mirrored - kCalfHorn).dot(Vec3(-0.176, 0.88, 0.44));
    const double beside = (mirrored - kCalfHorn).cross(Vec3(-0.176, 0.88, 0.44)).norm();
    if (horn < 0.08 && beside < 0.03)
        color = mix(color, mix(kHorn, Vec3(0.25, 0.20, 0.17), rise(0.022, 0.055, horn)),
                    rise(0.002, 0.010, horn));
    const double rings = 0.12 * gradient_noise(Vec3(12, 160, 12).cwiseProduct(p), 53);
    color = mix(color, kHoof * (1 + rings),
                rise(0.066, 0.060, p.y() + 0.002 * gradient_noise(70 * p, 54)));
    paint_muzzle(color, p, mirrored);
    paint_ear(color, mirrored, normal);
    paint_eye(color, mirrored);
    const double shade = 0.60 + 0.40 * openness(p, normal);
    const double belly = 1 - 0.10 * rise(0.2, -0.9, normal.y());
    return (color * shade * belly).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "geometry/calf.h"
#include "geometry/implicit.h"

namespace swage {

namespace {

double trunk(const Vec3& p) {
    const auto blob = [&](const Vec3& center, const Vec3& radii) {
        return ellipsoid_distance(p - center, radii);
    };
    double d = blob({0.10, 0.490, 0}, {0.185, 0.160, 0.128});                    // chest
    d = smooth_union(d, blob({-0.09, 0.474, 0}, {0.260, 0.152, 0.140}), 0.08);   // belly
    d = smooth_union(d, blob({-0.285, 0.510, 0}, {0.160, 0.145, 0.122}), 0.08);  // rump
    d = smooth_union(d, blob({0.110, 0.610, 0}, {0.115, 0.055, 0.050}), 0.08);   // withers
    d = smooth_union(d, limb_distance(p, {0.06, 0.590, 0}, 0.060, {-0.27, 0.590, 0}, 0.056), 0.07);
    d = smooth_union(d, blob({-0.265, 0.612, 0.055}, {0.075, 0.030, 0.036}), 0.06);  // hips
    d = smooth_union(d, blob({-0.395, 0.600, 0}, {0.055, 0.045, 0.040}), 0.06);      // tail root
    d = smooth_union(d, blob({0.135, 0.470, 0.085}, {0.085, 0.130, 0.060}), 0.06);   // shoulder
    d = smooth_union(d, blob({-0.295, 0.430, 0.075}, {0.115, 0.135, 0.068}), 0.06);  // thigh
    d = smooth_union(d, blob({0.245, 0.410, 0}, {0.060, 0.085, 0.060}), 0.07);       // brisket
    return d;
}

double neck_and_head(const Vec3& p) {
    Vec3 flat = p;  // the neck is deeper than wide
    flat.z() *= 1.25;
    double d = limb_distance(flat, {0.185, 0.520, 0}, 0.135, {0.365, 0.705, 0}, 0.085) / 1.1;
    // Head: a skull, a wedge down to the muzzle, a jaw, cheeks.
    double head = ellipsoid_distance(p - Vec3(0.408, 0.752, 0), {0.082, 0.078, 0.074});
    head = smooth_union(head, limb_distance(p, {0.430, 0.738, 0}, 0.066, {0.545, 0.668, 0}, 0.047),
                        0.04);
    head = smooth_union(head, limb_distance(p, {0.395, 0.690, 0}, 0.050, {0.540, 0.634, 0}, 0.030),
                        0.04);
    head = smooth_union(
        head, ellipsoid_distance(p - Vec3(0.405, 0.705, 0.038), {0.060, 0.050, 0.034}), 0.03);
    head = smooth_union(head, ellipsoid_distance(p - Vec3(0.562, 0.650, 0), {0.044, 0.041, 0.056}),
                        0.03);
    // Brow over the eye, the socket, the eye itself.
    head = smooth_union(
        head, limb_distance(p, {0.425, 0.790, 0.050}, 0.020, {0.470, 0.775, 0.052}, 0.014), 0.03);
    head = smooth_union(head, ball_distance(p, kCalfEye, kCalfEyeRadius), 0.008);
    head = smooth_cut(head, ellipsoid_distance(p - kCalfNostril, {0.016, 0.011, 0.010}), 0.012);
    // Tuft between the horns, horn buds.
    head = smooth_union(head, ellipsoid_distance(p - Vec3(0.398, 0.826, 0), {0.034, 0.024, 0.034}),
                        0.03);
    head = smooth_union(
        head, limb_distance(p, kCalfHorn, 0.0185, kCalfHorn + Vec3(-0.008, 0.040, 0.020), 0.0105),
        0.014);
    return smooth_union(d, head, 0.05);
}

double ear(const Vec3& p) {
    // A leaf from root to tip, hollow in front.
    const Vec3 along = (kCalfEarTip - kCalfEarRoot).normalized();
    const Vec3 face = (Vec3(1.0, 0.10, 0.0) - along * along.x()).normalized();
    const Vec3 up = face.cross(along);
    const Vec3 from = p - 0.5 * (kCalfEarRoot + kCalfEarTip);
    const Vec3 local = {from.dot(along), from.dot(up), from.dot(face)};
    const double taper =
        std::clamp(1 + 2.2 * local.x(), 0.8, 1.2);  // wider towards the tip than at the root
    const double half = 0.5 * (kCalfEarTip - kCalfEarRoot).norm();
    double d = ellipsoid_distance(local, {half + 0.006, 0.042 * taper, 0.0175});
    d = smooth_cut(
        d, ellipsoid_distance(local - Vec3(0.012, 0, 0.021), {half - 0.018, 0.026, 0.017}), 0.010);
    return d;
}

double hoof(const Vec3& p, const Vec3& place) {
    // A blunt cone, wider at the ground and longer than wide, with a cleft in front.
    const Vec3 from = p - place;
    const double height = from.y() / 0.062;
    const Vec2 half = {0.047 - 0.008 * height, 0.040 - 0.007 * height};
    const Vec2 flat(from.x() + 0.012 * height, from.z());
    const double region = round_rectangle_distance(flat, half, 0.028);
    double d = plate_distance(region, from.y() - 0.029, 0.029, 0.010);
    const double cleft = std::max(std::abs(from.z()) - 0.003, 0.018 - from.x());
    return smooth_cut(d, cleft, 0.010);
}

double fore_leg(const Vec3& p) {
    double d = limb_distance(p, {0.140, 0.400, 0.088}, 0.066, {0.158, 0.255, 0.092}, 0.045);
    d = smooth_union(d, ellipsoid_distance(p - Vec3(0.162, 0.238, 0.092), {0.041, 0.056, 0.039}),
                     0.03);
    d = smooth_union(
        d, limb_distance(p, {0.160, 0.225, 0.092}, 0.036, {0.155, 0.100, 0.092}, 0.032), 0.02);
    d = smooth_union(d, ball_distance(p, {0.156, 0.085, 0.092}, 0.0365), 0.02);
    return smooth_union(d, hoof(p, {0.170, 0, 0.092}), 0.012);
}

double hind_leg(const Vec3& p) {
    double d = limb_distance(p, {-0.275, 0.400, 0.085}, 0.082, {-0.300, 0.320, 0.088}, 0.062);
    d = smooth_union(
        d, limb_distance(p, {-0.300, 0.320, 0.088}, 0.058, {-0.362, 0.235, 0.092}, 0.040), 0.03);
    d = smooth_union(d, ellipsoid_distance(p - Vec3(-0.370, 0.230, 0.092), {0.043, 0.048, 0.038}),
                     0.02);
    d = smooth_union(
        d, limb_distance(p, {-0.366, 0.225, 0.092}, 0.036, {-0.347, 0.100, 0.092}, 0.033), 0.02);
    d = smooth_union(d, ball_distance(p, {-0.346, 0.085, 0.092}, 0.037), 0.02);
    return smooth_union(d, hoof(p, {-0.330, 0, 0.092}), 0.012);
}

double tail(const Vec3& p) {
    double d = limb_distance(p, {-0.405, 0.612, 0}, 0.030, {-0.452, 0.570, 0}, 0.023);
    d = smooth_union(d, limb_distance(p, {-0.452, 0.570, 0}, 0.022, {-0.476, 0.470, 0}, 0.018),
                     0.02);
    d = smooth_union(d, limb_distance(p, {-0.476, 0.470, 0}, 0.018, {-0.484, 0.360, 0}, 0.017),
                     0.01);
    return smooth_union(d, ellipsoid_distance(p - Vec3(-0.487, 0.305, 0), {0.028, 0.068, 0.028}),
                        0.02);
}

double udder(const Vec3& p) {
    return ellipsoid_distance(p - Vec3(-0.175, 0.330, 0), {0.080, 0.045, 0.056});
}

}  // namespace

double calf_distance(const Vec3& point) {
    const Vec3 p = {point.x(), point.y(), std::abs(point.z())};
    double d = smooth_union(trunk(p), neck_and_head(p), 0.09);
    d = smooth_union(d, ear(p), 0.016);
    d = smooth_union(d, fore_leg(p), 0.045);
    d = smooth_union(d, hind_leg(p), 0.045);
    d = smooth_union(d, udder(p), 0.020);
    return smooth_union(d, tail(p), 0.018);
}

Box calf_bounds() { return {{-0.56, -0.03, -0.25}, {0.66, 0.93, 0.25}}; }

double calf_edge_length(const Vec3& point) {
    const auto near = [](double value, double from, double to) {
        const double s = std::clamp((value - from) / (to - from), 0.0, 1.0);
        return s * s * (3 - 2 * s);
    };
    const double head = near(point.x() + 0.5 * point.y(), 0.62, 0.76);
    const double feet = near(-point.y(), -0.16, -0.06);
    const double tail = near(-point.x(), 0.40, 0.46);
    const double ears = near(std::abs(point.z()), 0.06, 0.11);
    return 1 - 0.35 * std::max(feet, tail) * (1 - head) - (0.50 + 0.09 * ears) * head;
}

double calf_texel_density(const Vec3& point) {
    return point.x() + 0.5 * point.y() > 0.70 ? 1.8 : 1.0;
}

}  // namespace swage

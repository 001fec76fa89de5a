// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the interpolation: F. N. Fritsch and R. E. Carlson, "Monotone Piecewise Cubic
// Interpolation", SIAM J. Numer. Anal. 17 (1980), with harmonic-mean slopes: no key is overshot.
#include "render/camera.h"

#include <algorithm>
#include <cmath>

#include "render/camera_change.h"

namespace swage {

namespace {

// The slope at key k of a monotone curve through the keys; flat at both ends, so that the camera
// starts and stops gently, unless the curve goes on from its end as from its start.
double slope_at(const std::vector<double>& x, const std::vector<double>& y, std::size_t k,
                bool goes_on) {
    const std::size_t last = x.size() - 1;
    if (!goes_on && (k == 0 || k == last)) return 0;
    const auto slope = [&](std::size_t i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
    const double before = slope(k == 0 ? last - 1 : k - 1), after = slope(k == last ? 0 : k);
    if (before * after <= 0) return 0;
    return 2 * before * after / (before + after);
}

double monotone_cubic(const std::vector<double>& x, const std::vector<double>& y, double at,
                      bool goes_on) {
    if (at <= x.front()) return y.front();
    if (at >= x.back()) return y.back();
    const std::size_t k =
        static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin()) - 1;
    const double width = x[k + 1] - x[k], t = (at - x[k]) / width;
    const double t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * y[k] + (t3 - 2 * t2 + t) * width * slope_at(x, y, k, goes_on) +
           (3 * t2 - 2 * t3) * y[k + 1] + (t3 - t2) * width * slope_at(x, y, k + 1, goes_on);
}

constexpr double kMostNearer = 2;  // than zoom says, at most: of the near side of what is framed

Box sensible(Box box) {
    if (box.empty()) box = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
    const double least = std::max(1e-9, 1e-6 * box.size().maxCoeff());
    const Vec3 half = (0.5 * box.size()).cwiseMax(least), center = box.center();
    return {center - half, center + half};
}

}  // namespace

std::vector<Vec3> corners_of(const Box& box) {
    std::vector<Vec3> corners;
    for (int c = 0; c < 8; ++c) corners.push_back(box.corner(c));
    return corners;
}

Lens lens_of(const RenderSettings& settings) {
    const double tangent = std::tan(0.5 * settings.field_of_view);
    return {tangent * settings.width / settings.height, tangent, settings.free_below};
}

Mat3 orbit_rotation(double azimuth, double elevation) {
    const double sa = std::sin(azimuth), ca = std::cos(azimuth);
    const double se = std::sin(elevation), ce = std::cos(elevation);
    const Vec3 right = {ca, 0, -sa}, back = {sa * ce, se, ca * ce};
    Mat3 rotation;
    rotation << right, back.cross(right), back;
    return rotation;
}

View look_at(const Vec3& eye, const Vec3& target) {
    View view{eye, Mat3::Identity()};
    const double distance = (eye - target).norm();
    if (!(distance > 0)) return view;
    const Vec3 back = (eye - target) / distance;
    const double sideways = std::hypot(back.x(), back.z());
    const double azimuth = sideways > 1e-9 ? std::atan2(back.x(), back.z()) : 0;
    view.world_from_view = orbit_rotation(azimuth, std::atan2(back.y(), sideways));
    return view;
}

Framing frame_points(const std::vector<Vec3>& points, const Vec3& center,
                     const Mat3& world_from_view, const Lens& lens) {
    const double tx = lens.tangent_x / kFramingMargin, ty = lens.tangent_y / kFramingMargin;
    const double below = ty - 2 * lens.free_below * lens.tangent_y;  // ty of the lower half
    // With the eye at (cx, cy, cz), a corner is inside the pyramid when |x - cx| <= tx (cz - z)
    // and the same for y: four upper bounds over the corners, met by the least cz.
    const double none = -std::numeric_limits<double>::infinity();
    double right = none, left = none, top = none, bottom = none;
    for (const Vec3& point : points) {
        const Vec3 p = world_from_view.transpose() * (point - center);
        right = std::max(right, p.x() + tx * p.z());
        left = std::max(left, -p.x() + tx * p.z());
        top = std::max(top, p.y() + ty * p.z());
        bottom = std::max(bottom, -p.y() + below * p.z());
    }
    const double distance = std::max((right + left) / (2 * tx), (top + bottom) / (ty + below));
    const Vec3 shift = {0.5 * (right - left), 0.5 * (top - bottom), 0};
    return {distance, center + world_from_view * shift};
}

DepthRange depth_range(const Box& box, const View& view) {
    double least = std::numeric_limits<double>::infinity(), greatest = 0;
    for (const Vec3& corner : corners_of(box)) {
        const double depth = -view.in_view(corner).z();
        least = std::min(least, depth);
        greatest = std::max(greatest, depth);
    }
    const double size = std::max(box.size().norm(), 1e-9);
    const double near = std::max(0.8 * least, 2e-3 * size);
    return {near, std::max(1.1 * greatest, 2 * near)};
}

glm::dmat4 clip_from_view(const Lens& lens, const DepthRange& depth) {
    return glm::perspective(2 * std::atan(lens.tangent_y), lens.tangent_x / lens.tangent_y,
                            depth.near, depth.far);
}

glm::dmat4 view_from_world(const View& view) {
    const glm::dvec3 eye = to_glm(view.eye);
    const glm::dvec3 up = to_glm(view.world_from_view.col(1));
    return glm::lookAt(eye, eye - to_glm(view.world_from_view.col(2)), up);
}

bool comes_round(const std::vector<CameraKey>& keys) {
    if (keys.empty() || keys.front().at > 0 || keys.back().at < 1) return false;
    if (stands_at_eye(keys)) return false;
    const CameraKey &first = keys.front(), &last = keys.back();
    const double turns = (last.azimuth - first.azimuth) / (2 * kPi), whole = std::round(turns);
    return whole != 0 && std::abs(turns - whole) < 1e-9 && first.elevation == last.elevation &&
           first.zoom == last.zoom && first.target == last.target;
}

double still_share(const std::vector<CameraKey>& keys, int still, int count) {
    const int steps = comes_round(keys) ? count : count - 1;
    return steps > 0 ? static_cast<double>(still) / steps : 0;
}

CameraPath::CameraPath(const RenderSettings& settings, FramedAction action)
    : bounds_(sensible(action.bounds)),
      outline_(std::move(action.outline)),
      way_(std::move(action.way)),
      lens_(lens_of(settings)) {
    if (outline_.empty()) outline_ = corners_of(bounds_);
    std::vector<CameraKey> keys = settings.camera;
    if (keys.empty()) keys.emplace_back();
    by_eye_ = stands_at_eye(keys);
    comes_round_ = comes_round(keys);
    for (const CameraKey& key : keys) {
        // Of keys at one moment the last counts.
        if (!share_.empty() && key.at <= share_.back()) {
            share_.pop_back();
            value_.pop_back();
        }
        share_.push_back(key.at);
        const Mat3 rotation = orbit_rotation(key.azimuth, key.elevation);
        const Vec3 aim =
            key.target.value_or(frame_points(outline_, bounds_.center(), rotation, lens_).target);
        value_.push_back({key.azimuth, key.elevation, std::log(std::max(1e-6, key.zoom)), aim.x(),
                          aim.y(), aim.z(), key.target ? 1.0 : 0.0});
    }
    distance_ = 0;
    constexpr int kSamples = 64;
    for (int i = 0; i <= (share_.size() > 1 ? kSamples : 0); ++i) {
        const double share = share_.front() + i * (share_.back() - share_.front()) / kSamples;
        const std::vector<double> v = interpolated(share);
        const Framing framing =
            frame_points(outline_, bounds_.center(), orbit_rotation(v[0], v[1]), lens_);
        distance_ = std::max(distance_, framing.distance);
    }
    if (!by_eye_) return;
    std::vector<std::vector<double>> places;
    for (std::size_t k = 0; k < share_.size(); ++k) {
        const auto named = std::find_if(keys.rbegin(), keys.rend(),
                                        [&](const CameraKey& key) { return key.at == share_[k]; });
        Vec3 eye, target;
        if (named->eye && named->target) {
            eye = *named->eye;
            target = *named->target;
        } else {
            const View view = orbit(value_[k]);
            eye = view.eye;
            const double depth = -view.in_view(named->target.value_or(bounds_.center())).z();
            target = eye - depth * view.world_from_view.col(2);
        }
        places.push_back({eye.x(), eye.y(), eye.z(), target.x(), target.y(), target.z()});
    }
    value_ = std::move(places);
}

std::vector<double> CameraPath::interpolated(double film_share) const {
    std::vector<double> result, curve(share_.size());
    for (std::size_t i = 0; i < value_.front().size(); ++i) {
        for (std::size_t k = 0; k < share_.size(); ++k) curve[k] = value_[k][i];
        result.push_back(monotone_cubic(share_, curve, film_share, comes_round_));
    }
    return result;
}

View CameraPath::orbit(const std::vector<double>& value) const {
    const Mat3 rotation = orbit_rotation(value[0], value[1]);
    const Framing framing = frame_points(outline_, bounds_.center(), rotation, lens_);
    const Vec3 aim = {value[3], value[4], value[5]};
    const Vec3 middle = framing.target + value[6] * (aim - framing.target);
    const double zoom = std::exp(value[2]);
    double distance = distance_ / zoom;
    // Zoom is about the middle: where the bodies' way reaches far towards the eye, that would bring
    // the eye within it, or so near that one face fills the picture. A target is the user's own.
    double front = 0;
    for (const Vec3& point : outline_) {
        front = std::max(front, rotation.col(2).dot(point - framing.target));
    }
    const double least = front + (distance_ - front) / (kMostNearer * zoom);
    distance += (1 - value[6]) * std::max(least - distance, 0.0);
    // What is named is looked at straight.
    const double lift = (1 - value[6]) * lens_.free_below * lens_.tangent_y * distance;
    return {middle + distance * rotation.col(2) - lift * rotation.col(1), rotation};
}

View CameraPath::at(double film_share) const {
    const std::vector<double> v = interpolated(film_share);
    if (by_eye_) return look_at({v[0], v[1], v[2]}, {v[3], v[4], v[5]});
    View view = orbit(v);
    view.eye += gone(film_share);
    return view;
}

Vec3 CameraPath::gone(double film_share) const {
    if (way_.empty()) return Vec3::Zero();
    const double last = static_cast<double>(way_.size() - 1);
    const double at = film_share * (last + comes_round_);  // as still_share() has it
    const double before = std::clamp(std::floor(at), 0.0, last), next = std::min(before + 1, last);
    const double share = std::clamp(at - before, 0.0, 1.0);
    return (1 - share) * way_[std::size_t(before)] + share * way_[std::size_t(next)];
}

}  // namespace swage

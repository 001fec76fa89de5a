// SPDX-License-Identifier: GPL-3.0-or-later
// Where the picture is taken from. The world has y up; a view looks along its own -z with x to
// the right and y up.
#pragma once

#include "base/math.h"
#include "geometry/box.h"
#include "render/framed_action.h"
#include "render/glm_bridge.h"
#include "render/settings.h"

namespace swage {

struct View {
    Vec3 eye = {0, 0, 1};
    Mat3 world_from_view = Mat3::Identity();  // columns: right, up, back

    Vec3 in_view(const Vec3& point) const { return world_from_view.transpose() * (point - eye); }
};

// A pyramid of sight: tangents of half the angles.
struct Lens {
    double tangent_x, tangent_y;
    double free_below = 0;  // of the height, that what is framed is kept off at the bottom
};
Lens lens_of(const RenderSettings& settings);

// Turns right, up and back for an orbit's angles [rad], at any elevation.
Mat3 orbit_rotation(double azimuth, double elevation);

// Looks from eye to target with the world's y up; looking straight up or down, -z is up (or +z).
// Eye and target at one place look along -z.
View look_at(const Vec3& eye, const Vec3& target);

// The distance to the point `center`, along the view, from which all the given points are seen with
// a margin, and the sideways shift of the eye that centres them in the whole picture.
struct Framing {
    double distance;
    Vec3 target;  // the point looked at, as deep as `center`
};
inline constexpr double kFramingMargin =
    1.12;  // the picture is this much wider than what it frames
Framing frame_points(const std::vector<Vec3>& points, const Vec3& center,
                     const Mat3& world_from_view, const Lens& lens);
std::vector<Vec3> corners_of(const Box& box);

// Least and greatest depth of the box before the eye, with 0 < near < far even when the eye is
// inside the box.
struct DepthRange {
    double near, far;
};
DepthRange depth_range(const Box& box, const View& view);

// OpenGL's projection to the cube of -1 to 1.
glm::dmat4 clip_from_view(const Lens& lens, const DepthRange& depth);
glm::dmat4 view_from_world(const View& view);

// Whether the flight ends as it began, after whole turns: its film can be shown round and round.
bool comes_round(const std::vector<CameraKey>& keys);
// The share of the film, 0 to 1, at which the camera takes still 0 ... count - 1. Of a flight that
// comes round the last is a step short of 1, where it would be the first again.
double still_share(const std::vector<CameraKey>& keys, int still, int count);

// The keys of the settings as one smooth flight, which starts and stops gently unless it comes
// round. The distance that frames the whole motion is found once for the whole flight, so an orbit
// does not pump; zoom divides it. As soon as one key gives eye and target, all keys are turned into
// eyes and targets and fly straight between them.
class CameraPath {
  public:
    CameraPath(const RenderSettings& settings, FramedAction action);
    CameraPath(const RenderSettings& settings, const Box& action_bounds)
        : CameraPath(settings, FramedAction{action_bounds}) {}
    View at(double film_share) const;

  private:
    // At azimuth, elevation, log of zoom, and what is looked at with a weight: 0 is the framed
    // action.
    View orbit(const std::vector<double>& value) const;
    std::vector<double> interpolated(double film_share) const;
    Vec3 gone(double film_share) const;  // along the way

    Box bounds_;
    std::vector<Vec3> outline_, way_;
    Lens lens_;
    bool by_eye_;  // a key's values are eye and target; else those of an orbit
    bool comes_round_;
    double distance_ = 1;
    std::vector<double> share_;
    std::vector<std::vector<double>> value_;  // one a key
};

}  // namespace swage

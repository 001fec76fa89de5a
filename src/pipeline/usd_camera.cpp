// SPDX-License-Identifier: GPL-3.0-or-later
// A camera of USD looks along its own -z with y up, as one here does, and a distant light shines
// along its own -z (openusd.org, UsdGeomCamera, UsdLuxDistantLight).
#include "pipeline/usd_camera.h"

#include <algorithm>

#include "base/portable_math.h"
#include "geometry/usd_time.h"
#include "render/studio.h"

namespace swage {

namespace {

// The film of a small camera is 36 mm wide; USD has lengths of cameras in tenths of its unit.
constexpr double kFilmWidth = 0.36;
// What is put nearer or farther afterwards is to be seen too [nearest, box].
constexpr double kBefore = 0.1, kBehind = 10;

float as_float(double value) { return static_cast<float>(value); }

}  // namespace

void write_usd_view(UsdText& out, const Shot& shot, int count, const FrameRange& frames,
                    const Box& seen, const Box& all) {
    const CameraPath camera = shot.camera();
    const Pose world_from_drawn = {shot.drawn_from_world.conjugate(), Vec3::Zero()};
    std::vector<Pose> pose;
    double near = std::numeric_limits<double>::infinity(), far = 0;
    for (int frame = frames.first; frame <= frames.last; ++frame) {
        const View drawn = camera.at(still_share(shot.settings.camera, frame - 1, count));
        pose.push_back(world_from_drawn * Pose{Quat(drawn.world_from_view), drawn.eye});
        const View view{pose.back().translation, pose.back().rotation.toRotationMatrix()};
        near = std::min(near, depth_range(seen, view).near);
        far = std::max(far, depth_range(all, view).far);
    }
    const Lens lens = lens_of(shot.settings);
    out.open("def Camera \"camera\"");
    out.value("float2 clippingRange", "", {frames.first}, [&](int) {
        out.vector<2>(Eigen::Vector2f(as_float(kBefore * near),
                                      as_float(far + kBehind * seen.size().norm())));
    });
    out.line(fmt::format(
        "float focalLength = {}\nfloat horizontalAperture = {}\ntoken projection = \"perspective\""
        "\nfloat verticalAperture = {}",
        as_float(kFilmWidth / (2 * lens.tangent_x)), as_float(kFilmWidth),
        as_float(kFilmWidth * lens.tangent_y / lens.tangent_x)));
    write_usd_poses(out, frames.first, pose);
    out.close();

    const double front = front_of(camera.at(0));
    const LightPlace& light = shot.settings.light;
    const Pose lamp =
        world_from_drawn *
        Pose{Quat(orbit_rotation(front + light.azimuth, light.elevation)), Vec3::Zero()};
    out.open("def DistantLight \"key_lamp\"");
    out.line(fmt::format(
        "float inputs:angle = {}\ncolor3f inputs:color = ({}, {}, {})\nfloat inputs:intensity = {}"
        "\nbool inputs:normalize = 1",
        as_float(2 * portable::atan(kLampSize) * 180 / kPi), as_float(kKeyLight[0]),
        as_float(kKeyLight[1]), as_float(kKeyLight[2]), as_float(kPi)));
    write_usd_poses(out, frames.first, {lamp});
    out.close();
}

}  // namespace swage

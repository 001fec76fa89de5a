// SPDX-License-Identifier: GPL-3.0-or-later
// A camera of USD looks along its own -z with y up, as one here does, and a distant light shines
// along its own -z (openusd.org, UsdGeomCamera, UsdLuxDistantLight).
#include "pipeline/usd_camera.h"

#include "base/portable_math.h"
#include "geometry/usd_time.h"
#include "render/studio.h"

namespace swage {

namespace {

// The film of a small camera is 36 mm wide; USD has lengths of cameras in tenths of its unit.
constexpr double kFilmWidth = 0.36;

float as_float(double value) { return static_cast<float>(value); }

}  // namespace

void write_usd_view(UsdText& out, const Shot& shot, int first_frame, const ViewTrack& view) {
    out.open("def Camera \"camera\"");
    out.value("float2 clippingRange", "", {first_frame}, [&](int) {
        out.vector<2>(Eigen::Vector2f(as_float(view.near), as_float(view.far)));
    });
    const Lens& lens = view.lens;
    out.line(fmt::format(
        "float focalLength = {}\nfloat horizontalAperture = {}\ntoken projection = \"perspective\""
        "\nfloat verticalAperture = {}",
        as_float(kFilmWidth / (2 * lens.tangent_x)), as_float(kFilmWidth),
        as_float(kFilmWidth * lens.tangent_y / lens.tangent_x)));
    write_usd_poses(out, first_frame, view.pose);
    out.close();

    const double front = front_of(shot.camera().at(0));
    const LightPlace& light = shot.settings.light;
    const Pose lamp =
        Pose{shot.drawn_from_world.conjugate(), Vec3::Zero()} *
        Pose{Quat(orbit_rotation(front + light.azimuth, light.elevation)), Vec3::Zero()};
    out.open("def DistantLight \"key_lamp\"");
    out.line(fmt::format(
        "float inputs:angle = {}\ncolor3f inputs:color = ({}, {}, {})\nfloat inputs:intensity = {}"
        "\nbool inputs:normalize = 1",
        as_float(2 * portable::atan(kLampSize) * 180 / kPi), as_float(kKeyLight[0]),
        as_float(kKeyLight[1]), as_float(kKeyLight[2]), as_float(kPi)));
    write_usd_poses(out, first_frame, {lamp});
    out.close();
}

}  // namespace swage

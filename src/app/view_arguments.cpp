// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/view_arguments.h"

#include <cmath>
#include <cstdlib>
#include <tuple>

#include "base/error.h"
#include "base/log.h"
#include "pipeline/render_record.h"
#include "render/camera_change.h"

namespace swage {

namespace {

constexpr const char* kAuto = "auto";

// An angle of the camera, or "auto".
CLI::Validator angle_or_auto(double low, double high) {
    return CLI::Validator(
        [low, high](const std::string& text) {
            if (text == kAuto) return std::string();
            char* end = nullptr;
            const double angle = std::strtod(text.c_str(), &end);
            if (text.empty() || *end != '\0' || !std::isfinite(angle)) {
                return "\"" + text + "\" is not an angle: give degrees, or auto";
            }
            return angle < low || angle > high
                       ? fmt::format("{} is out of range: give {:g} to {:g}, or auto", text, low,
                                     high)
                       : std::string();
        },
        "");
}

}  // namespace

const CLI::Validator kFinite(
    [](const std::string& text) {
        char* end = nullptr;
        const bool is_number =
            std::isfinite(std::strtod(text.c_str(), &end)) && !text.empty() && *end == '\0';
        return is_number ? std::string() : "\"" + text + "\" is not a finite number";
    },
    "");

void set_view(const ViewArguments& given, RenderSettings& settings) {
    constexpr double kDegree = kPi / 180;
    if (!given.size.empty()) std::tie(settings.width, settings.height) = parse_size(given.size);
    if (given.field_of_view) settings.field_of_view = *given.field_of_view * kDegree;
    const auto radians = [&](const std::optional<double>& degrees) {
        return degrees ? std::optional(*degrees * kDegree) : std::nullopt;
    };
    // As where nobody says: the usual one, which gives way to where more is seen.
    const auto angle = [&](const std::string& text, double usual, bool& open) {
        if (text.empty()) return std::optional<double>();
        open = text == kAuto;
        return std::optional(open ? usual : std::strtod(text.c_str(), nullptr) * kDegree);
    };
    const CameraKey usual;
    const auto place = [](const std::vector<double>& p) { return Vec3(p[0], p[1], p[2]); };
    CameraChange change{angle(given.azimuth, usual.azimuth, settings.open.azimuth),
                        angle(given.elevation, usual.elevation, settings.open.elevation),
                        given.zoom, radians(given.turn)};
    if (given.eye.empty() && !given.target.empty()) change.target = place(given.target);
    change.follows = given.follow;
    settings.follow = given.follow || (settings.follow && !given.no_follow && given.target.empty());
    if (change.any() && stands_at_eye(settings.camera)) {
        log_info("the camera options replace the scene's eye and target");
    }
    settings.camera = changed_camera(std::move(settings.camera), change);
    if (!given.eye.empty()) {
        settings.open = {};
        CameraKey key;
        key.eye = place(given.eye);
        key.target = place(given.target);
        if (key.eye == key.target) {
            fail(ExitCode::command_line, "--camera-eye and --camera-target are the same point");
        }
        settings.camera.assign(1, key);
    }
    if (!given.up.empty()) settings.up = up_named(given.up);
    if (!given.hide.empty()) settings.hide = given.hide;
    if (given.hide == std::vector<std::string>{"none"}) settings.hide.clear();
    if (given.light_azimuth) settings.light.azimuth = *given.light_azimuth * kDegree;
    if (given.light_elevation) settings.light.elevation = *given.light_elevation * kDegree;
}

void add_view_arguments(CLI::App& command, ViewArguments& given) {
    command
        .add_option(
            "--camera-azimuth", given.azimuth,
            "direction of the camera about the upward axis at the start of the film: 0 is +z and "
            "90 is +x, or with z up +x and +y. Motion from the scene (orbit, keys) starts from "
            "there. This and the next three options, or a target alone, replace an eye and target "
            "of the scene. auto: chosen as described by swage keys render.camera")
        ->check(angle_or_auto(-1e9, 1e9))
        ->type_name("DEG|auto");
    command
        .add_option(
            "--camera-elevation", given.elevation,
            "elevation of the camera throughout the film. Of azimuth and elevation, whatever "
            "neither the scene nor the command line gives is chosen as with auto")
        ->check(angle_or_auto(-90, 90))
        ->type_name("DEG|auto");
    command.add_option("--camera-zoom", given.zoom, "zoom throughout the film; 2 is twice as near")
        ->check(kFinite & CLI::Range(0.01, 1000.0));
    command
        .add_option("--camera-turn", given.turn,
                    "how far the camera turns during the film. Whole turns (360) keep a constant "
                    "pace and end one step short of the first still, so that the film loops")
        ->check(kFinite)
        ->type_name("DEG");
    CLI::Option* eye = command.add_option(
        "--camera-eye", given.eye,
        "position of the camera [m] throughout the film, in place of all options above and of the "
        "scene's camera; needs a target");
    CLI::Option* target =
        command.add_option("--camera-target", given.target,
                           "point that the camera looks at [m]: from the eye or, without one, from "
                           "the direction that the other options give and far enough away to show "
                           "the whole action");
    for (CLI::Option* place : {eye, target}) place->expected(3)->check(kFinite)->type_name("X Y Z");
    eye->needs(target);
    for (const char* other :
         {"--camera-azimuth", "--camera-elevation", "--camera-zoom", "--camera-turn"}) {
        eye->excludes(command.get_option(other));
    }
    CLI::Option* follow = command.add_flag("--camera-follow", given.follow,
                                           "let the camera go along with the bodies");
    follow->excludes(target);
    command.add_flag("--no-camera-follow", given.no_follow, "let it stand as it does without")
        ->excludes(follow);
    command.add_option("--camera-up", given.up, "axis that points upward in the pictures")
        ->check(CLI::IsMember(std::vector<std::string>(kUpName.begin() + 1, kUpName.end())));
    command
        .add_option("--light-azimuth", given.light_azimuth,
                    "direction of the lamp that casts the shadows, from the film's first view "
                    "toward its right (default: as in the scene, or -45.8)")
        ->check(kFinite)
        ->type_name("DEG");
    command
        .add_option("--light-elevation", given.light_elevation,
                    "elevation of the lamp (default: as in the scene, or 51.6)")
        ->check(kFinite & CLI::Range(5.0, 90.0))
        ->type_name("DEG");
    command.add_option("--field-of-view", given.field_of_view, "vertical field of view")
        ->check(kFinite & CLI::Range(1.0, 170.0))
        ->type_name("DEG");
    command
        .add_option("--hide", given.hide,
                    "names of tools, grips and blades that are left out, none: of none (default: "
                    "as in the scene); of repeated ones NAME hides all, NAME_2 the second")
        ->delimiter(',')
        ->type_name("LIST");
    command
        .add_option("--size", given.size, "size of a still in pixels (default: as in the scene)")
        ->type_name("WxH")
        ->each([](const std::string& text) { parse_size(text); });
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdlib>
#include <optional>
#include <tuple>
#include <vector>

#include "app/command.h"
#include "base/error.h"
#include "base/log.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "pipeline/draw.h"
#include "pipeline/render_directory.h"
#include "pipeline/render_record.h"
#include "pipeline/run_record.h"
#include "render/camera_change.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAuto = "auto";

struct RenderArguments {
    std::string run, out, size, frames, up, gl, background, color;
    std::vector<double> color_range;
    std::vector<std::string> passes;
    std::string azimuth, elevation;                        // degrees, or "auto"
    std::optional<double> zoom, turn, field_of_view;       // degrees
    std::optional<double> light_azimuth, light_elevation;  // likewise
    std::vector<double> eye, target;                       // [m]
    std::optional<int> frames_per_second;
    bool film = false, no_film = false, no_tools = false, no_ground = false, no_legend = false,
         json = false;
};

// As the run's scene says; what is given on the command line takes the place of that alone.
RenderSettings settings_of(const RenderArguments& given, const Json& record) {
    constexpr double kDegree = kPi / 180;
    RenderSettings settings = render_settings_of(record);
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
    if (change.any() && stands_at_eye(settings.camera)) {
        log_info("the scene's eye and target give way to the camera that is asked for");
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
    if (given.frames_per_second) settings.frames_per_second = *given.frames_per_second;
    if (given.light_azimuth) settings.light.azimuth = *given.light_azimuth * kDegree;
    if (given.light_elevation) settings.light.elevation = *given.light_elevation * kDegree;
    if (!given.background.empty()) settings.background = background_named(given.background);
    if (settings.background == Background::transparent && given.film) {
        fail(ExitCode::command_line,
             "--film: a film cannot be transparent; --background studio makes one that is not");
    }
    if (given.film) settings.film = true;
    if (given.no_film) settings.film = false;
    if (given.no_tools) settings.tools = false;
    if (given.no_ground) settings.ground = false;
    if (given.no_legend) settings.legend = false;
    if (!given.color.empty()) {
        const std::optional<SkinField> before = settings.color;
        settings.color = skin_field_named(given.color);
        if (settings.color != before) settings.color_range.reset();
    }
    if (!given.color_range.empty()) {
        if (!settings.color) fail(ExitCode::command_line, "--color-range needs --color");
        if (!(given.color_range[0] < given.color_range[1])) {
            fail(ExitCode::command_line, "--color-range: the first has to be less than the second");
        }
        settings.color_range = {given.color_range[0], given.color_range[1]};
    }
    if (!given.passes.empty()) settings.passes.clear();
    for (const std::string& name : given.passes) {
        const std::optional<PicturePass> pass = pass_named(name);
        if (pass && !settings.has(*pass)) settings.passes.push_back(*pass);
    }
    if (!given.gl.empty()) settings.gl = gl_named(given.gl);
    return settings;
}

int render(const RenderArguments& given) {
    const fs::path run = given.run;
    const Json record = record_of_run(run);
    const FrameStore store(RunDirectory::store_in(run));
    FrameRange frames{1, store.frame_count()};
    if (!given.frames.empty()) frames = parse_frame_range(given.frames, store.frame_count());

    // The run's own pictures stay what its scene says they are.
    const fs::path out = given.out.empty() ? RunDirectory::drawn_again(run) : fs::path(given.out);
    const RenderDirectory directory(out, given.out.empty());
    Stopwatch watch;
    const DrawOutcome drawn =
        draw_run(store, settings_of(given, record), frames, directory.files(), watch,
                 record.contains("bodies") ? run_names_of(record) : RunNames());
    const int removed = directory.remove_others(frames, drawn.film, drawn.passes);
    if (removed > 0) {
        log_info("{}: {} of an earlier drawing removed", out.string(),
                 counted(std::size_t(removed), "picture", "pictures"));
    }
    log_info("{}: done", out.string());
    if (given.json) {
        Json json = drawing_json(drawn);
        json["out"] = out.string();
        json["seconds"] = seconds_json(watch);
        put_json(json);
    }
    return 0;
}

// CLI::Range lets "nan" pass.
const CLI::Validator kFinite(
    [](const std::string& text) {
        char* end = nullptr;
        return std::isfinite(std::strtod(text.c_str(), &end)) ? std::string()
                                                              : text + " is no finite number";
    },
    "");

// An angle of the camera, or "auto".
CLI::Validator angle_or_auto(double low, double high) {
    return CLI::Validator(
        [low, high](const std::string& text) {
            if (text == kAuto) return std::string();
            char* end = nullptr;
            const double angle = std::strtod(text.c_str(), &end);
            if (text.empty() || *end != '\0' || !std::isfinite(angle)) {
                return "\"" + text + "\" is no angle: give degrees, or auto";
            }
            return angle < low || angle > high
                       ? fmt::format("{} is out of range: {:g} to {:g}, or auto", text, low, high)
                       : std::string();
        },
        "");
}

}  // namespace

void add_render_command(CLI::App& app, Action& chosen) {
    static RenderArguments given;
    CLI::App* command = add_command(
        app, "render", "Draw a finished run again, without simulating",
        "  swage render renders/calf-line --camera-azimuth 90 --size 1920x1080 --out /tmp/side\n"
        "  swage render renders/calf-line --frames 1 --no-film --no-tools\n"
        "  swage render renders/calf-line --camera-turn 360 --out /tmp/round\n"
        "  swage render renders/calf-line --passes depth,matte --out /tmp/layers\n"
        "  swage render renders/wrench-stress --color stress --color-range 0 300e6\n"
        "  swage render renders/calf-line --camera-eye 0.5 0.2 0.4 --camera-target 0 0.1 0\n",
        chosen, [] { return render(given); });
    command->add_option("run", given.run, "run directory")->required()->type_name("RUN");
    command
        ->add_option("--out", given.out,
                     "where to draw (default: RUN/again): a new or empty folder, or one that was "
                     "drawn into before, whose earlier pictures go")
        ->check(kSomewhere)
        ->type_name("DIR");
    command
        ->add_option(
            "--camera-azimuth", given.azimuth,
            "where the camera stands about the upward axis, at the film's start: 0 is +z "
            "and 90 +x, or with z up +x and +y. What the scene has it do from there on "
            "(orbit, keys) it does; an eye and target of the scene give way to this and "
            "the next three, and to a target alone. auto: chosen, as swage keys render.camera "
            "tells")
        ->check(angle_or_auto(-1e9, 1e9))
        ->type_name("DEG|auto");
    command
        ->add_option("--camera-elevation", given.elevation,
                     "how high it stands, all through the film. Of these two, what neither the "
                     "scene nor this gives is chosen as if auto stood here")
        ->check(angle_or_auto(-90, 90))
        ->type_name("DEG|auto");
    command->add_option("--camera-zoom", given.zoom, "2 is twice as near, all through the film")
        ->check(kFinite & CLI::Range(0.01, 1000.0));
    command
        ->add_option("--camera-turn", given.turn,
                     "how far it goes round during the film; whole turns (360) go at one pace, and "
                     "their last still is a step short of the first, so that the film can be shown "
                     "round and round")
        ->check(kFinite)
        ->type_name("DEG");
    CLI::Option* eye = command->add_option(
        "--camera-eye", given.eye,
        "where the camera stands [m], all through the film, instead of all these and of what the "
        "scene says of it; needs a target");
    CLI::Option* target =
        command->add_option("--camera-target", given.target,
                            "what it looks at [m], from the eye, or without one from where the "
                            "others say, as far away as what shows the whole action");
    for (CLI::Option* place : {eye, target}) place->expected(3)->check(kFinite)->type_name("X Y Z");
    eye->needs(target);
    for (const char* other :
         {"--camera-azimuth", "--camera-elevation", "--camera-zoom", "--camera-turn"}) {
        eye->excludes(command->get_option(other));
    }
    command->add_option("--camera-up", given.up, "what the pictures have upward")
        ->check(CLI::IsMember({"x", "y", "z"}));
    command
        ->add_option("--light-azimuth", given.light_azimuth,
                     "where the lamp stands that throws the shadows, from the film's first view "
                     "toward its right; -45.8 where the scene says nothing")
        ->check(kFinite)
        ->type_name("DEG");
    command
        ->add_option("--light-elevation", given.light_elevation,
                     "how high it stands; 51.6 where the scene says nothing")
        ->check(kFinite & CLI::Range(5.0, 90.0))
        ->type_name("DEG");
    command
        ->add_option("--background", given.background,
                     "transparent: stills with alpha, for compositing, of the ground only its "
                     "shadows; no film")
        ->check(CLI::IsMember(
            std::vector<std::string>(kBackgroundName.begin(), kBackgroundName.end())));
    command->add_option("--field-of-view", given.field_of_view, "vertical")
        ->check(kFinite & CLI::Range(1.0, 170.0))
        ->type_name("DEG");
    command->add_option("--size", given.size, "of a still in pixels (default: as the scene says)")
        ->type_name("WxH")
        ->each([](const std::string& text) { parse_size(text); });
    command
        ->add_option(
            "--frames", given.frames,
            "draw only the stills A to B, A, or A- to the end; 1 is the start. The pictures "
            "frame the whole run all the same")
        ->type_name("A-B")
        ->each([](const std::string& text) { parse_frame_range(text); });
    command
        ->add_option("--fps", given.frames_per_second,
                     "frames a second of the film (default: as the scene says)")
        ->check(CLI::Range(1, 240));
    command->add_option("--gl", given.gl, "library that draws")
        ->check(CLI::IsMember(std::vector<std::string>(kGlName.begin(), kGlName.end())));
    std::vector<std::string> colors = {"none"};
    for (const SkinFieldWords& words : kSkinFieldWords) colors.emplace_back(words.name);
    command
        ->add_option("--color", given.color,
                     "bodies by a field that the run holds ([output] fields in its scene), with a "
                     "scale; none: as they look (default: as the scene says)")
        ->check(CLI::IsMember(colors));
    command
        ->add_option("--color-range", given.color_range,
                     "the ends of that scale, stresses in Pa (default: of all frames, from 0 what "
                     "has no sign); one beyond which anything lies is an arrow")
        ->expected(2)
        ->check(kFinite)
        ->type_name("LOW HIGH");
    std::vector<std::string> passes = {"none"};
    passes.insert(passes.end(), kPassName.begin(), kPassName.end());
    command
        ->add_option(
            "--passes", given.passes,
            "files beside each still, for compositing, without blending at edges: depth "
            "(EXR, in metres along the view), matte (PNG, a colour for each body, tool and "
            "the ground, which mattes.json names), normal (EXR, by the world's axes); "
            "none: no such files (default: as the scene says)")
        ->delimiter(',')
        ->check(CLI::IsMember(passes))
        ->type_name("LIST");
    CLI::Option* film =
        command->add_flag("--film", given.film, "a film too, although the scene has film = false");
    command->add_flag("--no-film", given.no_film, "stills only")->excludes(film);
    command->add_flag("--no-tools", given.no_tools, "the work-piece alone");
    command->add_flag("--no-ground", given.no_ground, "no ground, and no floor that stands for it");
    command->add_flag("--no-legend", given.no_legend, "no scale of what --color shows");
    command->add_flag("--json", given.json, "print one JSON object");
}

}  // namespace swage

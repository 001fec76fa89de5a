// SPDX-License-Identifier: GPL-3.0-or-later
#include <vector>

#include "app/frame_arguments.h"
#include "app/view_arguments.h"
#include "base/error.h"
#include "base/log.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "pipeline/draw.h"
#include "pipeline/part_look.h"
#include "pipeline/render_directory.h"
#include "pipeline/render_record.h"
#include "pipeline/run_record.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

struct RenderArguments {
    std::string run, out, gl, background, color;
    ViewArguments view;
    FrameArguments frames;
    std::vector<double> color_range;
    std::vector<std::string> passes;
    bool film = false, no_film = false, no_tools = false, no_ground = false, no_legend = false,
         json = false;
};

// As the run's scene says; what is given on the command line takes the place of that alone.
RenderSettings settings_of(const RenderArguments& given, const Json& record) {
    RenderSettings settings = render_settings_of(record);
    set_view(given.view, settings);
    set_frames(given.frames, settings);
    if (!given.background.empty()) settings.background = background_named(given.background);
    if (settings.background == Background::transparent && given.film) {
        fail(ExitCode::command_line,
             "--film: a film cannot be transparent; use --background studio for an opaque one");
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
            fail(ExitCode::command_line, "--color-range: the first must be less than the second");
        }
        settings.color_range = {given.color_range[0], given.color_range[1]};
    }
    if (!given.passes.empty()) settings.passes.clear();
    for (const std::string& name : given.passes) {
        const std::optional<PicturePass> pass = pass_named(name);
        if (!pass && given.passes.size() > 1) {
            fail(ExitCode::command_line, "--passes: \"none\" stands alone");
        }
        if (pass && !settings.has(*pass)) settings.passes.push_back(*pass);
    }
    if (!given.gl.empty()) settings.gl = gl_named(given.gl);
    return settings;
}

int render(const RenderArguments& given) {
    const fs::path run = given.run;
    const Json record = record_of_run(run);
    const FrameStore store(RunDirectory::store_in(run));
    const RenderSettings settings = settings_of(given, record);
    refuse_unknown_parts(store, settings);
    const FrameRange frames = wanted_frames(given.frames, settings, store.frame_count());

    // The run's own pictures stay what its scene says they are.
    const fs::path out = given.out.empty() ? RunDirectory::drawn_again(run) : fs::path(given.out);
    const RenderDirectory directory(out, given.out.empty(), settings.first_frame);
    Stopwatch watch;
    const DrawOutcome drawn =
        draw_run(store, settings, frames, directory.files(), watch, run_names_of(record));
    const int removed = directory.remove_others(frames, drawn.film, drawn.passes);
    if (removed > 0) {
        log_info("{}: removed {} of an earlier drawing", out.string(),
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

}  // namespace

void add_render_command(CLI::App& app, Action& chosen) {
    static RenderArguments given;
    CLI::App* command = add_command(
        app, "render", "Draw a finished run again without simulating it",
        "  swage render renders/calf-line --camera-azimuth 90 --size 1920x1080 --out /tmp/side\n"
        "  swage render renders/calf-line --frames 1 --no-film --no-tools\n"
        "  swage render renders/calf-line --hide left,right --frames 1-40\n"
        "  swage render renders/calf-line --camera-turn 360 --out /tmp/round\n"
        "  swage render renders/calf-line --passes depth,matte --out /tmp/layers\n"
        "  swage render renders/calf-line --passes beauty,motion --first-frame 1001\n"
        "  swage render renders/wrench-stress --color stress --color-range 0 300e6\n"
        "  swage render renders/calf-line --camera-eye 0.5 0.2 0.4 --camera-target 0 0.1 0\n",
        chosen, [] { return render(given); });
    command->add_option("run", given.run, "run directory")->required()->type_name("RUN");
    command
        ->add_option("--out", given.out,
                     "folder to draw into (default: RUN/again): a new or empty one, or one that "
                     "was drawn into before, whose earlier pictures are removed")
        ->type_name("DIR");
    add_view_arguments(*command, given.view);
    command
        ->add_option("--background", given.background,
                     "transparent: stills with alpha for compositing, with only the shadows of the "
                     "ground; no film")
        ->check(CLI::IsMember(
            std::vector<std::string>(kBackgroundName.begin(), kBackgroundName.end())));
    add_frame_arguments(*command, given.frames);
    command->add_option("--gl", given.gl, "graphics library")
        ->check(CLI::IsMember(std::vector<std::string>(kGlName.begin(), kGlName.end())));
    std::vector<std::string> colors = {"none"};
    for (const SkinFieldWords& words : kSkinFieldWords) colors.emplace_back(words.name);
    command
        ->add_option("--color", given.color,
                     "colour bodies by a field that the run contains ([output] fields in its "
                     "scene), with a scale; none: their own look (default: as in the scene)")
        ->check(CLI::IsMember(colors));
    command
        ->add_option("--color-range", given.color_range,
                     "ends of that scale, stresses in Pa (default: the range over all frames, from "
                     "0 for unsigned fields); an arrow marks an end beyond which values lie")
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
            "the ground, which mattes.json names), normal (EXR, by the world's axes), "
            "motion (EXR, pixels to the next still and the one before, y up), piece (PNG, a "
            "colour for each piece of a body, which pieces.json names); blended as the still "
            "is: beauty (EXR, light before the tone curve, premultiplied); none: no such files "
            "(default: as the scene says)")
        ->delimiter(',')
        ->check(CLI::IsMember(passes))
        ->transform(CLI::Validator(
            [](std::string& name) {
                CLI::detail::trim(name);
                return std::string();
            },
            ""))
        ->type_name("LIST");
    CLI::Option* film =
        command->add_flag("--film", given.film, "make a film even if the scene has film = false");
    command->add_flag("--no-film", given.no_film, "make stills only")->excludes(film);
    command->add_flag("--no-tools", given.no_tools, "draw only the work-piece");
    command->add_flag("--no-ground", given.no_ground,
                      "draw no ground, nor a floor that serves as the ground");
    command->add_flag("--no-legend", given.no_legend, "draw no scale for --color");
    command->add_flag("--json", given.json, "print one JSON object");
}

}  // namespace swage

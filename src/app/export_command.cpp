// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/frame_arguments.h"
#include "app/view_arguments.h"
#include "base/error.h"
#include "base/log.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "pipeline/glb_export.h"
#include "pipeline/part_look.h"
#include "pipeline/render_record.h"
#include "pipeline/run_record.h"
#include "pipeline/usd_export.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

struct ExportArguments {
    std::string run, out;
    ViewArguments view;
    FrameArguments frames;
    bool no_tools = false, json = false;
};

ExportScene export_scene_of(const Json& record, const ExportArguments& given) {
    ExportScene scene;
    scene.render = render_settings_of(record);
    set_view(given.view, scene.render);
    set_frames(given.frames, scene.render);
    RunNames names = run_names_of(record);
    scene.name = fs::path(names.scene).stem().string();
    scene.body = std::move(names.body);
    scene.stage = std::move(names.stage);
    scene.piece = std::move(names.piece);
    return scene;
}

int export_run(const ExportArguments& given) {
    const fs::path run = given.run;
    ExportScene scene = export_scene_of(record_of_run(run), given);
    scene.tools = !given.no_tools;
    const fs::path file = given.out.empty() ? RunDirectory::exported(run) / (scene.name + ".usda")
                                            : fs::path(given.out);
    const bool as_glb = file.extension() == ".glb";
    if (!as_glb && file.extension() != ".usda") {
        fail(ExitCode::command_line, "{}: the name must end in .usda or .glb", file.string());
    }
    const FrameStore store(RunDirectory::store_in(run));
    refuse_unknown_parts(store, scene.render);
    const FrameRange frames = wanted_frames(given.frames, scene.render, store.frame_count());
    const int first_frame = scene.render.first_frame;
    Stopwatch watch;
    const ExportOutcome outcome = [&] {
        const auto lap = watch.lap("export");
        return (as_glb ? export_glb : export_usd)(store, scene, frames, file);
    }();
    log_info("{}: {}, {}, {}, {}", file.string(), counted(outcome.bodies, "body", "bodies"),
             counted(outcome.tools, "tool", "tools"),
             counted(std::size_t(frames.last - frames.first + 1), "frame", "frames"),
             bytes_text(double(outcome.bytes)));
    if (given.json) {
        Json json = {{"out", file.string()},
                     {"images", outcome.image},
                     {"bodies", outcome.bodies},
                     {"tools", outcome.tools},
                     {"frames", {frames.first, frames.last}},
                     {"bytes", outcome.bytes},
                     {"seconds", seconds_json(watch)}};
        if (first_frame != 1) json["first_frame"] = first_frame;
        put_json(json);
    }
    return 0;
}

}  // namespace

void add_export_command(CLI::App& app, Action& chosen) {
    static ExportArguments given;
    CLI::App* command = add_command(
        app, "export",
        "Write a finished run's animated skins and tools, and the camera of its stills, into one "
        "file: USD for Blender, Houdini, Maya, ..., or glTF for viewers, engines and web pages",
        "  swage export renders/calf-line\n"
        "  swage export renders/calf-line --frames 1-40 --out /tmp/bend.usda\n"
        "  swage export renders/calf-line --out calf.glb\n"
        "  swage export renders/calf-line --camera-azimuth 90 --size 1920x1080\n",
        chosen, [] { return export_run(given); });
    command->add_option("run", given.run, "run directory")->required()->type_name("RUN");
    command
        ->add_option(
            "-o,--out", given.out,
            "file to write (default: RUN/usd/SCENE.usda), in metres: every body with its materials "
            "and its place in every frame, tools by stage, the stills' camera. A .usda is USD as "
            "text, with key_lamp and fields, and images beside it; a .glb is binary glTF, with "
            "images in it. An earlier export of that name is replaced")
        ->type_name("FILE");
    add_frame_arguments(*command, given.frames);
    add_view_arguments(*command, given.view);
    command->add_flag("--no-tools", given.no_tools,
                      "leave out tools, grips and blades, which are otherwise included where the "
                      "stills show them");
    command->add_flag("--json", given.json, "print one JSON object");
}

}  // namespace swage

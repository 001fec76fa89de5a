// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command.h"
#include "app/scene_argument.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "pipeline/cost.h"
#include "pipeline/run.h"

namespace swage {

namespace {

struct RunArguments {
    SceneArgument scene;
    std::string out, frames, keep_every;
    bool no_render = false, fresh = false, go_on = false, force = false, json = false;
};

RunOptions options_of(const RunArguments& given, const SceneSpec& scene) {
    RunOptions options;
    if (!given.frames.empty()) {
        options.frames =
            parse_frame_range(given.frames, frame_count(scene), scene.render.first_frame);
    }
    options.out = given.out.empty() ? std::filesystem::path("renders") / scene.name
                                    : std::filesystem::path(given.out);
    options.overrides = given.scene.overrides;
    options.draw = !given.no_render;
    options.earlier = given.fresh   ? EarlierRun::replace
                      : given.go_on ? EarlierRun::extend
                                    : EarlierRun::finish;
    options.insist = given.force;
    if (!given.keep_every.empty()) {
        options.keep_every = parse_quantity(given.keep_every, Quantity::time);
    }
    return options;
}

// Wherever the run is repeated from, it says the same.
std::string text_for_record(Mistake warning) {
    warning.warning = false;
    if (warning.line > 0) warning.file = warning.file.filename();
    return mistake_text(warning);
}

int run(const RunArguments& given) {
    const SceneReading reading = read_scene_argument(given.scene);
    log_mistakes(reading.mistakes);
    // Of a run that did not begin.
    const auto tell_why_not = [&](const std::exception& why) {
        std::vector<Mistake> mistakes = reading.mistakes;
        if (reading.scene) {
            const std::vector<Mistake> late = mistakes_of(why, given.scene);
            mistakes.insert(mistakes.end(), late.begin(), late.end());
        }
        put_json({{"file", given.scene.file}, {"mistakes", mistakes_json(mistakes)}});
    };
    Json record;
    try {
        const SceneSpec& scene = scene_of(reading, given.scene);
        RunOptions options = options_of(given, scene);
        for (const Mistake& one : reading.mistakes) {
            if (one.warning) options.warnings.push_back(text_for_record(one));
        }
        record = run_scene(scene, options);
    } catch (const StoppedRun& stopped) {
        if (given.json) put_json(stopped.record);
        throw;
    } catch (const InterruptedRun& interrupted) {
        if (given.json) put_json(interrupted.record);
        throw;
    } catch (const Error& error) {
        if (given.json) tell_why_not(error);
        throw;
    } catch (const Interrupted& interrupted) {
        if (given.json) tell_why_not(interrupted);
        throw;
    }
    if (given.json) put_json(record);
    return 0;
}

}  // namespace

void add_run_command(CLI::App& app, Action& chosen) {
    static RunArguments given;
    CLI::App* command = add_command(
        app, "run",
        "Run a scene: from the mesh through matter and machines to skin, stills and film",
        "  swage run assets/scenes/calf-line.toml\n"
        "  swage run assets/scenes/bar-springback.toml --out /tmp/soft --set material.name=copper\n"
        "  swage run assets/scenes/rod-cut.toml --no-render --json --quiet\n",
        chosen, [] { return run(given); });
    add_scene_argument(*command, given.scene);
    command->add_option("--out", given.out, "run directory (default: renders/NAME-OF-SCENE)")
        ->type_name("DIR");
    command
        ->add_option("--frames", given.frames,
                     "draw only the stills A to B, A, or A- to the end; 1, or what "
                     "first_frame says, is the start")
        ->type_name("A-B")
        ->each([](const std::string& text) { parse_frame_range(text); });
    command->add_flag("--no-render", given.no_render,
                      "draw no pictures; OpenGL is then not needed");
    CLI::Option* fresh = command->add_flag(
        "--fresh", given.fresh,
        "delete what an earlier run left in the directory, once this one is set up");
    command
        ->add_flag(
            "--go-on", given.go_on,
            "if the scene has changed since the run in the directory: keep its first stages, up to "
            "the last finished one that is unaffected, and run the others again. A complete run "
            "stays in DIR/replaced until the new one is complete")
        ->excludes(fresh);
    command
        ->add_option("--keep-every", given.keep_every,
                     "save the state to resume from at the end of the first frame that comes this "
                     "long after the last save (\"10 min\"; default: when saving takes at most a "
                     "fiftieth of the time)")
        ->check([](const std::string& text) -> std::string {
            try {
                return parse_quantity(text, Quantity::time) >= 0 ? "" : "is less than 0";
            } catch (const std::exception& error) {
                return error.what();
            }
        })
        ->type_name("TIME");
    command->add_flag(
        "--force", given.force,
        "run even if the scene seems to need more memory, disk or time than there is");
    command->add_flag("--json", given.json,
                      "print the run's record to stdout, even if the run stopped or was "
                      "interrupted; if it could not "
                      "start, print why as `swage check` does");
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "app/command.h"
#include "app/lines.h"
#include "app/scene_argument.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/text.h"
#include "base/whole.h"
#include "pipeline/accuracy.h"
#include "pipeline/body_look.h"
#include "pipeline/cost.h"
#include "pipeline/draw.h"
#include "pipeline/folded_bodies.h"
#include "pipeline/run_record.h"

namespace swage {

namespace {

constexpr double kMuchMore = 1.2;    // memory
constexpr int kAnyDraws = 4096;      // pixels of a side, whatever draws
constexpr double kLeastCells = 1.5;  // of a part whose stiffness the measured table tells

struct CheckArguments {
    SceneArgument scene;
    bool json = false;
};

// Of the mold, with which what is `cells` thick now comes within 1 %.
int across_for_percent(const BodyCost& body, double cells) {
    constexpr double kRounding = 1e-9;
    return to_int(
        std::ceil(accuracy_at(cells).cells_for_percent * body.across / cells - kRounding));
}

std::string stiffness_text(const BodyCost& body, double cells) {
    const std::string enough = fmt::format("1 % at across = {}", across_for_percent(body, cells));
    if (cells < kLeastCells) return "too few cells; " + enough;
    const Accuracy accuracy = accuracy_at(cells);
    return fmt::format("within about {:.2g} % in bending, {:.2g} % in torsion; {}",
                       100 * accuracy.bending, 100 * accuracy.torsion, enough);
}

constexpr const char* kOfSprings =
    "springs are right in stretching only; they are too stiff in bending and torsion";

std::vector<std::string> accuracy_texts(const BodySpec& spec, const BodyCost& body) {
    if (spec.material.mechanics != Mechanics::cells) return {kOfSprings};
    std::vector<std::string> texts;
    if (body.has_thin_parts()) {
        texts = {fmt::format("elastic stiffness of the whole, {:.3g} cells across, where thin "
                             "parts stretch and shear (a tube that is bent or twisted): {}",
                             body.across, stiffness_text(body, body.across)),
                 fmt::format("elastic stiffness where thin parts, about {:.2g} cells thick, bend "
                             "by themselves (a ring squeezed flat, a bracket): {}",
                             body.thickness, stiffness_text(body, body.thickness))};
    } else {
        texts = {fmt::format("elastic stiffness of a part {:.3g} cells thick: {}", body.thickness,
                             stiffness_text(body, body.thickness))};
    }
    if (!spec.inset.empty()) texts.push_back("that is of one material, without its insets");
    if (const int layers = body.whole_layers(); layers > 0) {
        texts.push_back(
            fmt::format("the thinnest side is {:.3g} cells, so its outermost layers are filled to "
                        "{:.2g}: across = {} or spacing = \"{}\" gives whole layers",
                        body.across, body.outermost_fill(), layers,
                        length_text(body.spacing * body.across / layers)));
    }
    for (const Material* material : spec.materials()) {
        if (!std::isfinite(material->yield_stress)) continue;
        texts.push_back(
            "permanent deformation is less accurate than that, and far less near a limit load");
        break;
    }
    return texts;
}

Json accuracy_json(const BodySpec& spec, const BodyCost& body, double cells) {
    if (spec.material.mechanics != Mechanics::cells) {
        return {{"of", "elastic stiffness"},
                {"cells", cells},
                {"bending", nullptr},
                {"torsion", nullptr},
                {"note", kOfSprings}};
    }
    const Accuracy accuracy = accuracy_at(cells);
    return {{"of", "elastic stiffness"},
            {"cells", cells},
            {"without_insets", !spec.inset.empty()},
            {"bending", accuracy.bending},
            {"torsion", accuracy.torsion},
            {"across_for_percent", across_for_percent(body, cells)}};
}

std::string range_text(const CostRange& range, std::string (*text)(double)) {
    if (range.is_narrow()) return "about " + text(range.middle());
    return text(range.least) + " to " + text(range.most);
}

bool says(const SceneSpec& scene, std::size_t stage, std::string_view key) {
    const std::string whole = fmt::format("stage.{}.{}", stage + 1, key);
    return std::any_of(scene.said.begin(), scene.said.end(),
                       [&](const Said& one) { return one.key == whole; });
}

// Why a stage has its solver where the scene does not name it; empty: it does.
std::string why_solver(const SceneSpec& scene, std::size_t n) {
    if (says(scene, n, "solver")) return {};
    const StageSpec& stage = scene.stage[n];
    if (!in_motion(stage.sim.solver)) return "nothing asks for motion";
    if (scene.body.size() > 1) return "there are several bodies";
    if (scene.work_piece().start.moves()) {
        return scene.work_piece().name + " starts with a velocity or spin";
    }
    return fmt::format("machine {} is for motion", stage.machine.name);
}

double slower_than_real(const SceneSpec& scene, const StageSpec& stage) {
    return double(stage.frames) / scene.render.frame_rate.value() / stage.duration;
}

// How fast the film plays a stage that takes the time that it says.
std::string film_text(const SceneSpec& scene, const StageSpec& stage) {
    const double slower = slower_than_real(scene, stage);
    const auto times = [](double ratio) {
        return (ratio < 100 ? fmt::format("{:.3g}", ratio) : count_text(ratio)) + " times";
    };
    const std::string speed = std::abs(slower - 1) < 0.01 ? "in real time"
                              : slower > 1                ? times(slower) + " slower than real time"
                                           : times(1 / slower) + " faster than real time";
    return fmt::format("{} at {} fps show its {} {}",
                       counted(std::size_t(stage.frames), "frame", "frames"),
                       frame_rate_text(scene.render.frame_rate),
                       quantity_text(stage.duration, Quantity::time), speed);
}

void add_matter(Lines& lines, const SceneSpec& scene, const std::vector<InputMesh>& input,
                const RunCost& cost) {
    const char* about = cost.counted ? "" : "about ";
    const std::vector<std::string> name = body_names(scene);
    const auto each = [&](const char* what, const auto& value) {
        std::vector<std::vector<std::string>> texts;
        for (std::size_t b = 0; b < scene.body.size(); ++b) texts.push_back(value(b));
        for (const FoldedText& one : folded(texts)) {
            const bool is_work_piece = one.body.back() == 0;
            const bool is_one = one.body.size() == 1;
            lines.add(what, is_work_piece ? one.text
                                          : fmt::format("{}{}: {}", bodies_text(name, one.body),
                                                        is_one ? "" : ", each", one.text));
        }
    };
    using Texts = std::vector<std::string>;
    each("mesh", [&](std::size_t b) { return Texts{summary_line(input[b].report)}; });
    each("cells", [&](std::size_t b) {
        return Texts{fmt::format("{}{} of {}", about, count_text(cost.body[b].cells),
                                 length_text(cost.body[b].spacing))};
    });
    lines.add("particles", about + count_text(cost.mold.particles));
    lines.add("connections", about + count_text(cost.mold.connections));
    each("accuracy", [&](std::size_t b) { return accuracy_texts(scene.body[b], cost.body[b]); });
    if (cost.tool_give > 0) {
        const double thickness = cost.work_piece().thickness;
        lines.add("tools",
                  fmt::format("each tool's surface gives way like up to {:.2g} cells of "
                              "the work-piece, {:.2g} % of a part {:.3g} cells thick",
                              cost.tool_give, 100 * cost.tool_give / thickness, thickness));
    }
    for (const std::string& strength : cost.warning.strength) lines.add("strength", strength);
    each("look", [&](std::size_t b) {
        if (!hides_material(scene.body[b], input[b].mesh)) return Texts{};
        return Texts{"as in the mesh file; look = \"material\" shows the material's"};
    });
}

void add_stages(Lines& lines, const SceneSpec& scene, const RunCost& cost) {
    lines.add("stages", std::to_string(scene.stage.size()));
    for (std::size_t n = 0; n < scene.stage.size(); ++n) {
        const std::string whose = scene.stage.size() == 1 ? "" : scene.stage[n].name + ": ";
        const std::string why = why_solver(scene, n);
        lines.add("solver",
                  whose + name_of(scene.stage[n].sim.solver) + (why.empty() ? "" : ", as " + why));
        if (scene.stage[n].sim.self_contact && !says(scene, n, "self_contact")) {
            lines.add(
                "pieces",
                whose + "meet each other, as a blade cuts; self_contact = false: they do not");
        }
    }
    for (const MachinePlace& place : cost.place) {
        const bool is_later = &place != &cost.place.front();
        const std::string whose = cost.place.size() == 1 ? "" : place.stage + ": ";
        const std::string when = is_later ? " (for the work-piece before the first stage)" : "";
        if (!place.axes.empty()) lines.add("axes", whose + place.axes + when);
        if (!place.tools.empty()) lines.add("side", whose + place.tools + when);
        for (const std::string& load : place.load) lines.add("load", whose + load + when);
        for (const std::string& push : place.push) lines.add("load", whose + push + when);
        for (const std::string& limit : place.limit) lines.add("limit", whose + limit);
    }
    lines.add("frames", count_text(cost.frames));
    for (const StageSpec& stage : scene.stage) {
        if (!in_motion(stage.sim.solver)) continue;
        const std::string whose = scene.stage.size() == 1 ? "" : stage.name + ": ";
        lines.add("film", whose + film_text(scene, stage));
    }
}

std::string cost_text(const SceneSpec& scene, const std::vector<InputMesh>& input,
                      const RunCost& cost, bool is_refused) {
    Lines lines(scene.name + ": no mistakes" + (is_refused ? ", but it cannot run here" : ""));
    add_matter(lines, scene, input, cost);
    add_stages(lines, scene, cost);
    lines.add("steps", range_text(cost.steps, count_text));
    const bool may_crumble = cost.most_memory_bytes > kMuchMore * cost.memory_bytes;
    lines.add("memory", fmt::format("about {}, of which the matter takes {}{}",
                                    bytes_text(cost.memory_bytes), bytes_text(cost.mold.bytes),
                                    may_crumble ? fmt::format("; up to {} if all of it breaks to "
                                                              "rubble",
                                                              bytes_text(cost.most_memory_bytes))
                                                : ""));
    lines.add("disk", fmt::format("{} to {}, by what stills show and what is kept to go on from",
                                  bytes_text(cost.least_disk_bytes), bytes_text(cost.disk_bytes)));
    lines.add("time", range_text(cost.seconds, seconds_text) +
                          (cost.hangs_on.empty() ? "" : ", depending on " + cost.hangs_on));
    for (const std::string& note : cost.note) lines.add("note", note);
    for (const std::string& note : later_notes(cost.place)) lines.add("note", note);
    return lines.text();
}

// Counts of what there is in whole numbers.
Json with_whole_counts(Json cost) {
    constexpr double kMost = 9e18;
    const auto round = [](Json& in, const char* key) {
        const double value = in.at(key).get<double>();
        if (std::abs(value) < kMost) in[key] = std::llround(value);
    };
    for (const char* key : {"cells", "particles", "connections", "matter_bytes", "memory_bytes",
                            "memory_bytes_most", "memory_bytes_undrawn", "disk_bytes_least",
                            "disk_bytes", "steps", "steps_least", "steps_most"}) {
        round(cost, key);
    }
    for (Json& body : cost.at("bodies")) round(body, "cells");
    return cost;
}

Json stages_json(const SceneSpec& scene, const RunCost& cost) {
    Json stages = places_json(cost.place);  // empty where nothing has been molded
    for (std::size_t n = 0; n < scene.stage.size(); ++n) {
        const StageSpec& stage = scene.stage[n];
        Json& json = stages[n];
        json["name"] = stage.name;
        json["solver"] = name_of(stage.sim.solver);
        if (const std::string why = why_solver(scene, n); !why.empty()) {
            json["solver_chosen_as"] = why;
        }
        json["self_contact"] = stage.sim.self_contact;
        if (!in_motion(stage.sim.solver)) continue;
        json["film"] = {{"frames", stage.frames},
                        {"frame_rate", scene.render.frame_rate.value()},
                        {"duration_s", stage.duration},
                        {"slower", slower_than_real(scene, stage)}};
    }
    return stages;
}

// As `run` refuses, by sizes alone, or what is known of it better.
std::optional<Error> refusal_of(const SceneSpec& scene, const std::vector<InputMesh>& input,
                                const RunCost& counted, const RunOptions& options) {
    try {
        refuse_excess(estimate_cost(scene, input, options), options);
        refuse_excess(counted, options);
        const RenderSettings& render = scene.render;
        if (std::max(render.width, render.height) > kAnyDraws) check_drawing(render);
    } catch (const Error& error) {
        return error;
    }
    return std::nullopt;
}

// Of the work-piece as "accuracy", of bodies beside it in their list; strengths of all in one.
void add_accuracy(const SceneSpec& scene, const RunCost& cost, Json& json) {
    for (std::size_t b = 0; b < scene.body.size(); ++b) {
        const BodySpec& spec = scene.body[b];
        const BodyCost& body = cost.body[b];
        Json& whole = b == 0 ? json : json["bodies"][spec.name];
        whole["accuracy"] = accuracy_json(spec, body, body.thickness);
        if (body.has_thin_parts() && spec.material.mechanics == Mechanics::cells) {
            whole["accuracy_of_whole"] = accuracy_json(spec, body, body.across);
        }
        for (const Material* of : spec.materials()) {
            const Resolved strength = resolved_strength(*of, body.spacing, body.across);
            if (strength.whole()) continue;
            const Json one = {{"body", spec.name},
                              {"material", of->name},
                              {"resolved_Pa", strength.strength},
                              {"across_for_whole", strength.cells_for_whole}};
            Json& told = json["strength"];
            if (std::find(told.begin(), told.end(), one) == told.end()) told.push_back(one);
        }
    }
}

int check(const CheckArguments& given) {
    const SceneReading reading = read_scene_argument(given.scene);
    Json json = {{"file", given.scene.file}, {"mistakes", mistakes_json(reading.mistakes)}};
    if (!given.json) log_mistakes(reading.mistakes);
    const ExitCode code = exit_code(reading.mistakes);
    if (code != ExitCode::done || !reading.scene) {
        if (given.json) put_json(json);
        return static_cast<int>(code);
    }
    const auto tell_why_not = [&](const std::exception& why) {
        std::vector<Mistake> mistakes = reading.mistakes;
        for (Mistake& late : mistakes_of(why, given.scene)) mistakes.push_back(std::move(late));
        json["mistakes"] = mistakes_json(mistakes);
        put_json(json);
    };
    RunOptions options;
    options.out = ".";
    try {
        const std::vector<InputMesh> input = read_input_meshes(*reading.scene);
        const RunCost cost = count_cost(*reading.scene, input, options);
        const std::optional<Error> refusal = refusal_of(*reading.scene, input, cost, options);
        for (const InputMesh& one : input) json["meshes"].push_back(mesh_json(one));
        json["cost"] = with_whole_counts(cost_json(cost));
        json["stages"] = stages_json(*reading.scene, cost);
        add_accuracy(*reading.scene, cost, json);
        if (!given.json) {
            for (const auto* untold : {&cost.warning.mold, &cost.warning.bodies}) {
                for (const std::string& warning : *untold) log_warning("{}", warning);
            }
            if (log_level() != LogLevel::quiet) {
                put_out(cost_text(*reading.scene, input, cost, refusal.has_value()));
            }
        }
        if (refusal) throw Error(*refusal);
    } catch (const Error& error) {
        if (!given.json) throw;
        tell_why_not(error);
        return static_cast<int>(error.code());
    } catch (const Interrupted& interrupted) {
        if (given.json) tell_why_not(interrupted);
        throw;
    }
    if (given.json) put_json(json);
    return 0;
}

}  // namespace

void add_check_command(CLI::App& app, Action& chosen) {
    static CheckArguments given;
    CLI::App* command =
        add_command(app, "check", "Report every mistake in a scene and what running it will cost",
                    "  swage check assets/scenes/calf-line.toml\n"
                    "  swage check assets/scenes/calf-line.toml --set mold.across=12 --json\n",
                    chosen, [] { return check(given); });
    add_scene_argument(*command, given.scene);
    command->add_flag("--json", given.json, "print one JSON object");
}

}  // namespace swage

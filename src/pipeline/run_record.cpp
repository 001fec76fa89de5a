// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_record.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/process.h"
#include "base/text.h"
#include "pipeline/given_record.h"
#include "pipeline/render_record.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr int kRecordFormat = 2;  // more, once a key goes or means something else

Json box_json(const Box& box) {
    if (box.empty()) return nullptr;
    return {{"low", {box.low[0], box.low[1], box.low[2]}},
            {"high", {box.high[0], box.high[1], box.high[2]}}};
}

}  // namespace

Json mesh_json(const InputMesh& input) {
    Json parts = Json::array(), materials = Json::array();
    for (const std::string& name : input.mesh.part_name) parts.push_back(name);
    for (const SurfaceMaterial& material : input.mesh.material) {
        materials.push_back({{"name", material.name}, {"texture", material.texture.string()}});
    }
    return {{"vertices", input.mesh.position.size()},
            {"triangles", input.mesh.triangle.size()},
            {"components", input.report.components},
            {"watertight", input.report.watertight},
            {"manifold", input.report.manifold},
            {"volume_m3", input.report.volume},
            {"area_m2", input.report.area},
            {"box_m", box_json(input.report.box)},
            {"uv", !input.mesh.uv.empty()},
            {"vertex_colors", !input.mesh.position_color.empty()},
            {"parts", parts},
            {"materials", materials},
            {"scale", input.scale},
            {"summary", summary_line(input.report)},
            {"findings", input.finding},
            {"repair", input.repair}};
}

Json matter_json(const Aggregate& matter) {
    return {{"spacing_m", matter.lattice.spacing},
            {"cells", matter.cell_fill.size()},
            {"particles", matter.particle_count()},
            {"connections", matter.connection_count()},
            {"volume_m3", matter.volume()},
            {"mass_kg", matter.mass()},
            {"bytes", matter.bytes()}};
}

Json drawing_json(const DrawOutcome& drawing) {
    Json json = {{"renderer", drawing.renderer},
                 {"size", {drawing.width, drawing.height}},
                 {"frames", {drawing.frames.first, drawing.frames.last}},
                 {"film", drawing.film},
                 {"ffmpeg", program_exists("ffmpeg")},
                 {"warnings", drawing.warning}};
    if (drawing.first_frame != 1) json["first_frame"] = drawing.first_frame;
    if (drawing.view) {
        json["view"] = {{"azimuth", drawing.view->camera.front().azimuth},
                        {"elevation", drawing.view->camera.front().elevation},
                        {"seen", drawing.view->seen},
                        {"seen_before", drawing.view->seen_before}};
        if (!drawing.view->hiding.empty()) json["view"]["hiding"] = drawing.view->hiding;
    }
    if (!drawing.passes.empty()) json["passes"] = passes_json(drawing.passes);
    if (drawing.color) {
        json["color"] = words_of(*drawing.color).name;
        json["color_range"] = drawing.color_range;
    }
    return json;
}

Json seconds_json(const Stopwatch& watch) {
    Json json = Json::object();
    for (const auto& [phase, seconds] : watch.phases()) {
        json[phase] = std::round(seconds * 1e3) / 1e3;
    }
    return json;
}

bool is_simulated(const Json& record) {
    const Json& state = record.at("state");
    return state == RunState::simulated || state == RunState::complete;
}

Json begin_record(const SceneSpec& scene, const RunOptions& options, const RunIdentity& identity,
                  const std::vector<InputMesh>& input) {
    Json record;
    record["program"] = "swage";
    record["format"] = kRecordFormat;
    record["version"] = identity.version;
    record["build"] = identity.build;
    record["state"] = RunState::begun;
    record["scene"] = (scene.piped ? scene.file.filename() : scene.file).string();
    record["overrides"] = options.overrides;
    record["warnings"] = options.warnings;
    for (const RunInput& one : identity.input) {
        record["inputs"].push_back(
            {{"role", one.role}, {"file", one.file.string()}, {"hash", one.hash}});
    }
    record["threads"] = thread_count();
    for (std::size_t b = 0; b < input.size(); ++b) {
        const BodySpec& body = scene.body[b];
        Json materials = Json::array();  // the body's own first, then those of its insets
        for (const Material* one : body.materials()) materials.push_back(material_json(*one));
        Json insets = Json::array();  // where they are
        for (const InsetSpec& one : body.inset) insets.push_back(inset_json(one));
        record["bodies"].push_back({{"name", body.name},
                                    {"mesh", mesh_json(input[b])},
                                    {"mold", mold_json(body.mold)},
                                    {"start", start_json(body.start)},
                                    {"materials", materials},
                                    {"insets", insets}});
    }
    record["skin"] = skin_json(scene.skin);
    record["render"] = render_json(scene.render);
    return record;
}

std::vector<std::string> warnings_in(const Json& record) {
    std::vector<std::string> all;
    const auto add = [&](const Json& of) {
        for (const Json& one : of.value("warnings", Json::array())) all.push_back(one);
    };
    add(record);
    for (const char* part : {"plots", "drawing"}) add(record.value(part, Json::object()));
    return all;
}

void write_record(const RunDirectory& directory, Json& record, const Stopwatch& watch) {
    record["seconds"].update(seconds_json(watch));
    write_file_whole(directory.record(), json_text(record));
}

std::optional<Json> read_record(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    const std::string text = record_text(file, ExitCode::output);
    try {
        Json json = parse_json(text);
        if (json.is_object() && json.contains("state")) return json;
    } catch (const Json::exception&) {  // no record
    }
    return std::nullopt;
}

Json record_of_run(const fs::path& run) {
    std::error_code error;
    if (!fs::exists(run, error)) fail(ExitCode::output, "{}: no such folder", run.string());
    std::optional<Json> record = read_record(RunDirectory::record_in(run));
    // One that goes on from an earlier one has its frames already.
    const bool has_frames = fs::exists(RunDirectory::store_in(run), error);
    if (!record || (record->at("state") == RunState::begun && !has_frames))
        fail(ExitCode::output, "{}: is not a finished run of swage", run.string());
    return *std::move(record);
}

RunNames run_names_of(const Json& record) {
    RunNames names;
    try {
        names.scene = record.at("scene");
        for (const Json& body : record.at("bodies")) names.body.push_back(body.at("name"));
        const Json stages = record.value("stages", Json::array());
        for (const Json& stage : stages) {
            names.stage.push_back({stage.at("name"), stage.at("frames").at(1)});
        }
        if (!stages.empty() && stages.back().contains("skin_pieces")) {
            const Json& pieces = stages.back().at("skin_pieces");
            // They are told of the meshes that it left.
            const int last = stages.back().value("unfinished_frame", names.stage.back().last);
            for (const std::string& body : names.body) {
                names.piece.push_back({last, {}});
                for (const Json& piece : pieces.value(body, Json::array())) {
                    // Of format 1 it is a triangle of its largest shell alone.
                    names.piece.back().triangle.push_back(piece.is_array()
                                                              ? piece.get<std::vector<int>>()
                                                              : std::vector{piece.get<int>()});
                }
            }
        }
    } catch (const Json::exception&) {
        fail(ExitCode::output,
             "run.json does not say what bodies and stages the run has; run it again with --fresh");
    }
    return names;
}

bool is_drawn(const Json& record, const DrawnFiles& files, const FrameRange& frames,
              const RenderSettings& settings) {
    try {
        if (record.at("state") != RunState::complete || !record.contains("drawing")) return false;
        const Json& drawing = record.at("drawing");
        if (drawing.at("frames").at(0).get<int>() > frames.first ||
            drawing.at("frames").at(1).get<int>() < frames.last) {
            return false;
        }
        std::error_code error;
        for (int f = frames.first; f <= frames.last; ++f) {
            if (!fs::exists(files.still(f), error)) return false;
            for (const PicturePass pass : settings.passes) {
                if (!fs::exists(files.pass(f, pass), error)) return false;
            }
        }
        for (const PicturePass pass : settings.passes) {
            if (is_colored(pass) && !fs::exists(files.table(pass), error)) return false;
        }
        // What ffmpeg failed to make once is not tried again.
        const bool may_come = drawing.at("film").get<bool>() ||
                              (!drawing.at("ffmpeg").get<bool>() && program_exists("ffmpeg"));
        return fs::exists(files.contact_sheet(), error) &&
               (!settings.has_film() || !may_come || fs::exists(files.film(), error));
    } catch (const Json::exception&) {
        return false;
    }
}

}  // namespace swage

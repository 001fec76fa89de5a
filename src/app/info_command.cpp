// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command.h"
#include "app/lines.h"
#include "base/error.h"
#include "base/text.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_numbered.h"
#include "geometry/mesh_repair.h"
#include "pipeline/bend_watch.h"
#include "pipeline/run_record.h"
#include "pipeline/use_watch.h"

namespace swage {

namespace {

struct InfoArguments {
    std::string file;
    bool json = false;
};

std::string yes_no(bool value) { return value ? "yes" : "no"; }

// What a run makes of a mesh that bounds no volume, or a wrong one.
std::vector<std::string> repairs_of(const InputMesh& input) {
    if (input.report.is_one_body()) return {};
    try {
        Repair repair = repair_mesh(input.mesh);
        if (repair.account.empty()) return {};
        repair.account.push_back("then: " + summary_line(check_mesh(repair.mesh)));
        return repair.account;
    } catch (const Error& error) {
        return {fmt::format("refuses this mesh: {}", error.what())};
    }
}

// Pieces that touch, as after a cut, are manifold only where places that coincide stay apart.
bool is_manifold_as_numbered(const std::string& file, const MeshReport& welded) {
    if (welded.manifold) return true;
    const MeshReport own = check_mesh(read_as_numbered(file));
    return own.watertight && own.manifold;
}

std::string text_of(const std::string& file, const InputMesh& input, bool is_manifold,
                    const std::vector<std::string>& repairs) {
    const MeshReport& report = input.report;
    const Vec3 size = report.box.empty() ? Vec3::Zero().eval() : report.box.size();
    Lines lines(file);
    lines.add("vertices", count_text(static_cast<double>(report.vertices)));
    lines.add("triangles", count_text(static_cast<double>(report.triangles)));
    lines.add("components", std::to_string(report.components));
    lines.add("watertight", yes_no(report.watertight));
    const bool differs = is_manifold != report.manifold;
    lines.add("manifold", yes_no(is_manifold) + (differs ? ", going by its vertex numbers" : ""));
    if (differs) lines.add("by place", "not manifold");
    lines.add("oriented", yes_no(report.oriented));
    lines.add("volume", report.bounds_a_volume() ? volume_text(report.volume) : "none enclosed");
    lines.add("area", area_text(report.area));
    lines.add("box", fmt::format("{} x {} x {}", length_text(size[0]), length_text(size[1]),
                                 length_text(size[2])));
    lines.add("uv", yes_no(report.has_uv));
    lines.add("colors", input.mesh.position_color.empty() ? "no" : "at vertices");
    for (const SurfaceMaterial& material : input.mesh.material) {
        const std::string name = material.name.empty() ? "(no name)" : material.name;
        const std::string image = material.texture.filename().string();
        lines.add("material", material.embedded_texture ? name + ", texture in the file"
                              : image.empty()           ? name
                                                        : name + ", texture " + image);
    }
    for (const std::string& part : input.mesh.part_name) {
        if (!part.empty()) lines.add("part", part);
    }
    for (const std::string& finding : input.finding) lines.add("finding", finding);
    for (const std::string& finding : report.finding) lines.add("finding", finding);
    for (const std::string& repair : repairs) lines.add("a run", repair);
    return lines.text();
}

// Of a run's folder: how far it came, and what its bodies have used of what they can bear.
std::string run_text(const std::string& folder, const Json& record) {
    const auto text_at = [](const Json& of, const char* key) {
        return of.at(key).get<std::string>();
    };
    Lines lines(folder);
    lines.add("state", text_at(record, "state"));
    if (record.contains("stopped")) lines.add("because", text_at(record, "stopped"));
    for (const Json& stage : record.value("stages", Json::array())) {
        const int first = stage.at("frames").at(0).get<int>(),
                  last = stage.at("frames").at(1).get<int>();
        const std::string within =
            stage.contains("unfinished_frame")
                ? fmt::format(", and a part of frame {}", stage.at("unfinished_frame").get<int>())
                : "";
        lines.add(text_at(stage, "name"),
                  fmt::format("{}, {}{}", text_at(stage, "machine"),
                              last < first ? "no frame is finished"
                                           : fmt::format("frames {} to {}", first, last),
                              within));
        if (const std::string bent = bend_text(stage); !bent.empty()) lines.add(bent);
        for (const std::string& use : use_texts(stage)) lines.add(use);
    }
    for (const std::string& warning : warnings_in(record)) lines.add("warning", warning);
    return lines.text();
}

int info(const InfoArguments& given) {
    if (std::filesystem::is_directory(given.file)) {
        const std::filesystem::path file = RunDirectory::record_in(given.file);
        const std::optional<Json> record = read_record(file);
        if (!record) {
            fail(ExitCode::output, "{} is not a run directory: it has no complete run.json",
                 given.file);
        }
        if (given.json) {
            put_json(*record);
            return 0;
        }
        try {
            put_out(run_text(given.file, *record));
        } catch (const Json::exception&) {
            fail(ExitCode::output, "{}: is damaged", file.string());
        }
        return 0;
    }
    const InputMesh input = read_mesh_as_it_is(given.file, std::nullopt);
    const std::vector<std::string> repairs = repairs_of(input);
    const bool is_manifold = is_manifold_as_numbered(given.file, input.report);
    if (given.json) {
        Json json = mesh_json(input);
        json["file"] = given.file;
        json["repairs"] = repairs;
        json["manifold_as_numbered"] = is_manifold;
        put_json(json);
    } else {
        put_out(text_of(given.file, input, is_manifold, repairs));
    }
    return 0;
}

}  // namespace

void add_info_command(CLI::App& app, Action& chosen) {
    static InfoArguments given;
    CLI::App* command = add_command(
        app, "info", "Describe a mesh file and what is wrong with it, or report how far a run got",
        "  swage info assets/meshes/calf.obj\n"
        "  swage info assets/meshes/calf.obj --json\n",
        chosen, [] { return info(given); });
    command
        ->add_option("mesh", given.file,
                     "OBJ, PLY, STL, OFF, glTF, GLB, DAE, 3DS or 3MF file, or a run directory")
        ->required()
        ->type_name("MESH|RUN");
    command->add_flag("--json", given.json, "print one JSON object");
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_scene.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/suggest.h"
#include "base/text.h"
#include "geometry/mesh_write.h"
#include "scene/document.h"
#include "scene/idle_keys.h"
#include "scene/overrides.h"
#include "scene/product_names.h"
#include "scene/read_body.h"
#include "scene/read_fields.h"
#include "scene/read_inset.h"
#include "scene/read_material.h"
#include "scene/read_probe.h"
#include "scene/read_render.h"
#include "scene/read_stage.h"

namespace swage {

namespace {

namespace fs = std::filesystem;

// Against gravity where all stages that have it agree on an axis.
Up up_of(const std::vector<StageSpec>& stages) {
    Up found = Up::automatic;
    for (const StageSpec& stage : stages) {
        const Vec3& g = stage.sim.gravity;
        if (g == Vec3::Zero()) continue;
        Up own = Up::y;
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(g[axis]) != g.norm()) continue;
            own = static_cast<Up>(static_cast<int>(g[axis] < 0 ? Up::x : Up::minus_x) + axis);
        }
        if (found != Up::automatic && found != own) return Up::y;
        found = own;
    }
    return found == Up::automatic ? Up::y : found;
}

void read_longest_edge(TableReader& table, std::optional<double>& longest) {
    table.describe("divide",
                   fmt::format("false, or number, {} to {}", kLeastSkinEdge, kMostSkinEdge),
                   fmt::format("{}", kLongestSkinEdge));
    const Node* node = table.find("divide");
    if (node == nullptr) return;
    if (node->kind == Node::Kind::truth) {
        longest = node->truth ? std::optional(kLongestSkinEdge) : std::nullopt;
    } else if (node->kind == Node::Kind::whole || node->kind == Node::Kind::real) {
        double cells = kLongestSkinEdge;
        table.value("divide", *node, Quantity::number, between(kLeastSkinEdge, kMostSkinEdge),
                    cells);
        longest = cells;
    } else {
        table.mistake("divide", fmt::format("divide must be false or a number of cells, {} to {}, "
                                            "without quotes",
                                            kLeastSkinEdge, kMostSkinEdge));
    }
}

void read_skin(TableReader& table, SkinSettings& skin) {
    table.choice<SkinKind>("kind",
                           {{"mount", SkinKind::mount},
                            {"frame4", SkinKind::frame4},
                            {"boundary", SkinKind::boundary}},
                           skin.kind);
    read_longest_edge(table, skin.longest_edge);
    table.quantity("crease_angle", Quantity::angle, between(0, kPi + 1e-12), skin.crease_angle);
    table.quantity("roughness", Quantity::number, between(0, kMostRoughness), skin.roughness);
    table.finish();
}

// Sections and keys at the top that nothing is known of.
void report_unknown_sections(const Document& document, Reading& reading) {
    const std::vector<std::string> sections = {"mesh", "material", "inset", "mold",   "body",
                                               "skin", "probe",    "stage", "render", "output"};
    for (const Entry& entry : document.root.entry) {
        if (std::find(sections.begin(), sections.end(), entry.key) != sections.end()) continue;
        const Node::Kind kind = entry.value.kind;
        if (kind == Node::Kind::table || kind == Node::Kind::array) {
            const std::string near = nearest_word(entry.key, sections);
            const std::string hint = near.empty() ? "; known: " + joined(sections, ", ")
                                                  : ", did you mean [" + near + "]?";
            reading.mistakes.add(entry.place,
                                 fmt::format("unknown section [{}]{}", entry.key, hint));
        } else {
            reading.unknown.push_back({"no section", entry.key, entry.place, {}});
        }
    }
}

// What the scene does not say and its other sections do.
void fill_in(SceneSpec& scene) {
    if (scene.render.up == Up::automatic) scene.render.up = up_of(scene.stage);
    for (StageSpec& stage : scene.stage) {
        if (stage.duration > 0) continue;
        stage.duration = static_cast<double>(stage.frames) / scene.render.frame_rate.value();
    }
}

void refuse_remolded_blocks(TableReader& root, const SceneSpec& scene) {
    for (const StageSpec& stage : scene.stage) {
        if (!stage.remold || scene.work_piece().mold.kind != MoldKind::block) continue;
        root.mistake("mold",
                     fmt::format("kind = \"block\" fills the mesh's box, and stage \"{}\" would "
                                 "mold the box of the deformed body: leave out remold or kind",
                                 stage.name));
    }
}

// Meshes are named after their stage, where there are several bodies also after those; a stage's
// meshes of every frame are in a folder of its name. Tables of bodies in motion lie among those of
// the stages' curves.
void refuse_same_files(TableReader& root, const SceneSpec& scene) {
    const bool has_several = scene.body.size() > 1;
    std::map<std::string, std::string> of;
    const auto refuse_same = [&](const std::vector<std::string>& files, const std::string& what) {
        for (const std::string& file : files) {
            const auto [at, is_new] = of.try_emplace(file, what);
            if (is_new || at->second == what) continue;  // those of one name are told already
            root.mistake("stage",
                         fmt::format("{} and {} would both be written as {}: rename one of them",
                                     at->second, what, file));
            break;
        }
    };
    for (const StageSpec& stage : scene.stage) {
        std::vector<std::string> tables;
        for (const std::string& name : table_names(stage)) {
            tables.push_back("curves/" + name + ".csv");
        }
        refuse_same(tables, fmt::format("stage \"{}\"", stage.name));
        for (const BodySpec& body : scene.body) {
            std::string what = fmt::format("stage \"{}\"", stage.name);
            if (has_several) what = fmt::format("body \"{}\" of {}", body.name, what);
            const std::string stem = mesh_name(scene, stage, body);
            const std::string mesh = stem + ".obj";
            std::vector<std::string> files = {mesh, library_of(mesh).string(), stem + ".ply"};
            if (scene.output.meshes_per_frame) files.push_back(stem);
            refuse_same(files, what);
        }
    }
}

}  // namespace

void read_scene_document(const Document& document, const AssetPaths& assets, Reading& reading,
                         SceneSpec& scene) {
    const fs::path folder = scene.file.parent_path();
    Node absent;  // a section that is not there stands nowhere in the file
    absent.place = {document.source, 0, 0};
    TableReader root(document.root, "the scene", reading);
    const auto is_there = [&](const std::string& name) {
        const Node* node = root.find(name);
        return node != nullptr && node->kind == Node::Kind::table;
    };
    const auto section = [&](const std::string& name) {
        const Node* node = root.find(name);
        if (node != nullptr && !is_there(name)) {
            root.mistake(name, fmt::format("{} is {}; write it as a section [{}]", name,
                                           kind_text(*node), name));
        }
        return TableReader(is_there(name) ? *node : absent, "[" + name + "]", reading);
    };
    TableReader mesh = section("mesh"), material = section("material"), mold = section("mold"),
                skin = section("skin"), render = section("render"), output = section("output");
    BodySpec& work_piece = scene.body.emplace_back();
    read_mesh_section(mesh, folder, work_piece);
    read_material(material, assets, folder, work_piece.material, work_piece.look, scene.inputs,
                  is_there("material"));
    work_piece.gives_look = material.find("look") != nullptr;
    refuse_look(mesh, work_piece);
    work_piece.gives_damping =
        work_piece.material.damping_ratio > 0 && material.find("damping_ratio");
    // Theirs, too, is of what the scene gives itself.
    for (const Node* node : root.tables("inset", "[[inset]]")) {
        TableReader inset(*node, "[[inset]]", reading);
        work_piece.inset.push_back(read_inset(inset, assets, folder, scene.inputs));
        work_piece.gives_damping =
            work_piece.gives_damping || (work_piece.inset.back().material.damping_ratio > 0 &&
                                         inset.find("damping_ratio") != nullptr);
    }
    read_mold(mold, work_piece);
    BodyReader bodies(reading, assets, folder);
    for (const Node* node : root.tables("body", "[[body]]")) bodies.read(*node, scene);
    std::set<std::string> probes;
    for (const Node* node : root.tables("probe", "[[probe]]")) {
        TableReader probe(*node, "[[probe]]", reading);
        read_probe(probe, probes, scene);
    }
    read_skin(skin, scene.skin);
    StageReader stages(reading, assets, folder, scene);
    for (const Node* node : root.tables("stage", "[[stage]]")) {
        scene.stage.push_back(stages.read(*node));
    }
    scene.inputs.insert(scene.inputs.end(), stages.inputs().begin(), stages.inputs().end());
    for (const InsetSpec& inset : scene.work_piece().inset) {
        if (!inset.file.empty()) scene.inputs.push_back(inset.file);
    }
    refuse_with_insets(root, scene);
    refuse_probes_named_as_parts(root, scene);
    refuse_remolded_blocks(root, scene);
    if (root.find("stage") == nullptr && reading.is_complete) {
        reading.mistakes.add(absent.place,
                             "nothing to do: the scene has no [[stage]], such as\n"
                             "    [[stage]]\n    machine = \"bend\"\n    angle = \"60 deg\"");
    }
    read_render(render, scene.stage, scene.render);
    fill_in(scene);
    output.truth("meshes_per_frame", scene.output.meshes_per_frame);
    read_fields(output, scene.output.fields);
    output.truth("keep_stages", scene.output.keep_stages);
    add_drawn_field(scene.render, scene.output.fields);
    output.finish();
    refuse_same_files(root, scene);
    report_unknown_sections(document, reading);
    reading.report_unknown();
}

SceneReading read_scene(const fs::path& file, const std::vector<std::string>& overrides,
                        const AssetPaths& assets) {
    SceneReading result;
    SceneSpec scene;
    std::error_code error;
    const bool is_piped = file == kPiped;
    const fs::path shown = is_piped ? fs::path("stdin") : file;
    scene.file = fs::absolute(shown, error).lexically_normal();
    scene.name = scene.file.stem().string();
    if (!is_piped) scene.inputs = {scene.file};

    MistakeList mistakes;
    std::map<const Node*, double> numbers;
    std::optional<Document> document =
        is_piped ? read_piped_document(shown, mistakes) : read_document(file, file, mistakes);
    if (document && is_piped) scene.piped = document->source->text;
    if (document && document->root.entry.empty() && document->is_complete) {
        mistakes.add(
            {document->source, 0, 0},
            "nothing to do: the scene is empty; it needs [mesh], [material] and [[stage]]");
    } else if (document) {
        apply_overrides(overrides, document->root, mistakes);
        Reading reading(mistakes);
        reading.is_complete = document->is_complete;
        read_scene_document(*document, assets, reading, scene);
        numbers = std::move(reading.number);
        if (reading.materials) {
            for (const Material& known : reading.materials->material) {
                scene.strange_toughness[known.name] = kOtherMatter * known.toughness;
            }
        }
    }
    if (mistakes.is_clean()) {
        warn_of_idle_keys(document->root, scene, mistakes);
        scene.said = said_in(document->root, numbers);
        result.scene = std::move(scene);
    }
    result.mistakes = mistakes.take(shown);
    return result;
}

}  // namespace swage

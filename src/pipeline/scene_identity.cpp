// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/scene_identity.h"

#include <algorithm>

#include "base/file_contents.h"
#include "base/hash.h"
#include "base/text.h"
#include "geometry/mesh_read.h"
#include "pipeline/carried_insets.h"
#include "pipeline/mesh_bytes.h"

namespace swage {

namespace fs = std::filesystem;
using namespace std::string_literals;

namespace {

constexpr std::uint64_t kLongestKeptText = 64 << 10;  // of a machine

std::string hash_of_mesh(TriMesh mesh) {
    // Files may lie elsewhere; what the textures hold is hashed by itself.
    for (SurfaceMaterial& material : mesh.material) material.texture = material.texture.filename();
    ByteWriter out;
    out(mesh);
    return hash_text(hash_of(out.bytes()));
}

// Returns its role, which no other has; empty: it is no file.
std::string add_file(RunIdentity& identity, const std::string& kind, const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return {};
    std::string role = kind.empty() ? file.filename().string() : kind;
    const auto taken = [&](const std::string& name) {
        return std::any_of(identity.input.begin(), identity.input.end(),
                           [&](const RunInput& input) { return input.role == name; });
    };
    std::string free_role = role;
    for (int n = 2; taken(free_role); ++n) free_role = fmt::format("{} ({})", role, n);
    identity.input.push_back({free_role, file, hash_text(hash_of_file(file))});
    if (file.extension() == ".toml" && role != "scene") {
        identity.input.back().text = file_contents(file, kLongestKeptText).value_or("");
    }
    return free_role;
}

void add_as_read(RunIdentity& identity, const std::string& role, const fs::path& file,
                 const TriMesh& mesh) {
    identity.input.push_back(
        {fmt::format("what the {} was read as", role), file, hash_of_mesh(mesh)});
}

// What is amiss with it is told where it is used.
void add_as_read(RunIdentity& identity, const std::string& role, const fs::path& file) {
    std::vector<std::string> findings;
    try {
        add_as_read(identity, role, file, read_mesh(file, {}, &findings));
    } catch (const Error&) {
    }
}

// Files that stages from this one on read, and nothing else.
std::vector<fs::path> files_of_later_stages(const SceneSpec& scene, std::size_t first) {
    const auto add = [](const StageSpec& stage, std::vector<fs::path>& files) {
        files.push_back(stage.machine.file);
        for (const ToolSpec& tool : stage.machine.tool) files.push_back(tool.mesh);
    };
    std::vector<fs::path> files, others;
    for (std::size_t s = 0; s < scene.stage.size(); ++s) {
        add(scene.stage[s], s < first ? others : files);
    }
    for (const BodySpec& body : scene.body) {
        others.push_back(body.mesh.file);
        for (const InsetSpec& inset : body.inset) others.push_back(inset.file);
    }
    std::erase_if(files, [&](const fs::path& file) {
        return std::find(others.begin(), others.end(), file) != others.end();
    });
    return files;
}

// What the scene says that the first stages depend on. How pictures are drawn is none of it; what
// of that makes frames what they are stands by its meaning.
std::string said_of_stages(const SceneSpec& scene, std::size_t stages) {
    std::string all;
    for (const Said& one : scene.said) {
        const std::size_t point = one.key.find('.');
        const std::string section = one.key.substr(0, point);
        if (section == "render" || section == "output") continue;
        if (section == "stage" && point != one.key.npos &&
            std::stoul(one.key.substr(point + 1)) > stages)
            continue;
        all += fmt::format("{}={}\n", one.key, one.value);
    }
    for (std::size_t s = 0; s < stages; ++s) {
        all += fmt::format("{:a} s\n", scene.stage[s].duration);
    }
    if (scene.output.meshes_per_frame) {  // whose names count from it
        all += fmt::format("meshes from {}\n", scene.render.first_frame);
    }
    if (carries_insets(scene, stages)) all += "with the surfaces of insets\n";
    for (const SkinField field : scene.output.fields) all += words_of(field).name + "\n"s;
    return all;
}

// `identity`: but for these. What names no file is in what the scene says.
std::vector<std::string> stage_keys(const SceneSpec& scene, const RunIdentity& identity) {
    std::vector<std::string> keys;
    const std::string program = identity.version + "\n" + identity.build + "\n";
    for (std::size_t stages = 0; stages <= scene.stage.size(); ++stages) {
        const std::vector<fs::path> later = files_of_later_stages(scene, stages);
        std::string read;
        for (const RunInput& input : identity.input) {
            if (is_said(input)) continue;
            if (std::find(later.begin(), later.end(), input.file) != later.end()) continue;
            read += input.hash + "\n";
        }
        keys.push_back(hash_text(hash_of(program + said_of_stages(scene, stages) + read)));
    }
    return keys;
}

}  // namespace

RunIdentity identity_of(const SceneSpec& scene, const std::vector<InputMesh>& input,
                        const RunOptions& options) {
    RunIdentity identity;
    std::vector<fs::path> files;
    if (scene.piped) {
        identity.input.push_back(
            {"scene", scene.file.filename(), hash_text(hash_of(*scene.piped))});
    } else {
        files = {scene.file};
    }
    for (const fs::path& file : scene.inputs) {
        if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
    }
    for (const fs::path& file : files) {
        const std::string role = add_file(identity, file == scene.file ? "scene" : "", file);
        if (keeps_numbers_beside(file)) add_as_read(identity, role, file);
    }
    for (std::size_t b = 0; b < input.size(); ++b) {
        const BodySpec& body = scene.body[b];
        const std::string role = b == 0 ? "mesh" : "mesh of " + body.name;
        add_file(identity, role, body.mesh.file);
        add_as_read(identity, role, body.mesh.file, input[b].mesh);
        const auto add_texture = [&](const fs::path& picture) {
            if (picture.empty()) return;
            add_file(identity, "texture " + picture.filename().string(), picture);
        };
        add_texture(body.mesh.texture);
        for (const SurfaceMaterial& material : input[b].mesh.material) {
            add_texture(material.texture);
        }
    }
    identity.input.push_back({"--set", joined(options.overrides, ", "),
                              hash_text(hash_of(joined(options.overrides, "\n")))});
    identity.said = scene.said;
    identity.stage_key = stage_keys(scene, identity);
    return identity;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_warnings.h"

#include <fmt/format.h>

#include <utility>

#include "pipeline/folded_bodies.h"
#include "pipeline/stage_machine.h"
#include "pipeline/start_doubts.h"
#include "pipeline/start_overlap.h"

namespace swage {

std::vector<std::string> StartWarnings::all() const {
    std::vector<std::string> all = mesh;
    all.insert(all.end(), mold.begin(), mold.end());
    all.insert(all.end(), strength.begin(), strength.end());
    all.insert(all.end(), bodies.begin(), bodies.end());
    return all;
}

std::vector<std::string> body_names(const SceneSpec& scene) {
    std::vector<std::string> names;
    for (const BodySpec& body : scene.body) names.push_back(body.name);
    return names;
}

std::vector<std::string> warnings_of_meshes(const SceneSpec& scene,
                                            const std::vector<InputMesh>& input) {
    std::vector<std::vector<std::string>> findings;
    for (std::size_t b = 0; b < input.size(); ++b) {
        const std::string file = scene.body[b].mesh.file.filename().string();
        findings.emplace_back();
        for (const std::string& one : input[b].finding) {
            findings.back().push_back(file.empty() ? one : file + ": " + one);
        }
    }
    std::vector<std::string> told;
    const std::vector<std::string> name = body_names(scene);
    for (FoldedText& one : folded(findings)) {
        if (name.size() > 1) one.text += fmt::format(" ({})", bodies_text(name, one.body));
        told.push_back(std::move(one.text));
    }
    return told;
}

std::vector<std::string> warnings_of_mold(const std::string& body, bool is_one_of_several,
                                          const std::vector<std::string>& findings) {
    std::vector<std::string> told;
    for (const std::string& finding : findings) {
        told.push_back(is_one_of_several ? fmt::format("mold of {}: {}", body, finding)
                                         : "mold: " + finding);
    }
    return told;
}

std::vector<NamedMatter> named(const std::vector<WorkPiece>& bodies) {
    std::vector<NamedMatter> named;
    for (const WorkPiece& body : bodies)
        named.push_back({body.name, &body.matter, box_of(body.position)});
    return named;
}

std::vector<std::string> warnings_of_bodies(const SceneSpec& scene,
                                            const std::vector<NamedMatter>& bodies) {
    std::vector<std::string> told = start_overlaps(bodies);
    const std::vector<std::string> mistakes =
        foreseen_mistakes(scene, *bodies.front().matter, bodies.front().skin,
                          materials_beside(bodies), bodies.front().coarser);
    told.insert(told.end(), mistakes.begin(), mistakes.end());
    for (std::string& doubt : doubts_of_start(scene, bodies)) told.push_back(std::move(doubt));
    return told;
}

}  // namespace swage

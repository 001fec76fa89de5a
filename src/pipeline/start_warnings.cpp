// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_warnings.h"

#include "pipeline/stage_machine.h"

namespace swage {

std::vector<std::string> StartWarnings::all() const {
    std::vector<std::string> all = mesh;
    all.insert(all.end(), strength.begin(), strength.end());
    all.insert(all.end(), bodies.begin(), bodies.end());
    return all;
}

std::vector<NamedMatter> named(const std::vector<WorkPiece>& bodies) {
    std::vector<NamedMatter> named;
    for (const WorkPiece& body : bodies) named.push_back({body.name, &body.matter});
    return named;
}

std::vector<std::string> warnings_of_bodies(const SceneSpec& scene,
                                            const std::vector<NamedMatter>& bodies) {
    std::vector<std::string> told = start_overlaps(bodies);
    const std::vector<std::string> mistakes = foreseen_mistakes(scene, *bodies.front().matter);
    told.insert(told.end(), mistakes.begin(), mistakes.end());
    return told;
}

}  // namespace swage

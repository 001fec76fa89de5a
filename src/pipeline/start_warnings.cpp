// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_warnings.h"

#include <fmt/format.h>

#include "pipeline/stage_machine.h"
#include "pipeline/start_overlap.h"

namespace swage {

std::vector<std::string> StartWarnings::all() const {
    std::vector<std::string> all = mesh;
    all.insert(all.end(), mold.begin(), mold.end());
    all.insert(all.end(), strength.begin(), strength.end());
    all.insert(all.end(), bodies.begin(), bodies.end());
    return all;
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
        foreseen_mistakes(scene, *bodies.front().matter, bodies.front().skin);
    told.insert(told.end(), mistakes.begin(), mistakes.end());
    return told;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_volumes.h"

#include "pipeline/json.h"
#include "sim/cell_volume.h"
#include "sim/flowed_volume.h"
#include "skin/broken_skin.h"
#include "skin/skin_volume.h"
#include "skin/whole_parts.h"

namespace swage {

std::vector<BodyVolume> body_volumes(const std::vector<WorkPiece>& bodies) {
    std::vector<BodyVolume> volumes;
    for (const WorkPiece& body : bodies) {
        volumes.push_back({present_volume(body.matter), flowed_volume(body.matter),
                           enclosed_volume(body.skin, body.position), boundary_off(body)});
    }
    return volumes;
}

std::optional<double> boundary_off(const WorkPiece& body) {
    if (!body.look) return {};
    const std::optional<double> skin = enclosed_volume(body.skin, body.skin.position);
    if (!skin) return {};
    return *skin / body.matter.volume() - 1;
}

Json volumes_json(const std::vector<WorkPiece>& bodies, const std::vector<BodyVolume>& at_start) {
    const std::vector<BodyVolume> now = body_volumes(bodies);
    Json json = Json::object();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        Json& own = json[bodies[b].name];
        own["matter_at_start"] = at_start[b].matter;
        own["matter"] = now[b].matter;
        if (at_start[b].skin) own["skin_at_start"] = *at_start[b].skin;
        if (now[b].skin) own["skin"] = *now[b].skin;
    }
    return json;
}

std::optional<double> swollen_by(const WorkPiece& body) {
    if (!keeps_volume(body)) return {};
    const std::optional<double> was = enclosed_volume(body.skin, body.skin.position),
                                is = enclosed_volume(body.skin, body.position);
    if (!was || !is || !(*was > 0)) return {};
    return *is / *was - present_volume(body.matter) / body.matter.volume();
}

std::optional<double> stretched_by(const WorkPiece& body, const BodyVolume& before) {
    const std::optional<double> is = enclosed_volume(body.skin, body.position);
    if (!is || !before.skin || !(*before.skin > 0)) return {};
    const bool is_made_anew = body.look && is_broken(body.matter);
    if (is_made_anew || !spans_pieces(body.skin, body.mount, body.matter)) return {};
    return *is / *before.skin - present_volume(body.matter) / before.matter;
}

}  // namespace swage

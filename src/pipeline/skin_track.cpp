// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/skin_track.h"

#include <algorithm>
#include <functional>

#include "base/hash.h"

namespace swage {

void SkinTrack::add(const StoredBody& body) {
    std::array<Float3, 2> ends = {Float3::Zero(), Float3::Zero()};
    Hasher place;
    place.add_bytes(&body.skin, sizeof body.skin);
    for (std::size_t i = 0; i < body.position.size(); ++i) {
        const Float3 p = body.position[i].cast<float>();
        place.add_bytes(p.data(), 3 * sizeof(float));
        ends[0] = i == 0 ? p : ends[0].cwiseMin(p).eval();
        ends[1] = i == 0 ? p : ends[1].cwiseMax(p).eval();
    }
    field.resize(body.field.size());
    for (std::size_t n = 0; n < body.field.size(); ++n) {
        Hasher values;
        values.add_bytes(&body.skin, sizeof body.skin);
        values.add_bytes(body.field[n].data(), body.field[n].size() * sizeof(float));
        field[n].push_back(values.value());
    }
    vertices.push_back(body.position.size());
    skin.push_back(body.skin);
    shape.push_back(place.value());
    extent.push_back(ends);
}

int SkinTrack::main_look() const {
    const auto most = std::max_element(faces.begin(), faces.end());
    return most == faces.end() ? -1 : look[std::size_t(most - faces.begin())];
}

bool SkinTrack::changes_faces() const {
    return std::adjacent_find(skin.begin(), skin.end(), std::not_equal_to<>()) != skin.end();
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/skin_velocity.h"

#include "pipeline/surface_match.h"

namespace swage {

std::vector<Vec3> skin_velocity(const FrameStore& store, std::size_t body, int frame,
                                double frame_rate) {
    const StoredBody now = std::move(store.frame(frame - 1).body.at(body));
    std::vector<Vec3> velocity(now.position.size(), Vec3::Zero());
    const bool is_last = frame == store.frame_count();
    const int other = is_last ? frame - 1 : frame + 1;
    if (other < 1) return velocity;
    StoredBody then = std::move(store.frame(other - 1).body.at(body));
    if (then.skin != now.skin) {
        then.position = carried_places(store.skin(now.skin), now.position, store.skin(then.skin),
                                       then.position);
    }
    for (std::size_t i = 0; i < velocity.size(); ++i) {
        velocity[i] = (is_last ? -frame_rate : frame_rate) * (then.position[i] - now.position[i]);
    }
    return velocity;
}

}  // namespace swage

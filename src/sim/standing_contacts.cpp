// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/standing_contacts.h"

#include "geometry/box.h"
#include "sim/body_contact.h"
#include "sim/vector_sums.h"

namespace swage {

std::vector<ContactSums> standing_contacts(const std::vector<Aggregate*>& bodies,
                                           SimSettings settings) {
    std::vector<ContactSums> all(bodies.size());
    std::vector<Box> box;
    for (const Aggregate* body : bodies) box.push_back(box_of(body->particle_position));
    std::vector<std::size_t> number;  // of those that may touch any
    std::vector<Aggregate*> near;
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            if (a == b || gap_between(box[a], box[b]) > 0) continue;
            number.push_back(a);
            near.push_back(bodies[a]);
            break;
        }
    }
    if (near.empty()) return all;
    std::vector<Vec3Array> unused(near.size());
    std::vector<Vec3Array*> force;
    for (std::size_t n = 0; n < near.size(); ++n) {
        set_zero(near[n]->particle_count(), unused[n]);
        force.push_back(&unused[n]);
    }
    settings.self_contact = false;
    BodyContact contact(near, settings);
    const std::vector<char> awake(near.size(), 0);
    contact.renew_all(awake);
    std::vector<ContactSums> sums;
    contact.add_forces(force, Vec3::Zero(), 0, awake, sums);
    for (std::size_t n = 0; n < near.size(); ++n) all[number[n]] = sums[n];
    return all;
}

}  // namespace swage

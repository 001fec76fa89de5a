// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/own_overlap.h"

#include "sim/body_contact.h"

namespace swage {

double own_overlap(Aggregate& matter) {
    SimSettings settings;
    settings.self_contact = true;
    const std::vector<char> awake = {0};
    BodyContact contact({&matter}, settings);
    contact.renew_all(awake);
    if (contact.candidates() == 0) return 0;
    Vec3Array force;
    force.resize(matter.particle_count());
    std::vector<ContactSums> sums;
    contact.add_forces({&force}, Vec3::Zero(), 0, awake, sums);
    return sums[0].penetration;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// What contact between bodies does to the books.
#pragma once

#include <algorithm>

namespace swage {

// Of one body; what two share is halved between them.
struct ContactSums {
    double stored = 0;                // in contacts, before the step [J]
    double damped = 0, friction = 0;  // taken in the step [J]
    double work = 0;                  // done on the body in the step [J]
    double penetration = 0;           // of the deepest point in contact [m]
    int contacts = 0, sliding = 0;

    // Those of the next step.
    void add(const ContactSums& next) {
        damped += next.damped;
        friction += next.friction;
        work += next.work;
        penetration = std::max(penetration, next.penetration);
        stored = next.stored;
        contacts = next.contacts;
        sliding = next.sliding;
    }
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// What contact between bodies does to the books.
#pragma once

#include <algorithm>

namespace swage {

// Of one body; what two share is halved between them. A force does half of its work on the way to
// where it was found and half on the way from there.
struct ContactSums {
    using IsPlain = ContactSums;
    double stored = 0, stored_at_start = 0;  // in contacts [J]
    double friction = 0;                     // taken [J]
    double damped = 0;                       // taken by dashpots and by parting [J]
    double work = 0;                         // done on the body [J]
    double came = 0, goes = 0;               // power on the body before and after now [W]
    double took = 0;         // power of dashpots before now, and after they were last found
    double penetration = 0;  // of the deepest point in contact [m]
    int contacts = 0;

    // Those of other contacts at the same time.
    void join(const ContactSums& other) {
        stored += other.stored;
        friction += other.friction;
        damped += other.damped;
        came += other.came;
        goes += other.goes;
        took += other.took;
        penetration = std::max(penetration, other.penetration);
        contacts += other.contacts;
    }
    // The same contacts while nothing moves.
    void freeze() { friction = damped = came = goes = took = 0; }
    // Nothing is taken yet where `now` holds, but what was let go of as a blade cut it.
    void start(const ContactSums& now) {
        *this = now;
        stored_at_start = now.stored + now.damped;
        friction = work = 0;
    }
    // Those found at the end of the next step [s].
    void add(const ContactSums& next, double step) {
        work += 0.5 * step * (goes + next.came);
        damped += 0.5 * step * next.took + next.damped;
        friction += next.friction;
        penetration = std::max(penetration, next.penetration);
        stored = next.stored;
        goes = next.goes;
        contacts = next.contacts;
    }
};

}  // namespace swage

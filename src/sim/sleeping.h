// SPDX-License-Identifier: GPL-3.0-or-later
// Which bodies have come to rest. One rests when gravity holds it down and, for ten times as long
// as a fall over one spacing or its slowest swing takes, whichever is longer,
//
//     no particle goes farther than a thousandth of a spacing from where it was,
//     its kinetic energy stays below a millionth of m g a,
//
// g the gravity that acts at the time.
// What rolls or slides slower than a 14,000th of sqrt(g a) is taken as at rest; what is thrown and
// stands at the top of its way, or swings, is not. Without gravity nothing ever rests.
#pragma once

#include <algorithm>
#include <vector>

#include "matter/aggregate.h"
#include "sim/settings.h"

namespace swage {

class Sleeping {
  public:
    Sleeping(const std::vector<Aggregate*>& bodies, const SimSettings& settings);

    const std::vector<char>& asleep() const { return asleep_; }
    bool any() const { return std::find(asleep_.begin(), asleep_.end(), 1) != asleep_.end(); }
    bool is_asleep(std::size_t body) const { return asleep_[body] != 0; }

    // A body that holds this kinetic energy [J] is watched; returns whether it has been at rest for
    // long enough by now [s], for the gravity [m/s2] that acts now.
    bool rests(std::size_t body, double now, double kinetic, double gravity);
    void put_to_sleep(std::size_t body) { asleep_[body] = 1; }
    void wake(std::size_t body);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(asleep_);
        for (Watched& one : body_) io(one.since, one.lies, one.from);
    }

  private:
    struct Watched {
        const Aggregate* matter;
        double mass;   // [kg]
        double swing;  // its slowest takes [s]
        double since = 0;
        bool lies = false;
        Vec3Array from;  // where its particles were then
    };
    std::vector<Watched> body_;
    std::vector<char> asleep_;
    bool can_ = false;
};

}  // namespace swage

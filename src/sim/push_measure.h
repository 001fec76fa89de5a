// SPDX-License-Identifier: GPL-3.0-or-later
// What the residual of an equilibrium is measured by [N]: the largest force that any tool or grip
// carries, or a load or gravity asks for or has asked for; where none asks for anything, also what
// was carried before. Where loads alone have driven the body it is what they ask for: a slender
// body's grips carry far more, against each other.
#pragma once

#include <algorithm>
#include <vector>

#include "sim/part_sum.h"

namespace swage {

class PushMeasure {
  public:
    using IsPlain = PushMeasure;

    // `least`: what the first touch of a slender body, next to nothing, is measured by where no
    // load has asked for anything.
    explicit PushMeasure(double least) : least_(least) {}

    // A grip, or a tool near the body, has moved.
    void drive() { driven_ = true; }
    void ask(double load) { asked_ = std::max(asked_, load); }
    // What tools and grips carry, each by itself, where a move ends.
    void carry(const std::vector<PartSum>& load) {
        carries_ = 0;
        for (const PartSum& one : load) carries_ = std::max(carries_, one.size);
        carried_ = std::max(carried_, carries_);
    }
    double carries() const { return carries_; }
    // What loads ask for now, or have asked for.
    double asked(double asking) const { return std::max(asked_, asking); }

    // With what loads ask for now, and what tools and grips carry.
    template <typename Carried>
    double measure(double asking, const Carried& carrying) const {
        const double asked = this->asked(asking);
        if (!driven_ && asked > 0) return std::max(asked, eased_);
        double most = std::max(asked > 0 ? asked : std::max(least_, carried_), eased_);
        for (const PartSum& load : carrying()) most = std::max(most, load.size);
        return most;
    }

    // What was cut, or lost its grips, has let go of this.
    void let_go(double force) { let_go_ = std::max(let_go_, force); }
    // Where there is no better rest it may be eased to a part of that, or of what has been carried
    // by what has moved.
    bool ease(double force, double share) {
        if (!(force <= share * std::max(let_go_, driven_ ? carried_ : 0))) return false;
        eased_ = force;
        return true;
    }

  private:
    double least_;
    bool driven_ = false;
    double asked_ = 0, carries_ = 0, carried_ = 0, let_go_ = 0, eased_ = 0;
};

}  // namespace swage

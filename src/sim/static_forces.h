// SPDX-License-Identifier: GPL-3.0-or-later
// What acts on a body that is to come to rest: its own forces, those of tools, grips, loads and
// gravity, itself where it touches itself, and a little drag; and what is left over of them.
#pragma once

#include <limits>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/free_pieces.h"
#include "sim/lattice_forces.h"
#include "sim/load_set.h"
#include "sim/move_outcome.h"
#include "sim/push_measure.h"
#include "sim/resting_contacts.h"
#include "sim/self_contact.h"
#include "sim/settings.h"
#include "sim/static_move.h"

namespace swage {

// What the residual of a body's equilibria is measured by at least [N].
double least_push(const Aggregate& body);

struct StaticForces {
    // Both must outlive it.
    StaticForces(Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings);

    // What is whole has changed, as the lattice already knows.
    void connections_changed();
    void find_bound() { stiffness_bound = lattice.stiffness_bound(matter); }

    // At the present positions. `moved`: as RestingContacts::add_forces() takes it.
    void find(const Drive& to, double moved = std::numeric_limits<double>::infinity());
    // What is left over; 1: as much as the largest push.
    double residual_of(const Vec3Array& left, const Drive& to) const;
    double push_measure(
        const Drive& to) const;  // that push, or more where rounding leaves more [N]
    // What may be left over there for rounding alone [N]; 0: what is asked for is well beyond that.
    double rounded(const Drive& to) const;
    // Finds them where the body is, with no drag; what is left over there.
    double find_at_rest(const Drive& now);

    bool touches() { return !contacts.pairs().empty() || self.presses(); }
    bool has_fallen(const StaticMove& move) {
        return free.has_fallen(pushes, move.to, move.start, extent());
    }
    bool begins_to_fall(const Drive& to);
    // Whether nothing stands in the way of what is pushed off, which is pushed by more than may be
    // left over.
    bool is_pushed_off(const Drive& to);
    int let_hang(const Drive& to);

    bool may_lie() const {  // some of it, on something
        return !apparatus.tool.empty() || (may_touch_itself && free.are_several());
    }
    double extent() const {  // [m]
        return matter.lattice.spacing * matter.lattice.cell_count.maxCoeff();
    }
    double elastic_energy() { return lattice.elastic_energy(matter); }  // [J]
    Stored stored(const Drive& now);

    Aggregate& matter;
    const Apparatus& apparatus;
    bool may_touch_itself;
    LatticeForces lattice;
    RestingContacts contacts;
    LoadSet pushes;
    SelfContact self;
    FreePieces free;
    PushMeasure measure;
    std::vector<double> stiffness_bound;  // of each particle, by the lattice [N/m]

    // The drag: springs to where the particles were.
    std::vector<double> drag;  // [N/m]
    double hold = 1;           // share of it that acts
    Vec3Array held;            // positions that it pulls back to

    // As they were found last.
    Vec3Array force;
    int mirrored = 0;  // cells inside out

    template <typename Io>
    void visit(Io& io) {  // what steps change
        lattice.visit(io, matter);
        io(contacts, pushes, self, free, measure, stiffness_bound, hold, held, force, mirrored,
           least_left_);
        if constexpr (Io::kReads) find_drag();  // by the masses, which a blade may have changed
    }

  private:
    void find_bounds();
    void find_drag();

    double tolerance_;
    double least_left_ = 0;  // what rounding leaves over, whatever is done [N]
};

}  // namespace swage

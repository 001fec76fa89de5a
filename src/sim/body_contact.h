// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of bodies with each other, and of a body with itself where it folds.
//
// Both bodies' surface points meet the other's cells (sim/contact_way.h). Alone either way would
// have the stiffness of both bodies' tools' in series,
//
//     1/k = 1/k_1 + 1/k_2,   k_i = contact_stiffness E_i A / a_i        A the point's area, E_i
//                                                                       of sim/surface_modulus.h,
//
// and its springs would hold E_1, E_2. Together they hold a mean, and each way has its share of it:
//
//     U = ((E_1^p + E_2^p) / 2)^(1/p),   dU/dE_i = (E_i / U)^(p-1) / 2,   p = 4.
//
// Where both bodies' points lie in the other that is half each. Where only those of one do, a
// corner on a face between its points, it is 2^(-1/p) of the one: 0.84. An energy has these forces,
// so no round trip gains. NOTE: p = 1, half each always, leaves the corner half of its stiffness;
// the larger of both, p = infinity, would swing between them: where the two go against each other
// the springs are 2p - 1 times as stiff. A thousandth of (E_1 + E_2) / 2 is added, so that all
// points keep a stiffness. A body with itself has one way, which sim/own_shares.h parts in pairs.
//
// Of two materials friction, static friction and stickiness are the means (S2.8), restitution is
// shared by laws/impact.h.
//
// In motion pieces without a whole cell (sim/thin_piece.h) meet the others as bodies of their own.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "geometry/box.h"
#include "matter/aggregate.h"
#include "sim/contact_side.h"
#include "sim/contact_sums.h"
#include "sim/contact_way.h"
#include "sim/settings.h"
#include "sim/thin_piece.h"

namespace swage {

class BodyContact {
  public:
    // The bodies must outlive it.
    BodyContact(const std::vector<Aggregate*>& bodies, const SimSettings& settings);

    bool acts() const { return !way_.empty(); }
    void limit_stiffness(double step);  // for steps of this length [s]

    // Finds what has come near, if anything can have since the last time. Bodies that sleep have
    // not moved since they fell asleep.
    void renew(const std::vector<char>& asleep);
    void renew_all(const std::vector<char>& asleep);

    // Groups of bodies of which each is near the next, by the number of one of them.
    std::vector<std::size_t> groups() const;

    // Adds the forces at the present positions, from which `step` [s] goes on with the forces so
    // far, which must be all others, and gravity [m/s2]; 0: from one equilibrium to another, where
    // nothing has a speed. By body; sums likewise, set anew. Between bodies that sleep nothing
    // changes.
    void add_forces(const std::vector<Vec3Array*>& force, const Vec3& gravity, double step,
                    const std::vector<char>& asleep, std::vector<ContactSums>& sums,
                    Meet meet = Meet::anew);
    // The step is kept: remembers where points stick and how they met. What sleeps has made none.
    void commit(const std::vector<char>& asleep);

    // All that a step changes.
    struct State;
    std::shared_ptr<const State> save() const;
    void restore(const State& state);

    // A blade or a crack has changed which cells are whole.
    void connections_changed(std::size_t body);

    std::size_t candidates() const;

    // What the next stage's begins with, of the same bodies as they are now: which contacts there
    // are and what they remember. Of pairs that do not act in it nothing is taken on, and such as
    // are new begin.
    void hand_on(ByteWriter& out);
    void take_on(ByteReader& in);
    void begin_unpressed();  // as Simulation::take_on()

    // For equilibria, of one body: see sim/contact_way.h; adds to each particle what its contacts
    // can add to its stiffness [N/m]; what pressed when forces were last found.
    void meet_anew();
    void add_stiffness(std::vector<double>& stiffness) const;
    std::vector<PressedPlaces> pressed() const;
    int let_be(double deeper);  // see sim/contact_way.h

    template <typename Io>
    void visit(Io& io) {  // what steps change
        if constexpr (Io::kReads) find_thin();
        io(listed_, near_, step_, allowance_);
        for (std::unique_ptr<ContactSide>& side : side_) io(*side);
        std::vector<Sides> thin = thin_ways();
        io(thin);
        if constexpr (Io::kReads) keep_ways(thin);
        for (ContactWay& way : way_) io(way);
    }

  private:
    using Sides = std::pair<std::size_t, std::size_t>;  // from, onto
    struct Pair {
        std::size_t from, onto;
        std::size_t back;  // the way from `onto` to `from`
        bool sleeps(const std::vector<char>& asleep) const { return asleep[from] && asleep[onto]; }
    };
    // One of the sides after those of the bodies.
    struct Thin {
        std::size_t body;
        std::unique_ptr<ThinPiece> piece;
    };
    std::size_t body_of(std::size_t side) const {
        return side < bodies_ ? side : thin_[side - bodies_].body;
    }
    void find_thin();
    void replace_thin(std::vector<Thin> thin);
    std::vector<Sides> thin_ways() const;
    void keep_ways(const std::vector<Sides>& thin);
    double find_near_thin(const std::vector<Box>& box, const std::vector<char>& asleep,
                          double margin, double most);
    std::vector<char> of_sides(const std::vector<char>& of_bodies) const;
    void follow();

    SimSettings settings_;
    std::size_t bodies_ = 0;  // that may meet
    std::vector<std::unique_ptr<ContactSide>> side_;
    std::vector<Thin> thin_;
    std::vector<double> let_go_;             // by side, held by ways that are no more [J]
    std::vector<std::vector<Vec3>> listed_;  // of each side, where its skin was
    // Between bodies, of all pairs; then of those pairs with thin pieces that are near each other,
    // of each the two ways one after the other.
    std::vector<ContactWay> way_;
    std::vector<Pair> pair_;  // the sides of each way
    std::size_t between_bodies_ = 0;
    std::vector<std::size_t> near_;  // ways of bodies that are near each other, in their order
    double least_spacing_ = 0;       // [m]
    double step_ = 0;                // that stiffness is held to; 0: any [s]
    double allowance_ = -1;          // that any particle may go until renew() finds anew [m]
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The points of one body's surface against the cells of another, or of its own: what they do.
//
// The cell that holds a point is found by the inverse of its trilinear map, and there the depth D
// below the surface that the body was molded with (sim/rest_surface.h), a continuous function of
// the place g in the rest shape. Its spring holds k (a D)^2 / 2, whose slope is what pushes:
//
//     F = k s^2 d n,   d = -a D / s,   n = J^-T grad D / |J^-T grad D|,
//     s = a |J^-T grad D|,   J = dx / dg:
//
// the depth as the cell is strained now, and a spring as much stiffer as it is pressed. Measured in
// strained lengths the energy would jump where J does, from cell to cell and over every edge, and
// no step would close the books. Friction's spring keeps what it holds when J changes, likewise.
//
// The point pushes back with its own weights, the cell with the trilinear weights of the same place
// in space, so that force and moment are kept to round-off. Friction's anchors are material points
// of the other body. All points together never make their carriers swing faster than half the way
// to what steps can follow, nor the body that they press on (stiffest_on_body()).
//
// In each step: resolve() where contacts have been found anew; then of all ways find() and press(),
// of all push(), of all respond() and answer(); and commit() where the step is kept. Both sides'
// patches are read before, know all springs before respond(), and are written after.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>

#include "sim/contact_list.h"
#include "sim/held_point.h"
#include "sim/limited_stiffness.h"
#include "sim/own_shares.h"
#include "sim/settings.h"

namespace swage {

class ByteReader;
class ByteWriter;

class ContactWay {
  public:
    // The sides, which may be one, must outlive it.
    ContactWay(ContactSide& from, ContactSide& onto, const SimSettings& settings);

    // The bodies have come near: what is asked of each point is found, for steps of this length
    // [s]. None of the rest may be called before, but for surfaces_changed() and commit().
    void come_near(double step);
    // What one side finds deep in the other as it begins has not been pressed in.
    void come_late() { begins_ = false; }
    // They have gone from each other: nothing is kept.
    void part();

    const ContactList& contacts() const { return list_; }
    // All that a step changes, but for points that are let be.
    struct State {
        ContactList contacts;
        double gone = 0;  // held by what is gone and not yet booked [J]
        std::vector<OwnGone> own_gone;
        bool has_changed = false, begins = true;
    };
    State save() const { return {list_, gone_, own_gone_, has_changed_, begins_}; }
    void restore(const State& state);
    // Finds what is nearer than `margin` [m]; what touches stays.
    void search(double margin);
    // Takes what its contacts touch into both sides' patches, which have been cleared.
    void resolve();

    void set_stiffness(double step);  // for steps of this length [s]; 0: any
    // What is whole has changed on one side or both: the first too, whose points are others then.
    void surfaces_changed(bool points_too, double step);

    // How each point lies and moves now, for a step of this length [s]: of all ways at once.
    void find(double step);
    // What springs would do, and hold, if this way were alone. Of a body with itself push_own()
    // asks.
    ContactHeld press();
    // Adds this share of it. Half of what both ways hold less for what is gone, and for what the
    // surface turned away from [J].
    void push(double share, double gone, double turned);
    // Of a body with itself: the share of each (sim/own_shares.h).
    void push_own();
    // Dashpots and friction, given what all springs do.
    void respond(double step, Meet meet);
    // Adds what they do.
    void answer();
    // What its springs would hold alone, now that friction has let go of some of it [J].
    double kept() const { return kept_; }
    // What friction has let go of is less by this [J].
    void keep_more(double energy);
    void keep_own();  // of a body with itself
    // Adds what its contacts can add to the stiffness of its one body's particles [N/m], about.
    void add_stiffness(std::vector<double>& stiffness) const;
    // Of its one body, what pressed when forces were last found, and still stands in the list.
    void add_pressed(std::vector<PressedPlaces>& pressed) const;
    // Of its one body, points that were deeper than this [m] when forces were last found meet it no
    // more; how many did until now.
    int let_be(double deeper);
    // For equilibria: from here on each point that comes to press presses against the plane that it
    // has met, until the next time. NOTE: surfaces are bent from cell to cell, and a point that
    // rests in a crease of them has a force to either side and none between, which no relaxation
    // finds: it was thrown from one to the other for ever.
    void meet_anew() { plane_.assign(list_.size(), {}); }
    // While nothing moves.
    void freeze() { sums_.freeze(); }
    // Of each side, less the power that forces have: the patches' matter.
    const ContactSums& sums() const { return sums_; }
    // The step is kept: remembers where points stick and how they met.
    void commit();

    // What it leaves to the same way of a stage that follows, whose steps are of this length [s].
    // What touches goes on as stiff as it was, whatever is asked for then.
    void hand_on(ByteWriter& out);
    void take_on(ByteReader& in, double step);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        bool is_near = this->is_near();
        io(is_near, step_);
        if constexpr (Io::kReads) {
            points_ = nullptr;
            if (is_near) set_stiffness(step_);
        }
        io(has_changed_, begins_, is_let_be_, share_, gone_, broken_, turned_, kept_, own_gone_,
           list_, meeting_, next_, plane_, is_found_, point_push_, cell_push_, met_, sums_);
    }

  private:
    bool is_own() const { return from_ == onto_; }
    // Nothing has a speed.
    bool is_static() const { return !in_motion(solver_); }
    bool is_near() const { return points_ != nullptr; }
    double stiffest(int point) const {
        const auto p = static_cast<std::size_t>(point);
        return stiffest_on_body(points_->stiffest[p], borne_, points_->asked[p]);
    }
    OtherSide as_other(ContactSide& side) const;
    // How a point meets the cell that holds it, at the present positions. What has no vector lies
    // in the fourth lane of one.
    struct alignas(32) Meeting {
        using IsPlain = Meeting;
        Vec4 normal;
        Vec4 reach;       // from the point to where it sticks [m]
        Vec4 now;         // speed of the point over the other side [m/s]
        Vec4 spring;      // what its springs would do if this way were alone, then what it does
                          // beside that [N]
        Vec4 inverse[3];  // rows of J^-1 [1/m]

        SWAGE_INLINE double depth() const { return normal[3]; }  // that counts [m]
        SWAGE_INLINE double sunk() const { return now[3]; }      // depth that does not count [m]
        SWAGE_INLINE double stretch() const { return inverse[0][3]; }    // s
        SWAGE_INLINE double soft() const { return inverse[1][3]; }       // ContactMemory::soft
        SWAGE_INLINE double stiffness() const { return inverse[2][3]; }  // [N/m]
        SWAGE_INLINE bool is_known() const { return stretch() != 0; }    // the depth is
        SWAGE_INLINE bool meets() const { return soft() != 0; }

        SWAGE_INLINE void set_depth(double value) { normal[3] = value; }
        SWAGE_INLINE void set_sunk(double value) { now[3] = value; }
        SWAGE_INLINE void set_stretch(double value) { inverse[0][3] = value; }
        SWAGE_INLINE void set_soft(double value) { inverse[1][3] = value; }
        SWAGE_INLINE void set_stiffness(double value) { inverse[2][3] = value; }
        SWAGE_INLINE void forget() {  // its depth, and that it meets
            set_stretch(0);
            set_soft(0);
        }
    };
    struct Chunk {
        std::vector<int> moved;  // contacts that have come into other cells
        double took = 0;         // ContactSums::took, of the one half
        bool is_met = false;     // some touch that had not
        ContactHeld held;        // by springs of the whole stiffness
        double kept = 0;         // of it, kept()
        ContactSums sums{};
    };
    // What springs do to the particles of a patch, from the slot `low` on [N], and how stiff they
    // are [N/m].
    struct Pushed {
        int low = 0, high = -1;
        struct alignas(32) Force {
            using IsPlain = Force;
            Vec4 value{};
        };
        std::vector<Force> force;
        void grow(int slot) {
            low = high < 0 ? slot : std::min(low, slot);
            high = std::max(high, slot);
        }
        // Another, while there are forces.
        void take(int slot) {
            if (slot < low) {
                force.insert(force.begin(), std::size_t(low - slot), Force{});
            } else if (slot > high) {
                force.resize(std::size_t(slot - low + 1));
            }
            grow(slot);
        }
        void add_to(ContactPatch& patch, double share) const;

        template <typename Io>
        void visit(Io& io) {
            io(low, high, force);
        }
    };
    // In one cell, which holds the place or lies beside it: depth as it goes on from one place.
    struct Plane {
        using IsPlain = Plane;
        bool is_met = false;
        Vec3 place, gradient;
        double distance;
    };
    struct Kernel;
    void keep_contacts(const std::function<bool(int point)>& meets);
    void leave_out_let_be();
    // Where a chunk of contacts begins: a point's own stay together where several may end in one
    // cell.
    std::size_t begin_of(std::size_t chunk) const;
    OwnWay own_way(const Contact& contact) const {
        return {from_->home(contact.point), from_->is_loose(contact.point),
                contact.site.cast<double>() + contact.place};
    }
    void share_own();
    void find_chunk(std::size_t chunk, double step);
    void press_chunk(std::size_t chunk);
    void find_met();
    void push_chunk(std::size_t chunk);
    void respond_chunk(std::size_t chunk, double step, Meet meet);
    void answer_chunk(std::size_t chunk);

    ContactSide *from_, *onto_;
    Solver solver_;
    double scale_;                                  // contact_stiffness
    bool has_changed_ = false;                      // since the last commit
    bool begins_ = true;                            // nothing committed yet
    ImpactLaw law_{};                               // stiffness and hold: of each point
    double step_ = 0;                               // that these are for [s]
    std::shared_ptr<const PointStiffness> points_;  // null: the sides are not near
    double borne_ = 1;                              // by the other side
    std::vector<char> is_let_be_;                   // of each point; empty: none is
    double share_ = 0.5;                            // of what this way would do alone
    double gone_ = 0;                               // ContactHeld::gone, of points, so far [J]
    double broken_ = 0, turned_ = 0;                // push()
    double kept_ = 0;                               // kept()
    // Of a body with itself; the last is in the place of gone_.
    OwnShares own_;
    std::vector<OwnSpot> own_spot_{};
    std::vector<ContactHeld> own_held_{};  // of each contact
    std::vector<OwnGone> own_gone_{};
    ContactList list_, spare_{};         // the spare one keeps its room for the next search
    std::vector<Meeting> meeting_{};     // of each contact
    std::vector<ContactMemory> next_{};  // to commit
    std::vector<Plane> plane_{};         // of each contact; empty: not for equilibria
    bool is_found_ = false;              // since the last commit
    std::vector<Chunk> chunk_;
    Pushed point_push_{}, cell_push_{};
    // The speed at which what touches was met and does not rest, of each slot that carries it, from
    // the lowest of point_push_ on [m/s]; empty: nothing touches that had not.
    std::vector<double> met_{};
    ContactSums sums_{};
    bool at_once_ = false;   // find() presses too, and respond() answers
    ContactHeld pressed_{};  // press()
};

}  // namespace swage

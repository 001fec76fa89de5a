// SPDX-License-Identifier: GPL-3.0-or-later
// Contact of bodies with each other, and of a body with itself where it folds.
//
// Each surface point of one body meets the volume of the other's cells: the cell that holds it is
// found by the inverse of its trilinear map, and there the depth below the surface that the body
// was molded with (sim/rest_surface.h), turned and stretched as the cell is:
//
//     d = -D a / |J^-T grad D|,   n = J^-T grad D / |J^-T grad D|,   J = dx / dg at the place g.
//
// The point pushes back with its own weights, the cell with the trilinear weights of the same place
// in space, so that force and moment are kept to round-off. Both bodies' points meet the other,
// each with half the stiffness, which is that of both bodies' tools' in series:
//
//     1/k = 1/k_1 + 1/k_2,   k_i = contact_stiffness E_i A / a_i        A the point's area.
//
// A point is never stiffer than a quarter of what its lightest carrier can follow in one step.
// Friction's anchors are material points of the other body. Of two materials friction, static
// friction and stickiness are the means (S2.8), restitution is shared by laws/impact.h.
#pragma once

#include <memory>
#include <vector>

#include "laws/impact.h"
#include "matter/aggregate.h"
#include "sim/cell_place.h"
#include "sim/contact_side.h"
#include "sim/contact_sums.h"
#include "sim/settings.h"

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
    // far, which must be all others, and gravity [m/s2]. By body; sums likewise, set anew. Between
    // bodies that sleep nothing changes.
    void add_forces(const std::vector<Vec3Array*>& force, const Vec3& gravity, double step,
                    const std::vector<char>& asleep, std::vector<ContactSums>& sums);
    // The step is kept: remembers where points stick and how they met.
    void commit();

    // All that a step changes.
    struct State;
    std::shared_ptr<const State> save() const;
    void restore(const State& state);

    // A blade or a crack has changed which cells are whole.
    void connections_changed(std::size_t body);

    std::size_t candidates() const;

  private:
    // A point and the cell of the other side that holds it, or the last that did.
    struct Contact : CellPlace {
        int point;
        Vec3 anchor = Vec3::Zero();  // in cells from the other's origin
        ImpactHistory history{};
        Vec3 bond = Vec3::Zero();  // ImpactForce::bond [N]
        // Where matter has broken a point may be deep in what lies there at once, and deeper than
        // it can have gone: nobody has pressed it in. That much of the depth does not count until
        // it has come out again [m].
        double sunk = 0, pressed = 0;  // pressed: what counted
        bool is_new = true;            // to the surfaces as they are
    };
    // What it does at the present positions.
    struct Push {
        ImpactForce made;
        Vec3 anchor;
    };
    // How a point meets the cell that holds it.
    struct Meeting {
        bool meets = false, is_known = false;
        double depth = 0, sunk = 0;  // depth: that counts
        Vec3 normal, reach;          // reach: from the point to where it sticks [m]
        Mat3 gradient;               // J [m]
        std::array<double, 8> weight;
        Vec3 own;     // of the point [m/s]
        Vec3 now;     // speed of the point over the other side [m/s]
        double give;  // ImpactState::give [1/kg]
        Vec3 spring;  // what its springs do [N]
    };
    // The points of one body against the cells of another, or of its own.
    struct Way {
        int from, onto;
        bool has_broken = false;  // one of them
        ImpactLaw law{};          // stiffness and hold: of each point
        std::vector<double> stiffness{}, hold{};
        std::vector<Contact> contact{};    // sorted by point
        std::vector<Meeting> meeting{};    // of each, at the present positions
        std::vector<Push> push{};          // likewise
        std::array<ContactSums, 2> sum{};  // of the one side and of the other
    };
    void find_pairs(Way& way, double margin);
    Meeting meet(const Way& way, Contact& contact) const;
    void prepare(const Way& way, const Contact& contact, double step, Meeting& meeting) const;
    void spread(const Way& way, std::size_t n, const Vec3& f,
                const std::vector<Vec3Array*>& force) const;
    void respond(Way& way, const std::vector<Vec3Array*>& force, double step);
    void book(Way& way, const std::vector<Vec3Array*>& force, const Vec3& gravity,
              double step) const;
    void set_stiffness(Way& way);

    SimSettings settings_;
    std::vector<ContactSide> side_;
    std::vector<std::vector<Vec3>> listed_;  // of each side, where its skin was
    std::vector<Way> way_;
    double least_spacing_ = 0;  // [m]
    double step_ = 0;           // that stiffness is held to; 0: any [s]
    double allowance_ = -1;     // that any particle may go until renew() finds anew [m]
};

}  // namespace swage

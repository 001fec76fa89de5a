// SPDX-License-Identifier: GPL-3.0-or-later
// The points of one body's surface against the cells of another, or of its own: what they do.
//
// The cell that holds a point is found by the inverse of its trilinear map, and there the depth
// below the surface that the body was molded with (sim/rest_surface.h), turned and stretched as the
// cell is:
//
//     d = -D a / |J^-T grad D|,   n = J^-T grad D / |J^-T grad D|,   J = dx / dg at the place g.
//
// The point pushes back with its own weights, the cell with the trilinear weights of the same place
// in space, so that force and moment are kept to round-off. Friction's anchors are material points
// of the other body. A point is never stiffer than a quarter of what its lightest carrier can
// follow in one step.
//
// In each step, of all ways: meet(), push(), respond(), book(); and commit() where it is kept.
#pragma once

#include <array>
#include <vector>

#include "laws/impact.h"
#include "sim/cell_place.h"
#include "sim/contact_side.h"
#include "sim/contact_sums.h"

namespace swage {

// A point and the cell of the other side that holds it, or the last that did.
struct Contact : CellPlace {
    int point;
    Vec3 anchor = Vec3::Zero();  // in cells from the other's origin
    ImpactHistory history{};
    Vec3 bond = Vec3::Zero();  // ImpactForce::bond [N]
    // Where matter has broken a point may be deep in what lies there at once, and deeper than it
    // can have gone: nobody has pressed it in. That much of the depth does not count until it has
    // come out again [m].
    double sunk = 0, pressed = 0;  // pressed: what counted
    bool is_new = true;            // to the surfaces as they are
};

class ContactWay {
  public:
    // The sides, which may be one, must outlive it; `stiffness` is SimSettings::contact_stiffness.
    ContactWay(const ContactSide& from, const ContactSide& onto, double stiffness);

    const std::vector<Contact>& contacts() const { return contact_; }
    void set_contacts(const std::vector<Contact>& contacts) { contact_ = contacts; }
    // Finds what is nearer than `margin` [m]; what touches stays.
    void search(double margin);

    void set_stiffness(double step);  // for steps of this length [s]; 0: any
    // What is whole has changed on one side or both: the first too, whose points are others then.
    void surfaces_changed(bool points_too, double step);

    // How each point lies and moves now, for a step of this length [s].
    void meet(double step);
    // Adds what springs do to the forces on the one side and on the other.
    void push(Vec3Array& on_a, Vec3Array& on_b) const;
    // Dashpots and friction, one contact after the other, given what all springs do.
    void respond(double step, Vec3Array& on_a, Vec3Array& on_b);
    // What the contacts do while the bodies move, now that all forces are known.
    void book(double step, const Vec3& gravity, const Vec3Array& on_a, const Vec3Array& on_b);
    // While nothing moves.
    void freeze() {
        for (ContactSums& sum : sum_) sum.freeze();
    }
    // Of the one side and of the other.
    const std::array<ContactSums, 2>& sums() const { return sum_; }
    // The step is kept: remembers where points stick and how they met.
    void commit();

  private:
    // What a contact does at the present positions.
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
    Meeting find(Contact& contact) const;
    void prepare(const Contact& contact, double step, Meeting& meeting) const;
    void spread(std::size_t n, const Vec3& f, Vec3Array& on_a, Vec3Array& on_b) const;

    const ContactSide *from_, *onto_;
    double scale_;             // contact_stiffness
    bool has_broken_ = false;  // one of them
    ImpactLaw law_{};          // stiffness and hold: of each point
    std::vector<double> stiffness_{}, hold_{};
    std::vector<Contact> contact_{};  // sorted by point
    std::vector<Meeting> meeting_{};  // of each, at the present positions
    std::vector<Push> push_{};        // likewise
    std::array<ContactSums, 2> sum_{};
};

}  // namespace swage

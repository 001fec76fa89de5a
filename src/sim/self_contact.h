// SPDX-License-Identifier: GPL-3.0-or-later
// A body that comes to rest against itself: sim/body_contact.h without speeds, so that its springs
// alone push, and friction, whose one coefficient is the material's.
#pragma once

#include <memory>
#include <vector>

#include "sim/body_contact.h"

namespace swage {

class SelfContact {
  public:
    // Does nothing unless settings.self_contact. The matter must outlive it.
    SelfContact(Aggregate& matter, const SimSettings& settings);

    // An attempt at an equilibrium begins; take_back(): it has come to nothing, and the matter
    // stands where it began. Returns what points held there that are let be since [J].
    void begin_move();
    double take_back();
    // It is kept, at the present positions: remembers where points stick; returns what friction
    // took [J].
    double commit();

    // Whether any point presses, and from here on against the plane that it meets now.
    bool meet_anew();

    // What is whole has changed: what lies in new surface by now has not been pressed into it.
    void connections_changed();

    // Adds the forces at the present positions [N].
    void add_forces(Vec3Array& force);
    // Of the last forces: what is stored [J], how deep, how many points.
    const ContactSums& sums() const { return sums_; }

    // Whether any point may meet the body; whether any does now; whether more have come near since
    // add_stiffness().
    bool is_near() const { return contact_ != nullptr && contact_->candidates() > 0; }
    bool presses();
    bool has_found_more() const { return is_near() && contact_->candidates() > weighed_; }
    // Adds what they can add to each particle's stiffness [N/m].
    void add_stiffness(std::vector<double>& stiffness);
    // What pressed when forces were last found.
    std::vector<PressedPlaces> pressed() const;

    // Points that were deeper in the body than this [m] when forces were last found meet it no
    // more, whatever is taken back; how many did until now.
    int let_be(double deeper);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(sums_, weighed_);
        if (contact_ != nullptr) io(*contact_);
    }

  private:
    void find();

    std::unique_ptr<BodyContact> contact_;  // null: off
    Vec3Array unused_;                      // forces
    std::shared_ptr<const BodyContact::State> start_;
    ContactSums sums_{}, start_sums_{};
    bool lets_be_ = false;  // more than when the attempt began
    std::size_t weighed_ = 0;
};

}  // namespace swage

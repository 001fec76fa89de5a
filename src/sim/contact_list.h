// SPDX-License-Identifier: GPL-3.0-or-later
// Points of one body's surface and the cells of another, or of its own, that may hold them.
#pragma once

#include <array>
#include <vector>

#include "laws/impact.h"
#include "sim/cell_place.h"

namespace swage {

// A point and the cell that holds it, or the last that did.
struct Contact : CellPlace {
    using IsPlain = Contact;
    int point;
    // What carries the point, in its body's patch; first those with a share.
    int carriers = 0;
    std::array<int, 8> carrier{};
    std::array<float, 8> share{};
    Eigen::Vector3f slope = Eigen::Vector3f::Zero();  // of the depth, where it was last found
    float gap = 0;               // a hole here would pass whatever bytes it holds
    Vec3 dashed = Vec3::Zero();  // what its dashpots did when last found [N]
};

// Contacts meet as a step has brought them; or they are where the last step that was kept has
// ended, and what touched then has the forces of then.
enum class Meet { anew, as_kept };

// What it remembers, committed once a step.
struct ContactMemory {
    using IsPlain = ContactMemory;
    // Where it met the other, and from there to where it sticks: in cells. What that holds is kept
    // apart, for the other may be strained by now, which stretches the way, but not the spring.
    Vec3 place = Vec3::Zero(), reach = Vec3::Zero();
    double held = 0;           // [J], of its way alone
    Vec3 bond = Vec3::Zero();  // ImpactForce::bond [N]
    double stiffness = 0;      // with which it was found [N/m]
    ImpactHistory history{};
    double stored = 0;  // in its springs, were its way alone [J]
    double bound = 0;   // of that, what is lost when it parts; 0 where it does not touch
    // Where matter has broken, a cell turned inside out has held nothing for a while, or another
    // cell tells the depth of what lies beside it, a point may be deeper there than it can have
    // gone: nobody has pressed it in. That much of the depth does not count until it has come out
    // again. Depths as at rest [m].
    double sunk = 0, pressed = 0;  // pressed: what counted
    // Share of its stiffness that is left since a cell was squeezed so thin that no step could have
    // followed the whole.
    double soft = 1;
    // Of the depth in a thin piece; zero where it does not touch, or in others.
    Eigen::Vector3f slope = Eigen::Vector3f::Zero();
    bool is_new = true;  // to the surfaces as they are: its depth is not known from before

    // It has become as soft where it is, which is counted once.
    void soften(const ContactMemory& now) {
        held = now.held, stored = now.stored, bound = now.bound;
        stiffness = now.stiffness, soft = now.soft;
    }
};

// Sorted by point.
struct ContactList {
    std::vector<Contact> contact;
    std::vector<ContactMemory> memory;
    std::size_t size() const { return contact.size(); }

    template <typename Io>
    void visit(Io& io) {
        io(contact, memory);
    }
};

}  // namespace swage

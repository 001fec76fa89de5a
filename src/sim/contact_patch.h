// SPDX-License-Identifier: GPL-3.0-or-later
// The particles of one body that its contacts touch, copied side by side for the time of one step's
// contact: a cache line for how each moves and another for the forces on it, where the body's own
// arrays would ask for seven lines. They stand in the order in which contacts first ask.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/contact_sums.h"
#include "sim/vec4.h"

namespace swage {

class ContactPatch {
  public:
    struct alignas(64) Motion {
        Vec4 place;  // [m], and 1 / mass [1/kg]
        Vec4 speed;  // [m/s], and 0
    };
    struct alignas(64) Force {
        Vec4 all;      // [N], and what points that touch have of stiffness on it [N/m]
        Vec4 springs;  // the same over its mass, of all forces but those of dashpots
    };

    // The body must outlive it.
    explicit ContactPatch(const Aggregate& matter)
        : matter_(&matter), slot_(matter.particle_count(), -1) {}

    void clear();
    // Where the particle stands, which is taken in if it does not yet.
    int slot_of(ParticleId particle);

    // Begins a step's contact with what else acts on the body [N].
    void read(const Vec3Array& force);
    // All springs have been added: from here on springs() stay, whatever else is.
    void find_springs();
    // Ends it, and adds what contacts have done to the powers in `sums`: speeds go on for `step`
    // [s] with these forces and gravity [m/s2].
    void write(Vec3Array& force, const Vec3& gravity, double step, ContactSums& sums);

    const Motion& motion(int slot) const { return motion_[slot]; }
    Vec4& force(int slot) { return force_[slot].all; }
    const Vec4& springs(int slot) const { return force_[slot].springs; }
    Motion motion_of(ParticleId particle) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(particle_);
        if constexpr (Io::kReads) {
            slot_.assign(slot_.size(), -1);
            for (std::size_t n = 0; n < particle_.size(); ++n) slot_[particle_[n]] = int(n);
            motion_.assign(particle_.size(), Motion{});
            force_.assign(particle_.size(), Force{});
        }
    }

  private:
    void read(std::size_t begin, std::size_t end);

    const Aggregate* matter_;
    std::vector<int> slot_;  // of each particle of the body, or -1
    std::vector<ParticleId> particle_;
    std::vector<Motion> motion_;
    std::vector<Force> force_;
    const Vec3Array* others_ = nullptr;  // while a step's contact is under way
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// By which law (laws/fracture.h) each cell and connection of a body breaks: that of its material.
//
// Of a connection that cells of several materials share, and of a cell through which their boundary
// runs, each material has its part. The parts of those that break soften together, as the tougher
// of them; where the connection runs through the boundary, as the weaker, at the stress that both
// bear there. The part of one that does not break holds on alone, and with it the connection: a bar
// of steel keeps its outermost connections when the concrete around it has lost its part of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "laws/fracture.h"
#include "matter/aggregate.h"
#include "sim/connection_shares.h"

namespace swage {

class FractureLaws {
  public:
    explicit FractureLaws(const Aggregate& matter);
    explicit FractureLaws(const Fracture& one);  // of a body of one material

    bool break_any() const { return least_onset_ > 0; }
    double least_onset() const { return least_onset_; }  // of what breaks; 0: nothing does
    // Less where a cell of two materials strains one of them by more than itself.
    double watched_onset() const { return watched_ * least_onset_; }
    double onset_of(std::size_t material) const { return law_[material].onset; }
    // Which materials break, and which hold on; empty where all do the one or the other.
    const MaterialMask& breaking() const { return breaking_; }
    const MaterialMask& holding() const { return holding_; }

    // Of what breaks in it, the tougher; onset 0: nothing does.
    const Fracture& of_cell(const Aggregate& matter, CellId cell) const;
    Fracture of_connection(int direction, ParticleId lower) const {
        const Part part = part_of(direction, lower);
        const Fracture& law = law_[part.law];
        return {part.give * law.onset, part.give * law.peak, law.broken};
    }
    // Whether nothing in it holds on.
    bool breaks_wholly(int direction, ParticleId lower) const {
        return !part_of(direction, lower).holds;
    }
    // Whether what hangs by any connection can snap.
    bool snap_any() const;
    // The strain at which what hangs by the connection snaps; infinite where it holds on, or
    // yields below its strength: what flows bends.
    double snaps_at(int direction, ParticleId lower) const;

  private:
    struct Part {
        std::uint8_t law = 0;  // number of the material whose it is
        bool holds = false;    // something that does not break
        // What the whole connection is strained by over what the part is that breaks: it softens at
        // its stress, by its energy.
        float give = 1;
    };
    Part part_of(int direction, ParticleId lower) const {
        return part_[0].empty() ? whole_ : part_[direction][lower];
    }
    bool breaks(std::size_t material) const { return law_[material].onset > 0; }
    Part both(Part one, Part other) const;
    Part part_in(const Aggregate& matter, CellId cell, const MixedCell* two) const;
    Part part_in(const MixedCell& two, int direction) const;
    double give(const MixedCell& two, std::size_t material) const;

    std::vector<Fracture> law_;     // of each material
    std::vector<double> snaps_at_;  // likewise
    std::vector<double> strength_;  // likewise, as the spacing has it [Pa]
    std::vector<double> modulus_;   // Young's [Pa]
    double least_onset_ = 0, watched_ = 1;
    MaterialMask breaking_, holding_;
    Part whole_;                                         // of a body of one material
    std::array<std::vector<Part>, kForwardCount> part_;  // by lower end; empty: whole_
};

}  // namespace swage

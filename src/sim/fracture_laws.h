// SPDX-License-Identifier: GPL-3.0-or-later
// By which law (laws/fracture.h) each cell and connection of a body breaks: that of its material.
//
// A connection that cells of several materials share, or that lies in one through which their
// boundary runs, has of each that breaks a part of stiffness k, and all these soften together: what
// they bear at their peaks adds up, and what breaking them takes,
//
//     s_1 = sum(k s_1m) / sum(k)      s_f = sum(k s_1m s_fm) / sum(k s_1m)      s_0 as s_1
//
// Where the connection runs through the boundary both bear the same there: it is of the weaker, as
// that would be in the whole cell: with give = f E_m / k, f the cell's share of matter, strained by
// give s_1m when the weaker is at its peak, and broken at s_fm. The part of a material that does
// not break holds on alone, and with it the connection: a bar of steel keeps its outermost
// connections when the concrete around it has lost its part of them.
//
// NOTE: where that is so much softer than the weaker that s_fm is near give s_1m, or below, the
// strength is lowered and the toughness kept, as laws/fracture.h does where a spacing cannot
// resolve the softening: else it would break with more energy in it than breaking takes.
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
    // Of all that breaks of it; onset 0: nothing does.
    const Fracture& of_connection(int direction, ParticleId lower) const {
        return law_[part_of(direction, lower).law];
    }
    // Whether nothing in it holds on.
    bool breaks_wholly(int direction, ParticleId lower) const {
        return !part_of(direction, lower).holds;
    }
    // Whether what hangs by any connection can snap.
    bool snap_any() const;
    // The strain at which what hangs by the connection snaps; infinite where it holds on, or
    // some of it yields below its strength: what flows bends.
    double snaps_at(int direction, ParticleId lower) const;

  private:
    struct Part {
        std::uint32_t law : 31;
        std::uint32_t holds : 1;  // something that does not break
    };
    Part part_of(int direction, ParticleId lower) const {
        return part_[0].empty() ? whole_ : part_[direction][lower];
    }
    bool breaks(std::size_t material) const { return law_[material].onset > 0; }
    void find_parts(const Aggregate& matter);
    // Calls add(material, k, law, whether that is the material's own) of what breaks of a
    // connection in a cell.
    template <typename Add>
    void for_parts(const Aggregate& matter, CellId cell, const MixedCell* two, int direction,
                   const Add& add) const;
    double give(const MixedCell& two, std::size_t material) const;

    std::vector<Fracture> law_;     // of each material, of nothing, and of what several share
    std::vector<double> snaps_at_;  // likewise
    std::vector<double> strength_;  // of each material, as the spacing has it [Pa]
    std::vector<double> modulus_;   // likewise, Young's [Pa]
    double least_onset_ = 0, watched_ = 1;
    MaterialMask breaking_, holding_;
    Part whole_;                                         // of a body of one material
    std::array<std::vector<Part>, kForwardCount> part_;  // by lower end; empty: whole_
};

}  // namespace swage

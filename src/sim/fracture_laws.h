// SPDX-License-Identifier: GPL-3.0-or-later
// By which law (laws/fracture.h) each cell and connection of a body breaks: that of its material.
//
// Of a connection that cells of several materials share, and of a cell through which their boundary
// runs, each material has its part. The parts of those that break soften together, as the tougher
// of them; the part of one that does not break holds on alone, and with it the connection: a bar of
// steel keeps its outermost connections when the concrete around it has lost its part of them.
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
    // Which materials break, and which hold on; empty where all do the one or the other.
    const MaterialMask& breaking() const { return breaking_; }
    const MaterialMask& holding() const { return holding_; }

    // Of what breaks in it; onset 0: nothing does.
    const Fracture& of_cell(const Aggregate& matter, CellId cell) const;
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
    // yields: what flows bends.
    double snaps_at(int direction, ParticleId lower) const;

  private:
    struct Part {
        std::uint8_t law = 0;  // number of the material whose it is
        bool holds = false;    // something that does not break
    };
    Part part_of(int direction, ParticleId lower) const {
        return part_[0].empty() ? whole_ : part_[direction][lower];
    }
    bool breaks(std::size_t material) const { return law_[material].onset > 0; }
    Part both(Part one, Part other) const;
    Part part_in(const Aggregate& matter, CellId cell) const;

    std::vector<Fracture> law_;     // of each material
    std::vector<double> snaps_at_;  // likewise
    double least_onset_ = 0;
    MaterialMask breaking_, holding_;
    Part whole_;                                         // of a body of one material
    std::array<std::vector<Part>, kForwardCount> part_;  // by lower end; empty: whole_
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Plastic flow of the lattice: cells that yield hand their connections new rest lengths.
#pragma once

#include <array>
#include <vector>

#include "laws/yield.h"
#include "matter/aggregate.h"
#include "sim/lattice_sweep.h"
#include "sim/rest_lengths.h"

namespace swage {

class CellFlow {
  public:
    explicit CellFlow(const Aggregate& matter);

    // The rest strains that the connections have at the present positions: the committed ones,
    // and on top what flows. Valid until the next call.
    const RestStrains& rest_strains(const Aggregate& matter);

    // Whether any cell flowed in that call.
    bool flows() const { return !flowing_.empty(); }

    // Remembers the flow of a converged state; returns the work that it took [J]. `found`:
    // rest_strains() was last called at these positions. Adds to `growths`, where it is asked for.
    double commit(Aggregate& matter, bool found = false, RestGrowths* growths = nullptr);

    // What is committed is not what it was when this last looked.
    void history_changed(const Aggregate& matter);

  private:
    struct FlowingCell {
        CellId cell;
        std::array<ParticleId, 4> row;  // low ends of its four edges along x
        SpringReturn flow;
    };
    bool is_far_from_yield(const Aggregate& matter) const;
    void find_strains(const Aggregate& matter);
    void find_flowing(const Aggregate& matter);
    CellSprings springs_of(const Aggregate& matter, CellId cell,
                           const std::array<ParticleId, 4>& row) const;
    double plastic_work(const Aggregate& matter, int d, ParticleId lower, double growth) const;

    Yield law_{};
    double yield_distortion_ = 0;  // of a cell that has not yielded yet; 0: never yields
    std::array<std::vector<float>, kForwardCount> strain_;  // logarithmic, of each connection now
    RestStrains rest_;
    std::vector<FlowingCell> flowing_;  // what rest_ holds beyond the committed strains
};

}  // namespace swage

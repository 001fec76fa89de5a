// SPDX-License-Identifier: GPL-3.0-or-later
// Plastic flow of the lattice: cells that yield hand their connections new rest lengths.
#pragma once

#include <optional>
#include <vector>

#include "sim/flow.h"
#include "sim/flowing_cells.h"

namespace swage {

class CellFlow {
  public:
    explicit CellFlow(const Aggregate& matter);

    // The rest strains that the connections have at the present positions: the committed ones,
    // and on top what flows. Valid until the next call.
    const RestStrains& rest_strains(const Aggregate& matter);

    // Whether any cell flowed in that call.
    bool flows() const { return !flowing_.empty(); }

    // Remembers the flow of a converged state; returns the work that it took [J]. `found`: by
    // rest_strains(). Adds to `growths`, where it is asked for.
    double commit(Aggregate& matter, Forces found = Forces::stale, RestGrowths* growths = nullptr);

    // In motion, where rest_strains() was just called, by the velocities that led there from a step
    // before: what the next commit() returns.
    void book(const Aggregate& matter, double step) { taken_ = taken_in(step, matter); }

    // What is committed is not what it was when this last looked.
    void history_changed(const Aggregate& matter);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(yield_distortion_, strain_, rest_, sound_, flowing_);
    }

  private:
    bool is_far_from_yield(const Aggregate& matter) const;
    void find_strains(const Aggregate& matter);
    void find_sound(const Aggregate& matter);
    double taken_in(double step, const Aggregate& matter) const;

    Yield law_{};
    double yield_distortion_ = 0;  // of a cell that has not yielded yet; 0: never yields
    SpringStrains strain_;
    RestStrains rest_;
    std::vector<char> sound_;            // of each cell; empty: not known
    std::vector<FlowingCells> flowing_;  // what rest_ holds beyond the committed strains
    std::optional<double> taken_;        // between book() and commit()
};

}  // namespace swage

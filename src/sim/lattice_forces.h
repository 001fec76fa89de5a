// SPDX-License-Identifier: GPL-3.0-or-later
// The forces inside the matter by the mechanics that its material asks for, flow and guard
// included.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_sweep.h"
#include "sim/lattice_sweep.h"
#include "sim/loose_springs.h"

namespace swage {

class CellFlow;

// What a converged state took for good.
struct Committed {
    double plastic = 0;   // [J]
    double fracture = 0;  // [J]
    int broken = 0;       // connections
};

struct Cracked {
    int cells = 0;
    double lost = 0;  // energy that turning into springs took [J]
};

// What becomes of energy that a change of the matter would make.
enum class Excess {
    lives_on,  // in its motion, so none is made
    // At rest. NOTE: shapes at rest that are laid down so that none is made load what is beside a
    // crack as the crack closes: a bar of ice went to 23 pieces instead of 2.
    is_lost,
};

class LatticeForces {
  public:
    explicit LatticeForces(const Aggregate& matter, Excess excess = Excess::is_lost);
    LatticeForces(LatticeForces&&) noexcept;
    ~LatticeForces();

    // Connections have been severed or broken, or cells cracked. Such a cell is no cell any more;
    // what it has left acts as plain springs, with the plastic strain it had. Where excess lives on
    // those of matter that breaks are laid down so that they hold no more than it did. Where a
    // blade has `severed` what has flowed they are at rest as they lie: how a cell has flowed says
    // little of what bends it, and held to that what is cut loose crumples.
    void connections_changed(Aggregate& matter, bool severed = false);
    // The matter has been put back to what it was before such changes.
    void take_in(const Aggregate& matter);

    // Forces on every particle at the present positions [N].
    // Returns the number of cells that are inside out: they are stiffer than stiffness_bound()
    // says, by add_guard_stiffness(). With branches, those of each of damped_materials(), their
    // forces are among them, and `given` grows by the work done on them [J].
    int find(const Aggregate& matter, Flow flow, Vec3Array& force,
             std::span<const BranchStep> branches = {}, double* given = nullptr);
    // Whose branches find() moves on, of these of damped_materials().
    const LatticeSweep& sweep(const Aggregate& matter, std::size_t damped);

    // Whether any cell may have been below half of its volume then. Springs never say so: they are
    // left to themselves until cells are inside out, which find() tells.
    bool saw_crushed() const;

    // Remembers the flow and softening of a converged state. `found`: by find(). Adds what rest
    // lengths grow by to `growths`, where that is asked for.
    Committed commit(Aggregate& matter, Forces found = Forces::stale,
                     SlabGrowths* growths = nullptr);
    // In motion, where find() was just called: books what springs lose by flow in this step, while
    // velocities are those of the way there.
    void book_flow(const Aggregate& matter, double step);

    // Cells of a converged and committed state that have reached their strength act as springs from
    // now on; the most strained go first. The state has to be brought to rest again.
    Cracked crack(Aggregate& matter, Forces found = Forces::stale);

    // Whether snap() can find anything: cracked matter that breaks and does not flow. What flows
    // bends, and has no lengths at rest by which to tell.
    bool may_snap() const;
    // Breaks connections that have been bent by more than what they could be stretched
    // (sim/hinges.h), as far as the committed state shows. What they held counts as fracture.
    Committed snap(Aggregate& matter);

    double elastic_energy(const Aggregate& matter);  // [J]
    // By which springs have softened at the strains that were last found, and the energy is less,
    // since what is committed [J].
    double trial_loss() const { return loose_.trial_loss(); }

    // What the cells carry, where forces are theirs alone; else null.
    const std::vector<float>* cells_alone() const { return loose_.empty() ? carried() : nullptr; }

    // For each particle a stiffness [N/m] such that no motion of the lattice is faster than the
    // fastest of these on their own masses: w_max^2 <= max(bound / mass). Zero for a loose
    // particle.
    std::vector<double> stiffness_bound(const Aggregate& matter) const;

    template <typename Io>
    void visit(Io& io, const Aggregate& matter) {  // what steps change, of the matter as it is now
        if constexpr (Io::kReads) {
            if (cells_) cells_->cells_changed(matter);
        }
        bool has_sweep = spring_sweep_ != nullptr;
        std::size_t branches = branch_sweep_.size();
        io(has_sweep, branches);
        if constexpr (Io::kReads) {
            if (has_sweep && !spring_sweep_) spring_sweep_ = std::make_unique<LatticeSweep>(matter);
            while (branch_sweep_.size() < branches) branch_sweep_.emplace_back(matter);
        }
        if (spring_sweep_) io(*spring_sweep_);
        for (LatticeSweep& own : branch_sweep_) io(own);
        if (spring_flow_) io(*spring_flow_);
        io(loose_);
    }

  private:
    // By sound cells, 0 by others; null: springs.
    const std::vector<float>* carried() const { return cells_ ? &cells_->carried_fill() : nullptr; }
    void others_changed(const Aggregate& matter);  // after the sweep over cells knows of it
    double add_branches(const Aggregate& matter, std::span<const BranchStep> branches,
                        Vec3Array& force);

    // Where the strains of loose springs have just been found [J]; and with it what softening on to
    // the present positions is yet to take.
    double energy_found(const Aggregate& matter);
    double energy_to_come(const Aggregate& matter);
    // After cells or connections have become others: energy that this took, of energy_to_come().
    double energy_of_change(Aggregate& matter, double before);

    Excess excess_;
    std::unique_ptr<LatticeSweep> spring_sweep_;  // where springs or branches act
    std::vector<LatticeSweep> branch_sweep_;      // the branches' own, of several materials
    std::unique_ptr<CellFlow> spring_flow_;       // springs that yield
    std::unique_ptr<CellSweep> cells_;            // null: springs
    LooseSprings loose_;                          // of cells that are not sound
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/lattice_forces.h"

#include <algorithm>
#include <cmath>

#include "sim/cell_flow.h"
#include "sim/cracking.h"
#include "sim/crushed_cells.h"
#include "sim/hinges.h"

namespace swage {

namespace {

constexpr double kNearOnset = 1 - 1e-9;  // of the strain at which a cell is looked at

// How far a connection may have turned, over the strain at which it breaks. At a crack that opens,
// what softens is off by as much as it is strained.
constexpr double kMostBent = 3;

}  // namespace

LatticeForces::LatticeForces(const Aggregate& matter, Excess excess)
    : excess_(excess), loose_(matter) {
    const bool springs = matter.material.mechanics == Mechanics::springs;
    if (springs) spring_sweep_ = std::make_unique<LatticeSweep>(matter);
    if (!springs) cells_ = std::make_unique<CellSweep>(matter);
    if (springs && std::isfinite(matter.material.yield_stress)) {
        spring_flow_ = std::make_unique<CellFlow>(matter);
    }
    if (cells_) cells_->watch_strain(loose_.laws().watched_onset());
    take_in(matter);
}

LatticeForces::LatticeForces(LatticeForces&&) noexcept = default;
LatticeForces::~LatticeForces() = default;

void LatticeForces::connections_changed(Aggregate& matter, bool severed) {
    const bool in_excess = excess_ == Excess::lives_on && matter.breaks();
    const bool at_rest = severed && matter.has_flowed();
    std::vector<TurnedCell> turned, flowed;
    if (cells_) cells_->cells_changed(matter, in_excess || at_rest ? &turned : nullptr);
    if (at_rest) {
        const auto first = std::stable_partition(
            turned.begin(), turned.end(),
            [&](const TurnedCell& c) { return matter.hardening_of(c.id()) == 0; });
        flowed.assign(first, turned.end());
        turned.erase(first, turned.end());
    }
    if (in_excess) {
        loose_.lay_down_pressed(matter);
        loose_.take_over(matter, turned);
    }
    loose_.lay_to_rest(matter, flowed);
    others_changed(matter);
}

void LatticeForces::take_in(const Aggregate& matter) {
    if (cells_) cells_->cells_changed(matter);
    others_changed(matter);
}

void LatticeForces::others_changed(const Aggregate& matter) {
    loose_.connections_changed(matter, carried());
    if (spring_flow_) spring_flow_->history_changed(matter);
    if (spring_sweep_) spring_sweep_->connections_changed(matter, loose_.softening_ends(matter));
    for (LatticeSweep& own : branch_sweep_) {
        own.connections_changed(matter, loose_.softening_ends(matter));
    }
}

const LatticeSweep& LatticeForces::sweep(const Aggregate& matter, std::size_t damped) {
    if (!matter.inset.empty()) {
        if (branch_sweep_.empty()) {
            for (const DampedMaterials& of : damped_materials(matter)) {
                branch_sweep_.emplace_back(matter, ConnectionShares(matter, of.counts));
                branch_sweep_.back().connections_changed(matter, loose_.softening_ends(matter));
            }
        }
        return branch_sweep_[damped];
    }
    if (!spring_sweep_) {
        spring_sweep_ = std::make_unique<LatticeSweep>(matter);
        spring_sweep_->connections_changed(matter, loose_.softening_ends(matter));
    }
    return *spring_sweep_;
}

double LatticeForces::add_branches(const Aggregate& matter, std::span<const BranchStep> branches,
                                   Vec3Array& force) {
    double work = 0;
    for (std::size_t n = 0; n < branches.size(); ++n) {
        LatticeSweep& own = branch_sweep_.empty() ? *spring_sweep_ : branch_sweep_[n];
        work += own.add_branches(matter, branches[n], force);
    }
    return work;
}

int LatticeForces::find(const Aggregate& matter, Flow flow, Vec3Array& force,
                        std::span<const BranchStep> branches, double* given) {
    if (cells_) {
        cells_->forces(matter, flow, force);
        if (!branches.empty()) *given += add_branches(matter, branches, force);
        loose_.add_forces(matter, flow, nullptr, force);
        return add_guard_forces(matter, flow, cells_->crushed_runs(), force);
    }
    const bool flows = spring_flow_ && flow == Flow::trial;
    const RestStrains* rest = flows ? &spring_flow_->rest_strains(matter) : nullptr;
    if (flows && !spring_flow_->flows() && matter.connection[0].plastic.empty()) rest = nullptr;
    const FractureLaws& laws = loose_.laws();
    const double limit = laws.break_any() ? kNearOnset * laws.least_onset() : 1e100;
    const bool apart = spring_sweep_->branches_soften() || !branch_sweep_.empty();
    double work = spring_sweep_->forces(
        matter, rest, force, apart || branches.empty() ? nullptr : branches.data(), limit);
    if (apart) work = add_branches(matter, branches, force);
    if (!branches.empty()) *given += work;
    loose_.add_forces(matter, flow, rest, force);
    return add_guard_forces(matter, flow, force);
}

bool LatticeForces::saw_crushed() const {
    if (!cells_) return false;
    for (const auto& runs : cells_->crushed_runs()) {
        if (!runs.empty()) return true;
    }
    return false;
}

void LatticeForces::book_flow(const Aggregate& matter, double step) {
    if (spring_flow_) spring_flow_->book(matter, step);
}

Committed LatticeForces::commit(Aggregate& matter, Forces found, SlabGrowths* growths) {
    Committed result;
    if (growths) growths->resize(std::max<std::size_t>(1, growths->size()));
    if (cells_) result.plastic = cells_->commit(matter, found, growths);
    if (spring_flow_) {
        result.plastic = spring_flow_->commit(matter, found, growths ? &growths->back() : nullptr);
    }
    if (found == Forces::stale || spring_flow_) loose_.find_strains(matter, nullptr);
    const Broken broken = loose_.commit(matter);
    result.fracture = broken.lost;
    result.broken = broken.count;
    if (broken.count > 0 && cells_) {
        // Sound cells beside what broke turn into springs too.
        result.fracture += energy_of_change(matter, energy_to_come(matter));
    } else if (broken.count > 0) {
        connections_changed(matter);
    } else {
        if (spring_sweep_) spring_sweep_->soften(matter);
        for (LatticeSweep& own : branch_sweep_) own.soften(matter);
    }
    return result;
}

Cracked LatticeForces::crack(Aggregate& matter, Forces found) {
    if (!matter.breaks()) return {};
    const bool is_seen = found == Forces::fresh;
    std::vector<const CellRun*> runs;
    if (is_seen && cells_) {
        runs = cells_->strained_runs(matter);
    } else if (is_seen) {
        runs = cells_beside(matter, spring_sweep_->stretched_runs());
    }
    if (is_seen && runs.empty()) return {};
    const std::vector<CellId> cells =
        cells_beyond_strength(matter, loose_.laws(), is_seen ? &runs : nullptr, carried());
    if (cells.empty()) return {};
    if (!is_seen) loose_.find_strains(matter, nullptr);
    const double before = energy_to_come(matter);
    matter.cell_cracked.resize(matter.cell_fill.size(), 0);
    for (CellId cell : cells) matter.cell_cracked[cell] = 1;
    return {static_cast<int>(cells.size()), energy_of_change(matter, before)};
}

double LatticeForces::energy_of_change(Aggregate& matter, double before) {
    connections_changed(matter);
    return before - energy_to_come(matter);
}

bool LatticeForces::may_snap() const { return loose_.laws().snap_any() && !loose_.empty(); }

Committed LatticeForces::snap(Aggregate& matter) {
    const std::vector<Hinge> hinges =
        find_hinges(matter, loose_.ends(matter), [&](const Hinge& connection) {
            return kMostBent * loose_.laws().snaps_at(connection.direction, connection.lower);
        });
    if (hinges.empty()) return {};
    loose_.find_strains(matter, nullptr);
    const double before = energy_to_come(matter);
    for (ConnectionArrays& all : matter.connection) all.damage.resize(all.weight.size(), 0.0f);
    for (const Hinge& h : hinges) {
        matter.connection[h.direction].damage[h.lower] = 1;
        matter.connection[h.direction].weight.set(h.lower, 0);
    }
    return {.fracture = energy_of_change(matter, before),
            .broken = static_cast<int>(hinges.size())};
}

double LatticeForces::elastic_energy(const Aggregate& matter) {
    loose_.find_strains(matter, nullptr);
    return energy_found(matter);
}

double LatticeForces::energy_found(const Aggregate& matter) {
    const double lattice = cells_ ? cells_->elastic_energy(matter) : swage::elastic_energy(matter);
    return lattice + loose_.elastic_energy() + guard_energy_of(matter);
}

double LatticeForces::energy_to_come(const Aggregate& matter) {
    return energy_found(matter) + loose_.trial_loss();
}

std::vector<double> LatticeForces::stiffness_bound(const Aggregate& matter) const {
    std::vector<double> bound;
    if (cells_) {
        bound.assign(matter.particle_count(), 0.0);
        cells_->add_stiffness_bound(matter, bound);
    } else {
        bound = swage::stiffness_bound(matter);
    }
    loose_.add_stiffness_bound(bound);
    return bound;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep over all connections of a lattice: forces of their springs (laws/spring_damper.h) and
// of the branches that damp them (laws/internal_damping.h).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "laws/internal_damping.h"
#include "laws/lane_tensor.h"
#include "matter/aggregate.h"
#include "sim/connection_shares.h"
#include "sim/force_slabs.h"

namespace swage {

double lattice_stiffness(const Aggregate& matter);  // of a full connection [N/m]

// rest_length / reference_length - 1 of every connection, by direction and lower particle.
using RestStrains = std::array<std::vector<float>, kForwardCount>;

// A step of the branches beside each connection (laws/internal_damping.h).
struct BranchStep {
    int count = 0;
    std::array<DampingStep, kMostBranches> forward{};
    double step = 0;                       // [s]
    std::vector<float>* strain = nullptr;  // LatticeSweep::branch_floats() of them
    // By how much the logarithms of rest lengths have grown since the last step, with kLanes more
    // behind; null: nothing flowed.
    const RestStrains* grown = nullptr;
    double yield_strain = 0;
};

// The lattice in slabs of rows, cut by its size alone; each row in lanes, as wide as the machine
// has them. The same bits at any width and number of threads.
class LatticeSweep {
  public:
    // `shares`: how stiff the connections of a body of several materials are.
    explicit LatticeSweep(const Aggregate& matter, ConnectionShares shares = {});

    // Connections were severed or broken. `softens`: of each particle, whether connections that it
    // is the lower end of may soften; empty: none.
    void connections_changed(const Aggregate& matter, const std::vector<char>& softens = {});
    // Connections have softened: the branches beside them do too.
    void soften(const Aggregate& matter);
    bool branches_soften() const { return !softened_.empty(); }

    // force = sum of the connections' forces on each particle [N], with the given rest strains or
    // else the committed ones. A strain above `limit` is told by stretched_runs(). With branches,
    // these are moved on and pull too; returns the work done on them in the step [J].
    double forces(const Aggregate& matter, const RestStrains* rest, Vec3Array& force,
                  const BranchStep* branches = nullptr, double limit = 1e100);
    // Adds those of the branches alone.
    double add_branches(const Aggregate& matter, const BranchStep& branches, Vec3Array& force);

    std::size_t branch_floats(int count) const {
        return batch_.size() * kForwardCount * static_cast<std::size_t>(count) * kLanes;
    }
    // Energy stored in branches with these strains [J].
    double branch_energy(const Aggregate& matter, const DampingBranches& branches,
                         const std::vector<float>& strain) const;

    // Runs of the last sweep with a strain above the limit, slab by slab.
    const std::vector<std::vector<const SpringRun*>>& stretched_runs() const { return stretched_; }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(shares_, batch_, weight_, softens_, softened_);
    }

  private:
    ConnectionShares shares_;
    std::vector<SpringRun> run_;
    std::vector<RowSlab> slab_;
    std::vector<std::size_t> slab_batch_;  // first batch of eight of each slab
    // Of each batch: -1 where all its connections are there and whole; or where their weights are,
    // by direction and lane.
    std::vector<std::int32_t> batch_;
    std::vector<float> weight_;
    struct SofteningEnd {
        using IsPlain = SofteningEnd;
        ParticleId lower;
        std::int32_t at;  // in weight_, of the first direction
    };
    std::vector<SofteningEnd> softens_;  // lower ends of connections that may soften
    std::vector<float> softened_;        // weight_ of the branches where these are; else empty
    std::vector<std::vector<const SpringRun*>> stretched_;
    std::vector<double> work_;  // a slab [J]

    struct Wanted {
        bool springs;
        const RestStrains* rest;
        const BranchStep* branches;
        double limit;
    };
    double sweep(const Aggregate& matter, const Wanted& wanted, Vec3Array& force);
};

// Elastic energy stored in the connections of a body of one material [J].
double elastic_energy(const Aggregate& matter);

// For each particle a stiffness [N/m] such that no motion of the lattice is faster than the fastest
// of these on their own masses: w_max^2 <= max(bound / mass). Zero without connections.
std::vector<double> stiffness_bound(const Aggregate& matter, const ConnectionShares& shares = {});

}  // namespace swage

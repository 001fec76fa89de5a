// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of a lattice that hold two materials (laws/laminate.h), beside the sweep over the rest.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/flow.h"
#include "sim/material_laws.h"
#include "sim/rest_lengths.h"

namespace swage {

// The cells of two materials in batches of the same two. Those with `carried` 0 are left out.
struct MixedBatches {
    MixedBatches() = default;
    MixedBatches(const Aggregate& matter, const std::vector<float>& carried);

    std::size_t count() const { return cell.empty() ? 0 : first.size() - 1; }

    std::vector<int> cell;  // into mixed_cell
    std::vector<std::array<ParticleId, 8>> corner;
    std::vector<int> first;  // of each batch; the end
};

// What it holds [J].
double elastic_energy(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                      const MixedCell& cell);

// The largest principal strain of each of its two materials, less what has flowed.
std::array<double, 2> largest_strains(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                                      const MixedCell& cell);

// Of each of its two materials the equivalent stress, before any return, over that at which it
// flows; 0: it does not yield.
std::array<double, 2> part_yield_shares(const Aggregate& matter,
                                        const std::vector<MaterialLaw>& laws,
                                        const MixedCell& cell);

// Gradient, and P = dW/dF per volume of material [Pa], of each of its two materials.
struct PartStress {
    Mat3 gradient, stress;
};
std::array<PartStress, 2> part_stresses(const Aggregate& matter,
                                        const std::vector<MaterialLaw>& laws,
                                        const MixedCell& cell);

class MixedCells {
  public:
    // Cells with `carried` 0 are left out.
    void cells_changed(const Aggregate& matter, const std::vector<float>& carried);

    // Adds their forces on the particles [N]. Laws: by material, as they are to hold now.
    void add_forces(const Aggregate& matter, const std::vector<MaterialLaw>& laws,
                    Vec3Array& force);
    // Remembers the flow and the jumps of a converged state; returns the work that flow took [J].
    double commit(Aggregate& matter, const std::vector<MaterialLaw>& laws, Forces found,
                  RestGrowths* growths) const;
    double elastic_energy(const Aggregate& matter, const std::vector<MaterialLaw>& laws) const;

    // What the last forces found of a cell.
    struct Seen {
        bool may_flow;
        Vec3 jump;  // as in MixedCell
    };

  private:
    std::vector<Seen> seen_;
    MixedBatches batches_;
    std::vector<std::array<double, 24>> push_;
};

}  // namespace swage

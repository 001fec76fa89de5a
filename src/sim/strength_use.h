// SPDX-License-Identifier: GPL-3.0-or-later
// How much of what it can bear a body's matter uses, as the laws have it that let it flow and
// break:
//
//     yield       equivalent stress over that at which the cell flows now (laws/cell.h, less the
//                 back stress laws/cell_back.h, of springs laws/yield.h); where it has not flowed
//                 yet, at its corners too, as far as its bending carries: a bent bar comes to 1
//                 when its surface does, and its cells flow a little later
//     strength    largest elastic strain over that at which the cell breaks (sim/cracking.h)
//
// Each is 1 at the most, and where it has flowed or broken. At a corner (xi, eta, zeta), -1 or 1,
// of what laws/cell.h calls D and Q
//
//     C_xx = |D_x + eta Q_xy + zeta Q_zx + eta zeta Q_xyz|^2 / 16 a^2
//     C_xy = (D_x + zeta Q_zx).(D_y + zeta Q_yz) / 16 a^2              and so on
//
// for a cell that bends shears its corners by nothing that is real: shear is told from where it is
// not (assumed strains). Nor can it grow thin on the one side and thick on the other: of what C_xx
// and C_yy change by along z, C_zz is less by nu / (1 - nu) (incompatible modes).
//
// Sources of these: E. Dvorkin, K. Bathe, "A continuum mechanics based four-node shell element",
// Eng. Comput. 1, 1984; E. Wilson, R. Taylor, W. Doherty, J. Ghaboussi, "Incompatible displacement
// models", 1973.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/material_laws.h"

namespace swage {

// The most of it, and the middle of the matter in that cell, as it is now; 0: nothing.
struct Used {
    using IsPlain = Used;
    double share = 0;
    Vec3 place = Vec3::Zero();
};

class StrengthUse {
  public:
    // What has flowed or broken by now counts no more.
    explicit StrengthUse(const Aggregate& matter);

    bool may_flow() const { return may_flow_; }
    bool has_strength() const { return has_strength_; }

    struct Most {
        Used yield, strength;
    };
    // Where it is more than this, which is soon told of most cells; a converged state. Of equals
    // that of the first cell.
    Most beyond(const Aggregate& matter, double yield, double strength);

    template <typename Io>
    void visit(Io& io) {  // what looking changes
        io(flowed_, broken_);
    }

  private:
    double yield_share(const Aggregate& matter, const CellRun& run, int n) const;
    double strength_share(const Aggregate& matter, const CellRun& run, int n) const;
    void remember(const Aggregate& matter);
    void look(const Aggregate& matter, const CellRun& run, std::vector<double>& measure,
              Most& most) const;

    std::vector<MaterialLaw> law_;
    // By material, infinite: never; of the second at the least.
    std::vector<double> onset_, first_flow_;  // strain
    std::vector<float> flowed_;               // of each cell when last looked; empty: none
    std::vector<float> broken_;               // how far each was as this began; empty: none was
    bool may_flow_, has_strength_, springs_;
};

// The most that any cell has flowed, and where.
Used most_flowed(const Aggregate& matter);

// Of a cell of mechanics "springs": equivalent stress of what works in it [Pa].
double spring_stress(const Aggregate& matter, CellId cell, const std::array<ParticleId, 4>& row);

double spring_flow_stress(const Material& of, double alpha);  // at which it flows [Pa]

// Radius of the surface within which a cell's stress, less the back stress, stays [Pa].
double yield_radius(const CellModuli& law, double alpha);

}  // namespace swage

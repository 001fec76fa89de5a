// SPDX-License-Identifier: GPL-3.0-or-later
// The connections of cells that are not sound: what a blade has severed, and what has reached its
// strength, acts as plain springs, which soften and break (laws/fracture.h) when the material does.
#pragma once

#include <vector>

#include "matter/aggregate.h"
#include "sim/flow.h"
#include "sim/fracture_laws.h"
#include "sim/lattice_sweep.h"
#include "sim/turned_cell.h"

namespace swage {

struct Broken {
    double lost = 0;  // energy that softening took [J]
    int count = 0;    // connections that broke
};

class LooseSprings {
  public:
    explicit LooseSprings(const Aggregate& matter);

    // Lays down in the matter what the springs of such cells are at rest with (cell_set), so that
    // they hold no more than the cells did. A cell that is partly filled resists being bent by its
    // filling cubed, and springs by the filling itself: their excess of that is taken away first,
    // and what their stretch holds too much then, as it does across the boundary of two materials.
    // For matter that breaks: what a blade severs, its tools pay for. connections_changed() must
    // follow.
    void take_over(Aggregate& matter, const std::vector<TurnedCell>& turned);
    // The same of what has just broken, in cells that press on it: closed cracks are stiffer. To be
    // called while the springs and their strains are still those of before.
    void lay_down_pressed(Aggregate& matter) const;
    // The same so that they hold nothing, as they lie.
    void lay_to_rest(Aggregate& matter, const std::vector<TurnedCell>& turned);

    const FractureLaws& laws() const { return laws_; }
    bool empty() const { return spring_.empty(); }

    // Connections were severed or broken, or cells cracked. `carried`: what each sound cell
    // carries, 0: none; null: they are told by themselves.
    void connections_changed(const Aggregate& matter, const std::vector<float>* carried);

    // Of each particle, whether it is the lower end of any that softens; empty: none is.
    std::vector<char> softening_ends(const Aggregate& matter) const;

    // Of each particle, whether any spring ends there.
    std::vector<char> ends(const Aggregate& matter) const;

    // Adds the springs' forces. `rest`: as for LatticeSweep; read with mechanics "springs" only,
    // whose sweep carries every connection as if sound: what it carries too much is taken off.
    void add_forces(const Aggregate& matter, Flow flow, const RestStrains* rest, Vec3Array& force);

    // Finds the springs' strains at the present positions, as add_forces() and
    // connections_changed() do too: what follows is of the last time.
    void find_strains(const Aggregate& matter, const RestStrains* rest);

    // Remembers the softening of a converged state. Connections that it breaks have no weight from
    // then on: connections_changed() must follow when there are any.
    Broken commit(Aggregate& matter);

    // [J], softened as far as the strains ask; with mechanics "springs" beside that of the sweep.
    double elastic_energy() const { return sum_of(&LooseSprings::stored_in); }
    // Energy that softening on to them would take [J].
    double trial_loss() const { return sum_of(&LooseSprings::loss_of); }

    void add_stiffness_bound(std::vector<double>& bound) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(spring_, now_, pull_);
    }

  private:
    template <typename Factor>
    void lay_down(Aggregate& matter, CellId cell, const Factor& longer_by);
    enum class Kind : char {
        elastic,    // for ever
        softening,  // when pulled
        closing,    // a broken edge: only resists being pressed
    };
    struct Spring {
        using IsPlain = Spring;
        ParticleId lower, upper;
        char direction, slot;
        Kind kind;
        CellId cell;
        double stiffness;    // [N/m]
        double rest_length;  // [m]; mechanics of cells only
        double worst;        // largest strain so far, committed; of a diagonal: of its face
        Fracture law;        // onset 0: does not break
        int partner;         // the other diagonal, or itself
        double strain = 0;   // its own and what it softens by, committed
        double softens_by = 0;
    };
    void add_springs(const Aggregate& matter, const CellRun& run, int n);
    void find_softening();
    // A broken edge that is not pressed does nothing.
    bool is_open(std::size_t n) const {
        return spring_[n].kind == Kind::closing && now_[n].strain > 0;
    }
    double now_worst(std::size_t n) const { return std::max(spring_[n].worst, now_[n].softens_by); }
    void commit_strains();
    double loss_of(std::size_t n) const;
    double stored_in(std::size_t n) const;
    double sum_of(double (LooseSprings::*part)(std::size_t) const) const;

    FractureLaws laws_;
    bool beside_sweep_;
    double stiffness_;
    std::array<double, kForwardCount> reference_;  // [m]
    std::vector<Spring> spring_;
    struct Stretch {
        using IsPlain = Stretch;
        Vec3 reach;                       // from lower to upper [m]
        double distance, length, strain;  // length: at rest [m]
        double softens_by;                // the strain of its face, or its own
    };
    std::vector<Stretch> now_;  // of each spring, when last looked at
    std::vector<Vec3> pull_;    // likewise, on its lower end [N]
};

}  // namespace swage

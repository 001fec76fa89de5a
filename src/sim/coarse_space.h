// SPDX-License-Identifier: GPL-3.0-or-later
// The slow motions of a body, for relaxation: shifting, rocking and bending as a whole take a
// simple scheme thousands of iterations. In the few numbers of a spline space P (sim/spline_space)
// a force moves the body by its stiffness and not by mass, as in a two-level additive Schwarz
// method (Dryja and Widlund, 1987):
//
//     B = M^-1 + P C P^T,   C = (2 P^T K P + P^T M P / g)^-1
//
// M are masses under which steps of M^-1 f are stable; no motion is made lighter than by a factor
// g. K is the lattice's elastic stiffness, by differences of its forces, and that of what holds
// points and of places that press on each other.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "matter/aggregate.h"
#include "sim/held_point.h"
#include "sim/panel_cholesky.h"
#include "sim/spline_space.h"

namespace swage {

class CoarseSpace {
  public:
    explicit CoarseSpace(const Aggregate& matter);

    using Vector = SplineSpace::Vector;
    // Of the lattice at the present positions.
    using Forces = std::function<void(Vec3Array& force)>;

    // Whether the stiffness is not known, or the body has turned or strained too far since then.
    bool is_stale(const Vec3Array& position) const;
    // Finds the lattice's stiffness; the positions are moved a little and put back.
    void find_stiffness(Aggregate& matter, const Forces& forces);
    void find_masses(const std::vector<double>& mass);
    // With what now holds the body, and where it presses on itself.
    void hold(const Aggregate& matter, const std::vector<HeldPoint>& held,
              const std::vector<PressedPlaces>& pressed = {});
    void limit_gain(double most);  // g

    // Whether there is a C.
    bool gains() const { return gains_; }
    // velocity = keep velocity + P C P^T (step force)
    void add(const Vec3Array& force, double step, double keep, Vec3Array& velocity) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(probed_, stiffness_, held_, inertia_, most_gain_, gains_);
    }

  private:
    // Nodes that move the same matter as a node does, itself among them.
    struct Neighbor {
        int node;
        int mirror;  // where that one has this one
    };
    using Edges = std::array<Vec3, 3>;
    Edges edges(CellId cell, const Vec3Array& position) const;
    void choose_samples();
    void find_pattern();
    void choose_turns();
    int neighbor_at(int node, int other) const;  // -1: it is none
    void factor();

    const Lattice& lattice_;
    SplineSpace space_;
    std::vector<CellId> sample_;  // a cell in each element
    std::vector<Edges> probed_;   // of each, when the stiffness was found; empty: it was not
    // Of all nodes one after the other, in the order of the places that they stand at.
    std::vector<Neighbor> neighbor_;
    // By node and way: the first neighbor that stands there or beyond; one more at the end.
    std::vector<int> first_;
    // Of each node those from its own place in the factor on, in the factor's order.
    std::vector<std::vector<int>> from_here_;
    // Nodes that are moved together, turn by turn: no two of them pull on the same node.
    std::vector<std::vector<int>> turn_;
    std::vector<Mat3> stiffness_, held_;  // of each neighbor
    std::vector<double> inertia_;         // likewise
    double most_gain_ = 1;
    std::unique_ptr<PanelCholesky> factor_;
    bool gains_ = false;
};

}  // namespace swage

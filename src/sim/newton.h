// SPDX-License-Identifier: GPL-3.0-or-later
// Equilibrium by Newton's method, for bodies that are held and loaded smoothly: no tool touches, no
// connection is severed. The tangent is never stored; its system is solved by conjugate gradients
// with a multigrid or direct solution before them (sim/multigrid.h), and each step is as long as
// the work along it says.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_tangent.h"
#include "sim/flow_aside.h"
#include "sim/held_point.h"
#include "sim/multigrid.h"
#include "sim/soft_mode.h"

namespace swage {

// What the solver asks of the body.
struct NewtonProblem {
    std::function<void(Vec3Array& force)> forces;            // at the present positions
    std::function<double(const Vec3Array& force)> residual;  // 1: as much as is pushed with
    double tolerance;                                        // of that residual
    std::vector<HeldPoint> held;
    // Asked before each step where what holds the body changes as it moves; may be empty.
    std::function<std::vector<HeldPoint>()> held_now;
    std::vector<double> diagonal;  // of each particle, no less than its stiffness [N/m]
    std::vector<double> drag;      // springs to where the particles began [N/m]
    bool gives_way = false;        // as a body that has buckled does: it may go far
};

// The share of a motion, weighed by mass, in how far the body has gone from `start`.
double gone_by(const Aggregate& matter, const Vec3Array& motion, const Vec3Array& start);

class Newton {
  public:
    Newton(const Aggregate& matter, const std::vector<float>& carried_fill);

    struct Result {
        bool converged = false;
        int steps = 0;
        double residual = 0;
    };
    // Moves the particles. What it leaves when it does not converge means nothing.
    Result solve(Aggregate& matter, NewtonProblem problem);

    // Whether the body, at rest under a load of this size, would leave this equilibrium at the
    // slightest touch; by which motion.
    bool buckles(const Aggregate& matter, const NewtonProblem& problem, double load);
    const Vec3Array& softest_motion() const { return softest_.motion(); }
    // Where it does not: whether it would by this motion if what flows bore only what it does.
    bool buckles_in_flow(const FlowAside& flow) const;
    // Whether in the last solution it gave way so, near rest, and has gone from `start` most of all
    // by the motion that it gave way to.
    bool has_gone_over(const Aggregate& matter, const Vec3Array& start) const;
    const Vec3Array& gave_way_by() const { return gave_way_; }  // that motion

    // How far the body has gone from `start` by its slowest motion, that of least stiffness for its
    // mass, and how far these forces, left over, would still take it.
    struct Astray {
        double gone = 0, left = 0;  // [m]
    };
    Astray astray(const Aggregate& matter, const NewtonProblem& problem, const Vec3Array& force,
                  const Vec3Array& start);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(multigrid_, falls_, prepared_, softest_, slowest_);
    }

  private:
    bool prepare(const Aggregate& matter, const NewtonProblem& problem, bool exact);
    bool find_direction(const Aggregate& matter, const NewtonProblem& problem, double accuracy);
    void give_way(const Aggregate& matter, const NewtonProblem& problem, double curvature);
    // `turns`: nothing holds the body, it may turn as a whole.
    double line_search(Aggregate& matter, const NewtonProblem& problem, bool turns);
    struct Descent;
    double go_down(Aggregate& matter, const NewtonProblem& problem, Descent& descent);
    bool find_bend(Aggregate& matter, const NewtonProblem& problem);
    void product(const Aggregate& matter, const NewtonProblem& problem, CellTangent::Kind kind,
                 const Vec3Array& direction, Vec3Array& result);

    // A step apart from the shift and turn of the whole body, which is done as such: a body that
    // nothing holds turns far, and along straight lines it would grow.
    struct Way {
        Vec3 center, shift, turn;  // [m], [m], [rad]
        Vec3Array rest;            // [m]
    };
    Way way_of(const Aggregate& matter, bool loose) const;

    // What stands in multigrid_, and how old it is.
    struct Prepared {
        bool stands = false;  // the last try has come to something
        CellTangent::Kind kind{};
        Vec3Array at{};          // positions
        std::size_t points = 0;  // that were held
        int iterations = -1;     // of the first solution with it; -1: none yet
        bool is_stale = false;   // it serves badly by now, or for long enough

        bool is_for(const NewtonProblem& problem, const Aggregate& matter) const;
        // In a solution of so many iterations.
        void serve(int count);

        template <typename Io>
        void visit(Io& io) {
            io(stands, kind, at, points, iterations, is_stale);
        }
    };

    CellTangent tangent_;
    Multigrid multigrid_;
    double extent_;       // [m]
    bool falls_ = false;  // some direction has had negative curvature
    Vec3Array gave_way_;  // that motion, the first in a solution; empty: to none
    Prepared prepared_;
    SoftMode softest_, slowest_;
    Vec3Array force_, direction_, residual_, search_, image_, better_, from_, bent_;
};

}  // namespace swage

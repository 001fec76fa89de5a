// SPDX-License-Identifier: GPL-3.0-or-later
// One step of backward Euler for one body: the places x that make least
//
//     1/2 (x - x~)^T M (x - x~) / h^2 + E(x),   x~ = x0 + h v0,
//
// E all energy at the end of the step, by Newton's method (sim/newton.h): mass enters as a spring
// of m / h^2 to x~ for each particle. Where the tangent is not positive definite the part of it
// that is stands in, and each Newton step is as long as the work along it says (Baraff, Witkin,
// SIGGRAPH 1998; Martin et al., SIGGRAPH 2011). Which points of the surface touch a tool, and
// whether they slip, is asked anew before each Newton step, so that contact is part of the
// solution.
//
// Stability: for a swing of angular frequency w the step maps (x, v h) by a matrix whose
// eigenvalues are 1 / (1 +- i w h), inside the unit circle for every h: no bound. Each step takes
// 1/2 m |v1 - v0|^2 + 1/2 dx K dx from the swing, a share of about w h per radian.
#pragma once

#include <memory>

#include "sim/moving_body.h"
#include "sim/newton.h"

namespace swage {

class ImplicitStep {
  public:
    // Why it cannot move such a body, as the end of a sentence; null: it can.
    static const char* cannot(const Aggregate& matter);

    // The body's forces have been found where it is and begin_step() called. Moves it on by a step
    // of `step` [s] to where `now` is, forces found there. False: no solution; the body is then
    // anywhere.
    bool move(MovingBody& body, const Drive& now, double step, BodyOutcome& outcome);


    template <typename Io>
    void visit(Io& io, const MovingBody& body) {  // what steps change, of the body as it is now
        bool has_newton = newton_ != nullptr;
        io(has_newton);
        if constexpr (Io::kReads) {
            const std::vector<float>* cells = body.cells_alone();
            if (has_newton && cells != nullptr) {
                newton_ = std::make_unique<Newton>(body.matter(), *cells);
            }
        }
        if (newton_) io(*newton_);
    }

  private:
    std::unique_ptr<Newton> newton_;
    std::vector<double> inertia_;  // m / h^2 [N/m]
    Vec3Array start_, aim_;
};

}  // namespace swage

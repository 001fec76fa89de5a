// SPDX-License-Identifier: GPL-3.0-or-later
// The motion that the stress in a body at rest takes most of the matter's own stiffness from,
// followed from one equilibrium to the next: when it takes more than all of it the body buckles.
// Locally optimal preconditioned conjugate gradients for one eigenvector (Knyazev, SIAM J. Sci.
// Comput. 23, 2001).
//
// NOTE: the motion of least stiffness for its mass is another. A broad plate on slender legs swings
// by itself far more slowly than it sways on them, and was followed while they gave way.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

class SoftMode {
  public:
    using Map = std::function<void(const Vec3Array& from, Vec3Array& to)>;

    // Comes closer to that motion, of those that have nothing of what is `free`
    // (sim/free_motions.h), and now and then looks whether it is another by now: where `load`, of
    // any unit, has grown by a share since, too. `mass` and `stiffness` are those of each particle,
    // the latter about; `product`: by the whole stiffness;
    // `of_matter`: by the matter's own and what holds it, or by its mass, which makes it the
    // slowest motion and what is left its stiffness [1/s2]; `solve` is about the inverse of either.
    // Returns what is left, as a share of the matter's own, never less than there is; 1 where the
    // matter itself has none.
    double follow(const std::vector<double>& mass, const std::vector<double>& stiffness,
                  const std::vector<Vec3Array>& free, const Map& product, const Map& of_matter,
                  const Map& solve, double load = 0);

    const Vec3Array& motion() const { return found_.motion; }  // the matter's own of it is 1
    double left() const { return found_.left; }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(found_, looks_, load_);
    }

  private:
    struct Found {
        Vec3Array motion, last{};  // the last step towards it
        double left = 1;           // when last looked at

        template <typename Io>
        void visit(Io& io) {
            io(motion, last);
        }
    };

    Found found_;
    int looks_ = 0;
    double load_ = 0;  // at which it was looked whether it is another
};

}  // namespace swage

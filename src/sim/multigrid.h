// SPDX-License-Identifier: GPL-3.0-or-later
// Approximate solution of K x = b for the tangent K of a lattice: a symmetric V-cycle over ever
// coarser lattices. The finest is never stored: it is known by its products. The coarsest is solved
// directly; it is the body's own lattice where that is cheap, and then the solution is exact.
//
// Smoothing: Chebyshev polynomials of the matrix scaled by its diagonal (Adams, Brezina, Hu,
// Tuminaro, J. Comput. Phys. 188, 2003), whose largest eigenvalue is found by power iteration.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "matter/aggregate.h"
#include "sim/cell_tangent.h"
#include "sim/held_point.h"
#include "sim/lattice_transfer.h"
#include "sim/node_stiffness.h"
#include "sim/slab_cholesky.h"

namespace swage {

class Multigrid {
  public:
    explicit Multigrid(const Aggregate& matter);

    using Product = std::function<void(const Vec3Array& direction, Vec3Array& result)>;

    // Finds the coarse matrices at the present positions. False: a level is not positive definite.
    // `drag`: of each particle, a spring to a fixed place [N/m].
    bool prepare(const Aggregate& matter, const CellTangent& tangent, CellTangent::Kind kind,
                 const std::vector<HeldPoint>& held, const std::vector<double>& drag,
                 const Product& product);

    // x = about K^-1 b
    void solve(const Product& product, const Vec3Array& b, Vec3Array& x);

    bool is_direct() const { return level_.size() == 1 && level_[0].ratio == Vec3i::Ones(); }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(inverse_blocks_, finest_, level_);
        io(*direct_);
    }

  private:
    struct Smoother {
        double largest = 0;  // eigenvalue of the scaled matrix; 0: not known yet
        Vec3Array mode;      // about its vector
        Vec3Array step, residual, product;

        template <typename Io>
        void visit(Io& io) {
            io(largest, mode);
        }
    };
    struct Level {
        Vec3i ratio;  // to the body's own lattice
        Lattice lattice;
        std::unique_ptr<LatticeTransfer> from_finer;  // null: there is nothing finer
        std::unique_ptr<NodeStiffness> matrix;
        std::vector<Mat3> inverse_diagonal;
        Smoother smoother;
        Vec3Array b, x;

        template <typename Io>
        void visit(Io& io) {
            io(*matrix, inverse_diagonal, smoother);
        }
    };
    void add_points(Level& level, const std::vector<HeldPoint>& held) const;
    void find_own_blocks(const Aggregate& matter, const CellTangent& tangent,
                         CellTangent::Kind kind, const std::vector<HeldPoint>& held,
                         const std::vector<double>& drag);
    template <typename Scale>
    void find_largest(const Product& product, const Scale& scale, std::size_t count, Smoother& s);
    template <typename Scale>
    void smooth(const Product& product, const Scale& scale, const Vec3Array& b, bool from_zero,
                Smoother& s, Vec3Array& x);
    void cycle(std::size_t level, const Vec3Array& b, Vec3Array& x);

    std::vector<Vec3i> site_;           // of each particle
    std::vector<Mat3> inverse_blocks_;  // of the finest
    Smoother finest_;
    Vec3Array coarse_;
    std::vector<Level> level_;  // from fine to coarse
    std::unique_ptr<SlabCholesky> direct_;
};

}  // namespace swage

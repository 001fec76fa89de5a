// SPDX-License-Identifier: GPL-3.0-or-later
// The slow motions of a body, for relaxation: shifting, rocking and bending as a whole take a
// simple scheme thousands of iterations. They are well described by a few coarse nodes over the
// lattice, whose motions P the particles follow trilinearly; there each mode is given the mass that
// suits its own stiffness:
//
//     a = M^-1 f + P V (s - 1) V^T P^T f,   s = 1 / (2 l), at least 1
//
// V, l: modes of the coarse stiffness, V^T P^T M P V = 1, V^T P^T K P V = l. K is the lattice's
// elastic stiffness now, by differences of its forces, and the contacts'.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "matter/aggregate.h"
#include "sim/held_point.h"

namespace swage {

class CoarseModes {
  public:
    explicit CoarseModes(const Aggregate& matter);

    using Vector = Eigen::VectorXd;  // three numbers a coarse node
    using Forces =
        std::function<void(Vec3Array& force)>;  // of the lattice at the present positions

    // Finds the coarse stiffness of the lattice anew; the positions are moved a little and put
    // back.
    void find_stiffness(Aggregate& matter, const Forces& forces);
    // Finds the modes for these relaxation masses and held points.
    void find_modes(const Aggregate& matter, const std::vector<double>& mass,
                    const std::vector<HeldPoint>& held);
    // No mode is made lighter than by this factor.
    void limit_gain(double most);
    bool gains() const { return gains_; }

    Vector restricted(const Vec3Array& force) const;  // P^T f
    // The coarse motion that a adds to M^-1 f, and by how much a M a exceeds f M^-1 f.
    Vector gain(const Vector& total) const {
        return modes_ * (more_ * (modes_.transpose() * total));
    }
    double gain_size(const Vector& total) const;
    // v = keep v + P motion
    void add(const Vector& motion, double keep, Vec3Array& velocity) const;

  private:
    // Particles of one run within one coarse cell along x.
    struct Stretch {
        ParticleId begin, end;
        double at;    // place of the first particle along x in the coarse cell, 0 to 1
        double step;  // from one particle to the next
        int node;     // lowest of the coarse cell
        double y, z;  // place in the coarse cell
    };
    int node_at(int i, int j, int k) const { return i + nodes_.x() * (j + nodes_.y() * k); }
    Eigen::MatrixXd restricted_mass(const std::vector<double>& mass) const;
    Eigen::MatrixXd restricted_points(const Aggregate& matter,
                                      const std::vector<HeldPoint>& held) const;
    template <typename Act>
    void for_each_corner(const Stretch& s, const Act& act) const;

    Vec3i cells_;  // of the lattice
    Vec3i nodes_;
    std::vector<Stretch> stretch_;
    std::vector<std::size_t> chunk_;  // first stretch of each, one more at the end
    Eigen::MatrixXd stiffness_;       // of the lattice
    Eigen::MatrixXd modes_;           // V
    Vector eigenvalues_;              // l
    double most_gain_ = 100;
    Eigen::DiagonalMatrix<double, Eigen::Dynamic> more_;  // s - 1
    bool gains_ = false;
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth motions P of a body by few numbers: products of quadratic B-splines along its lattice's
// axes. They hold every linear motion exactly, and bend without locking however thin a body is;
// motions that are linear from node to node shear where they should bend. They do not reach over
// gaps and cuts (sim/spline_parts.h).
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"
#include "sim/spline_parts.h"

namespace swage {

class SplineSpace {
  public:
    // `elements`: pieces of the splines along each axis, at least one.
    SplineSpace(const Lattice& lattice,
                const std::array<ConnectionArrays, kForwardCount>& connection,
                const Vec3i& elements);

    using Vector = Eigen::VectorXd;  // three numbers a node

    const Vec3i& grid() const { return grid_; }  // of places for nodes
    int node_count() const { return static_cast<int>(parts_.place.size()); }
    const SplineParts& parts() const { return parts_; }

    Vector restricted(const Vec3Array& force) const;  // P^T f
    // fine = keep fine + P motion
    void add(const Vector& motion, double keep, Vec3Array& fine) const;

    // Where a site lies along an axis: the first of the three nodes that it follows, and how much.
    struct Place {
        int node;
        std::array<double, 3> weight;
    };
    const Place& place(int axis, int site) const { return place_[axis][site]; }

    // P^T M P, of each part: of two of its nodes (q, r, s) and (q', r', s') along x, y and z the
    // sum over its particles of mass times what both move them by, at pair_of(q, q') + 6 pair_of(r,
    // r')
    // + 36 pair_of(s, s').
    using PartMasses = std::array<double, 216>;
    std::vector<PartMasses> masses(const std::vector<double>& mass) const;
    static constexpr int pair_of(int a, int b) { return a == b ? a : a + b + 2; }

  private:
    // Particles of one run that follow the same nodes.
    struct Stretch {
        ParticleId first;
        int count, site, node, part;
    };
    // A row of particles: stretches first ... last - 1.
    struct Row {
        std::size_t first, last;
        int j, k;
        bool plain;  // all follow the first node of each place
    };
    static std::array<double, 6> pairs(const Place& at);
    std::array<double, 9> weights_across(const Row& row) const;

    Vec3i grid_;
    std::array<std::vector<Place>, 3> place_;    // of the sites along each axis
    std::array<std::vector<double>, 3> weight_;  // of those along x, by node
    SplineParts parts_;
    std::vector<Stretch> stretch_;
    std::vector<Row> row_;
    std::vector<std::size_t> chunk_;  // first row of each, one more at the end
};

}  // namespace swage

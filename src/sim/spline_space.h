// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth motions P of a lattice by few numbers: products of quadratic B-splines along its axes.
// They hold every linear motion exactly, and bend without locking however thin a body is; motions
// that are linear from node to node shear where they should bend.
#pragma once

#include <array>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

class SplineSpace {
  public:
    // `elements`: pieces of the splines along each axis, at least one.
    SplineSpace(const Lattice& lattice, const Vec3i& elements);

    using Vector = Eigen::VectorXd;  // three numbers a node

    const Vec3i& nodes() const { return nodes_; }
    int node_count() const { return nodes_.prod(); }
    int node_at(int i, int j, int k) const { return i + nodes_.x() * (j + nodes_.y() * k); }

    Vector restricted(const Vec3Array& force) const;  // P^T f
    // fine = keep fine + P motion
    void add(const Vector& motion, double keep, Vec3Array& fine) const;

    // Where a site lies along an axis: the first of the three nodes that it follows, and how much.
    struct Place {
        int node;
        std::array<double, 3> weight;
    };
    const Place& place(int axis, int site) const { return place_[axis][site]; }

  private:
    // Particles of one run that follow the same three nodes along x.
    struct Stretch {
        ParticleId first;
        int count, site, node;
    };
    // A row of particles: stretches first ... last - 1.
    struct Row {
        std::size_t first, last;
        int j, k;
    };

    Vec3i nodes_;
    std::array<std::vector<Place>, 3> place_;    // of the sites along each axis
    std::array<std::vector<double>, 3> weight_;  // of those along x, by node
    std::vector<Stretch> stretch_;
    std::vector<Row> row_;
    std::vector<std::size_t> chunk_;  // first row of each, one more at the end
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/slab_cholesky.h"

#include "sim/lattice_transfer.h"

namespace swage {

namespace {

// Particles by their place along the axis that has most of them. Where there are none, between
// parts of a body, there is no slab: nothing couples across the gap.
std::vector<std::vector<ParticleId>> slabs_of(const Lattice& lattice) {
    int axis = 0;
    lattice.cell_count.maxCoeff(&axis);
    std::vector<std::vector<ParticleId>> slab(lattice.cell_count[axis] + 1);
    for (const ParticleRun& run : lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) {
            const int site[3] = {run.i + n, run.j, run.k};
            slab[site[axis]].push_back(run.first + n);
        }
    }
    std::erase_if(slab, [](const auto& particles) { return particles.empty(); });
    return slab;
}

}  // namespace

double slab_cholesky_work(const Lattice& lattice) {
    double work = 0, last = 0;
    for (const auto& slab : slabs_of(lattice)) {
        const double size = 3.0 * slab.size();
        work += size * size * size / 6 + last * last * size / 2 + last * size * size / 2;
        last = size;
    }
    return work;
}

SlabCholesky::SlabCholesky(const Lattice& lattice)
    : slab_(slabs_of(lattice)),
      place_(particle_count(lattice)),
      slab_of_(place_.size()),
      diagonal_(slab_.size()),
      below_(slab_.size()) {
    for (std::size_t s = 0; s < slab_.size(); ++s) {
        for (std::size_t n = 0; n < slab_[s].size(); ++n) {
            place_[slab_[s][n]] = static_cast<int>(n);
            slab_of_[slab_[s][n]] = static_cast<int>(s);
        }
    }
}

bool SlabCholesky::factor(const NodeStiffness& matrix) {
    for (std::size_t s = 0; s < slab_.size(); ++s) {
        const auto size = static_cast<Eigen::Index>(3 * slab_[s].size());
        const auto next =
            static_cast<Eigen::Index>(s + 1 < slab_.size() ? 3 * slab_[s + 1].size() : 0);
        Eigen::MatrixXd& d = diagonal_[s];
        Eigen::MatrixXd& b = below_[s];
        d.setZero(size, size);
        b.setZero(next, size);
        for (std::size_t n = 0; n < slab_[s].size(); ++n) {
            const ParticleId p = slab_[s][n];
            for (int near = 0; near < NodeStiffness::kNear; ++near) {
                const ParticleId q = matrix.neighbour(p, near);
                if (q < 0) continue;
                if (slab_of_[q] == int(s)) {
                    d.block<3, 3>(3 * n, 3 * place_[q]) = matrix.block(p, near);
                } else if (slab_of_[q] == int(s) + 1) {
                    b.block<3, 3>(3 * place_[q], 3 * n) = matrix.block(p, near).transpose();
                }
            }
        }
        if (s > 0) d.selfadjointView<Eigen::Lower>().rankUpdate(below_[s - 1], -1);
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(d);  // in place
        if (factor.info() != Eigen::Success) return false;
        if (next > 0) {
            d.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(b);
        }
    }
    return true;
}

void SlabCholesky::solve(const Vec3Array& b, Vec3Array& x) const {
    std::vector<Eigen::VectorXd> part(slab_.size());
    for (std::size_t s = 0; s < slab_.size(); ++s) {
        Eigen::VectorXd& v = part[s];
        v.resize(static_cast<Eigen::Index>(3 * slab_[s].size()));
        for (std::size_t n = 0; n < slab_[s].size(); ++n) v.segment<3>(3 * n) = b.at(slab_[s][n]);
        if (s > 0) v.noalias() -= below_[s - 1] * part[s - 1];
        diagonal_[s].triangularView<Eigen::Lower>().solveInPlace(v);
    }
    x.resize(b.size());
    for (std::size_t s = slab_.size(); s-- > 0;) {
        Eigen::VectorXd& v = part[s];
        if (s + 1 < slab_.size()) v.noalias() -= below_[s].transpose() * part[s + 1];
        diagonal_[s].triangularView<Eigen::Lower>().transpose().solveInPlace(v);
        for (std::size_t n = 0; n < slab_[s].size(); ++n) x.set(slab_[s][n], v.segment<3>(3 * n));
    }
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/free_motions.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/principal_axes.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

// Of the stiffness, for its mass, of the motion that is held hardest: less is rounding. NOTE: what
// a patch of one cell holds of the turns of a bar of a thousand cells is a few 1e-7.
constexpr double kFree = 1e-10;

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Moves = Eigen::Matrix<double, 3, 6>;

// Shifts along the world's axes, turns about the body's own.
class RigidMotions {
  public:
    explicit RigidMotions(const Aggregate& matter) {
        const Vec3Array& x = matter.particle_position;
        const std::vector<double>& mass = matter.particle_mass;
        const auto sum = [&](const auto& term) { return chunked_sum(x.size(), term); };
        const double whole = sum([&](std::size_t p) { return mass[p]; });
        for (int d = 0; d < 3; ++d) {
            center_[d] = sum([&](std::size_t p) { return mass[p] * x.at(p)[d]; }) / whole;
        }
        Mat3 second;
        for (int d = 0; d < 3; ++d) {
            for (int e = 0; e <= d; ++e) {
                second(d, e) = second(e, d) = sum([&](std::size_t p) {
                    const Vec3 arm = x.at(p) - center_;
                    return mass[p] * arm[d] * arm[e];
                });
            }
        }
        const PrincipalAxes axes = principal_axes(second.trace() * Mat3::Identity() - second);
        shift_ = Mat3::Identity() / std::sqrt(whole);
        for (int d = 0; d < 3; ++d) {
            turn_.col(d) = axes.axis.col(d) / std::sqrt(axes.value[d]);
        }
    }

    Moves at(const Vec3& place) const {
        Moves moves;
        moves.leftCols<3>() = shift_;
        for (int d = 0; d < 3; ++d) moves.col(3 + d) = turn_.col(d).cross(place - center_);
        return moves;
    }

  private:
    Vec3 center_;
    Mat3 shift_, turn_;
};

}  // namespace

std::vector<Vec3Array> free_motions(const Aggregate& matter, const std::vector<HeldPoint>& held) {
    const Vec3Array& x = matter.particle_position;
    const RigidMotions rigid(matter);
    Mat6 stiffness = Mat6::Zero();
    for (const HeldPoint& h : held) {
        Moves moves = Moves::Zero();
        for (int c = 0; c < 8; ++c) moves += h.weight[c] * rigid.at(x.at(h.corner[c]));
        stiffness += moves.transpose() * h.stiffness * moves;
    }
    const Eigen::SelfAdjointEigenSolver<Mat6> ways(stiffness);
    std::vector<Vec3Array> free;
    for (int n = 0; n < 6 && ways.eigenvalues()[n] <= kFree * ways.eigenvalues()[5]; ++n) {
        const Eigen::Matrix<double, 6, 1> way = ways.eigenvectors().col(n);
        Vec3Array& motion = free.emplace_back();
        motion.resize(x.size());
        for_each_chunk(x.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) motion.set(p, rigid.at(x.at(p)) * way);
        });
    }
    return free;
}

}  // namespace swage

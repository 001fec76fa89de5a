// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/soft_mode.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

#include "base/portable_math.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kMostRounds = 12;
// Of the share that is left: what the last round may have changed. NOTE: two rounds each found
// 0.003 and rising where it was -0.055 already.
constexpr double kSettled = 0.02;

// Half waves across the longest axis, of both lateral directions and no symmetry.
Vec3Array first_guess(const Vec3Array& x) {
    Vec3 low = x.at(0), high = x.at(0);
    for (std::size_t p = 1; p < x.size(); ++p) {
        low = low.cwiseMin(x.at(p));
        high = high.cwiseMax(x.at(p));
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    Vec3Array guess;
    guess.resize(x.size());
    for (std::size_t p = 0; p < x.size(); ++p) {
        const double t = kPi * (x.at(p)[axis] - low[axis]) / (high - low)[axis];
        const auto waves = [&](double a, double b, double c) {
            return a * portable::sin(t) + b * portable::sin(2 * t) + c * portable::sin(3 * t);
        };
        Vec3 way = Vec3::Zero();
        way[(axis + 1) % 3] = waves(1, 0.5, 0.3);
        way[(axis + 2) % 3] = waves(0.7, -0.4, 0.35);
        guess.set(p, way);
    }
    return guess;
}

// A motion, and what the whole stiffness and the matter's own make of it.
struct Followed {
    Vec3Array way, force, own;
};

}  // namespace

double SoftMode::follow(const Vec3Array& position, const std::vector<double>& mass,
                        const std::vector<Vec3Array>& free, const Map& product,
                        const Map& of_matter, const Map& solve) {
    const std::size_t count = position.size();
    const auto with_mass = [&](const Vec3Array& a, const Vec3Array& b) {
        return chunked_sum(count, [&](std::size_t p) { return mass[p] * a.at(p).dot(b.at(p)); });
    };
    const auto take_free = [&](Vec3Array& way) {
        for (const Vec3Array& f : free) combine(1, -with_mass(f, way), f, way);
    };
    if (motion_.size() != count) {
        motion_ = first_guess(position);
        last_.resize(0);
    }
    Followed motion{motion_, {}, {}}, last{last_, {}, {}}, way;
    const auto look_at = [&](Followed& f) {
        take_free(f.way);
        product(f.way, f.force);
        of_matter(f.way, f.own);
        const double own = dot(f.way, f.own);
        if (!(own > 0) || !std::isfinite(own)) return false;
        const double scale = 1 / std::sqrt(own);
        for (Vec3Array* a : {&f.way, &f.force, &f.own}) combine(scale, 0, *a, *a);
        return true;
    };
    if (!look_at(motion)) return 1;
    bool has_last = last.way.size() == count && look_at(last);
    double left = dot(motion.way, motion.force);
    for (int round = 0; round < kMostRounds; ++round) {
        Vec3Array rest = motion.force;
        combine(1, -left, motion.own, rest);
        solve(rest, way.way);
        if (!look_at(way)) break;
        const Followed* basis[3] = {&motion, &way, &last};
        const int known = has_last ? 3 : 2;
        Eigen::MatrixXd whole(known, known), own(known, known);
        for (int a = 0; a < known; ++a) {
            for (int b = 0; b <= a; ++b) {
                whole(a, b) = whole(b, a) = dot(basis[a]->way, basis[b]->force);
                own(a, b) = own(b, a) = dot(basis[a]->way, basis[b]->own);
            }
        }
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(whole, own);
        if (own.llt().info() != Eigen::Success || modes.info() != Eigen::Success) {
            if (!has_last) break;
            has_last = false;  // the last step has come to say nothing new
            continue;
        }
        const Eigen::VectorXd share = modes.eigenvectors().col(0);
        const double old = std::exchange(left, modes.eigenvalues()[0]);
        // The step: all but the share of the motion itself.
        if (!has_last) last = way;
        const double of_last = has_last ? share[2] : 0;
        for (Vec3Array Followed::*a : {&Followed::way, &Followed::force, &Followed::own}) {
            combine(of_last, share[1], way.*a, last.*a);
            combine(share[0], 1, last.*a, motion.*a);
        }
        has_last = true;
        if (std::abs(old - left) <= kSettled * std::abs(left)) break;
    }
    motion_ = std::move(motion.way);
    last_ = has_last ? std::move(last.way) : Vec3Array{};
    return left;
}

}  // namespace swage

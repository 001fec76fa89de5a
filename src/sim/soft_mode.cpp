// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/soft_mode.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

#include "base/portable_math.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kMostRounds = 12;
// Of the quotient: what the last round may have changed, at first and where a motion is followed.
// NOTE: two rounds each found 0.003 and rising where it was -0.055 already.
constexpr double kSettled = 1e-3, kFollowed = 0.02;

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

}  // namespace

double SoftMode::follow(const Vec3Array& position, const std::vector<double>& mass,
                        const std::vector<Vec3Array>& free, const Map& product, const Map& solve) {
    const std::size_t count = position.size();
    const auto with_mass = [&](const Vec3Array& a, const Vec3Array& b) {
        return chunked_sum(count, [&](std::size_t p) { return mass[p] * a.at(p).dot(b.at(p)); });
    };
    const auto take_free = [&](Vec3Array& way) {
        for (const Vec3Array& f : free) combine(1, -with_mass(f, way), f, way);
    };
    double settled = kFollowed;
    if (motion_.size() != count) {
        motion_ = first_guess(position);
        last_.resize(0);
        settled = kSettled;
    }
    // Kept of one length: that of a unit mass.
    Vec3Array image, last_image, rest, way, way_image;
    take_free(motion_);
    if (last_.size() == count) take_free(last_);
    combine(1 / std::sqrt(with_mass(motion_, motion_)), 0, motion_, motion_);
    product(motion_, image);
    if (last_.size() == count) product(last_, last_image);
    double quotient = dot(motion_, image);
    for (int round = 0; round < kMostRounds; ++round) {
        rest = image;
        for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                rest.add(p, -quotient * mass[p] * motion_.at(p));
            }
        });
        solve(rest, way);
        take_free(way);
        const double size = with_mass(way, way);
        if (!(size > 0) || !std::isfinite(size)) return quotient;
        combine(1 / std::sqrt(size), 0, way, way);
        product(way, way_image);
        const Vec3Array *basis[3] = {&motion_, &way, &last_},
                        *images[3] = {&image, &way_image, &last_image};
        const int known = last_.size() == count ? 3 : 2;
        Eigen::MatrixXd stiffness(known, known), inertia(known, known);
        for (int a = 0; a < known; ++a) {
            for (int b = 0; b <= a; ++b) {
                stiffness(a, b) = stiffness(b, a) = dot(*basis[a], *images[b]);
                inertia(a, b) = inertia(b, a) = with_mass(*basis[a], *basis[b]);
            }
        }
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness, inertia);
        if (modes.info() != Eigen::Success) {  // the last step has come to say nothing new
            last_.resize(0);
            continue;
        }
        const Eigen::VectorXd share = modes.eigenvectors().col(0);
        const double old = std::exchange(quotient, modes.eigenvalues()[0]);
        // The step: all but the share of the motion itself.
        const double of_last = known == 3 ? share[2] : 0;
        if (known == 2) set_zero(count, last_), set_zero(count, last_image);
        combine(of_last, share[1], way, last_);
        combine(of_last, share[1], way_image, last_image);
        combine(share[0], 1, last_, motion_);
        combine(share[0], 1, last_image, image);
        if (std::abs(old - quotient) <= settled * std::abs(quotient)) break;
    }
    return quotient;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/soft_mode.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/noise.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kMostRounds = 12;
// Of the share that is left: what the last round may have changed where a motion is followed, and
// where one is found anew. NOTE: two rounds each found 0.003 and rising where it was -0.055
// already.
constexpr double kFollowed = 0.02, kFound = 1e-3;
constexpr int kOftenAtFirst = 16;
constexpr double kMore = 1.2;  // times the load

// Whether the softest motion is looked for anew: often while there are few increments yet.
bool looks_anew(int look) {
    return look < kOftenAtFirst ? std::has_single_bit(unsigned(look)) : look % kOftenAtFirst == 0;
}

// A motion, and what the whole stiffness and the matter's own make of it.
struct Followed {
    Vec3Array way, force, own;
};

}  // namespace

double SoftMode::follow(const std::vector<double>& mass, const std::vector<double>& stiffness,
                        const std::vector<Vec3Array>& free, const Map& product,
                        const Map& of_matter, const Map& solve, double load) {
    const std::size_t count = mass.size();
    const auto with_mass = [&](const Vec3Array& a, const Vec3Array& b) {
        return chunked_sum(count, [&](std::size_t p) { return mass[p] * a.at(p).dot(b.at(p)); });
    };
    const auto look_at = [&](Followed& f) {
        for (const Vec3Array& way : free) combine(1, -with_mass(way, f.way), way, f.way);
        product(f.way, f.force);
        of_matter(f.way, f.own);
        const double own = dot(f.way, f.own);
        if (!(own > 0) || !std::isfinite(own)) return false;
        const double scale = 1 / std::sqrt(own);
        for (Vec3Array* a : {&f.way, &f.force, &f.own}) combine(scale, 0, *a, *a);
        return true;
    };
    // From this motion, the last step to which was that, if any.
    const auto descend = [&](Found& found, double settled) {
        Followed motion{found.motion, {}, {}}, last{found.last, {}, {}}, way;
        if (!look_at(motion)) return;
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
            if (std::abs(old - left) <= settled * std::abs(left)) break;
        }
        found = {std::move(motion.way), has_last ? std::move(last.way) : Vec3Array{}, left};
    };
    ++looks_;
    const bool has_one = found_.motion.size() == count;
    found_.left = 1;
    if (has_one) descend(found_, kFollowed);
    // NOTE: one that others are no part of, by symmetry, may come late and is never come upon.
    if (has_one && !looks_anew(looks_) && load <= kMore * load_) return found_.left;
    load_ = load;
    // From what gives way to forces that know nothing of it, and strain all alike.
    Found other;
    Vec3Array force;
    force.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        const std::uint64_t n = 3 * (looks_ * count + p);
        force.set(p, std::sqrt(stiffness[p]) * Vec3(noise(n), noise(n + 1), noise(n + 2)));
    }
    solve(force, other.motion);
    descend(other, kFound);
    if (!has_one || other.left < found_.left) found_ = std::move(other);
    return found_.left;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Plasticity after von Mises with isotropic hardening, linear or along a flow curve
// (laws/flow_curve.h), for a cell of 24 connections (12 edges, 12 face diagonals) along unit
// vectors n_b:
//
//     e_b = ln(d / reference_length) - p_b   elastic strain of a connection
//     c_b = w_b (d / reference_length)^2     w: 1/4 of edges, 1 of diagonals; mu c_b e_b is the
//                                            tension times d, for the cell's volume [Pa]
//     <u, v> = sum c_b u_b v_b
//     t i_b                                  the part of e_b that is pressure alone: i is the rest
//                                            of 1 after all n_b.N n_b with tr N = 0 are taken out
//                                            of it, and t = <e, i> / <i, i>
//     s_b = e_b - t i_b                      what is left is distortion; N the closest to it
//     S = <s, s>,  S_0 = 2 |N|^2 + what of S is not N, by the mean of w / c
//     q = mu S sqrt(3 / S_0)                 equivalent stress [Pa]: of the stress, what works
//     q > sigma(alpha):                      p_b += phi (s_b - theta + t),  theta = ln(det F) / 3,
//                                            alpha += phi sqrt(S_0 / 3), by the phi that leaves
//                                            q = sigma(alpha)
//
// p_b is the plastic strain that the cell gives the connection, alpha the accumulated plastic
// strain; a connection's rest_length follows the mean of its cells. <e, s> = S is never negative,
// so flow takes energy, however far matter has flowed and whatever its connections mean by then;
// N has no trace, so it keeps the volume, and theta - t, of second order in a step, brings back
// what was lost of it. Of a cell as it was molded S_0 = S = 2 |dev eps|^2, the same in every
// direction.
//
// Bending and twisting within the cell count as distortion too and yield by the same factor: kept
// elastic they would carry a moment of 1.8 E I kappa / N^2 for ever (N cells across), more than the
// plastic one at large curvature.
//
// NOTE: yielding each connection by its own strain, the nearest thing to the papers, was tried
// first: tuned for tension it is half too weak in shear, it flows under pressure, and bars fold
// flat between tools. With c = w and i = 1 what is pressed works less the more it has flowed
// (pressed connections are weaker by the square of their length), and in the end makes energy.
// NOTE: without hardening a bent bar may fold in a hinge one cell wide.
//
// The history (p_b, alpha) has a committed value; every evaluation returns from it, leaving no
// trace.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/math.h"
#include "base/portable_math.h"
#include "laws/flow_curve.h"

namespace swage {

inline constexpr double kEdgeShare = 0.25;  // w
inline constexpr double kDiagonalShare = 1.0;
inline constexpr double kAllShares = 12 * (kEdgeShare + kDiagonalShare);

// ln of a ratio of lengths by its rational series; error below 1e-7 from 0.7 to 1.4, 2e-4 at 0.4
// and 2.5. One division, so that loops over it vectorise.
template <typename Number>
Number log_ratio(const Number& ratio) {
    const Number y = (ratio - 1.0) / (ratio + 1.0), y2 = y * y;
    return 2.0 * y * (1.0 + y2 * (1.0 / 3 + y2 * (1.0 / 5 + y2 * (1.0 / 7 + y2 * (1.0 / 9)))));
}

struct Yield {
    double yield_stress;   // sigma_y [Pa]
    double hardening;      // H [Pa]
    double shear_modulus;  // mu [Pa]
    FlowCurve curve = {};  // instead of sigma_y + H alpha where it is not empty
};

// sigma(alpha).
inline double flow_stress(const Yield& law, double alpha) {
    if (law.curve.empty()) return law.yield_stress + law.hardening * alpha;
    const FlowLine<double>& line = part_from(law.curve, alpha)->line;
    return line.stress + line.slope * alpha;
}

// S at which a cell that has never yielded begins to, as it was molded.
inline double yield_distortion(const Yield& law) {
    const double e = law.yield_stress / law.shear_modulus;
    return e * e / 3;
}

// At least q / mu of a cell, from what is soon found: the sum of w (e_b - theta)^2, and the least
// and most of ln(d / reference_length). S is no more than <e - x, e - x> with any x that is
// pressure alone, c no more than w r^2 of the longest's ratio r, S / S_0 than that r^2, and i is no
// farther from 1 than the cell from a cube.
inline double most_stress(double distortion, double theta, double shortest, double longest) {
    const double off_cube = std::min(1.0, 2 * (portable::exp(2 * (longest - shortest)) - 1));
    const double root = std::sqrt(distortion) + std::abs(theta) * std::sqrt(kAllShares) * off_cube;
    return std::sqrt(3.0) * portable::exp(2 * longest) * root;
}

using Springs = std::array<double, 24>;  // a number of each connection

struct CellSprings {
    std::array<Vec3, 24> way;  // d n_b, over its reference_length
    Springs strain;            // e_b
};

struct SpringDistortion {
    double pressed;        // t
    double worked, meant;  // S, S_0

    double stress(double shear) const {  // q
        return meant > 0 ? shear * worked * std::sqrt(3 / meant) : 0;
    }
};

// A cell as its connections lie, for strains of these.
class SpringFrame {
  public:
    using Five = Eigen::Matrix<double, 5, 1>;  // a symmetric tensor without trace

    SpringFrame(const std::array<Vec3, 24>& way, const Springs& weight) : weight_(weight) {
        Eigen::Matrix<double, 5, 5> m = Eigen::Matrix<double, 5, 5>::Zero();
        for (std::size_t b = 0; b < weight.size(); ++b) {
            const Vec3& d = way[b];
            const double r = 1 / std::max(d.squaredNorm(), 1e-300);
            along_[b] << kR2 * r * (d.x() * d.x() - d.y() * d.y()),
                kR6 * (1 - 3 * r * d.z() * d.z()), 2 * kR2 * r * d.x() * d.y(),
                2 * kR2 * r * d.y() * d.z(), 2 * kR2 * r * d.z() * d.x();
            for (int i = 0; i < 5; ++i) {
                const double part = weight[b] * along_[b][i];
                for (int j = 0; j <= i; ++j) m(i, j) += part * along_[b][j];
                of_one_[i] += part;
            }
            one_one_ += weight[b];
        }
        // All in a plane: what none of them can tell is not theirs.
        for (int i = 0; i < 5; ++i) m(i, i) += 1e-12 * one_one_;
        solver_.compute(m);  // of the lower half
        size_ = solver_.solve(of_one_);
        pressed_ = std::max(one_one_ - of_one_.dot(size_), 1e-12 * one_one_);
    }

    // Of strains: their parts along n_b.N n_b, and N; their sum; each linear in them.
    struct Sums {
        Five along, mean;
        double one;
    };
    Sums sums(const Springs& strain) const {
        Sums s{Five::Zero(), Five::Zero(), 0};
        for (std::size_t b = 0; b < strain.size(); ++b) {
            const double part = weight_[b] * strain[b];
            s.along += part * along_[b];
            s.one += part;
        }
        s.mean = solver_.solve(s.along);
        return s;
    }
    double product(const Springs& u, const Springs& v) const {
        double sum = 0;
        for (std::size_t b = 0; b < u.size(); ++b) sum += weight_[b] * u[b] * v[b];
        return sum;
    }
    // `square`: <e, e>.
    SpringDistortion distortion(const Sums& strain, double square) const {
        const double t = (strain.one - strain.along.dot(size_)) / pressed_;
        const double worked = std::max(square - t * t * pressed_, 0.0);
        const double of_mean = std::min(strain.along.dot(strain.mean), worked);
        return {t, worked,
                2 * strain.mean.squaredNorm() + kAllShares / one_one_ * (worked - of_mean)};
    }
    double pressure_strain(std::size_t b) const { return 1 - along_[b].dot(size_); }  // i_b
    double weight() const { return one_one_; }

    // About the strain of the cell as a whole.
    Mat3 mean_strain(const Springs& share, const Springs& strain) const {
        Five dev = Five::Zero();
        double size = 0;
        for (std::size_t b = 0; b < strain.size(); ++b) {
            dev += 0.5 * share[b] * strain[b] * along_[b];
            size += share[b] * strain[b] / kAllShares;
        }
        Mat3 mean;
        mean << kR2 * dev[0] + kR6 * dev[1] + size, kR2 * dev[2], kR2 * dev[4],  //
            kR2 * dev[2], kR6 * dev[1] - kR2 * dev[0] + size, kR2 * dev[3],      //
            kR2 * dev[4], kR2 * dev[3], size - 2 * kR6 * dev[1];
        return mean;
    }

  private:
    static constexpr double kR2 = 0.70710678118654752, kR6 = 0.40824829046386302;

    Springs weight_;  // c_b
    std::array<Five, 24> along_;
    Five of_one_ = Five::Zero(), size_;
    Eigen::LLT<Eigen::Matrix<double, 5, 5>> solver_;
    double one_one_ = 0, pressed_;
};

// Halfway between rest, where `strain` is none, and now.
inline SpringFrame halfway(const SpringFrame& now, const CellSprings& cell, const Springs& share,
                           Springs weight) {
    const Mat3 half = Mat3::Identity() - 0.5 * now.mean_strain(share, cell.strain);
    std::array<Vec3, 24> way;
    for (std::size_t b = 0; b < share.size(); ++b) {
        way[b] = half * cell.way[b];
        const double e = 0.5 * std::clamp(cell.strain[b], -1.0, 1.0);
        weight[b] *= (1 - e) / (1 + e);  // exp(-2 e)
    }
    return {way, weight};
}

struct SpringReturn {
    double d_alpha = 0;
    Springs grows{};  // of p_b
};

// `theta`: of what the cell is large by. Nothing where it does not flow. NOTE: what grows goes by
// how the cell lay halfway between rest and now, what the stress is by how it lies now: a step of
// five percent is then right to a few thousandths, and its end lies on the yield surface.
inline std::optional<SpringReturn> return_springs(const Yield& law, const CellSprings& cell,
                                                  const Springs& share, double theta,
                                                  double alpha) {
    constexpr int kTries = 40;
    constexpr double kError = 1e-12;  // of the stress
    Springs weight;
    for (std::size_t b = 0; b < share.size(); ++b) weight[b] = share[b] * cell.way[b].squaredNorm();
    const SpringFrame now(cell.way, weight);
    const SpringFrame::Sums sums = now.sums(cell.strain);
    const double square = now.product(cell.strain, cell.strain);
    const double q = now.distortion(sums, square).stress(law.shear_modulus);
    if (!(q > flow_stress(law, alpha))) return std::nullopt;

    const SpringFrame mid = halfway(now, cell, share, weight);
    const SpringFrame::Sums of_mid = mid.sums(cell.strain);
    const SpringDistortion flows = mid.distortion(of_mid, mid.product(cell.strain, cell.strain));
    // The volume gets no more than half of the work, nor a tenth of the flow.
    const double most = std::min(0.5 * flows.worked / std::max(std::abs(of_mid.one), 1e-300),
                                 0.1 * std::sqrt(flows.worked / mid.weight()));
    const double lost = std::clamp(theta - flows.pressed, -most, most);
    SpringReturn r;
    for (std::size_t b = 0; b < share.size(); ++b) {
        r.grows[b] = cell.strain[b] - flows.pressed * mid.pressure_strain(b) - lost;
    }

    // By false position with halving (Illinois).
    const double per_share = std::sqrt(flows.meant / 3);
    const SpringFrame::Sums gone = now.sums(r.grows);
    const double across = now.product(cell.strain, r.grows), own = now.product(r.grows, r.grows);
    const auto over = [&](double part) {
        const SpringFrame::Sums left{sums.along - part * gone.along, sums.mean - part * gone.mean,
                                     sums.one - part * gone.one};
        const double squared = square + part * (part * own - 2 * across);
        return now.distortion(left, squared).stress(law.shear_modulus) -
               flow_stress(law, alpha + part * per_share);
    };
    double low = 0, high = 1, at_low = q - flow_stress(law, alpha), at_high = over(1);
    double part = 1;
    for (int n = 0; n < kTries && at_high < 0; ++n) {
        part = low + (high - low) * at_low / (at_low - at_high);
        const double at = over(part);
        if (std::abs(at) < kError * q) break;
        if (at > 0) {
            low = part, at_low = at, at_high *= 0.5;
        } else {
            high = part, at_high = at, at_low *= 0.5;
        }
    }
    r.d_alpha = part * per_share;
    for (double& one : r.grows) one *= part;
    return r;
}

}  // namespace swage

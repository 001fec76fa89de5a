// SPDX-License-Identifier: GPL-3.0-or-later
// Plasticity after von Mises with isotropic hardening, linear or along a flow curve
// (laws/flow_curve.h), for a cell of 24 connections (12 edges, 12 face diagonals):
//
//     e_b = ln(d / reference_length)         strain of a connection
//     theta = ln(det F) / 3                  change of size, F the cell's mean gradient
//     s_b = e_b - p_b - theta                elastic distortion of a connection
//     S = sum_edges s_b^2 / 4 + sum_diagonals s_b^2
//     q = mu sqrt(3 S)                       equivalent stress [Pa]
//     q > sigma_y + H alpha:                 d_alpha = (q - sigma_y - H alpha) / (3 mu + H)
//                                            p_b += (3 mu d_alpha / q) s_b,  alpha += d_alpha
//
// p_b is the plastic strain that the cell gives the connection, alpha the accumulated plastic
// strain; a connection's rest_length follows the mean of its cells. For a uniform strain S = 2 |dev
// eps|^2, the same in every direction, so the cell yields where von Mises says, as long as it has
// not flowed far: p_b is of connections, which turn and stretch away from what it meant (1.13 and
// 1.6 times the work at a flow of 0.1 and 0.3).
//
// Bending and twisting within the cell count as distortion too and yield by the same factor: kept
// elastic they would carry a moment of 1.8 E I kappa / N^2 for ever (N cells across), more than the
// plastic one at large curvature. Size never yields, so flow keeps the volume. Measuring it by the
// edges' mean strain instead lets the cell fold like a trellis, whose edges keep their lengths
// while its volume goes.
//
// NOTE: yielding each connection by its own strain, the nearest thing to the papers, was tried
// first: tuned for tension it is half too weak in shear, it flows under pressure, and bars fold
// flat between tools. NOTE: without hardening a bent bar may fold in a hinge one cell wide.
//
// The history (p_b, alpha) has a committed value; every evaluation returns from it, leaving no
// trace.
#pragma once

#include <cmath>

#include "laws/flow_curve.h"

namespace swage {

inline constexpr double kEdgeShare = 0.25;  // in S
inline constexpr double kDiagonalShare = 1.0;

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

// S at which a cell that has never yielded begins to.
inline double yield_distortion(const Yield& law) {
    const double e = law.yield_stress / law.shear_modulus;
    return e * e / 3;
}

// d_alpha for the distortion S; zero inside the yield surface.
inline double flow(const Yield& law, double distortion, double alpha) {
    const double q = law.shear_modulus * std::sqrt(3 * distortion);
    const FlowLine<double> line = law.curve.empty()
                                      ? FlowLine<double>{law.yield_stress, law.hardening}
                                      : line_at(law.curve, q + 3 * law.shear_modulus * alpha);
    const double over = q - line.stress - line.slope * alpha;
    return over > 0 ? over / (3 * law.shear_modulus + line.slope) : 0;
}

// The share of each s_b that flows.
inline double flow_share(double distortion, double d_alpha) {
    return d_alpha > 0 ? 3 * d_alpha / std::sqrt(3 * distortion) : 0;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Flow curves: the stress at which matter flows over the plastic strain that it has gathered, in
// straight lines from point to point, and flat behind the last.
//
//     q - 3 mu d_alpha = sigma(alpha + d_alpha)     where the return of a trial stress q ends [Pa]
//
// As sigma never falls, sigma(x) + 3 mu x rises: it meets q + 3 mu alpha on one line alone, and on
// that the return is the one of linear hardening (laws/cell.h, laws/yield.h), exact however many
// lines were passed. Its tangent is exact too; it jumps where lines meet.
#pragma once

#include <cstddef>
#include <vector>

#include "laws/lane_tensor.h"

namespace swage {

struct FlowPoint {
    double strain, stress;  // plastic, from 0 on; [Pa], never falling
};

// stress + slope alpha [Pa].
template <typename N>
struct FlowLine {
    N stress, slope;
};

struct FlowPart {
    double strain, reached;  // at its beginning: alpha; sigma + 3 mu alpha [Pa]
    FlowLine<double> line;
};
using FlowCurve = std::vector<FlowPart>;

inline FlowCurve flow_curve(const std::vector<FlowPoint>& point, double shear) {
    FlowCurve curve(point.size());
    for (std::size_t n = 0; n < point.size(); ++n) {
        const auto& [strain, stress] = point[n];
        const double slope = n + 1 < point.size()
                                 ? (point[n + 1].stress - stress) / (point[n + 1].strain - strain)
                                 : 0.0;
        curve[n] = {strain, stress + 3 * shear * strain, {stress - slope * strain, slope}};
    }
    return curve;
}

// The part of a curve that is not empty on which a return ends, by q + 3 mu alpha.
// NOTE: halved by a product, as a branch would be foreseen half the time.
SWAGE_INLINE const FlowPart* part_at(const FlowCurve& curve, double reached) {
    const FlowPart* part = curve.data();
    for (std::size_t left = curve.size(); left > 1;) {
        const std::size_t half = left / 2;
        part += half * (part[half].reached < reached);
        left -= half;
    }
    return part;
}
SWAGE_INLINE FlowLine<double> line_at(const FlowCurve& curve, double reached) {
    return part_at(curve, reached)->line;
}
// That holds from a strain on.
inline const FlowPart* part_from(const FlowCurve& curve, double alpha) {
    const FlowPart* part = curve.data();
    for (std::size_t left = curve.size(); left > 1;) {
        const std::size_t half = left / 2;
        part += alpha < part[half].strain ? 0 : half;
        left -= half;
    }
    return part;
}
// Of several at a time, whose searches do not wait for each other. NOTE: kept out of the loops over
// cells, which it would slow where nothing flows along a curve.
template <int kWidth>
[[gnu::noinline]] void find_lines(const FlowCurve& curve, const double (&reached)[kWidth],
                                  FlowLine<double> (&line)[kWidth]) {
    const FlowPart* part[kWidth];
    for (int l = 0; l < kWidth; ++l) part[l] = curve.data();
    for (std::size_t left = curve.size(); left > 1;) {
        const std::size_t half = left / 2;
        for (int l = 0; l < kWidth; ++l) part[l] += part[l][half].reached < reached[l] ? half : 0;
        left -= half;
    }
    for (int l = 0; l < kWidth; ++l) line[l] = part[l]->line;
}
template <LaneVector V>
SWAGE_INLINE FlowLine<V> line_at(const FlowCurve& curve, const V& reached) {
    constexpr int kWidth = kWidthOf<V>;
    double at[kWidth];
    FlowLine<double> line[kWidth];
    for (int l = 0; l < kWidth; ++l) at[l] = reached[l];
    find_lines(curve, at, line);
    FlowLine<V> r;
    for (int l = 0; l < kWidth; ++l) r.stress[l] = line[l].stress, r.slope[l] = line[l].slope;
    return r;
}

// The mean of the curve from alpha to alpha + d_alpha, which is what a flow takes per d_alpha.
inline double mean_flow_stress(const FlowCurve& curve, double alpha, double d_alpha) {
    auto n = static_cast<std::size_t>(part_from(curve, alpha) - curve.data());
    const double end = alpha + d_alpha;
    const auto end_of = [&](std::size_t part) {
        return part + 1 < curve.size() && curve[part + 1].strain < end ? curve[part + 1].strain
                                                                       : end;
    };
    const auto mean = [&](double from, double length) {
        return curve[n].line.stress + curve[n].line.slope * (from + 0.5 * length);
    };
    if (end_of(n) == end) return mean(alpha, d_alpha);
    double sum = 0;
    for (double from = alpha; from < end; ++n) {
        sum += (end_of(n) - from) * mean(from, end_of(n) - from);
        from = end_of(n);
    }
    return sum / (end - alpha);
}

}  // namespace swage

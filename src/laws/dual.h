// SPDX-License-Identifier: GPL-3.0-or-later
// A number and its derivative along one direction, exact: a law written over any number, called
// with these, gives the product of its Hessian with that direction.
#pragma once

#include "laws/cell.h"
#include "laws/lane_tensor.h"

namespace swage {

template <typename N>
struct Dual {
    N value, slope;
};

template <typename N>
SWAGE_INLINE Dual<N> operator+(const Dual<N>& a, const Dual<N>& b) {
    return {a.value + b.value, a.slope + b.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator-(const Dual<N>& a, const Dual<N>& b) {
    return {a.value - b.value, a.slope - b.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator*(const Dual<N>& a, const Dual<N>& b) {
    return {a.value * b.value, a.value * b.slope + a.slope * b.value};
}
template <typename N>
SWAGE_INLINE Dual<N> operator/(const Dual<N>& a, const Dual<N>& b) {
    const N quotient = a.value / b.value;
    return {quotient, (a.slope - quotient * b.slope) / b.value};
}
template <typename N>
SWAGE_INLINE Dual<N> operator+(const Dual<N>& a, double b) {
    return {a.value + b, a.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator+(double a, const Dual<N>& b) {
    return {a + b.value, b.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator-(const Dual<N>& a, double b) {
    return {a.value - b, a.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator-(double a, const Dual<N>& b) {
    return {a - b.value, -b.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator*(double a, const Dual<N>& b) {
    return {a * b.value, a * b.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> operator*(const Dual<N>& a, double b) {
    return {a.value * b, a.slope * b};
}
template <typename N>
SWAGE_INLINE Dual<N> operator/(double a, const Dual<N>& b) {
    const N quotient = a / b.value;
    return {quotient, -(quotient * b.slope) / b.value};
}

// The root of zero is taken to have no slope.
template <typename N>
SWAGE_INLINE Dual<N> root(const Dual<N>& a) {
    const N r = root(a.value);
    return {r, 0.5 * a.slope / (r + 1e-300)};
}
// Of two equal numbers the second, as the plain number does.
SWAGE_INLINE Dual<double> larger(const Dual<double>& a, const Dual<double>& b) {
    return a.value > b.value ? a : b;
}
template <LaneVector V>
SWAGE_INLINE Dual<V> larger(const Dual<V>& a, const Dual<V>& b) {
    const auto first = a.value > b.value;
    return {first ? a.value : b.value, first ? a.slope : b.slope};
}
template <typename N>
SWAGE_INLINE Dual<N> larger(const Dual<N>& a, double b) {
    return larger(a, Dual<N>{b + 0.0 * a.value, 0.0 * a.value});
}

// Numbers that do not change.
template <typename N>
SWAGE_INLINE Dual<N> constant(const N& v) {
    return {v, N{}};
}
// On one line a return stays as long as what changes is small.
template <typename N>
SWAGE_INLINE FlowLine<Dual<N>> line_at(const FlowCurve& curve, const Dual<N>& reached) {
    const FlowLine<N> line = line_at(curve, reached.value);
    return {constant(line.stress), constant(line.slope)};
}
template <typename N>
SWAGE_INLINE Triple<Dual<N>> constant(const Triple<N>& v) {
    return {constant(v.x), constant(v.y), constant(v.z)};
}
template <typename N>
SWAGE_INLINE CellModes<Dual<N>> constant(const CellModes<N>& v) {
    return {constant(v.xy), constant(v.yz), constant(v.zx), constant(v.xyz)};
}
template <typename N>
SWAGE_INLINE Symmetric<Dual<N>> constant(const Symmetric<N>& v) {
    return {constant(v.xx), constant(v.yy), constant(v.zz),
            constant(v.xy), constant(v.yz), constant(v.zx)};
}
template <typename N>
SWAGE_INLINE CellHistory<Dual<N>> constant(const CellHistory<N>& v) {
    return {constant(v.stretch), constant(v.modes), constant(v.alpha)};
}

// With a slope.
template <typename N>
SWAGE_INLINE Triple<Dual<N>> pair(const Triple<N>& v, const Triple<N>& s) {
    return {{v.x, s.x}, {v.y, s.y}, {v.z, s.z}};
}
template <typename N>
SWAGE_INLINE CornerSums<Dual<N>> pair(const CornerSums<N>& v, const CornerSums<N>& s) {
    return {pair(v.x, s.x),   pair(v.y, s.y),   pair(v.z, s.z),    pair(v.xy, s.xy),
            pair(v.yz, s.yz), pair(v.zx, s.zx), pair(v.xyz, s.xyz)};
}

// The same with its slope times s.
template <typename N>
SWAGE_INLINE Dual<N> slope_scaled(const Dual<N>& a, double s) {
    return {a.value, s * a.slope};
}
template <typename N>
SWAGE_INLINE Triple<Dual<N>> slope_scaled(const Triple<Dual<N>>& a, double s) {
    return {slope_scaled(a.x, s), slope_scaled(a.y, s), slope_scaled(a.z, s)};
}
template <typename N>
SWAGE_INLINE Columns<Dual<N>> slope_scaled(const Columns<Dual<N>>& a, double s) {
    return {slope_scaled(a.x, s), slope_scaled(a.y, s), slope_scaled(a.z, s)};
}
template <typename N>
SWAGE_INLINE CornerSums<Dual<N>> slope_scaled(const CornerSums<Dual<N>>& a, double s) {
    return {slope_scaled(a.x, s),  slope_scaled(a.y, s),  slope_scaled(a.z, s),
            slope_scaled(a.xy, s), slope_scaled(a.yz, s), slope_scaled(a.zx, s),
            slope_scaled(a.xyz, s)};
}
// Of a stress p = f s: the share `turning` of f' s in its slope f' s + f s'. What is flat or inside
// out has no such s: its slope stays.
template <typename N>
SWAGE_INLINE Columns<Dual<N>> turning_scaled(const Columns<Dual<N>>& p, const Columns<Dual<N>>& f,
                                             double turning) {
    if (turning == 1) return p;
    const auto value = [](const Triple<Dual<N>>& t) __attribute__((always_inline)) {
        return Triple<N>{t.x.value, t.y.value, t.z.value};
    };
    const auto slope = [](const Triple<Dual<N>>& t) __attribute__((always_inline)) {
        return Triple<N>{t.x.slope, t.y.slope, t.z.slope};
    };
    const Columns<N> at = {value(f.x), value(f.y), value(f.z)},
                     way = {slope(f.x), slope(f.y), slope(f.z)};
    const Triple<N> x = cross(at.y, at.z), y = cross(at.z, at.x), z = cross(at.x, at.y);
    const N none{}, size = dot(at.x, x);
    const N share = size > none ? (turning - 1) / size : none;
    const auto scaled = [&](const Triple<Dual<N>>& t) __attribute__((always_inline)) {
        const Triple<N> s = {dot(x, value(t)), dot(y, value(t)), dot(z, value(t))};
        return pair(value(t), slope(t) + share * (way * s));
    };
    return {scaled(p.x), scaled(p.y), scaled(p.z)};
}

}  // namespace swage

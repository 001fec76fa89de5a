// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors and symmetric tensors over any number: a double, a batch of lanes, a dual number.
// Everything is inlined, so that a law written with them becomes part of the loop that calls it.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

#define SWAGE_INLINE inline __attribute__((always_inline))

namespace swage {

// Several cells at a time, one a lane.
template <int kWidth>
struct LaneBatch {
    typedef double Numbers __attribute__((vector_size(8 * kWidth)));
    typedef long long Indices __attribute__((vector_size(8 * kWidth)));
    typedef float Floats __attribute__((vector_size(4 * kWidth)));
};
template <int kWidth>
using LanesOf = typename LaneBatch<kWidth>::Numbers;

inline constexpr int kLanes = 8;
using Lanes = LanesOf<kLanes>;

SWAGE_INLINE double root(double a) { return std::sqrt(a); }
SWAGE_INLINE double larger(double a, double b) { return a > b ? a : b; }
// Vectors of the compiler have no names to be called by.
template <typename V>
concept LaneVector = requires(V v) {
    v[0] = 1.0;
    v = v > v ? v : v;
}
&&!std::is_pointer_v<V>;
template <LaneVector V>
SWAGE_INLINE V root(const V& a) {
    V r;
    for (std::size_t l = 0; l < sizeof(V) / sizeof(double); ++l) r[l] = __builtin_sqrt(a[l]);
    return r;
}
template <typename V>
inline constexpr int kWidthOf = sizeof(V) / sizeof(double);
// From floats.
// NOTE: written out number by number; what the compiler makes of __builtin_convertvector() goes
// through halves of the vector.
template <typename V, typename F>
SWAGE_INLINE V widened(const F& f) {
    if constexpr (kWidthOf<V> == 8) {
        return V{f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7]};
    } else if constexpr (kWidthOf<V> == 4) {
        return V{f[0], f[1], f[2], f[3]};
    } else {
        return V{f[0], f[1]};
    }
}
template <LaneVector V>
SWAGE_INLINE V larger(const V& a, const V& b) {
    return a > b ? a : b;
}
template <typename N>
SWAGE_INLINE N smaller(const N& a, const N& b) {
    return a < b ? a : b;
}
// Of numbers N: bool of a double, one a lane of a batch.
template <typename N>
using MaskOf = std::remove_cvref_t<decltype(std::declval<N>() < std::declval<N>())>;
SWAGE_INLINE bool is_any(bool mask) { return mask; }
template <LaneVector M>
SWAGE_INLINE bool is_any(const M& mask) {
    bool any = false;
    for (int l = 0; l < kWidthOf<M>; ++l) any = any || mask[l] != 0;
    return any;
}
SWAGE_INLINE bool are_all(bool mask) { return mask; }
template <LaneVector M>
SWAGE_INLINE bool are_all(const M& mask) {
    bool all = true;
    for (int l = 0; l < kWidthOf<M>; ++l) all = all && mask[l] != 0;
    return all;
}

template <typename N>
struct Triple {
    N x, y, z;
};

template <typename N>
SWAGE_INLINE Triple<N> operator+(const Triple<N>& a, const Triple<N>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename N>
SWAGE_INLINE Triple<N> operator-(const Triple<N>& a, const Triple<N>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename S, typename N>  // a number, or N itself
SWAGE_INLINE Triple<N> operator*(const S& s, const Triple<N>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <typename N>
SWAGE_INLINE N dot(const Triple<N>& a, const Triple<N>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename N>
SWAGE_INLINE Triple<N> cross(const Triple<N>& a, const Triple<N>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Columns: the images of the material axes.
template <typename N>
struct Columns {
    Triple<N> x, y, z;
};
template <typename N>
SWAGE_INLINE Triple<N> operator*(const Columns<N>& f, const Triple<N>& a) {
    return a.x * f.x + a.y * f.y + a.z * f.z;
}
template <typename N>
SWAGE_INLINE Triple<N> transposed_times(const Columns<N>& f, const Triple<N>& a) {
    return {dot(f.x, a), dot(f.y, a), dot(f.z, a)};
}

template <typename N>
struct Symmetric {
    N xx, yy, zz, xy, yz, zx;
};
template <typename N>
SWAGE_INLINE Symmetric<N> operator+(const Symmetric<N>& a, const Symmetric<N>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
template <typename N>
SWAGE_INLINE Symmetric<N> operator-(const Symmetric<N>& a, const Symmetric<N>& b) {
    return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
}
template <typename S, typename N>  // a number, or N itself
SWAGE_INLINE Symmetric<N> operator*(const S& s, const Symmetric<N>& a) {
    return {s * a.xx, s * a.yy, s * a.zz, s * a.xy, s * a.yz, s * a.zx};
}
template <typename N>
SWAGE_INLINE N trace(const Symmetric<N>& a) {
    return a.xx + a.yy + a.zz;
}
template <typename N>
SWAGE_INLINE N contract(const Symmetric<N>& a, const Symmetric<N>& b) {
    return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz +
           2.0 * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}
// a b + b a
template <typename N>
SWAGE_INLINE Symmetric<N> both_ways(const Symmetric<N>& a, const Symmetric<N>& b) {
    return {2.0 * (a.xx * b.xx + a.xy * b.xy + a.zx * b.zx),
            2.0 * (a.xy * b.xy + a.yy * b.yy + a.yz * b.yz),
            2.0 * (a.zx * b.zx + a.yz * b.yz + a.zz * b.zz),
            a.xx * b.xy + a.xy * (b.xx + b.yy) + a.yy * b.xy + a.zx * b.yz + a.yz * b.zx,
            a.yy * b.yz + a.yz * (b.yy + b.zz) + a.zz * b.yz + a.xy * b.zx + a.zx * b.xy,
            a.zz * b.zx + a.zx * (b.zz + b.xx) + a.xx * b.zx + a.yz * b.xy + a.xy * b.yz};
}
template <typename N>
SWAGE_INLINE Symmetric<N> square(const Symmetric<N>& a) {
    return {a.xx * a.xx + a.xy * a.xy + a.zx * a.zx, a.xy * a.xy + a.yy * a.yy + a.yz * a.yz,
            a.zx * a.zx + a.yz * a.yz + a.zz * a.zz, a.xy * (a.xx + a.yy) + a.zx * a.yz,
            a.yz * (a.yy + a.zz) + a.xy * a.zx,      a.zx * (a.zz + a.xx) + a.yz * a.xy};
}
// F S
template <typename N>
SWAGE_INLINE Columns<N> operator*(const Columns<N>& f, const Symmetric<N>& s) {
    return {f * Triple<N>{s.xx, s.xy, s.zx}, f * Triple<N>{s.xy, s.yy, s.yz},
            f * Triple<N>{s.zx, s.yz, s.zz}};
}

// a b where these commute.
template <typename N>
SWAGE_INLINE Symmetric<N> commuting(const Symmetric<N>& a, const Symmetric<N>& b) {
    return 0.5 * both_ways(a, b);
}
template <typename N, typename S>  // a number, or N itself
SWAGE_INLINE Symmetric<N> plus_unit(const Symmetric<N>& a, const S& s) {
    return {a.xx + s, a.yy + s, a.zz + s, a.xy, a.yz, a.zx};
}
template <typename N>
SWAGE_INLINE Symmetric<N> cofactors(const Symmetric<N>& m) {
    return {m.yy * m.zz - m.yz * m.yz, m.xx * m.zz - m.zx * m.zx, m.xx * m.yy - m.xy * m.xy,
            m.yz * m.zx - m.xy * m.zz, m.xy * m.zx - m.xx * m.yz, m.xy * m.yz - m.yy * m.zx};
}
// Of m, whose cofactors these are.
template <typename N>
SWAGE_INLINE N determinant(const Symmetric<N>& m, const Symmetric<N>& cofactor) {
    return m.xx * cofactor.xx + m.xy * cofactor.xy + m.zx * cofactor.zx;
}
template <typename N>
SWAGE_INLINE Symmetric<N> inverse_of(const Symmetric<N>& m) {
    const Symmetric<N> c = cofactors(m);
    return (1.0 / determinant(m, c)) * c;
}
template <typename N>
SWAGE_INLINE Columns<N> inverse_of(const Columns<N>& m) {
    const Triple<N> x = cross(m.y, m.z), y = cross(m.z, m.x), z = cross(m.x, m.y);
    const N over = 1.0 / dot(m.x, x);
    return {over * Triple<N>{x.x, y.x, z.x}, over * Triple<N>{x.y, y.y, z.y},
            over * Triple<N>{x.z, y.z, z.z}};
}

template <typename N>
SWAGE_INLINE Triple<N> operator*(const Symmetric<N>& s, const Triple<N>& a) {
    return {s.xx * a.x + s.xy * a.y + s.zx * a.z, s.xy * a.x + s.yy * a.y + s.yz * a.z,
            s.zx * a.x + s.yz * a.y + s.zz * a.z};
}
// s m s
template <typename N>
SWAGE_INLINE Symmetric<N> between(const Symmetric<N>& s, const Symmetric<N>& m) {
    const Triple<N> a = {s.xx, s.xy, s.zx}, b = {s.xy, s.yy, s.yz}, c = {s.zx, s.yz, s.zz};
    const Triple<N> x = m * a, y = m * b, z = m * c;
    return {dot(a, x), dot(b, y), dot(c, z), dot(a, y), dot(b, z), dot(c, x)};
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// A cell of 24 springs as its connections lie: what of their strains is pressure, what distortion,
// by which they flow (laws/yield.h says how).
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "laws/lane_power.h"
#include "laws/lane_tensor.h"

namespace swage {

inline constexpr double kEdgeShare = 0.25;  // w
inline constexpr double kDiagonalShare = 1.0;
inline constexpr double kAllShares = 12 * (kEdgeShare + kDiagonalShare);
inline constexpr double kRootOfShares = 3.8729833462074169;  // of kAllShares
inline constexpr double kRoot3 = 1.7320508075688772;

template <typename N>
using SpringsOf = std::array<N, 24>;  // a number of each connection
using Springs = SpringsOf<double>;

// How the connections lie in a cell: w, and by what bending and twisting the cell moves their upper
// ends against their lower ones, over the reference length. With sides of -1 and 1 along the axes,
// the four ways of it take a corner along by xy, yz, zx and xyz.
inline constexpr int kBendings = 4;
struct SpringLayout {
    Springs share;
    std::array<std::array<double, kBendings>, 24> bent;
};

template <typename N>
struct CellSprings {
    std::array<Triple<N>, 24> way;  // d n_b, over its reference_length
    SpringsOf<N> strain;            // e_b
};

// A symmetric tensor without trace by what it is along n: of (xx - yy, xx + yy - 2 zz, xy, yz, zx)
// that n.N n is made of.
template <typename N>
using Traceless = std::array<N, 5>;
template <typename N>
SWAGE_INLINE N product(const Traceless<N>& a, const Traceless<N>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4];
}
// Of the tensors themselves, N : M.
template <typename N>
SWAGE_INLINE N contract(const Traceless<N>& a, const Traceless<N>& b) {
    return 2.0 * a[0] * b[0] + 6.0 * a[1] * b[1] + 0.5 * (a[2] * b[2] + a[3] * b[3] + a[4] * b[4]);
}

// L D L^T of equations, by the lower half of their matrix.
template <typename N, int kCount>
struct Equations {
    N lower[kCount][kCount], over[kCount];

    SWAGE_INLINE void take(const N (&m)[kCount][kCount], const N& least) {
        N part[kCount][kCount];  // L D
        for (int j = 0; j < kCount; ++j) {
            for (int i = j; i < kCount; ++i) {
                part[i][j] = m[i][j];
                for (int k = 0; k < j; ++k) part[i][j] -= part[i][k] * lower[j][k];
            }
            over[j] = 1.0 / larger(part[j][j], least);
            for (int i = j + 1; i < kCount; ++i) lower[i][j] = part[i][j] * over[j];
        }
    }
    SWAGE_INLINE std::array<N, kCount> solve(std::array<N, kCount> v) const {
        for (int i = 1; i < kCount; ++i) {
            for (int k = 0; k < i; ++k) v[i] -= lower[i][k] * v[k];
        }
        for (int i = 0; i < kCount; ++i) v[i] = v[i] * over[i];
        for (int i = kCount - 2; i >= 0; --i) {
            for (int k = i + 1; k < kCount; ++k) v[i] -= lower[k][i] * v[k];
        }
        return v;
    }
};

template <typename N>
struct SpringDistortion {
    N worked, meant;  // S, S_0

    SWAGE_INLINE N stress(double shear) const {  // q
        return meant > 0.0 ? shear * worked * root(3.0 / meant) : N{};
    }
};

// A connection as it lies.
template <typename N>
struct SpringWay {
    Triple<N> way;
    N weight, over;  // c_b, 1 / d^2
};

// A cell as its connections lie, for strains of these. Without bendings what is pressure is asked
// of the cell as a whole alone, which takes half of the time.
template <typename N, int kBent = kBendings>
class SpringFrame {
  public:
    // `connection(b)` gives its SpringWay.
    template <typename Of>
    SWAGE_INLINE explicit SpringFrame(const SpringLayout& layout, const Of& connection) {
        // Strains of what keeps the volume: five of the cell as a whole, then of its bendings.
        N m[kStill][kStill]{};
        std::array<N, kStill> of_one{};
        SpringsOf<Triple<N>> reach;
        for (std::size_t b = 0; b < weight_.size(); ++b) {
            const SpringWay<N> c = connection(b);
            const Triple<N> r = reach[b] = c.over * c.way;
            Traceless<N>& along = along_[b];
            along[0] = r.x * c.way.x - r.y * c.way.y;
            along[1] = 1.0 - 3.0 * (r.z * c.way.z);
            along[2] = r.x * c.way.y, along[3] = r.y * c.way.z, along[4] = r.z * c.way.x;
            weight_[b] = c.weight;
            one_one_ += c.weight;
            for (int i = 0; i < 5; ++i) {
                const N part = c.weight * along[i];
                for (int j = 0; j <= i; ++j) m[i][j] += part * along[j];
                of_one[i] += part;
            }
            const N* const r_of[3] = {&reach[b].x, &reach[b].y, &reach[b].z};
            for (int h = 0; h < kBent; ++h) {
                const double bent = layout.bent[b][h];
                if (bent == 0) continue;
                for (int axis = 0; axis < 3; ++axis) {
                    const int i = 5 + 3 * h + axis;
                    const N part = bent * c.weight * *r_of[axis];
                    of_one[i] += part;
                    for (int j = 0; j < 5; ++j) m[i][j] += part * along[j];
                    for (int g = 0; g <= h; ++g) {
                        const double beside = layout.bent[b][g];
                        if (beside == 0) continue;
                        for (int other = 0; other < (g < h ? 3 : axis + 1); ++other) {
                            m[i][5 + 3 * g + other] += beside * part * *r_of[other];
                        }
                    }
                }
            }
        }
        // All in a plane: what none of them can tell is not theirs.
        for (int i = 0; i < kStill; ++i) m[i][i] += 1e-12 * one_one_;
        N whole[5][5];
        Traceless<N> along_one;
        for (int i = 0; i < 5; ++i) {
            for (int j = 0; j <= i; ++j) whole[i][j] = m[i][j];
            along_one[i] = of_one[i];
        }
        equations_.take(whole, 1e-13 * one_one_);
        size_ = equations_.solve(along_one);
        Equations<N, kStill> still;
        still.take(m, 1e-13 * one_one_);
        const std::array<N, kStill> share = still.solve(of_one);
        for (std::size_t b = 0; b < weight_.size(); ++b) {
            N& pressed = pressure_[b] = 1.0 + N{};
            for (int i = 0; i < 5; ++i) pressed -= share[i] * along_[b][i];
            for (int h = 0; h < kBent; ++h) {
                const int i = 5 + 3 * h;
                const Triple<N> by = {share[i], share[i + 1], share[i + 2]};
                pressed -= layout.bent[b][h] * dot(by, reach[b]);
            }
            pressed_ += weight_[b] * pressed * pressed;
        }
        pressed_ = larger(pressed_, 1e-12 * one_one_);
        over_pressed_ = 1.0 / pressed_, spread_ = kAllShares / one_one_;
    }

    // Of strains: their parts along n_b.N n_b, and N; their sum; each linear in them.
    struct Sums {
        Traceless<N> along, mean;
        N one, pressed;
    };
    SWAGE_INLINE Sums sums(const SpringsOf<N>& strain) const {
        Sums s{};
        for (std::size_t b = 0; b < strain.size(); ++b) {
            const N part = weight_[b] * strain[b];
            for (int i = 0; i < 5; ++i) s.along[i] += part * along_[b][i];
            s.one += part;
            s.pressed += part * pressure_[b];
        }
        s.mean = equations_.solve(s.along);
        return s;
    }
    SWAGE_INLINE N product_of(const SpringsOf<N>& u, const SpringsOf<N>& v) const {
        N sum{};
        for (std::size_t b = 0; b < u.size(); ++b) sum += weight_[b] * u[b] * v[b];
        return sum;
    }
    SWAGE_INLINE N pressed(const Sums& strain) const {  // t
        return strain.pressed * over_pressed_;
    }
    // `square`: <e, e>; `along`: of e less what is not along any n_b.N n_b; `mean`: N : N.
    SWAGE_INLINE SpringDistortion<N> distortion(const N& t, const N& square, const N& along,
                                                const N& mean) const {
        const N worked = larger(square - t * t * pressed_, N{});
        return {worked, 2.0 * mean + spread_ * (worked - smaller(along, worked))};
    }
    SWAGE_INLINE SpringDistortion<N> distortion(const SpringsOf<N>& strain) const {
        const Sums s = sums(strain);
        return distortion(pressed(s), product_of(strain, strain), product(s.along, s.mean),
                          contract(s.mean, s.mean));
    }
    SWAGE_INLINE N pressure_strain(std::size_t b) const {  // i_b
        return pressure_[b];
    }
    SWAGE_INLINE N weight(std::size_t b) const { return weight_[b]; }
    SWAGE_INLINE N weight() const { return one_one_; }
    SWAGE_INLINE N pressure() const { return pressed_; }  // <i, i>
    SWAGE_INLINE N spread() const { return spread_; }     // the mean of w / c

    // The strain of the cell as a whole.
    SWAGE_INLINE Symmetric<N> mean_strain(const Sums& strain) const {
        const N t = pressed(strain);
        Traceless<N> dev;
        for (int i = 0; i < 5; ++i) dev[i] = strain.mean[i] - t * size_[i];
        return {t + dev[1] + dev[0], t + dev[1] - dev[0], t - 2.0 * dev[1],
                0.5 * dev[2],        0.5 * dev[3],        0.5 * dev[4]};
    }

  private:
    static constexpr int kStill = 5 + 3 * kBent;

    SpringsOf<N> weight_;  // c_b
    SpringsOf<Traceless<N>> along_;
    SpringsOf<N> pressure_;  // i_b
    Traceless<N> size_;
    Equations<N, 5> equations_;
    N one_one_{}, pressed_{}, over_pressed_, spread_;
};

template <typename N>
SWAGE_INLINE SpringFrame<N> frame_of(const CellSprings<N>& cell, const SpringLayout& layout) {
    return SpringFrame<N>(
        layout, [&](std::size_t b) __attribute__((always_inline)) {
            const N square = larger(dot(cell.way[b], cell.way[b]), 1e-300 + N{});
            return SpringWay<N>{cell.way[b], layout.share[b] * square, 1.0 / square};
        });
}
// Halfway between rest, where `cell.strain` is none, and now. Along n_b, (1 - exp(-2 e)) / 2 is
// n_b.A n_b of one A = (1 - exp(-2 H)) / 2 wherever a cell is strained alike, by H, however far.
template <typename N>
SWAGE_INLINE SpringFrame<N, 0> halfway(const SpringFrame<N>& now, const CellSprings<N>& cell,
                                       const SpringLayout& layout) {
    SpringsOf<N> almansi;
    for (std::size_t b = 0; b < almansi.size(); ++b) {
        const N e = smaller(larger(cell.strain[b], -0.5 + N{}), 0.5 + N{});
        almansi[b] = e - e * e * (1.0 - (2.0 / 3) * e);
    }
    const Symmetric<N> a = now.mean_strain(now.sums(almansi));
    const Symmetric<N> squared = square(a);
    const Symmetric<N> half =  // exp(-H/2)
        plus_unit(-0.5 * a - 0.375 * squared - 0.4375 * commuting(a, squared), 1.0);
    return SpringFrame<N, 0>(
        layout, [&](std::size_t b) __attribute__((always_inline)) {
            const Triple<N> way = half * cell.way[b];
            const N e = 0.5 * smaller<N>(larger(cell.strain[b], -1.0 + N{}), 1.0 + N{});
            const N square = larger(dot(way, way), 1e-300 + N{}), longer = 1.0 + e;
            const N over = 1.0 / (square * longer);
            // exp(-2 e) = (1 - e) / (1 + e)
            return SpringWay<N>{way, now.weight(b) * (1.0 - e) * square * over, longer * over};
        });
}

}  // namespace swage

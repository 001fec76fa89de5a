// SPDX-License-Identifier: GPL-3.0-or-later
// The middle of each cell goes somewhere within a ball, what lies between follows linearly along
// each axis. NOTE: two middles one spacing apart move at most twice the ball's radius against each
// other; the change of the way along the three axes is below sqrt(3) times that, so that of balls
// below 0.288 spacings no two places come to one and straight() closes in on its answer.
#include "skin/warp.h"

#include <array>

#include "base/noise.h"

namespace swage {

namespace {

constexpr double kGrain = 0.33;  // of the roughness
constexpr int kRounds = 60;      // of straight()
constexpr double kNear = 1e-12;  // spacings; nearer it is there

enum class Kind { middle, grain };

// Anywhere in the unit ball but its inner half.
Vec3 in_ball(const Vec3i& id, Kind kind) {
    std::uint64_t number = kind == Kind::grain;
    for (int d = 0; d < 3; ++d) {
        number = number << 19 | (static_cast<std::uint64_t>(id[d] + (1 << 18)) & 0x7FFFF);
    }
    number <<= 6;
    Vec3 at = Vec3::Zero();
    for (int draw = 0; draw < 20; ++draw) {
        for (int d = 0; d < 3; ++d) at[d] = noise(number++);
        if (const double far = at.squaredNorm(); far >= 0.25 && far <= 1) return at;
    }
    return at.normalized();
}

// The ways of the eight middles around a place, in spacings.
class Ways {
  public:
    // `at`: in spacings from the first middle.
    Vec3 at(const Vec3& at) {
        const Vec3 floor = at.array().floor().max(-1e5).min(1e5);
        const Vec3i low = floor.cast<int>();
        if (!known_ || low != low_) {
            known_ = true, low_ = low;
            for (int c = 0; c < 8; ++c) {
                way_[c] = in_ball(low + Vec3i(c & 1, c >> 1 & 1, c >> 2), Kind::middle);
            }
        }
        const Vec3 up = at - floor;
        std::array<Vec3, 8> mean = way_;
        for (int d = 2, half = 4; d >= 0; --d, half /= 2) {
            for (int c = 0; c < half; ++c) mean[c] += up[d] * (mean[c + half] - mean[c]);
        }
        return mean[0];
    }

  private:
    bool known_ = false;
    Vec3i low_ = Vec3i::Zero();
    std::array<Vec3, 8> way_;
};

}  // namespace

Vec3 Warp::rough(const Vec3& straight) const {
    if (is_none()) return straight;
    const Vec3 at = (straight - origin_) / spacing_ - Vec3::Constant(0.5);
    return straight + spacing_ * roughness_ * Ways().at(at);
}

Vec3 Warp::straight(const Vec3& place) const {
    if (is_none()) return place;
    const Vec3 at = (place - origin_) / spacing_ - Vec3::Constant(0.5);
    Ways ways;
    Vec3 straight = at;
    for (int round = 0; round < kRounds; ++round) {
        const Vec3 next = at - roughness_ * ways.at(straight);
        const double way = (next - straight).squaredNorm();
        straight = next;
        if (way < kNear * kNear) break;
    }
    return origin_ + spacing_ * (straight + Vec3::Constant(0.5));
}

Vec3 Warp::grain(const Vec3i& point) const {
    return kGrain * roughness_ * spacing_ * in_ball(point, Kind::grain);
}

}  // namespace swage

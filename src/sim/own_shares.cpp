// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/own_shares.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

constexpr int kBox = 8;            // cells
constexpr double kBlend = 0.5;     // cells to each side of a face between boxes
constexpr double kTurn = 0.25;     // cells forth or back that are wholly that
constexpr double kNear = 0.01;     // cells squared of a way that has no direction yet
constexpr double kAside = 1. / 6;  // of a way squared, less than which along an axis is nothing

// From 0 at -1 to 1 at 1, and its slope.
struct SmoothStep {
    double value, slope;
};
SmoothStep smooth_step(double x) {
    const double t = std::clamp(0.5 * (x + 1), 0.0, 1.0);
    return {t * t * (3 - 2 * t), 3 * t * (1 - t)};
}

// How much a way lies along each axis: smooth, the same back and forth, and of one axis alone where
// little of it is along others.
struct Along {
    Vec3 weight;
    Mat3 slope;  // of each weight, a row
};
Along along_axes(const Vec3& way) {
    const Vec3 square = way.cwiseProduct(way) + Vec3::Constant(kNear);
    const Vec3 more = (square - Vec3::Constant(kAside * square.sum())).cwiseMax(0.0);
    const double all = more.squaredNorm();
    Along along;
    along.weight = more.cwiseProduct(more) / all;
    Mat3 rise;  // of more squared
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 by = -2 * kAside * way;
        by[axis] += 2 * way[axis];
        rise.row(axis) = 2 * more[axis] * by;
    }
    const Vec3 sum = rise.colwise().sum();
    along.slope = (rise - along.weight * sum.transpose()) / all;
    return along;
}

Vec3 from_middle(const OwnWay& way) {
    return way.place - way.home.cast<double>() - Vec3::Constant(0.5);
}

}  // namespace

OwnShares::OwnShares(const Vec3i& cells) : boxes_((cells + Vec3i::Constant(kBox - 1)) / kBox) {}

int OwnShares::home_of(const OwnWay& way) const {
    if (way.is_loose) return boxes_.prod();
    return number_of((way.home / kBox).cwiseMax(0).cwiseMin(boxes_ - Vec3i::Ones()));
}

OwnShares::Boxes OwnShares::boxes_at(double place, int axis) const {
    const int last = boxes_[axis] - 1;
    const int face = static_cast<int>(place / kBox + 0.5);  // the nearest between two
    const double beyond = place - double(face * kBox);
    if (face < 1 || face > last || std::abs(beyond) >= kBlend) {
        return {1, {std::clamp(beyond < 0 ? face - 1 : face, 0, last), 0}, {1, 0}, {0, 0}};
    }
    const SmoothStep upper = smooth_step(beyond / kBlend);
    const double slope = upper.slope / kBlend;
    return {2, {face - 1, face}, {1 - upper.value, upper.value}, {-slope, slope}};
}

OwnSpot OwnShares::spot_of(const OwnWay& way) const {
    const Boxes x = boxes_at(way.place.x(), 0), y = boxes_at(way.place.y(), 1),
                z = boxes_at(way.place.z(), 2);
    OwnSpot spot;
    spot.box = OwnSpot::kMixed;
    if (x.count * y.count * z.count > 1) return spot;
    const int home = home_of(way), box = number_of({x.box[0], y.box[0], z.box[0]});
    if (home != box) return {std::min(home, box), std::max(home, box), 0, home < box};
    const Vec3 off = from_middle(way);
    int axis = 0;
    if (off.cwiseAbs().maxCoeff(&axis) < kTurn) return spot;
    const Vec3 square = off.cwiseProduct(off) + Vec3::Constant(kNear);  // as along_axes() has it
    const double least = kAside * square.sum();
    if (square[(axis + 1) % 3] > least || square[(axis + 2) % 3] > least) return spot;
    return {box, box, axis, off[axis] > 0};
}

void OwnShares::begin(std::size_t contacts) {
    number_.clear();
    pair_.clear();
    at_.clear();
    at_.reserve(contacts);
    mixed_.clear();
    part_.clear();
    last_ = -1;
}

int OwnShares::pair_of(int one, int other) {
    const std::uint64_t key = std::uint64_t(one) << 32 | std::uint64_t(other);
    if (last_ >= 0 && key == last_key_) return last_;
    last_key_ = key;
    const auto [at, is_new] = number_.try_emplace(key, static_cast<int>(pair_.size()));
    if (is_new) pair_.resize(pair_.size() + (one == other ? 3 : 1));
    return last_ = at->second;
}

void OwnShares::sum(int at, double weight, const ContactHeld& held) {
    ContactHeld& sum = pair_[std::size_t(at >> 1)].held[at & 1];
    sum.now += weight * held.now;
    sum.gone += weight * held.gone;
    sum.turned += weight * held.turned;
}

void OwnShares::add(const OwnSpot& spot, const ContactHeld& held) {
    if (spot.box == OwnSpot::kNowhere) {
        at_.push_back(kNone);
        return;
    }
    const int at = 2 * (pair_of(spot.box, spot.other) + spot.pair) + spot.back;
    at_.push_back(at);
    sum(at, 1, held);
}

void OwnShares::add_part(int home, int box, const Vec3& way, double weight, const Vec3& slope) {
    const int pair = pair_of(std::min(home, box), std::max(home, box));
    if (home != box) {
        part_.push_back({2 * pair + (home < box), weight, slope});
        return;
    }
    const Along along = along_axes(way);
    for (int axis = 0; axis < 3; ++axis) {
        const double of_axis = along.weight[axis];
        if (!(of_axis > 0)) continue;
        const Vec3 turns = along.slope.row(axis);
        const SmoothStep forth = smooth_step(way[axis] / kTurn);
        const auto add = [&](int which, double value, double rise) {
            if (!(value > 0)) return;
            Vec3 steep = of_axis * value * slope + weight * value * turns;
            steep[axis] += weight * of_axis * rise;
            part_.push_back({2 * (pair + axis) + which, weight * of_axis * value, steep});
        };
        add(0, 1 - forth.value, -forth.slope / kTurn);
        add(1, forth.value, forth.slope / kTurn);
    }
}

void OwnShares::add_mixed(const OwnWay& way, const ContactHeld& held) {
    const std::size_t first = part_.size();
    const int home = home_of(way);
    const Vec3 off = from_middle(way);
    const Boxes x = boxes_at(way.place.x(), 0), y = boxes_at(way.place.y(), 1),
                z = boxes_at(way.place.z(), 2);
    for (int k = 0; k < z.count; ++k) {
        for (int j = 0; j < y.count; ++j) {
            const double yz = y.weight[j] * z.weight[k];
            for (int i = 0; i < x.count; ++i) {
                add_part(home, number_of({x.box[i], y.box[j], z.box[k]}), off, x.weight[i] * yz,
                         Vec3(x.slope[i] * yz, x.weight[i] * y.slope[j] * z.weight[k],
                              x.weight[i] * y.weight[j] * z.slope[k]));
            }
        }
    }
    for (std::size_t n = first; n < part_.size(); ++n) sum(part_[n].at, part_[n].weight, held);
    at_.push_back(kFirst - static_cast<int>(mixed_.size()));
    mixed_.push_back({.end = part_.size()});
}

template <typename Act>
void OwnShares::for_each_part(std::size_t mixed, const Act& act) const {
    for (std::size_t n = mixed > 0 ? mixed_[mixed - 1].end : 0; n < mixed_[mixed].end; ++n) {
        act(part_[n]);
    }
}

ContactHeld OwnShares::find() {
    ContactHeld all;
    for (Pair& pair : pair_) {
        const auto& [one, other] = pair.held;
        pair.share[0] = share_of(one.now, other.now);
        pair.share[1] = share_of(other.now, one.now);
        const ContactHeld both = held_by_both(one, other);
        all.now += both.now;
        all.gone += both.gone;
        all.turned += both.turned;
    }
    for (std::size_t m = 0; m < mixed_.size(); ++m) {
        double share = 0;
        Vec3 slope = Vec3::Zero();
        for_each_part(m, [&](const Part& part) {
            const double s = pair_[std::size_t(part.at >> 1)].share[part.at & 1];
            share += s * part.weight;
            slope += s * part.slope;
        });
        mixed_[m].share = share;
        mixed_[m].slope = slope;
    }
    return all;
}

void OwnShares::keep(std::size_t n, double held) {
    const auto add = [&](int at, double weight) {
        pair_[std::size_t(at >> 1)].kept[at & 1] += weight * held;
    };
    if (at_[n] >= 0) {
        add(at_[n], 1);
    } else if (at_[n] != kNone) {
        for_each_part(std::size_t(kFirst - at_[n]), [&](const Part& p) { add(p.at, p.weight); });
    }
}

double OwnShares::kept_more() const {
    double more = 0;
    for (const Pair& pair : pair_) {
        const double one = pair.kept[0], other = pair.kept[1];
        more += held_by_both(one, other) - (pair.share[0] * one + pair.share[1] * other);
    }
    return more;
}

}  // namespace swage

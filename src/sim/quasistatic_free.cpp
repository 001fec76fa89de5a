// SPDX-License-Identifier: GPL-3.0-or-later
// A body that nothing holds any more can be at rest anywhere. It stays where it was let go, as near
// as tools leave it room; a piece that would fall stays too.
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "sim/hanging.h"
#include "sim/quasistatic.h"

namespace swage {

namespace {

constexpr int kHalvings = 8;
constexpr double kUnbalanced = 0.05;  // of all loads and gravity on a piece
constexpr double kBorne = 0.5;        // of what they come to

Eigen::Matrix3Xd columns(const Vec3Array& x) {
    Eigen::Matrix3Xd m(3, x.size());
    for (std::size_t p = 0; p < x.size(); ++p) m.col(Eigen::Index(p)) = x.at(p);
    return m;
}

template <typename Value, typename Of>
std::vector<Value> sums_of(const Pieces& pieces, const Value& none, const Of& of) {
    std::vector<Value> sum(static_cast<std::size_t>(pieces.count), none);
    for (std::size_t p = 0; p < pieces.particle_piece.size(); ++p) {
        sum[static_cast<std::size_t>(pieces.particle_piece[p])] += of(p);
    }
    return sum;
}

}  // namespace

// Tools and grips go no farther than a spacing in a move, and what springs back no farther than the
// body is long.
bool QuasistaticSolver::falls(const Drive& to) {
    fallen_.clear();
    if (pushes_.count() == 0) return false;
    const Vec3Array& x = matter_.particle_position;
    const auto count = sums_of(pieces_, 0.0, [](std::size_t) { return 1.0; });
    const auto way = sums_of(pieces_, Vec3(Vec3::Zero()),
                             [&](std::size_t p) -> Vec3 { return x.at(p) - start_.at(p); });
    for (std::size_t n = 0; n < way.size(); ++n) {
        if (way[n].norm() > count[n] * body_size_) fallen_.push_back(static_cast<int>(n));
    }
    keep_loose(to, std::vector<double>(way.size(), 0.0));
    return !fallen_.empty();
}

// What is stiff beside its weight has not gone far by the time it is given up.
bool QuasistaticSolver::begins_to_fall(const Drive& to) {
    fallen_.resize(static_cast<std::size_t>(pieces_.count));
    std::iota(fallen_.begin(), fallen_.end(), 0);
    Vec3Array contact;
    contact.resize(matter_.particle_count());
    contacts_.add_forces(matter_, to, contact, std::numeric_limits<double>::infinity());
    self_.add_forces(contact);
    const auto borne = sums_of(pieces_, 0.0, [&](std::size_t p) { return contact.at(p).norm(); });
    keep_loose(to, borne);
    return !fallen_.empty();
}

// Loads and gravity on each particle.
Vec3Array QuasistaticSolver::pushes_on(const Drive& to) const {
    Vec3Array push;
    push.resize(matter_.particle_count());
    add_loads(to, push);
    const Vec3 gravity = pushes_.gravity(to);
    for (std::size_t p = 0; p < push.size(); ++p) push.add(p, heavy_mass_[p] * gravity);
    return push;
}

// Of the fallen pieces those in no grip which loads and gravity drive somewhere, by more than is
// borne [N].
void QuasistaticSolver::keep_loose(const Drive& to, const std::vector<double>& borne) {
    if (fallen_.empty()) return;
    const Vec3Array push = pushes_on(to);
    const auto pushed =
        sums_of(pieces_, Vec3(Vec3::Zero()), [&](std::size_t p) { return push.at(p); });
    const auto size = sums_of(pieces_, 0.0, [&](std::size_t p) { return push.at(p).norm(); });
    std::erase_if(fallen_, [&](int n) {
        const double net = pushed[n].norm();
        return gripped_[n] || net <= kUnbalanced * size[n] || borne[n] > kBorne * net;
    });
}

// How many of some pieces loads and gravity leave alone from now on and did not before. Not what is
// all there is.
int QuasistaticSolver::let_float(const Pieces& pieces, const std::vector<int>& some) {
    if (pieces.count < 2) return 0;
    std::vector<char> floats(matter_.particle_count(), 0);
    for (ParticleId p : afloat_) floats[p] = 1;
    std::vector<char> to_come(static_cast<std::size_t>(pieces.count), 0);
    for (int piece : some) to_come[piece] = 1;
    std::vector<char> counted(to_come.size(), 0);
    int count = 0;
    for (std::size_t p = 0; p < floats.size(); ++p) {
        const auto piece = static_cast<std::size_t>(pieces.particle_piece[p]);
        if (floats[p] || !to_come[piece]) continue;
        afloat_.push_back(static_cast<ParticleId>(p));
        heavy_mass_[p] = 0;
        count += !std::exchange(counted[piece], 1);
    }
    return count;
}

// The same of what hangs by hinges, and does not lie on anything either.
int QuasistaticSolver::let_hang(const Drive& to) {
    std::vector<HeldPoint> held = contacts_.held_points(matter_, to, ContactSet::Slipping::free);
    if (self_.presses()) {
        for (const PressedPlaces& both : self_.pressed()) {
            for (int side : {0, 8}) {
                HeldPoint& h = held.emplace_back();
                std::copy_n(both.particle.begin() + side, 8, h.corner.begin());
                std::copy_n(both.weight.begin() + side, 8, h.weight.begin());
                h.stiffness = both.stiffness * Mat3::Identity();
            }
        }
    }
    const Pieces firm = find_firm_pieces(matter_, held);
    std::vector<int> hanging = find_hanging(matter_, pieces_, firm, held);
    const Vec3Array push = pushes_on(to);
    const auto size = sums_of(firm, 0.0, [&](std::size_t p) { return push.at(p).norm(); });
    std::erase_if(hanging, [&](int n) { return size[n] == 0; });
    return let_float(firm, hanging);
}

void QuasistaticSolver::stay(const Drive& to) {
    if (!apparatus_.grip.empty() || apparatus_.tool.empty() || pushes_.size(matter_, to) > 0) {
        return;
    }
    const auto is_free = [&] {
        contacts_.find_candidates(matter_, to);
        for (const LoadSum& load : contacts_.loads(matter_, to)) {
            if (load.size > 0) return false;
        }
        return true;
    };
    if (!is_free()) return;
    const Vec3Array free = matter_.particle_position;
    const Eigen::Matrix3Xd from = columns(start_), now = columns(free);
    if (from == now) return;
    const Vec3 start_center = from.rowwise().mean(), free_center = now.rowwise().mean();
    const Eigen::AngleAxisd turn(Mat3(Eigen::umeyama(from, now, false).topLeftCorner<3, 3>()));
    const auto go_back = [&](double share) {
        const Mat3 back = Eigen::AngleAxisd(-share * turn.angle(), turn.axis()).toRotationMatrix();
        const Vec3 center = free_center + share * (start_center - free_center);
        for (std::size_t p = 0; p < free.size(); ++p) {
            matter_.particle_position.set(p, center + back * (free.at(p) - free_center));
        }
    };
    double clear = 0, touches = 1;
    go_back(1);
    if (is_free()) return;
    for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (clear + touches);
        go_back(middle);
        (is_free() ? clear : touches) = middle;
    }
    go_back(clear);
    contacts_.find_candidates(matter_, to);
}

}  // namespace swage

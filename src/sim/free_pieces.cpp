// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/free_pieces.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "sim/hanging.h"
#include "sim/piece_sums.h"

namespace swage {

namespace {

constexpr double kBorne = 0.5;   // of what loads and gravity come to
constexpr double kCrumb = 0.02;  // of all particles

}  // namespace

FreePieces::FreePieces(const Aggregate& matter, const Apparatus& apparatus)
    : matter_(matter), apparatus_(apparatus) {
    connections_changed();
}

void FreePieces::connections_changed() { gripped_ = find_gripped_pieces(matter_, apparatus_); }

void FreePieces::carry(const Drive& from, const Drive& to, const Vec3Array& start, Vec3Array& rest,
                       Vec3Array& position) const {
    rest = start;
    if (!are_several()) return;
    std::vector<Pose> change;
    for (std::size_t g = 0; g < to.world_from_grip.size(); ++g) {
        change.push_back(to.world_from_grip[g] * from.world_from_grip[g].inverse());
    }
    for (std::size_t p = 0; p < start.size(); ++p) {
        const int grip = gripped_.by[std::size_t(gripped_.pieces.particle_piece[p])];
        if (grip < 0) continue;
        rest.set(p, change[static_cast<std::size_t>(grip)] * start.at(p));
        position.set(p, rest.at(p));
    }
}

std::vector<std::vector<ParticleId>> FreePieces::loose_pieces() const {
    const Pieces& pieces = gripped_.pieces;
    const std::size_t count = pieces.particle_piece.size();
    std::vector<std::vector<ParticleId>> loose(static_cast<std::size_t>(pieces.count));
    for (std::size_t p = 0; p < count; ++p) {
        const int piece = pieces.particle_piece[p];
        if (!gripped_.is_held(piece)) loose[piece].push_back(static_cast<ParticleId>(p));
    }
    std::erase_if(loose, [&](const auto& piece) {
        return piece.empty() || double(piece.size()) < kCrumb * double(count);
    });
    return loose;
}

void FreePieces::steady(const LoadSet& pushes, const Drive& to, Vec3Array& force) const {
    if (pushes.count() == 0 || is_firm_throughout()) return;
    add_steadying_forces(matter_, apparatus_, gripped_, to, pushes_on(pushes, to), force);
}

bool FreePieces::has_fallen(const LoadSet& pushes, const Drive& to, const Vec3Array& start,
                            double far) {
    fallen_.clear();
    if (pushes.count() == 0) return false;
    const Vec3Array& x = matter_.particle_position;
    const auto count = sums_of(gripped_.pieces, 0.0, [](std::size_t) { return 1.0; });
    const auto way = sums_of(gripped_.pieces, Vec3(Vec3::Zero()),
                             [&](std::size_t p) -> Vec3 { return x.at(p) - start.at(p); });
    for (std::size_t n = 0; n < way.size(); ++n) {
        if (way[n].norm() > count[n] * far) fallen_.push_back(static_cast<int>(n));
    }
    if (fallen_.empty()) return false;
    keep_loose(pushes, to, nullptr);
    return !fallen_.empty();
}

bool FreePieces::begins_to_fall(const LoadSet& pushes, const Drive& to, const Vec3Array& contact) {
    fallen_.resize(static_cast<std::size_t>(gripped_.pieces.count));
    std::iota(fallen_.begin(), fallen_.end(), 0);
    keep_loose(pushes, to, &contact);
    return !fallen_.empty();
}

bool FreePieces::is_pushed_off(const LoadSet& pushes, const Drive& to) {
    fallen_.clear();
    if (is_firm_throughout() || pushes.count() == 0) return false;
    const std::vector<LeftFree> left = left_of(pushes, to);
    for (std::size_t n = 0; n < left.size(); ++n) {
        const int piece = static_cast<int>(n);
        if (gripped_.is_held(piece) && left[n].is_pushed_off()) fallen_.push_back(piece);
    }
    return !fallen_.empty();
}

Vec3 FreePieces::push_off(const LoadSet& pushes, const Drive& to) const {
    const auto held = std::ranges::find_if(fallen_, [&](int n) { return gripped_.is_held(n); });
    if (held == fallen_.end()) return Vec3::Zero();
    return left_of(pushes, to)[std::size_t(*held)].push;
}

Vec3 FreePieces::turn_off(const LoadSet& pushes, const Drive& to) const {
    if (are_several() || is_firm_throughout() || pushes.count() == 0) return Vec3::Zero();
    const LeftFree left = left_of(pushes, to).front();
    return left.is_driven() && !left.is_pushed_off() ? left.turn : Vec3(Vec3::Zero());
}

// Loads and gravity on each particle.
Vec3Array FreePieces::pushes_on(const LoadSet& pushes, const Drive& to) const {
    Vec3Array push;
    push.resize(matter_.particle_count());
    pushes.add_forces(matter_, to, push);
    const Vec3 gravity = pushes.gravity(to);
    const std::vector<double>& mass = pushes.heavy_mass(matter_);
    for (std::size_t p = 0; p < push.size(); ++p) push.add(p, mass[p] * gravity);
    return push;
}

std::vector<LeftFree> FreePieces::left_of(const LoadSet& pushes, const Drive& to) const {
    return left_free(matter_, apparatus_, gripped_, to, pushes_on(pushes, to));
}

// Of the fallen pieces those which loads and gravity drive where no grip holds them, by more than
// is borne there.
void FreePieces::keep_loose(const LoadSet& pushes, const Drive& to, const Vec3Array* contact) {
    const Vec3 none = Vec3::Zero();
    const auto on = [&](std::size_t p) { return contact != nullptr ? contact->at(p) : none; };
    const auto size = sums_of(gripped_.pieces, 0.0, [&](std::size_t p) { return on(p).norm(); });
    const auto sum = sums_of(gripped_.pieces, none, on);
    const std::vector<LeftFree> left = left_of(pushes, to);
    std::erase_if(fallen_, [&](int n) {
        const Vec3& push = left[n].push;
        const double net = push.norm();
        // What a grip holds it bears, however much, and that is nothing along ways that it leaves.
        const bool is_borne =
            gripped_.is_held(n) ? -sum[n].dot(push) > kBorne * net * net : size[n] > kBorne * net;
        return !left[n].is_pushed_off() || is_borne;
    });
}

int FreePieces::let_float(LoadSet& pushes, const Pieces& pieces, const std::vector<int>& some) {
    if (pieces.count < 2) return 0;
    std::vector<char> to_come(static_cast<std::size_t>(pieces.count), 0);
    for (int piece : some) to_come[piece] = 1;
    std::vector<char> counted(to_come.size(), 0);
    std::vector<ParticleId> afloat;
    int count = 0;
    for (std::size_t p = 0; p < pieces.particle_piece.size(); ++p) {
        const auto piece = static_cast<std::size_t>(pieces.particle_piece[p]);
        const auto particle = static_cast<ParticleId>(p);
        if (!to_come[piece] || pushes.leaves_alone(particle)) continue;
        afloat.push_back(particle);
        count += !std::exchange(counted[piece], 1);
    }
    pushes.leave_alone(matter_, afloat);
    return count;
}

int FreePieces::let_hang(LoadSet& pushes, const Drive& to, const std::vector<HeldPoint>& held,
                         const Vec3Array& own) {
    const Pieces firm = find_firm_pieces(matter_, held);
    std::vector<int> hanging = find_hanging(matter_, gripped_.pieces, firm, held);
    const Vec3Array push = pushes_on(pushes, to);
    const Vec3 none = Vec3::Zero();
    const auto size = sums_of(firm, 0.0, [&](std::size_t p) { return push.at(p).norm(); });
    const auto pushed = sums_of(firm, none, [&](std::size_t p) { return push.at(p); });
    const auto borne = sums_of(firm, none, [&](std::size_t p) { return own.at(p); });
    std::erase_if(hanging, [&](int n) {
        return size[n] == 0 || -borne[n].dot(pushed[n]) > kBorne * pushed[n].squaredNorm();
    });
    return let_float(pushes, firm, hanging);
}

}  // namespace swage

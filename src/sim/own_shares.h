// SPDX-License-Identifier: GPL-3.0-or-later
// How contacts of a body with itself share what they do where the points of two of its sides lie in
// each other, or of one alone: what sim/body_contact.h has for two bodies.
//
// What two sides are is told in the shape at rest, which lies in boxes of kBox cells a side. Points
// of the box A that lie in cells of B are the one way of a pair of boxes, B's points in A's cells
// the other, and the body holds
//
//     U = sum over pairs of M(E_AB, E_BA)        M: the mean of two ways, sim/contact_shares.h.
//
// A point has its one box for good. The place where it lies in the body moves, and belongs to the
// boxes around it by weights w that sum to one and change within kBlend cells of their faces, so
// that U has no jump. What contact n holds alone, e_n, is there w e_n in each, and it pushes by the
// slope of that:
//
//     F_n = s_n F_n,alone - e_n J^-T sum s dw/dg,    s_n = sum s w,    s = dM/dE.
//
// Two sides of one box are told apart by the way from the middle of the point's cell to the place
// that it has come to: along an axis forth is the one way, back the other, and each axis has its
// pair, to which the contact belongs the more the more of its way is along it. Particles by
// themselves, in which no point can lie, have a box of their own.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "base/math.h"
#include "sim/contact_shares.h"

namespace swage {

// Where a contact of a body with itself is, from its point's home to its place in the body, both in
// cells.
struct OwnWay {
    using IsPlain = OwnWay;
    Vec3i home;
    bool is_loose;
    Vec3 place;
};

// What one held that is no longer listed, alone [J].
struct OwnGone {
    using IsPlain = OwnGone;
    OwnWay way;
    double held;
};

// Which way of which pair it is all of.
struct OwnSpot {
    int box = kNowhere, other = 0;
    int pair = 0;                                     // of one box, the axis
    bool back = false;                                // from the higher box to the lower, or forth
    static constexpr int kNowhere = -1, kMixed = -2;  // in `box`: it does nothing; of several
};

class OwnShares {
  public:
    explicit OwnShares(const Vec3i& cells);  // of the lattice's box

    OwnSpot spot_of(const OwnWay& way) const;

    // Of the contacts as they are now.
    void begin(std::size_t contacts);
    // The next contact; of one that is mixed the way too.
    void add(const OwnSpot& spot, const ContactHeld& held);
    void add_mixed(const OwnWay& way, const ContactHeld& held);
    // Of all that have been added; what they hold, what is gone of that, and what the surface
    // turned away from [J].
    ContactHeld find();

    // Of contact n: s_n, and sum s dw/dg [1 / cells].
    double share(std::size_t n) const {
        const int at = at_[n];
        return at >= 0 ? pair_[std::size_t(at >> 1)].share[at & 1]
                       : (at == kNone ? 0.5 : mixed_[std::size_t(kFirst - at)].share);
    }
    bool slopes(std::size_t n) const { return at_[n] <= kFirst; }
    const Vec3& slope(std::size_t n) const { return mixed_[std::size_t(kFirst - at_[n])].slope; }

    // Friction has let go of some, and so much is left of what n held alone [J].
    void keep(std::size_t n, double held);
    // By how much the whole is more than what has been counted by its share [J].
    double kept_more() const;

  private:
    static constexpr int kNone = -1, kFirst = -2;  // in at_; from there on down mixed ones
    struct Pair {
        ContactHeld held[2]{};
        double share[2] = {0.5, 0.5}, kept[2] = {0, 0};
    };
    struct Part {
        int at;  // 2 pair + way
        double weight;
        Vec3 slope;  // [1 / cells]
    };
    struct Mixed {
        std::size_t end;  // of its parts
        double share = 0.5;
        Vec3 slope = Vec3::Zero();
    };
    // The boxes of a place along one axis.
    struct Boxes {
        int count;
        int box[2];
        double weight[2], slope[2];
    };
    Boxes boxes_at(double place, int axis) const;
    int number_of(const Vec3i& box) const {
        return box.x() + boxes_.x() * (box.y() + boxes_.y() * box.z());
    }
    int home_of(const OwnWay& way) const;
    int pair_of(int one, int other);  // of one box, the first of three
    void add_part(int home, int box, const Vec3& way, double weight, const Vec3& slope);
    void sum(int at, double weight, const ContactHeld& held);
    template <typename Act>
    void for_each_part(std::size_t mixed, const Act& act) const;

    Vec3i boxes_;
    std::unordered_map<std::uint64_t, int> number_;  // of a pair
    std::uint64_t last_key_ = 0;
    int last_ = -1;
    std::vector<Pair> pair_;
    std::vector<int> at_;  // of each contact: 2 pair + way, or which mixed one
    std::vector<Mixed> mixed_;
    std::vector<Part> part_;
};

}  // namespace swage

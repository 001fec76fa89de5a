// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of a body at rest, and which of them loads and gravity would carry off: equilibria have no
// fall, so these leave such a piece alone from then on.
#pragma once

#include <algorithm>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/gripped_pieces.h"
#include "sim/held_point.h"
#include "sim/load_set.h"
#include "sim/steadying.h"

namespace swage {

class FreePieces {
  public:
    // Both must outlive it.
    FreePieces(const Aggregate& matter, const Apparatus& apparatus);

    // A blade or a crack has parted what was whole.
    void connections_changed();

    bool are_several() const { return gripped_.pieces.count > 1; }

    // What a single grip holds goes where that goes, whole. NOTE: else the drag, which is let go
    // only until it holds back no more than the residual may be, pulls at pieces that are drawn
    // away.
    void carry(const Drive& from, const Drive& to, const Vec3Array& start, Vec3Array& rest,
               Vec3Array& position) const;

    // The particles of each piece in no grip that is more than a crumb, or of all.
    std::vector<std::vector<ParticleId>> loose_pieces() const;

    // Takes off what loads and gravity are little short of balance by (sim/steadying.h).
    void steady(const LoadSet& pushes, const Drive& to, Vec3Array& force) const;

    // Whether any piece has gone farther than `far` [m] from where it was: tools and grips go no
    // farther than a spacing in a move, and what springs back no farther than the body is long.
    bool has_fallen(const LoadSet& pushes, const Drive& to, const Vec3Array& start, double far);
    // What is stiff beside its weight has not gone far by the time it is given up: whether any
    // piece is pushed somewhere by more than `contact`, forces of tools, grips and the body itself,
    // can bear there.
    bool begins_to_fall(const LoadSet& pushes, const Drive& to, const Vec3Array& contact);
    // Whether loads and gravity push any piece along a way that its grips leave it, and that would
    // have no end where no tool stands in it, nor the body itself.
    bool is_pushed_off(const LoadSet& pushes, const Drive& to);
    // What pushes the first of those, in a grip, that did any of these when last asked along such a
    // way [N]; 0: none is in a grip.
    Vec3 push_off(const LoadSet& pushes, const Drive& to) const;
    // About which axis loads and gravity turn the body where its grips leave it only that [rad/s2];
    // 0: they do not.
    Vec3 turn_off(const LoadSet& pushes, const Drive& to) const;
    // How many of them loads and gravity leave alone from now on and did not before. Not what is
    // all there is.
    int let_fall(LoadSet& pushes) { return let_float(pushes, gripped_.pieces, fallen_); }
    // The same of what hangs by hinges (sim/hanging.h) where these points are held, and does not
    // lie on its own body, which has these forces on it.
    int let_hang(LoadSet& pushes, const Drive& to, const std::vector<HeldPoint>& held,
                 const Vec3Array& own);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(gripped_, fallen_);
    }

  private:
    bool is_firm_throughout() const {
        return std::ranges::all_of(gripped_.firm, [](char f) { return f != 0; });
    }
    Vec3Array pushes_on(const LoadSet& pushes, const Drive& to) const;
    std::vector<LeftFree> left_of(const LoadSet& pushes, const Drive& to) const;
    void keep_loose(const LoadSet& pushes, const Drive& to, const Vec3Array* contact);
    int let_float(LoadSet& pushes, const Pieces& pieces, const std::vector<int>& some);

    const Aggregate& matter_;
    const Apparatus& apparatus_;
    GrippedPieces gripped_;
    std::vector<int> fallen_;  // pieces that did when it was last asked
};

}  // namespace swage

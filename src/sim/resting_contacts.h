// SPDX-License-Identifier: GPL-3.0-or-later
// What tools and grips (sim/grip_set.h) do to a body in equilibria, and in the implicit step, which
// has no use for rates: the law of laws/contact.h on the pairs of sim/tool_pairs.h. Forces act on
// the particles that carry a point, with the point's own weights, so that force and moment are kept
// exactly.
#pragma once

#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/grip_set.h"
#include "sim/held_point.h"
#include "sim/part_sum.h"
#include "sim/settings.h"
#include "sim/tool_pairs.h"

namespace swage {

class RestingContacts {
  public:
    // `body`: the matter's number among the bodies, by which grips name it. The apparatus must
    // outlive it.
    RestingContacts(const Aggregate& matter, const Apparatus& apparatus,
                    const SimSettings& settings, int body = 0);

    // As of sim/tool_pairs.h.
    void connections_changed(const Aggregate& matter);
    void masses_changed() {  // as MovingContacts has it
        pairs_.masses_changed();
        grips_.masses_changed();
    }
    void begin_move(const Aggregate& matter, const Drive& from) { pairs_.begin_move(matter, from); }
    void find_candidates(const Aggregate& matter, const Drive& now) {
        pairs_.find_candidates(matter, now);
    }

    // Adds to `stiffness` what the present candidates and grips can add to each particle [N/m].
    void add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const;

    // What holds the body now: touching points and gripped ones. Those that slip are free along the
    // tool's surface, or held as if they stuck: turned back they would. Or it is as the law has it,
    // and not symmetric.
    enum class Slipping { free, held, stuck, lawful };
    std::vector<HeldPoint> held_points(const Aggregate& matter, const Drive& now,
                                       Slipping slipping) const;

    // Adds all contact and grip forces. `moved`: as ToolPairs::may_touch() takes it.
    void add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force,
                    double moved = ToolPairs::kAnywhere) const;

    // Sums by tool, then by grip, for the present state; zero for grips that hold another body.
    std::vector<PartSum> loads(const Aggregate& matter, const Drive& now) const;

    // In the springs of touching and gripped points [J].
    double stored_energy(const Aggregate& matter, const Drive& now) const;

    // Remembers where each touching point sticks; forgets those that have left. Returns the work
    // that friction took on the way that they slipped [J].
    double commit(const Aggregate& matter, const Drive& now);
    // The tools, by number, that points have gone through since this was last asked.
    std::vector<int> take_pierced();

    // On the way from where the move began; to be asked before commit().
    struct Stroke {
        // By tool, then grip: what the trapezoid rule (add_work()) counts and was not done [J].
        std::vector<double> idle;
        double friction = 0;  // taken by it [J]
    };
    Stroke stroke(const Aggregate& matter, const Drive& from, const Drive& to) const;
    // What the trapezoid rule has of the way that tools go through the air before they touch at
    // all, or after they have left [J]; also before commit().
    double air(const Aggregate& matter, const Drive& from, const Drive& to) const;

    // The farthest that the surface of any tool near the body, or any gripped point, moves [m].
    // `every`: as ToolPairs has it.
    double travel(const Aggregate& matter, const Drive& from, const Drive& to,
                  std::size_t every = 1) const;
    // The farthest that any grip, or tool that was near when the candidates were found, moves [m].
    double near_travel(const Drive& from, const Drive& to) const;
    // Whether that is no more than how poses on the way from a pose to the same one are rounded.
    bool stand_still(const Aggregate& matter, const Drive& from, const Drive& to) const {
        return near_travel(from, to) <= 1e-9 * matter.lattice.spacing;
    }

    // The point with the largest force, for error messages: "tool at (x, y, z)".
    std::string hardest_point(const Aggregate& matter, const Drive& now) const;

    // For explicit steps, which go by the same (sim/moving_contacts.h).
    const ToolPairs& pairs() const { return pairs_; }
    ToolPairs& pairs() { return pairs_; }
    const GripSet& grips() const { return grips_; }
    GripSet& grips() { return grips_; }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(pairs_, grips_);
    }

  private:
    struct TouchNow;  // a pair that touches
    struct ToolFrame {
        Mat3 turn;  // world from tool
        Vec3 at;
    };
    void find_touches(const Aggregate& matter, const std::vector<ToolFrame>& frame, double moved,
                      std::size_t begin, std::size_t end, std::vector<TouchNow>& found) const;
    // Calls act(touch) for each point inside a tool.
    template <typename Act>
    void for_each_touch(const Aggregate& matter, const Drive& now, const Act& act,
                        double moved = ToolPairs::kAnywhere) const;

    const Apparatus* apparatus_;
    ToolPairs pairs_;
    GripSet grips_;
    std::vector<char> is_pierced_;  // by tool
};

}  // namespace swage

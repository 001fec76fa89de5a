// SPDX-License-Identifier: GPL-3.0-or-later
// Points of the body's true surface against tools (matter/touch_points.h), and in grips
// (sim/grip_set.h). Forces act on the particles that carry a point, with the point's own weights,
// so that force and moment are kept exactly.
//
// Equilibria, and the implicit step, which has no use for rates, take the law of laws/contact.h.
// Explicit steps take that of laws/impact.h, the tool rigid and as heavy as can be: a step first
// finds the springs of all points that touch, then each one's dashpot from the speed that it would
// end the step with. Were dashpots taken one after the other, those of what rests would bear
// against each other, and the first would slip before the last. Points share carriers, so that the
// dashpots together would overshoot; each is therefore taken as if all that touch worked as it
// does, in proportion to their stiffness:
//
//     S_i = sum_p |w_ip| sum_j |w_jp| k_j / (m_p k_i),   P_i = c_i dt v_i / (1 + c_i dt S_i)
//
// With P = D v they change v by -A D v; A is symmetric and not negative, D diagonal and D_i at most
// 1 / S_i = k_i / (|A| k)_i. The eigenvalues of A D, those of D^1/2 A D^1/2, grow with D, and with
// the largest one are those of A_ij k_j / (|A| k)_i, none of whose rows sums up to more than 1. So
// they lie from 0 to 1: dashpots never turn a speed round, and only widen the bound of the step, as
// laws/impact.h says.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "laws/impact.h"
#include "matter/aggregate.h"
#include "matter/drive.h"
#include "matter/touch_points.h"
#include "sim/grip_set.h"
#include "sim/held_point.h"
#include "sim/load_sum.h"
#include "sim/settings.h"
#include "sim/tool_entry.h"

namespace swage {

// What contact with tools took in a step [J].
struct ToolLosses {
    double damped = 0, friction = 0;
};

class ContactSet {
    static constexpr double kAnywhere = std::numeric_limits<double>::infinity();

  public:
    // `body`: the matter's number among the bodies, by which grips name it.
    ContactSet(const Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings,
               int body = 0);

    // Explicit steps of this length [s] must stay stable, so there is a stiffness that no point
    // that touches or is gripped exceeds (stiffest_of_points()).
    void limit_stiffness(const Aggregate& matter, double step);

    // A blade or a crack has changed which cells are whole. New surface that finds itself inside a
    // tool without having gone there is only kept from going deeper. Candidates are to be found
    // anew.
    void connections_changed(const Aggregate& matter);

    // A move of the drive begins; points touched anew stick where they are now.
    void begin_move(const Aggregate& matter, const Drive& from);

    // Pairs within one spacing of a tool; pairs with an anchor always stay.
    void find_candidates(const Aggregate& matter, const Drive& now);

    // Whether any tool has a candidate.
    bool tools_near() const { return !pair_.empty(); }

    // Adds to `stiffness` what the present candidates and grips can add to each particle [N/m].
    void add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const;

    // What holds the body now: touching points and gripped ones. Those that slip are free along the
    // tool's surface, or held as if they stuck: turned back they would. Or it is as the law has it,
    // and not symmetric.
    enum class Slipping { free, held, lawful };
    std::vector<HeldPoint> held_points(const Aggregate& matter, const Drive& now,
                                       Slipping slipping) const;

    // Adds all contact and grip forces. `moved`: the farthest that any component of a particle's
    // place is from where it was when candidates were found for this very drive [m].
    void add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force,
                    double moved = kAnywhere) const;

    // Sums by tool, then by grip, for the present state; zero for grips that hold another body.
    std::vector<LoadSum> loads(const Aggregate& matter, const Drive& now) const;

    // In the springs of touching and gripped points [J].
    double stored_energy(const Aggregate& matter, const Drive& now) const;

    // Remembers where each touching point sticks; forgets those that have left. Returns the work
    // that friction took on the way that they slipped [J].
    double commit(const Aggregate& matter, const Drive& now);

    // On the way from where the move began; to be asked before commit().
    struct Stroke {
        // By tool, then grip: what the trapezoid rule (add_work()) counts and was not done [J].
        std::vector<double> idle;
        double friction = 0;  // taken by it [J]
    };
    Stroke stroke(const Aggregate& matter, const Drive& from, const Drive& to) const;

    // The farthest that any grip, or tool that was near when the candidates were found, moves [m].
    double near_travel(const Drive& from, const Drive& to) const;
    bool is_stirred(const Drive& since, const Drive& now) const {
        return near_travel(since, now) > 1e-6 * spacing_;
    }

    // Explicit steps. One begins from this drive, with the forces that were found last.
    void begin_step(const Drive& from);
    // Adds all contact and grip forces at the present positions, toward which a step of this length
    // [s] goes on with the forces so far and gravity [m/s2]; 0: found anew where the last one
    // ended.
    void add_motion_forces(const Aggregate& matter, const Drive& now, double step,
                           const Vec3& gravity, Vec3Array& force);
    // Of these: by tool, then by grip; and the energy in springs [J].
    const std::vector<LoadSum>& motion_loads() const { return motion_load_; }
    double motion_energy() const { return motion_energy_; }
    // The step is kept: remembers where each point sticks and how it met its tool. Returns what
    // dashpots and friction took in it.
    ToolLosses commit_motion(const Drive& now);

    // The farthest that the surface of any tool near the body, or any gripped point, moves [m].
    double travel(const Aggregate& matter, const Drive& from, const Drive& to) const;

    // The point with the largest force, for error messages: "tool at (x, y, z)".
    std::string hardest_point(const Aggregate& matter, const Drive& now) const;

  private:
    // What a point did in explicit steps, at the end of one.
    struct Touch {
        Vec3 local = Vec3::Zero();    // in the tool's frame
        Vec3 speed = Vec3::Zero();    // against the tool, of those that touch [m/s]
        Vec3 dashpot = Vec3::Zero();  // its force [N]
        Vec3 bond = Vec3::Zero();     // ImpactForce::bond [N]
        double bound = 0;             // ImpactForce::bound [J]
        double friction = 0;          // taken in the step [J]
        double stored = 0;            // in its spring [J]
        ImpactHistory history{};      // to commit
        Vec3 anchor = Vec3::Zero();   // likewise, in the tool's frame
        ToolEntry entry{};            // likewise
        double depth = 0;             // that counts [m]
    };
    struct Pair {
        int tool, point;
        bool stuck;   // has a committed anchor
        Vec3 anchor;  // in the tool's frame
        ImpactHistory history{};
        ToolEntry entry{};     // where it touches
        double deep = 0;       // new surface came to be this deep, and goes no deeper [m]
        bool gone = false;     // its cell is no longer whole; until the step is kept
        Touch last{}, next{};  // before the present step and after it
    };
    // How a tool went in the last step.
    struct ToolWay {
        Pose from, to;
    };
    struct Meeting;
    std::vector<Meeting> find_meetings(const Aggregate& matter, const Drive& now, bool anew);
    void meet(const Aggregate& matter, const Drive& now, bool anew, const Vec3& gravity,
              Vec3Array& force);
    void find_limits(const Aggregate& matter);
    double point_stiffness(std::size_t point, double tool_says) const;
    double pair_stiffness(const Pair& pair) const;
    const SurfacePoints& points() const { return touch_->points(); }
    Vec3 anchor_of(const Pair& pair) const;  // in the tool's frame
    Vec3 start_of(const Pair& pair) const;   // of the move, likewise
    // Places in the tool's frame. What counts, less Pair::deep.
    Distance distance_of(const Pair& pair, const Vec3& from, const Vec3& now,
                         ToolEntry& entry) const;
    // Of equilibria: on the way from where the move began.
    Distance distance_since_start(const Pair& pair, const Vec3& now, ToolEntry& entry) const;
    struct TouchNow;  // a pair that touches
    struct ToolFrame {
        Mat3 turn;  // world from tool
        Vec3 at;
    };
    void find_touches(const Aggregate& matter, const std::vector<ToolFrame>& frame, double moved,
                      std::size_t begin, std::size_t end, std::vector<TouchNow>& found) const;
    // Calls act(pair, position, distance, stiffness, contact) for each point inside a tool.
    template <typename Act>
    void for_each_touch(const Aggregate& matter, const Drive& now, const Act& act,
                        double moved = kAnywhere) const;

    static void come_out(Pair& pair, double depth);  // depth: that counts
    void forget_gone();

    const Apparatus* apparatus_;
    GripSet grips_;
    int body_;
    SimSettings settings_;
    double spacing_, pressed_modulus_;
    std::shared_ptr<TouchPoints> touch_;  // null where there is no tool; copied on change
    // Of bodies of several materials [Pa], and limits [N/m], of each of those points; empty: none.
    std::vector<double> point_modulus_, stiffness_limit_;
    double limit_step_ = 0;             // [s]
    std::vector<Pair> pair_;            // sorted by tool, then point
    std::vector<double> clearance_;     // by pair: it cannot touch while particles move by less
    std::vector<Vec3> start_position_;  // of every surface point when the move began
    std::vector<Pose> tool_from_world_at_start_;

    // Of explicit steps.
    ImpactLaw law_;         // of the matter on rigid tools; what is each point's is not in it
    double holding_;        // static friction where the tool's own is the matter's
    double ratio_;          // of static friction to kinetic, where it is not
    double stickiness_;     // [Pa]
    double last_step_ = 0;  // [s]
    double way_step_ = 0;   // that tool_way_ took; 0: none yet [s]
    std::vector<ToolWay> tool_way_;
    std::vector<Pose> world_from_tool_at_start_;
    // Of each particle, what points that touch have of stiffness on it [N/m]; 0 between.
    std::vector<double> bears_;
    std::vector<double> met_;  // likewise, at which speed those that do not rest were met [m/s]
    std::vector<LoadSum> motion_load_;
    double motion_energy_ = 0;
};

}  // namespace swage

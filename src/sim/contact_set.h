// SPDX-License-Identifier: GPL-3.0-or-later
// Points of the body's true surface against tools and in grips. Forces act on the particles that
// carry a point, with the point's own weights, so that force and moment are kept exactly.
#pragma once

#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/held_point.h"
#include "sim/settings.h"

namespace swage {

// Sums over one tool or grip; forces are those it exerts on the matter.
struct LoadSum {
    Vec3 force = Vec3::Zero();   // [N]
    Vec3 torque = Vec3::Zero();  // about the origin of its pose [N m]
    double size = 0;             // sum of the points' force magnitudes [N]
    double penetration = 0;      // deepest [m]
    int contacts = 0;
    int sliding = 0;
};

class ContactSet {
  public:
    // `body`: the matter's number among the bodies, by which grips name it.
    ContactSet(const Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings,
               int body = 0);

    // Explicit steps of this length [s] must stay stable: no point is stiffer than a quarter of
    // what its lightest carrier can follow.
    void limit_stiffness(const Aggregate& matter, double step);

    // A move of the drive begins; points touched anew stick where they are now.
    void begin_move(const Aggregate& matter, const Drive& from);

    // Pairs within one spacing of a tool; pairs with an anchor always stay.
    void find_candidates(const Aggregate& matter, const Drive& now);

    // Whether any tool has a candidate.
    bool tools_near() const { return !pair_.empty(); }

    // Adds to `stiffness` what the present candidates and grips can add to each particle [N/m].
    void add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const;

    // What holds the body now: touching points, across the tool's surface only where they slip, and
    // gripped ones.
    std::vector<HeldPoint> held_points(const Aggregate& matter, const Drive& now) const;

    // Adds all contact and grip forces.
    void add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force) const;

    // Sums by tool, then by grip, for the present state; zero for grips that hold another body.
    std::vector<LoadSum> loads(const Aggregate& matter, const Drive& now) const;

    // In the springs of touching and gripped points [J].
    double stored_energy(const Aggregate& matter, const Drive& now) const;

    // Remembers where each touching point sticks; forgets those that have left. Returns the work
    // that friction took on the way that they slipped [J].
    double commit(const Aggregate& matter, const Drive& now);

    // Whether a tool that is near or a grip has moved.
    bool is_stirred(const Drive& since, const Drive& now) const;

    // The farthest that the surface of any tool near the body, or any gripped point, moves [m].
    double travel(const Aggregate& matter, const Drive& from, const Drive& to) const;

    // The point with the largest force, for error messages: "tool at (x, y, z)".
    std::string hardest_point(const Aggregate& matter, const Drive& now) const;

  private:
    struct Pair {
        int tool, point;
        bool stuck;   // has a committed anchor
        Vec3 anchor;  // in the tool's frame
    };
    double point_stiffness(const Aggregate& matter, int point, double factor) const;  // [N/m]
    // That grip g exerts on its point n [N].
    Vec3 grip_force(const Aggregate& matter, const Drive& now, std::size_t g, std::size_t n) const;
    Vec3 anchor_of(const Pair& pair) const;  // in the tool's frame
    // Calls act(pair, position, distance, stiffness, contact) for each point inside a tool.
    template <typename Act>
    void for_each_touch(const Aggregate& matter, const Drive& now, const Act& act) const;

    bool holds(std::size_t grip) const { return apparatus_->grip[grip].body == body_; }

    const Apparatus* apparatus_;
    int body_;
    SimSettings settings_;
    double spacing_, young_modulus_;
    std::vector<double> point_modulus_;    // of bodies of several materials [Pa]
    std::vector<double> stiffness_limit_;  // one a point [N/m]; empty: none
    std::vector<Pair> pair_;               // sorted by tool, then point
    std::vector<Vec3> start_position_;     // of every surface point when the move began
    std::vector<Pose> tool_from_world_at_start_;
};

}  // namespace swage

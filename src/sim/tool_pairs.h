// SPDX-License-Identifier: GPL-3.0-or-later
// Points of the body's true surface and the tools that they may touch (matter/touch_points.h):
// which they are, how deep each is and what it remembers. The forces between them are those of
// equilibria (sim/resting_contacts.h) or of explicit steps (sim/moving_contacts.h).
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "matter/touch_points.h"
#include "sim/settings.h"
#include "sim/surface_modulus.h"
#include "sim/tool_entry.h"

namespace swage {

class ToolPairs {
  public:
    static constexpr double kAnywhere = std::numeric_limits<double>::infinity();

    // What is remembered is committed once a move or step.
    struct Pair {
        using IsPlain = Pair;
        int tool, point;
        bool stuck = false;           // touched, and has an anchor
        bool gone = false;            // its cell is no longer whole; until forget_gone()
        Vec3 anchor = Vec3::Zero();   // in the tool's frame
        ToolEntry entry{};            // where it touches
        double depth = 0;             // in equilibria, likewise [m]
        double deep = 0;              // new surface came to be this deep, and goes no deeper [m]
        void come_out(double depth);  // depth: that counts [m]
    };

    // `body`: the matter's number among the bodies. The apparatus must outlive it.
    ToolPairs(const Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings,
              int body);

    // As of sim/moving_contacts.h.
    void limit_stiffness(const Aggregate& matter, double step);

    // A blade or a crack has changed which cells are whole. New surface that finds itself inside a
    // tool without having gone there is only kept from going deeper. Candidates are to be found
    // anew.
    void connections_changed(const Aggregate& matter);
    void masses_changed() { limit_is_old_ = true; }  // as MovingContacts has it

    // From here on these particles touch nothing by themselves, others do; candidates likewise.
    void leave_out(std::vector<ParticleId> particles);

    // All of the surface is new, and of a tool it finds itself inside as connections_changed()
    // says.
    void begin_as_new() { is_new_ = true; }

    // A move of the drive begins; points touched anew stick where they are now.
    void begin_move(const Aggregate& matter, const Drive& from);

    // Pairs within one spacing of a tool; pairs with an anchor always stay. Returns which pair each
    // was before; -1: none.
    std::vector<int> find_candidates(const Aggregate& matter, const Drive& now);
    void forget_gone();

    // Sorted by tool, then point.
    std::size_t size() const { return pair_.size(); }
    bool empty() const { return pair_.empty(); }
    const Pair& operator[](std::size_t n) const { return pair_[n]; }
    Pair& operator[](std::size_t n) { return pair_[n]; }
    auto begin() const { return pair_.begin(); }
    auto end() const { return pair_.end(); }

    // Whether the n-th can touch. `moved`: the farthest that any component of a particle's place is
    // from where it was when candidates were found for this very drive [m].
    bool may_touch(std::size_t n, double moved) const {
        return !(clearance_[n] > moved) && !pair_[n].gone;
    }

    const TouchPoints* touch() const { return touch_.get(); }  // null where there is no tool
    const SurfacePoints& points() const { return touch_->points(); }
    const Tool& tool(const Pair& pair) const { return apparatus_->tool[pair.tool]; }
    double friction(const Pair& pair) const { return tool(pair).friction_on(body_); }
    double stiffness(const Pair& pair) const;  // [N/m]
    Vec3 place(const Pair& pair, const Aggregate& matter) const {
        return points().position(std::size_t(pair.point), matter.particle_position);
    }
    // In the tool's frame.
    Vec3 local(const Pair& pair, const Aggregate& matter, const Drive& now) const {
        return now.world_from_tool[pair.tool].inverse() * place(pair, matter);
    }
    // When the move began.
    const Vec3& start_place(const Pair& pair) const { return start_position_[pair.point]; }

    // In the tool's frame: where the point sticks in a move; and its distance on the way between
    // two places, or from where the move began. That which counts, less Pair::deep. `entry` becomes
    // the pair's of now.
    Vec3 anchor(const Pair& pair) const;
    Distance distance(const Pair& pair, const Vec3& from, const Vec3& now, ToolEntry& entry) const;
    Distance distance_since_start(const Pair& pair, const Vec3& now, ToolEntry& entry) const;
    // Of one that touched, whether it is through the tool, too deep to be held by it.
    bool is_beyond(const Pair& pair, const Vec3& now) const;

    // Adds to `stiffness` what the present pairs can add to each particle [N/m].
    void add_stiffness(std::vector<double>& stiffness) const;

    // The farthest that the surface of any tool near the body moves; or any tool that was near when
    // the candidates were found [m]. `every`: so many points are judged by one, for estimates.
    double travel(const Aggregate& matter, const Drive& from, const Drive& to,
                  std::size_t every = 1) const;
    double near_travel(const Drive& from, const Drive& to) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(layer_, stiffness_limit_, limit_step_, pair_, clearance_, start_position_,
           tool_from_world_at_start_);
        if (touch_ != nullptr) io(*touch_);
    }

  private:
    void find_limits(const Aggregate& matter);
    void own_touch();
    double point_stiffness(std::size_t point, double tool_says) const;
    Vec3 start_of(const Pair& pair) const;  // of the move, in the tool's frame
    EntryReach reach_of(const Pair& pair) const;

    const Apparatus* apparatus_;
    int body_;
    SimSettings settings_;
    double spacing_;
    std::shared_ptr<TouchPoints> touch_;  // null where there is no tool; copied on change
    std::vector<ParticleId> left_out_;
    bool is_new_ = false;
    SurfaceLayer layer_;                   // under those points
    std::vector<double> stiffness_limit_;  // of each [N/m]; empty: none
    double limit_step_ = 0;                // [s]
    bool limit_is_old_ = false;            // until connections_changed()
    std::vector<Pair> pair_;
    std::vector<double> clearance_;     // by pair: it cannot touch while particles move by less
    std::vector<Vec3> start_position_;  // of every surface point when the move began
    std::vector<Pose> tool_from_world_at_start_;
};

}  // namespace swage

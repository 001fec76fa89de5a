// SPDX-License-Identifier: GPL-3.0-or-later
// What tools and grips do to a body in motion, but for implicit steps: the law of laws/impact.h on
// the pairs of sim/tool_pairs.h, the tool rigid and as heavy as can be. A step first finds the
// springs of all points that touch, then each one's dashpot from the speed that it would end the
// step with. Pieces without a whole cell (sim/thin_piece.h) touch as bodies of their own.
#pragma once

#include <memory>
#include <vector>

#include "laws/impact.h"
#include "sim/resting_contacts.h"
#include "sim/thin_piece.h"

namespace swage {

// What contact with tools took in a step [J].
struct ToolLosses {
    double damped = 0, friction = 0;
};

class MovingContacts {
  public:
    // As RestingContacts.
    MovingContacts(const Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings,
                   int body);

    // The same pairs and grips by the law without rates.
    const RestingContacts& at_rest() const { return rest_; }

    // Steps of this length [s] must stay stable, so there is a stiffness that no point that touches
    // or is gripped exceeds (stiffest_of_points()).
    void limit_stiffness(const Aggregate& matter, double step);

    // As of sim/tool_pairs.h. Returns what springs held by which nothing is held any more [J].
    double connections_changed(const Aggregate& matter, const Drive& now);
    // How stiff points may be is found anew by the connections_changed() that follows.
    void masses_changed() { rest_.masses_changed(); }
    void find_candidates(const Aggregate& matter, const Drive& now);

    // An implicit step begins from this drive; it is kept, and explicit ones may follow. Returns as
    // RestingContacts::commit().
    void begin_implicit_step(const Aggregate& matter, const Drive& from) {
        rest_.begin_move(matter, from);
    }
    double commit_implicit_step(const Aggregate& matter, const Drive& now);

    // As of RestingContacts.
    double travel(const Aggregate& matter, const Drive& from, const Drive& to) const;
    double near_travel(const Drive& from, const Drive& to) const;
    bool has_thin() const { return !thin_.empty(); }

    // A step begins from this drive, with the forces that were found last.
    void begin_step(const Drive& from);
    // Adds all contact and grip forces at the present positions, toward which a step of this length
    // [s] goes on with the forces so far and gravity [m/s2]; 0: found anew where the last one
    // ended.
    void add_forces(const Aggregate& matter, const Drive& now, double step, const Vec3& gravity,
                    Vec3Array& force);
    // Of these: by tool, then by grip; and the energy in springs [J].
    const std::vector<PartSum>& loads() const { return load_; }
    double stored_energy() const { return stored_; }
    // The step is kept: remembers where each point sticks and how it met its tool. Returns what
    // dashpots and friction took in it.
    ToolLosses commit(const Drive& now);

    template <typename Io>
    void visit(Io& io, const Aggregate& matter) {  // what steps change
        if constexpr (Io::kReads) find_thin(matter);
        visit_own(io);
        visit_thin(io);
    }

  private:
    struct Thin;

    template <typename Io>
    void visit_own(Io& io) {
        io(rest_, memory_, last_step_, way_step_, tool_way_, world_from_tool_at_start_, load_,
           stored_);
    }
    template <typename Io>
    void visit_thin(Io& io);
    double find_thin(const Aggregate& matter);  // what is let go of by it [J]
    void add_thin(const Drive& now, double step, const Vec3& gravity, Vec3Array& force);

    // What a point did, at the end of a step.
    struct Touch {
        Vec3 local = Vec3::Zero();    // in the tool's frame
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
    // Of a pair, beside what that itself remembers.
    struct Memory {
        using IsPlain = Memory;
        ImpactHistory history{};  // touches: as ToolPairs::Pair::stuck
        Touch last{}, next{};     // before the present step and after it
    };
    // How a tool went in the last step.
    struct ToolWay {
        using IsPlain = ToolWay;
        Pose from, to;
    };
    void carry(std::size_t n, const Vec3& from, const Vec3& to);
    struct Meeting;
    std::vector<Meeting> find_meetings(const Aggregate& matter, const Drive& now, bool anew);
    void meet(const Aggregate& matter, const Drive& now, bool anew, const Vec3& gravity,
              Vec3Array& force);

    const Apparatus* apparatus_;
    SimSettings settings_;
    int body_;
    std::vector<Thin> thin_;
    RestingContacts rest_;
    std::vector<Memory> memory_;  // by pair
    ImpactLaw law_;               // of the matter on rigid tools; what is each point's is not in it
    double holding_;              // static friction where the tool's own is the matter's
    double ratio_;                // of static friction to kinetic, where it is not
    double stickiness_;           // [Pa]
    double last_step_ = 0;        // [s]
    double way_step_ = 0;         // that tool_way_ took; 0: none yet [s]
    std::vector<ToolWay> tool_way_;
    std::vector<Pose> world_from_tool_at_start_;
    // Of each particle, what points that touch have of stiffness on it [N/m]; 0 between.
    std::vector<double> bears_;
    std::vector<double> met_speed_;  // likewise, at which those that do not rest were met [m/s]
    std::vector<PartSum> load_;
    double stored_ = 0;
};

struct MovingContacts::Thin {
    std::shared_ptr<ThinPiece> piece;            // saved states may have it too
    std::shared_ptr<const Apparatus> apparatus;  // the tools
    MovingContacts contacts;
};

template <typename Io>
void MovingContacts::visit_thin(Io& io) {
    for (Thin& thin : thin_) thin.contacts.visit_own(io);
}

}  // namespace swage

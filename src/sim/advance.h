// SPDX-License-Identifier: GPL-3.0-or-later
// The simulation's door: one frame of one stage.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/books.h"
#include "sim/settings.h"
#include "sim/step_counts.h"

namespace swage {

class ByteReader;
class ByteWriter;

// What a tool, grip, blade or load does to the matter. The pose of a load, and of gravity, is the
// middle of what it acts on.
struct ToolLoad {
    template <typename Io>
    void visit(Io& io) {
        auto& [of, at, jumped, share, pushes, turns, done, deep, points, met, cut] = *this;
        io(of, at, jumped, share, pushes, turns, done, deep, points, met, cut);
    }

    std::string name;
    Pose pose;
    Vec3 jump = Vec3::Zero();    // of its place, as what it acts on became other (LoadSum) [m]
    double strength = 0;         // of a load: by which it acts, 1 being full
    Vec3 force = Vec3::Zero();   // that it exerts on the matter [N]
    Vec3 torque = Vec3::Zero();  // about the pose's origin [N m]
    double work = 0;             // done by it since the stage began [J]
    double penetration = 0;      // of the deepest point [m], at the end of any leg of the frame
    int contacts = 0;
    bool touched = false;  // there were some in this frame
    long severed = 0;      // connections, since the stage began
};

struct FrameReport : Books, StepCounts {  // of all bodies
    std::vector<Books> body;
    double time = 0;              // [s] since the stage began
    int asleep = 0;               // bodies at rest at the end of it; in motion only
    std::vector<ToolLoad> load;   // tools, then grips, then blades, then loads, then gravity
    int severed = 0, broken = 0;  // connections, in this frame: by blades, by load
    int pieces = 1;               // of all bodies
    std::vector<std::string> warning;
    std::optional<LimitStop> stop;  // the machine came no farther than there, for a limit

    // What comes next belongs to the same frame. To be begun with an empty one.
    void go_on(FrameReport next);

    template <typename Io>
    void visit(Io& io) {
        io(static_cast<Books&>(*this), static_cast<StepCounts&>(*this), body, time, asleep, load,
           severed, broken, pieces, warning, stop);
    }
};

class Simulation {
  public:
    // Keeps references to the bodies and the apparatus; they must outlive it. Several bodies move
    // by explicit or energy-stepped solvers; the others refuse them with Error(stopped).
    Simulation(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
               const SimSettings& settings);
    Simulation(Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings)
        : Simulation(std::vector<Aggregate*>{&matter}, apparatus, settings) {}
    ~Simulation();

    // Whether a blade would sever anything on this way, from drive to drive, through a body as it
    // is now.
    bool blades_reach(std::size_t body, std::span<const Drive> way) const;

    // Plans all cuts of the marked blades (empty: of all) on the coming legs, of `steps` drives
    // each (way[0] is now), through a body as it is now: halves that spring apart under the blade
    // are severed where it first aimed, so that a skin that was cut along the same path opens
    // cleanly. What was planned of these is no more, of others it stays; of two blades the one that
    // comes first severs what both are to. Legs beyond the plan sever what they meet.
    void plan_cuts(std::size_t body, std::span<const Drive> way, int steps,
                   const std::vector<char>& blades = {});
    // The body once all of its plan is severed; then of the pieces of that the marked ones, which
    // stay with one that these blades would cut them from: false where this leaves them nothing to
    // sever that no other blade is to.
    Aggregate planned(std::size_t body) const;
    bool keep(std::size_t body, const Aggregate& planned, const std::vector<char>& piece,
              const std::vector<char>& blades = {});

    // Everything that may act on the bodies, in the order of FrameReport::load, without what it
    // does.
    std::vector<ToolLoad> loads(const Drive& now) const;

    // How the bodies are before the first frame: what moves, what holds strain, their pieces. What
    // contacts hold is not among it.
    FrameReport start() const;

    // Moves the matter on while the apparatus goes from one drive to another. What the blades
    // sweep in this frame is severed first. Throws Error(stopped) with a sentence that names what
    // to change; the matter is then in a state that was converged. Where a limit of the apparatus
    // is reached, it goes no farther than there, and later no limit is looked at. `way`: the drives
    // between the two, where they are not on the straight way.
    FrameReport advance(const Drive& from, const Drive& to, const DriveAt& way = {});

    // What touches as a stage of motion ends goes on as it was where another begins, of the same
    // bodies as they are: what contacts of bodies with each other and with themselves remember.
    // Nothing, and contacts begin, where either stage is none of motion. Throws as load().
    // `unpressed`: parts of a body that lie in each other have not been pressed, for until now they
    // could not touch: as deep as they are they push nothing, and less where they come out.
    std::string hand_on() const;
    void take_on(std::string_view contacts, bool unpressed = false);

    // All that its moves have changed, but for the bodies. What was saved of a simulation goes on
    // in another that began as it did, once the bodies are those of then: by the same bits. Throws
    // Error(output) where that is none of this simulation.
    void save(ByteWriter& out) const;
    void load(ByteReader& in);

  private:
    struct Rooms;
    std::unique_ptr<Rooms> rooms_;
};

// About how many explicit steps a second of machine time takes; for estimates. Each leg takes whole
// ones. `is_cut`: by a blade.
double explicit_steps_per_second(const Aggregate& matter, const SimSettings& settings,
                                 bool is_cut = false);
// How many equilibria a quasi-static stage takes along these drives where none has to be halved.
long equilibria_along(const Aggregate& matter, const Apparatus& apparatus,
                      const SimSettings& settings, const std::vector<Drive>& drives);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// A machine set up at a work-piece (S2.13 to S2.15): its parameters resolved, its tools brought up
// to the surface, its grips holding points of it, its motions ready to be asked for any time.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "machines/machine_spec.h"
#include "machines/motion.h"
#include "machines/region.h"
#include "matter/aggregate.h"
#include "matter/drive.h"

namespace swage {

// Local axes of the work-piece: x along its length, y up, z across; origin at the box's centre.
struct WorkFrame {
    Pose world_from_work;
    Vec3 size;  // [m] of the box: length, height, width
};

// Where every point of the body's true surface is now [m].
std::vector<Vec3> surface_positions(const Aggregate& matter);

// From the box of the surface as it is now, along the world's axes: `axis` is the frame's x, `up`
// its y. Left open `axis` is the longest side, and `up` the world's y, or z where the axis lies
// along y. For a machine that is upright, gravity has settled what is up before the body is known:
// there `up` left open is y, and `axis` the longest side across it. Throws Error(scene) where both
// lie on one line, Error(mesh) for a body without a surface. `shown`: the box of its skin, if there
// is one, which tells the longest side: what is sampled of a surface misses tips, more or less of
// them as cells are chosen.
WorkFrame place_work_frame(const Aggregate& matter, WorldAxis axis = WorldAxis::automatic,
                           WorldAxis up = WorldAxis::automatic, bool upright = false,
                           const Box& shown = {});

// Which of the world's axes its x, y and z are.
std::array<WorldAxis, 3> world_axes(const WorkFrame& frame);

struct Machine {
    MachineSpec spec;
    std::map<std::string, double> parameter;  // every one, SI
    WorkFrame frame;
    Apparatus apparatus;
    std::vector<std::string> notes;  // sentences for the user: what may go wrong

    // In the order of the apparatus.
    std::vector<Pose> work_from_tool, work_from_grip, work_from_blade;  // before they move
    std::vector<Motion> tool_motion, grip_motion, blade_motion;
    std::vector<Timed> load_strength;
    std::vector<std::vector<SurfaceComponent>> load_on;  // as the work-piece lies
    std::optional<Timed> gravity_strength;               // none: full from the start
    double stop = 1;                                     // the motions' variable of this name
};

// Of its tools, then its grips, those that turn about one as their motions say. At the start; what
// moves along takes it with it.
std::vector<std::optional<TurnAxis>> turn_axes(const Machine& machine);

// What expressions know of the work-piece: length, height, width, spacing, lattice_reach and
// material_friction. `coarser`: as for build_machine().
Variables work_piece_variables(const Aggregate& matter, const WorkFrame& frame, double coarser = 1);

// `given`: parameters by name, SI; the rest take defaults. Throws ParameterError, and PlacedError
// naming machine and tool, grip or blade: an expression without a value that can be meant; a tool
// that can never touch, or whose mesh cannot be read; a grip that holds nothing, a point that two
// hold, or one that does not start at rest; a load on nothing.
// `beside`: the materials of the bodies beside the work-piece, on which tools whose friction
// follows from that of the material have another. `duration`: of the stage [s]. `coarser`: the
// spacing of the matter, over that of what it stands for: expressions and notes know the latter,
// and no tool slips between points that are only farther apart for it.
Machine build_machine(const MachineSpec& spec, const std::map<std::string, double>& given,
                      const WorkFrame& frame, const Aggregate& matter,
                      const std::vector<Material>& beside = {}, double duration = 1,
                      double coarser = 1);

// Of each load, then gravity, at `t` (0 to 1). Throws as drive_at().
std::vector<double> strengths_at(const Machine& machine, double t);

// Poses at `t` (0 to 1) of a stage of `duration` [s]. Throws PlacedError naming machine and part
// where an expression has no value then.
Drive drive_at(const Machine& machine, double t, double duration);

}  // namespace swage

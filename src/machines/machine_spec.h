// SPDX-License-Identifier: GPL-3.0-or-later
// A machine as its file says it: plain data and expressions, nothing evaluated.
//
// Expressions (base/expression.h) see the machine's parameters, and of the work-piece: length,
// height, width (its box along the work frame's x, y, z), spacing (of the lattice), lattice_reach
// (how far particles stick out of that box, at the most) and material_friction; tools also the
// placed centres of the tools before them, as NAME_x, NAME_y, NAME_z in the work frame, and
// motions, grips, blades, loads and checks those of all tools. Motions and strengths of loads also
// see t, 0 at the start of the stage and 1 at its end, duration, of the stage [s], and, but for
// blades, stop: the t at which a limit was reached, 1 until then. What is to come no farther then
// goes by min(t, stop). A part that is repeated sees which one it is as number, and a tool's motion
// the middle of its own as NAME_x, NAME_y, NAME_z.
//
// The work frame stands at the centre of the work-piece's box: x along its length, y the way the
// machine calls up, z across.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/math.h"
#include "base/text_error.h"
#include "base/units.h"
#include "machines/world_axis.h"
#include "matter/drive.h"

namespace swage {

struct Expression {
    std::string text;
    TextPlace place = {};

    Expression() = default;
    Expression(std::string given, TextPlace at = {})
        : text(std::move(given)), place(std::move(at)) {}
    Expression(const char* given) : text(given) {}
    bool empty() const { return text.empty(); }
    bool operator==(const Expression& other) const { return text == other.text; }
};
using Expression3 = std::array<Expression, 3>;

struct ParameterSpec {
    std::string name;
    Quantity quantity = Quantity::number;
    Expression default_value;  // may use box variables and earlier parameters
    Expression low, high;      // allowed range, same variables; empty: unbounded
    std::string help;
};

// Pose over time in the work frame: first turned by `turn` about `axis` through `pivot`, then
// moved.
struct MotionSpec {
    Expression3 move = {"0", "0", "0"};  // [m]
    Expression turn = "0";               // [rad]
    Expression3 axis = {"0", "0", "1"};  // without t
    Expression3 pivot;                   // [m]; in the work frame; empty: its origin

    bool says_pivot() const { return !pivot[0].empty(); }
    bool stands() const { return turn == "0" && move == Expression3{"0", "0", "0"}; }
};

// A part may stand there several times, as many as `count` says; it uses no more than parameters
// that do not depend on the work-piece, so that the parts are known as soon as these are.
struct Repetition {
    Expression count;       // empty: it is a single part
    std::string name = "";  // of a single part that was repeated: without its number
    int number = 0;         // of such a part, from 1

    bool is_open() const { return !count.empty(); }
};

enum class ToolShape { none, cylinder, box, sphere, mesh };

struct ToolSpec {
    std::string name;
    ToolShape shape = ToolShape::none;   // has to be said
    Expression radius = "0";             // cylinder, sphere
    Expression length = "0";             // cylinder
    Expression hole = "0";               // cylinder
    Expression3 size = {"0", "0", "0"};  // box
    Expression rounding = "0";           // box, cylinder
    std::filesystem::path mesh;  // mesh: absolute; scaled so that its longest side is `length`
    TextPlace mesh_place;        // where it is named
    Expression3 axis = {"0", "0", "1"};  // the shape's z axis, in the work frame
    Expression turn = "0";               // about that axis [rad]
    Expression3 at = {"0", "0", "0"};    // centre before `touch`, in the work frame
    // Slides the tool along this direction (from far outside) until it just touches; zero: stays.
    Expression3 touch = {"0", "0", "0"};
    Expression gap = "0";       // left between tool and work-piece by `touch`
    Expression friction;        // empty: the material's
    std::optional<Vec3> color;  // linear RGB
    Finish finish = Finish::metal;
    double contact_stiffness = 0;  // Tool::contact_stiffness
    MotionSpec motion;
    Repetition repeat;
};

// What of the surface lies in the box [from, to] of the work frame is held, along those axes of it
// that are named: all three clamp, one is a smooth plane.
struct GripSpec {
    std::string name;
    Expression3 from, to;
    std::array<bool, 3> along = {true, true, true};  // x, y, z
    bool drawn = true;                               // as a clamp
    MotionSpec motion;
    Repetition repeat;
};

struct BladeSpec {
    std::string name;
    // In the work frame at the start. One alone is a curve: it sees `along`, 0 to 1.
    std::vector<Expression3> edge;
    int points = 33;                       // of a curve
    Expression thickness = "0.02*height";  // of the drawn body
    MotionSpec motion;
    Repetition repeat;
};

// The way that a part of the surface looks, in the work frame: more than to any other side. Or the
// walls of what was molded around cavities, whichever way they look.
enum class Side { all, left, right, bottom, top, back, front, inside };

// Pushes on the surface that looks to a side and lies in the box [from, to] of the work frame: a
// force in all, spread evenly by area, that keeps its size and direction; or a pressure, always
// along the inward normal of the surface as it deforms. `strength` times that; it sees t.
struct LoadSpec {
    std::string name;
    Side on = Side::all;
    std::optional<std::array<Expression3, 2>> box;  // none: wherever it looks that way
    std::optional<Expression3> force;               // [N], in the work frame; none: a pressure
    Expression pressure = "0";                      // [Pa]
    Expression strength = "ramp(t, 0, 1)";
};

// What a tool or grip may bear (matter/load_limit.h).
struct LimitSpec {
    std::string part;
    double most = 0;  // [N], or [N m] of a torque
    bool of_torque = false;
    TextPlace place;
};

// What had better hold before the machine starts; where it does not, the user is told.
struct CheckSpec {
    Expression holds;       // not 0
    std::string otherwise;  // a sentence that says what to change
};

struct MachineSpec {
    // Compiled once: a copy is thousands of instructions, which many places make.
    MachineSpec();
    ~MachineSpec();
    MachineSpec(const MachineSpec&);
    MachineSpec(MachineSpec&&) noexcept;
    MachineSpec& operator=(const MachineSpec&);
    MachineSpec& operator=(MachineSpec&&) noexcept;

    std::string name;
    std::string help;
    std::filesystem::path file;
    bool moves = false;    // for bodies in motion: no equilibrium is to be expected
    bool upright = false;  // what lies on its tools does so by gravity
    bool stops = false;    // something of it comes no farther once a limit is reached
    // The work frame's x and y, as place_work_frame takes them, where a stage leaves them open.
    WorldAxis axis = WorldAxis::automatic, up = WorldAxis::automatic;
    std::vector<ParameterSpec> parameter;
    std::vector<ToolSpec> tool;
    std::vector<GripSpec> grip;
    std::vector<BladeSpec> blade;
    std::vector<LoadSpec> load;    // a scene adds its own
    Expression gravity_strength;   // a scene's; sees t; empty: 1
    std::vector<LimitSpec> limit;  // a scene's
    std::vector<CheckSpec> check;

    // Whether nothing of it goes anywhere.
    bool stands() const {
        const auto all = [](const auto& parts) {
            return std::all_of(parts.begin(), parts.end(),
                               [](const auto& part) { return part.motion.stands(); });
        };
        return all(tool) && all(grip) && all(blade);
    }
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// What a machine is made of once it stands at the work-piece (Apparatus), and what it asks for at
// one time (Drive). Made by `machines`, read by `sim`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "geometry/shape.h"
#include "matter/load_limit.h"

namespace swage {

// How a tool is drawn: with a shine, without, or without and fading out into the backdrop.
enum class Finish : std::uint8_t { metal, matt, endless };

// A tool presses by contact with its smooth surface.
struct Tool {
    std::string name;
    Shape shape;
    double friction;  // on the work-piece: Coulomb, >= 0
    Vec3 color = {0.35, 0.38, 0.42};
    Finish finish = Finish::metal;
    // Where nothing moves: SimSettings::contact_stiffness of stages that do not say; 0: the usual.
    // NOTE: what rolls over a stiff tool does so from point to point, and its work is then known
    // less well; on flat ones nothing rolls.
    double contact_stiffness = 0;
    std::vector<double> friction_beside{};  // on the bodies beside it; what is missing is as on it

    double friction_on(int body) const {
        const std::size_t beside = static_cast<std::size_t>(body) - 1;
        return body > 0 && beside < friction_beside.size() ? friction_beside[beside] : friction;
    }
};

// Points of a body's true surface.
struct SurfacePart {
    std::vector<int> point;       // into Aggregate::surface
    std::vector<double> share{};  // of each one's patch, more than 0; empty: all
    int body = 0;                 // whose surface it is

    double share_of(std::size_t n) const { return share.empty() ? 1 : share[n]; }
};

// A grip holds points of the work-piece's true surface to its frame, by stiff springs; along some
// of the frame's axes only, where it is a smooth guide (one axis: a smooth plane).
struct Grip : SurfacePart {
    std::string name;
    std::vector<Vec3> anchor;  // where it holds each, in the grip's frame
    TriMesh jaw;               // for drawing, in the grip's frame; may be empty
    Vec3 color = {0.42, 0.36, 0.30};
    Vec3 hold = Vec3::Ones();  // along each axis of the frame: 1 held, 0 free
};

// A blade severs the connections that its edge sweeps through.
struct Blade {
    std::string name;
    std::vector<Vec3> edge;  // polyline in the blade's frame, two points or more
    TriMesh body;            // for drawing, in the blade's frame
    Vec3 color = {0.75, 0.76, 0.78};
};

// A push on points of the work-piece's true surface: dead forces, which keep their size and
// direction, or a pressure, which follows the surface (laws/pressure.h).
struct Load : SurfacePart {
    std::string name;
    std::vector<Vec3> force{};  // on each at full strength, in the world [N]; empty: a pressure
    double pressure = 0;        // at full strength [Pa]; less than zero sucks
    bool closed = false;        // the points make up whole closed surfaces
};

struct Apparatus {
    std::string name;
    std::vector<Tool> tool;
    std::vector<Grip> grip;
    std::vector<Blade> blade;
    std::vector<Load> load;
    std::vector<LoadLimit> limit{};  // whichever is reached first
};

// How what moves unevenly sets out on its way from the drive before, and comes to the end of it: as
// the twist from its first pose grows there, were the whole way gone so.
struct WayEnds {
    using IsPlain = WayEnds;
    Twist leaving, coming;
};

// Poses at one time, in the order of the apparatus.
struct Drive {
    double time = 0;  // [s] since the stage began
    std::vector<Pose> world_from_tool;
    std::vector<Pose> world_from_grip;
    std::vector<Pose> world_from_blade;
    std::vector<double> load_strength;  // 1: full
    double gravity_strength = 1;        // share of SimSettings::gravity
    // Of what comes from the drive before otherwise than straight (as a screw) and evenly; empty:
    // nothing does. What is in motion would feel each corner of such a way as a blow.
    std::vector<std::optional<WayEnds>> tool_way{}, grip_way{};

    template <typename Io>
    void visit(Io& io) {
        auto& [at, tool, grip, blade, load, gravity, tools, grips] = *this;
        io(at, tool, grip, blade, load, gravity, tools, grips);
    }
};

// The pose a share `s` of a way that bends: by the cubic that has its ends.
Pose between(const Pose& from, const Pose& to, const WayEnds& ends, double s);

// The drive a share `s` of the way between two, which follow each other.
Drive drive_between(const Drive& from, const Drive& to, double s);

// Of the part with this number: the tools, `tools` of them, then the grips.
inline const Pose& pose_of(const Drive& drive, std::size_t part, std::size_t tools) {
    return part < tools ? drive.world_from_tool[part] : drive.world_from_grip[part - tools];
}

// What a machine asks for at a time of the stage [s].
using DriveAt = std::function<Drive(double time)>;

// Where a machine came no farther.
struct LimitStop {
    std::size_t limit = 0;  // of the apparatus, the one that was reached
    Drive at;
    double borne = 0;   // of it, there
    double beyond = 0;  // what it jumps to at the least way farther; 0: it was met

    template <typename Io>
    void visit(Io& io) {
        io(limit, at, borne, beyond);
    }
};

}  // namespace swage

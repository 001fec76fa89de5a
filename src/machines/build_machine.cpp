// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "base/units.h"
#include "geometry/distance_field.h"
#include "geometry/mesh_read.h"
#include "machines/blade_edge.h"
#include "machines/bodies.h"
#include "machines/ever_turns.h"
#include "machines/load_name.h"
#include "machines/parameters.h"
#include "machines/repeat.h"
#include "machines/start_notes.h"
#include "machines/told_at.h"
#include "machines/touch.h"
#include "matter/carriage_of_held.h"
#include "matter/touch_points.h"

namespace swage {

namespace {

// A motion that begins nearer than this to rest begins at rest: share of the body's size, radians.
constexpr double kAtRest = 1e-9;
constexpr double kGripSlack = 1e-9;  // for points on the border of a grip's box: share of the size
constexpr double kClampClearance = 0.1;  // between a grip's drawn plates and the points; the same
const std::string kMaterialFriction = "material_friction";
constexpr double kMostReach = 10;   // spacings
constexpr int kTravelSamples = 64;  // of a blade's way, to see where it goes

struct Setting {  // what every part of a machine is set up in
    const WorkFrame& frame;
    double spacing;                         // of what the matter stands for
    double duration;                        // [s]
    std::vector<Vec3> point;                // the body's surface, in the work frame
    std::vector<Vec3> touch;                // what of it meets tools
    double apart;                           // these lie, at the most, about [m]
    bool coarser;                           // than those of what it stands for
    Variables known;                        // grows with each tool
    std::vector<Variables> known_beside{};  // to the bodies beside it: what differs
    std::vector<std::string> finding{};     // in the meshes of tools

    Variables timed() const {  // what expressions that see t know beside it
        Variables all = known;
        all["duration"] = duration;
        return all;
    }

    // What a part's expressions see is its own.
    void turn_to(const Repetition& part) {
        known.erase("number");
        if (part.number > 0) known["number"] = part.number;
    }
};

// Of what stands there; build_machine() adds whose it is.
[[noreturn]] void refuse(const Expression& at, const std::string& what) {
    throw PlacedError(at.place, what);
}

// A length. `of`: what has it, as "tool anvil".
double positive(const Setting& setting, const Expression& text, const std::string& of,
                const char* quantity) {
    const double value = evaluate(text, setting.known);
    if (!(value > 0)) {
        refuse(text, fmt::format("the {} of {} is {} and must be more than 0", quantity, of,
                                 quantity_text(value, Quantity::length)));
    }
    const std::string why = why_not_meant(value, Quantity::length, true);
    if (why.empty()) return value;
    refuse(text, fmt::format("the {} of {}: {}", quantity, of, why));
}

Vec3 length3(const Setting& setting, const Expression3& text) {
    return evaluate(text, setting.known, Quantity::length);
}

MeshShape scaled_mesh(Setting& setting, const ToolSpec& tool) {
    std::vector<std::string> finding;
    auto mesh = std::make_shared<TriMesh>();
    try {
        *mesh = read_mesh(tool.mesh, {}, &finding, kCreaseAngle, false);  // it looks as its tool
    } catch (const Error& error) {
        throw PlacedError(tool.mesh_place, error.what(), error.code());
    }
    for (const std::string& one : finding) {
        setting.finding.push_back(
            fmt::format("tool {}: {}: {}", tool.name, tool.mesh.filename().string(), one));
    }
    const Box box = box_of(mesh->position);
    const double scale =
        positive(setting, tool.length, "tool " + tool.name, "length") / box.size().maxCoeff();
    for (Vec3& p : mesh->position) p = scale * (p - box.center());
    auto field = std::make_shared<const DistanceField>(*mesh);
    if (!field->has_inside()) {
        refuse({"", tool.mesh_place},
               fmt::format("the mesh of tool {} encloses nothing that samples {} apart can find: "
                           "it must be a closed surface, and thicker than that",
                           tool.name, quantity_text(field->spacing(), Quantity::length)));
    }
    return {mesh, field};
}

Shape shape_of(Setting& setting, const ToolSpec& tool) {
    const auto length = [&](const Expression& text, const char* quantity) {
        return positive(setting, text, "tool " + tool.name, quantity);
    };
    const auto rounding = [&](double most, const char* what) {
        const double value = evaluate(tool.rounding, setting.known, Quantity::length);
        if (value >= 0 && value <= most) return value;
        refuse(tool.rounding,
               fmt::format("the rounding of tool {} is {} and must be 0 to half of {}", tool.name,
                           quantity_text(value, Quantity::length), what));
    };
    if (tool.shape == ToolShape::cylinder) {
        CylinderShape cylinder{length(tool.radius, "radius"), length(tool.length, "length")};
        cylinder.hole = evaluate(tool.hole, setting.known, Quantity::length);
        if (!(cylinder.hole >= 0 && cylinder.hole < cylinder.radius)) {
            refuse(tool.hole,
                   fmt::format("the hole of tool {} is {} and must be 0 to less than "
                               "its radius",
                               tool.name, quantity_text(cylinder.hole, Quantity::length)));
        }
        const double thin = thinness_of(cylinder);
        cylinder.rounding = rounding(0.5 * thin, thin == cylinder.length ? "its length"
                                                 : cylinder.hole > 0     ? "its wall"
                                                                         : "its diameter");
        return cylinder;
    }
    if (tool.shape == ToolShape::sphere) return SphereShape{length(tool.radius, "radius")};
    if (tool.shape == ToolShape::box) {
        const Vec3 size(length(tool.size[0], "size"), length(tool.size[1], "size"),
                        length(tool.size[2], "size"));
        return BoxShape{size, rounding(0.5 * size.minCoeff(), "the box's smallest side")};
    }
    if (tool.shape == ToolShape::mesh) return scaled_mesh(setting, tool);
    refuse({}, fmt::format("tool {} has no shape", tool.name));
}

std::string why_no_touch(const Setting& setting, const Tool& tool, const Pose& work_from_tool,
                         const Vec3& direction, double gap) {
    const bool is_beside =
        slide_to_touch(tool.shape, work_from_tool, direction, setting.touch, gap + setting.apart)
            .has_value();
    if (!is_beside) {
        return fmt::format(
            "tool {} can never touch the work-piece: it passes by. Place it nearer "
            "to the middle",
            tool.name);
    }
    return fmt::format(
        "tool {} meets no point of the work-piece's surface. They lie about {} "
        "apart, and it passes between them or close by: make it thicker or the "
        "cells smaller, or place it nearer to the middle",
        tool.name, quantity_text(setting.apart, Quantity::length));
}

void add_tool(Machine& machine, Setting& setting, const ToolSpec& spec) {
    Tool tool{.name = spec.name,
              .shape = shape_of(setting, spec),
              .friction = 0,
              .finish = spec.finish,
              .contact_stiffness = spec.contact_stiffness};
    if (spec.color) tool.color = *spec.color;
    const auto friction = [&](const Variables& known) {
        const double value = spec.friction.empty()
                                 ? known.at(kMaterialFriction)
                                 : evaluate(spec.friction, known, Quantity::number);
        if (value >= 0) return value;
        refuse(spec.friction, fmt::format("the friction of tool {} is {} and cannot be negative",
                                          spec.name, value));
    };
    tool.friction = friction(setting.known);
    for (Variables known : setting.known_beside) {
        known.insert(setting.known.begin(), setting.known.end());
        tool.friction_beside.push_back(friction(known));
    }
    const Vec3 axis = evaluate(spec.axis, setting.known, Quantity::number);
    if (!(axis.norm() > 0)) {
        refuse(spec.axis[0], fmt::format("the axis of tool {} has no length", spec.name));
    }
    const double turn = evaluate(spec.turn, setting.known, Quantity::angle);
    const Quat rotation = turn_onto(Vec3::UnitZ(), axis) * turn_about(Vec3::UnitZ(), turn);
    Pose work_from_tool{rotation.normalized(), length3(setting, spec.at)};
    const Vec3 touch = evaluate(spec.touch, setting.known, Quantity::number);
    if (touch.norm() > 0) {
        const Vec3 direction = touch.normalized();
        const double gap = evaluate(spec.gap, setting.known, Quantity::length);
        std::optional<double> shift =
            slide_to_touch(tool.shape, work_from_tool, direction, setting.touch, gap);
        if (!shift && setting.coarser) {
            shift = slide_to_touch(tool.shape, work_from_tool, direction, setting.touch,
                                   gap + setting.apart);
        }
        if (!shift)
            refuse(spec.touch[0], why_no_touch(setting, tool, work_from_tool, direction, gap));
        work_from_tool.translation += *shift * direction;
    }
    for (int c = 0; c < 3; ++c) {
        setting.known[spec.name + "_" + "xyz"[c]] = work_from_tool.translation[c];
    }
    machine.apparatus.tool.push_back(std::move(tool));
    machine.work_from_tool.push_back(work_from_tool);
}

// With the middle of a repeated tool under the name that all of these share.
Variables seen_by_motion(const Setting& setting, const ToolSpec& spec) {
    Variables seen = setting.timed();
    if (spec.repeat.number == 0) return seen;
    for (const char* axis : {"_x", "_y", "_z"}) {
        seen[spec.repeat.name + axis] = setting.known.at(spec.name + axis);
    }
    return seen;
}

// Of any two opposite corners.
Box box_between(const Setting& setting, const Expression3& from, const Expression3& to) {
    const Vec3 slack = Vec3::Constant(kGripSlack * setting.frame.size.norm());
    const Box box = box_of({length3(setting, from), length3(setting, to)});
    return {box.low - slack, box.high + slack};
}

// Whether two grips hold along different axes all the way, as planes of symmetry that meet do.
bool are_apart(const GripSpec& one, const Motion& own, const GripSpec& other, const Motion& its) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (one.along[axis] && other.along[axis]) return false;
    }
    return !ever_turns(own) && !ever_turns(its);
}

// `regions`: of the grips before it.
void add_grip(Machine& machine, const Setting& setting, const Aggregate& matter,
              const GripSpec& spec, std::vector<Box>& regions) {
    constexpr double kLeastShare = 0.01, kOverlap = 1e-3;  // of a patch
    const Box region = box_between(setting, spec.from, spec.to);
    const Pose work_from_world = setting.frame.world_from_work.inverse();
    const Mat3 turn = work_from_world.rotation.toRotationMatrix();
    Motion motion(spec.motion, setting.timed());
    Grip grip;
    grip.name = spec.name;
    Box jaws;
    for (std::size_t p = 0; p < setting.point.size(); ++p) {
        const Vec3 at = work_from_world * position_of_held(matter, p);
        const Box patch = patch_box(matter, turn, p, at);
        const double share = share_within(patch, region);
        if (share < kLeastShare) continue;
        for (std::size_t g = 0; g < regions.size(); ++g) {
            if (are_apart(machine.spec.grip[g], machine.grip_motion[g], spec, motion)) continue;
            const Box both = {region.low.cwiseMax(regions[g].low),
                              region.high.cwiseMin(regions[g].high)};
            if (both.empty() || share_within(patch, both) <= kOverlap) continue;
            refuse(spec.from[0],
                   fmt::format(
                       "grips {} and {} would hold the same points; make one of them smaller, or "
                       "let them hold along different axes (along) without turning",
                       machine.apparatus.grip[g].name, spec.name));
        }
        grip.point.push_back(static_cast<int>(p));
        grip.anchor.push_back(at);
        grip.share.push_back(share);
        jaws.grow(patch.low.cwiseMax(region.low));
        jaws.grow(patch.high.cwiseMin(region.high));
    }
    if (grip.point.empty()) {
        refuse(spec.from[0],
               fmt::format("grip {} holds nothing: no point of the work-piece's surface "
                           "lies in its box",
                           spec.name));
    }
    const Vec3 center = jaws.center();
    const Pose work_from_grip{Quat::Identity(), center};
    for (Vec3& anchor : grip.anchor) anchor -= center;
    for (int axis = 0; axis < 3; ++axis) grip.hold[axis] = spec.along[axis];
    if (spec.drawn) {
        grip.jaw = clamp_around({jaws.low - center, jaws.high - center},
                                kClampClearance * setting.spacing);
    }

    const Pose start = pose_at(motion, "grip " + spec.name, 0);
    const double size = setting.frame.size.norm();
    if ((start * center - center).norm() > kAtRest * size ||
        rotation_of(start.rotation).norm() > 10 * kAtRest) {
        const Expression& moves = spec.motion.turn == "0" ? spec.motion.move[0] : spec.motion.turn;
        refuse(moves, fmt::format("the motion of grip {} must be 0 at t = 0", spec.name));
    }
    regions.push_back(region);
    machine.apparatus.grip.push_back(std::move(grip));
    machine.work_from_grip.push_back(work_from_grip);
    machine.grip_motion.push_back(std::move(motion));
}

void add_blade(Machine& machine, const Setting& setting, const BladeSpec& spec) {
    const std::vector<Vec3> edge = edge_of(spec, setting.known);
    const std::string whose = "blade " + spec.name;
    const double thickness = positive(setting, spec.thickness, whose, "thickness");
    const Vec3 centre = box_of(edge).center();
    Motion motion(spec.motion, setting.timed());

    // The plate stands behind the edge and is tall enough to show above what it has cut.
    const Vec3 start = pose_at(motion, whose, 0) * centre;
    std::vector<Vec3> way;
    for (int n = 1; n <= kTravelSamples; ++n) {
        const double t = static_cast<double>(n) / kTravelSamples;
        way.push_back(pose_at(motion, whose, t) * centre - start);
    }
    const Vec3 travel = farthest_forth(way);
    const bool is_closed = edge.front() == edge.back();
    const double width = (is_closed ? box_of(edge).size() : edge.back() - edge.front()).norm();
    const bool moves = travel.norm() > kAtRest * setting.frame.size.norm();
    const Vec3 back = moves ? Vec3(-travel) : Vec3(0.5 * width * Vec3::UnitY());

    Blade blade;
    blade.name = spec.name;
    for (const Vec3& point : edge) blade.edge.push_back(point - centre);
    blade.body = blade_behind(blade.edge, back, 1.15 * back.norm(), thickness);
    machine.apparatus.blade.push_back(std::move(blade));
    machine.work_from_blade.push_back({Quat::Identity(), centre});
    machine.blade_motion.push_back(std::move(motion));
}

void add_load(Machine& machine, const Setting& setting, const Aggregate& matter,
              const LoadSpec& spec) {
    Box box;
    if (spec.box) box = box_between(setting, (*spec.box)[0], (*spec.box)[1]);
    Load load{find_region(matter, setting.frame.world_from_work, setting.point, spec.on,
                          spec.box ? &box : nullptr),
              spec.name};
    if (load.point.empty()) {
        const Expression& where = spec.box     ? (*spec.box)[0][0]
                                  : spec.force ? (*spec.force)[0]
                                               : spec.pressure;
        refuse(where, fmt::format("{} acts on nothing: no part of the work-piece's surface {}{}",
                                  load_name(spec.name),
                                  spec.on == Side::inside ? "is the wall of a closed cavity"
                                                          : "faces that way",
                                  spec.box ? " and lies in its box" : ""));
    }
    load.closed = load.share.empty() && are_whole_surfaces(matter, load.point);
    if (spec.force) {
        const Vec3 force = setting.frame.world_from_work.turn(
            evaluate(*spec.force, setting.known, Quantity::force));
        std::vector<double> area;
        for (std::size_t n = 0; n < load.point.size(); ++n) {
            area.push_back(load.share_of(n) * patch_area(matter, std::size_t(load.point[n])));
        }
        const double all = std::accumulate(area.begin(), area.end(), 0.0);
        for (double own : area) load.force.push_back(own / all * force);
    } else {
        load.pressure = evaluate(spec.pressure, setting.known, Quantity::stress);
    }
    machine.load_on.push_back(components_of(matter, load));
    machine.apparatus.load.push_back(std::move(load));
    machine.load_strength.emplace_back(spec.strength, setting.timed(), Quantity::number);
}

// The scene's reader has found the part, and that it turns where a torque is meant.
void add_limit(Machine& machine, const LimitSpec& spec) {
    std::vector<std::string> names;
    for (const Tool& tool : machine.apparatus.tool) names.push_back(tool.name);
    for (const Grip& grip : machine.apparatus.grip) names.push_back(grip.name);
    const auto at = std::find(names.begin(), names.end(), spec.part);
    if (at == names.end()) {
        refuse({"", spec.place}, fmt::format("no tool or grip is called \"{}\"", spec.part));
    }
    const auto part = static_cast<std::size_t>(at - names.begin());
    machine.apparatus.limit.push_back(
        {part, spec.most, spec.of_torque, turn_axes(machine)[part].value_or(TurnAxis())});
}

// How far particles stick out of the work-piece's box, at the most [m]: corners of cells that the
// mesh does not fill. What has been driven farther than kMostReach holds next to nothing.
double lattice_reach(const Aggregate& matter, const WorkFrame& frame) {
    const Pose work_from_world = frame.world_from_work.inverse();
    double reach = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 at = work_from_world * matter.particle_position.at(p);
        reach = std::max(reach, (at.cwiseAbs() - 0.5 * frame.size).maxCoeff());
    }
    return std::min(reach, kMostReach * matter.lattice.spacing);
}

}  // namespace

Variables work_piece_variables(const Aggregate& matter, const WorkFrame& frame, double coarser) {
    return {{"length", frame.size.x()},
            {"height", frame.size.y()},
            {"width", frame.size.z()},
            {"spacing", matter.lattice.spacing / coarser},
            {"lattice_reach", lattice_reach(matter, frame) / coarser},
            {kMaterialFriction, matter.material.friction}};
}

namespace {

// Of a machine that cannot be set up: what its checks find may be why. Those that see what has not
// been placed are left out.
[[noreturn]] void refuse_with_checks(const PlacedError& why, const MachineSpec& spec,
                                     const Variables& known) {
    std::string told = why.what();
    for (const CheckSpec& check : spec.check) {
        try {
            if (evaluate(check.holds, known) == 0) told += ". " + check.otherwise;
        } catch (const Error&) {
        }
    }
    throw PlacedError(why.place(), told, why.code());
}

void place_parts(Machine& machine, Setting& setting, const Aggregate& matter) {
    const MachineSpec& spec = machine.spec;
    for (const ToolSpec& tool : spec.tool) {
        setting.turn_to(tool.repeat);
        add_tool(machine, setting, tool);
    }
    for (const ToolSpec& tool : spec.tool) {
        setting.turn_to(tool.repeat);
        machine.tool_motion.emplace_back(tool.motion, seen_by_motion(setting, tool));
    }
    std::vector<Box> regions;
    for (const GripSpec& grip : spec.grip) {
        setting.turn_to(grip.repeat);
        add_grip(machine, setting, matter, grip, regions);
    }
    for (const BladeSpec& blade : spec.blade) {
        setting.turn_to(blade.repeat);
        add_blade(machine, setting, blade);
    }
    setting.turn_to({});
    for (const LoadSpec& load : spec.load) add_load(machine, setting, matter, load);
}

Machine set_up(const MachineSpec& given_spec, const std::map<std::string, double>& given,
               const WorkFrame& frame, const Aggregate& matter, const std::vector<Material>& beside,
               double duration, double coarser) {
    Setting setting{frame, matter.lattice.spacing / coarser, duration, {}, {}, 0, coarser > 1, {}};
    const Pose work_from_world = frame.world_from_work.inverse();
    for (const Vec3& p : surface_positions(matter)) setting.point.push_back(work_from_world * p);
    const TouchPoints touch(matter);
    for (int p = 0; p < int(touch.size()); ++p) {
        if (!touch.meets(p)) continue;
        setting.touch.push_back(work_from_world *
                                touch.points().position(std::size_t(p), matter.particle_position));
        setting.apart = std::max(setting.apart, std::sqrt(touch.points().area(std::size_t(p))));
    }
    setting.known = work_piece_variables(matter, frame, coarser);

    Machine machine;
    machine.frame = frame;
    for (const Material& material : beside) {
        Variables known = setting.known;
        known[kMaterialFriction] = material.friction;
        known.merge(resolve_parameters(given_spec, given, known));
        setting.known_beside.push_back(std::move(known));
    }
    machine.parameter = resolve_parameters(given_spec, given, setting.known);
    machine.apparatus.name = given_spec.name;
    setting.known.insert(machine.parameter.begin(), machine.parameter.end());

    machine.spec = with_single_parts(given_spec, machine.parameter);
    const MachineSpec& spec = machine.spec;
    try {
        place_parts(machine, setting, matter);
    } catch (const PlacedError& why) {
        setting.turn_to({});
        refuse_with_checks(why, spec, setting.known);
    }
    for (const LimitSpec& limit : spec.limit) add_limit(machine, limit);
    if (!spec.gravity_strength.empty()) {
        machine.gravity_strength.emplace(spec.gravity_strength, setting.timed(), Quantity::number);
    }
    machine.notes = setting.finding;
    for (std::string& note : start_notes(machine, matter, setting.touch, setting.spacing)) {
        machine.notes.push_back(std::move(note));
    }
    for (const CheckSpec& check : spec.check) {
        if (evaluate(check.holds, setting.known) == 0) machine.notes.push_back(check.otherwise);
    }
    return machine;
}

}  // namespace

Machine build_machine(const MachineSpec& spec, const std::map<std::string, double>& given,
                      const WorkFrame& frame, const Aggregate& matter,
                      const std::vector<Material>& beside, double duration, double coarser) {
    return naming(spec,
                  [&] { return set_up(spec, given, frame, matter, beside, duration, coarser); });
}

}  // namespace swage

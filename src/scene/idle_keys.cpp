// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/idle_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/expression.h"
#include "geometry/mesh_read.h"
#include "laws/spring_moduli.h"
#include "scene/expressions.h"
#include "scene/stage_doubts.h"

namespace swage {

namespace {

// A section of the scene, and what it was read as.
struct Section {
    const Node& node;
    const SceneSpec& scene;
    const Material* material = nullptr;  // of a [material] or an [[inset]]
    const StageSpec* stage = nullptr;    // of a [[stage]]

    bool says(const char* key, const char* text) const {
        const Entry* entry = node.find(key);
        return entry != nullptr && entry->value.text == text;
    }
};

bool meets_anything(const SceneSpec& scene, const StageSpec& stage) {
    return !stage.machine.tool.empty() || scene.body.size() > 1 || stage.sim.self_contact;
}

// Behind "KEY has no effect"; empty: it has one.
using Why = std::string (*)(const Section&);

std::string with_solver(const Section& at) {
    return fmt::format(" with solver = \"{}\"", name_of(at.stage->sim.solver));
}
std::string unless_it_relaxes(const Section& at) {
    return in_motion(at.stage->sim.solver) ? with_solver(at) : "";
}
std::string unless_it_makes_steps(const Section& at) {
    const Solver solver = at.stage->sim.solver;
    return is_explicit(solver) || solver == Solver::implicit_steps ? "" : with_solver(at);
}
std::string unless_it_follows_all_motion(const Section& at) {
    return follows_all_motion(at.stage->sim.solver) ? "" : with_solver(at);
}

constexpr const char* kNothingMeets =
    ": nothing can touch, as no machine has a tool, there is only one body, and no stage has "
    "self_contact";

std::string unless_something_meets(const Section& at) {
    const auto meets = [&](const StageSpec& stage) { return meets_anything(at.scene, stage); };
    return at.scene.any_stage(meets) ? "" : kNothingMeets;
}
// Whether the friction of some tool goes by that of the material.
bool has_tool_of_material_friction(const StageSpec& stage) {
    std::vector<std::string> known = work_piece_names(), goes_by_it = {"material_friction"};
    const auto names_it = [&](const Expression& text) {
        if (text.empty()) return false;
        const std::vector<std::string> used = Formula(text.text, known).used();
        return std::find_first_of(used.begin(), used.end(), goes_by_it.begin(), goes_by_it.end()) !=
               used.end();
    };
    for (const ParameterSpec& one : stage.machine.parameter) {
        if (stage.parameter.count(one.name) == 0 && names_it(one.default_value))
            goes_by_it.push_back(one.name);
        known.push_back(one.name);
    }
    for (const ToolSpec& tool : stage.machine.tool) {
        for (const char* axis : {"_x", "_y", "_z"}) known.push_back(tool.name + axis);
    }
    return std::any_of(
        stage.machine.tool.begin(), stage.machine.tool.end(),
        [&](const ToolSpec& tool) { return tool.friction.empty() || names_it(tool.friction); });
}
std::string unless_something_rubs(const Section& at) {
    const std::string apart = unless_something_meets(at);
    if (!apart.empty()) return apart;
    const auto rubs = [&](const StageSpec& stage) {
        // In motion a tool's holds before it slides in the proportion of the material's.
        const bool meets_its_like = at.scene.body.size() > 1 || stage.sim.self_contact;
        return meets_its_like || (in_motion(stage.sim.solver) && meets_anything(at.scene, stage)) ||
               has_tool_of_material_friction(stage);
    };
    return at.scene.any_stage(rubs)
               ? ""
               : ": every tool has its own friction, and nothing else can touch";
}
constexpr const char* kNothingMoves =
    " unless a stage is in motion (solver = \"explicit\", \"euler\" or \"energy-stepped\")";
std::string unless_something_moves(const Section& at) {
    const auto moves = [](const StageSpec& stage) { return follows_all_motion(stage.sim.solver); };
    return at.scene.any_stage(moves) ? "" : kNothingMoves;
}
std::string unless_something_strikes(const Section& at) {
    const std::string still = unless_something_moves(at);
    return still.empty() ? unless_something_meets(at) : still;
}

std::string unless_skin_is_mounted(const Section& at) {
    return at.scene.skin.kind != SkinKind::boundary
               ? ""
               : " with kind = \"boundary\": such a skin is made anew from voxels";
}

bool creases_matter(const SceneSpec& scene) {
    return std::any_of(scene.body.begin(), scene.body.end(), [](const BodySpec& body) {
        try {
            return goes_by_crease_angle(body.mesh.file);
        } catch (const Error&) {
            return true;  // what is amiss with it is told then
        }
    });
}

// Why a field is 0 everywhere; empty: it need not be.
std::string tells_nothing(const std::string& field, const SceneSpec& scene) {
    if ((field == "plastic_strain" || field == "yield_use") && !scene.yields()) {
        return ": no material yields (yield_stress, flow_curve), so it is 0 everywhere";
    }
    if (field == "strength_use" && !scene.breaks()) {
        return ": no material breaks (strength, toughness), so it is 0 everywhere";
    }
    return {};
}

bool cuts(const SceneSpec& scene) {
    return scene.any_stage([](const StageSpec& s) { return !s.machine.blade.empty(); });
}

std::string unless_it_is_cut(const Section& at) {
    return cuts(at.scene) ? "" : ": no machine cuts";
}

struct IdleKey {
    const char* key;
    Why why;
};

const std::vector<IdleKey> kOfMaterials = {
    {"poisson_ratio",
     [](const Section& at) -> std::string {
         constexpr double kSlack = 0.005;
         const bool is_other = std::abs(at.material->poisson_ratio - kPoissonOfSprings) > kSlack;
         return at.material->mechanics == Mechanics::springs && is_other
                    ? fmt::format(": a lattice of springs always has {}", kPoissonOfSprings)
                    : "";
     }},
    {"elasticity",
     [](const Section& at) -> std::string {
         return at.material->mechanics == Mechanics::springs ? " with springs" : "";
     }},
    {"hardening",
     [](const Section& at) -> std::string {
         return at.material->yields() ? "" : " without yield_stress";
     }},
    {"toughness",
     [](const Section& at) -> std::string {
         return at.material->breaks() ? "" : " without strength";
     }},
    // A ratio of 0 says what is so anyhow. Implicit steps are told of where they are chosen.
    {"damping_ratio",
     [](const Section& at) -> std::string {
         return !at.scene.moves() && at.material->damping_ratio > 0 ? kNothingMoves : "";
     }},
    {"friction", unless_something_rubs},
    {"static_friction", unless_something_strikes},
    {"restitution", unless_something_strikes},
    {"stickiness", unless_something_strikes},
};

const std::vector<IdleKey> kOfInsets = {{"color", unless_it_is_cut}, {"look", unless_it_is_cut}};

const std::vector<IdleKey> kOfMeshes = {
    {"cut_color",
     [](const Section& at) -> std::string {
         return cuts(at.scene) || at.scene.breaks() ? ""
                                                    : ": no machine cuts, and no material breaks";
     }},
};

const std::vector<IdleKey> kOfSkins = {
    {"divide", unless_skin_is_mounted},
    {"crease_angle",
     [](const Section& at) -> std::string {
         const std::string voxels = unless_skin_is_mounted(at);
         if (!voxels.empty() || creases_matter(at.scene)) return voxels;
         return ": the mesh file itself says which edges are sharp";
     }},
    {"roughness",
     [](const Section& at) -> std::string {
         return at.scene.breaks() ? "" : ": no material breaks (strength, toughness)";
     }},
};

// Whether anything of the machine goes by it as a time.
bool names_duration(const MachineSpec& machine) {
    const auto in = [](const Expression& one) {
        return one.text.find("duration") != std::string::npos;
    };
    const auto moves_by_it = [&](const auto& parts) {
        return std::any_of(parts.begin(), parts.end(), [&](const auto& part) {
            return in(part.motion.turn) || std::ranges::any_of(part.motion.move, in) ||
                   std::ranges::any_of(part.motion.pivot, in);
        });
    };
    return moves_by_it(machine.tool) || moves_by_it(machine.grip) || moves_by_it(machine.blade) ||
           in(machine.gravity_strength) ||
           std::any_of(machine.load.begin(), machine.load.end(),
                       [&](const LoadSpec& load) { return in(load.strength); });
}

const std::vector<IdleKey> kOfStages = {
    {"remold",
     [](const Section& at) -> std::string {
         return at.stage->remold && at.stage == &at.scene.stage.front()
                    ? " in the first stage, whose matter has just been molded"
                    : "";
     }},
    {"duration",
     [](const Section& at) -> std::string {
         return !in_motion(at.stage->sim.solver) && !names_duration(at.stage->machine)
                    ? with_solver(at) + ", except on the times in curves"
                    : "";
     }},
    {"tolerance", unless_it_relaxes},
    {"iteration_limit", unless_it_relaxes},
    {"halving_limit", unless_it_relaxes},
    {"step_safety", unless_it_follows_all_motion},
    {"retry_limit", unless_it_makes_steps},
    {"self_contact",
     [](const Section& at) -> std::string {
         return at.stage->sim.solver == Solver::implicit_steps ? with_solver(at) : "";
     }},
    {"sleep",
     [](const Section& at) -> std::string {
         const std::string other = unless_it_makes_steps(at);
         if (!other.empty() || at.stage->sim.gravity != Vec3::Zero()) return other;
         return " without gravity: only what gravity holds down can sleep";
     }},
    {"contact_stiffness",
     [](const Section& at) -> std::string {
         return meets_anything(at.scene, *at.stage)
                    ? ""
                    : fmt::format(
                          ": nothing can touch, as machine {} has no tool, there is only one body, "
                          "and self_contact is off",
                          at.stage->machine.name);
     }},
    {"grip_stiffness",
     [](const Section& at) -> std::string {
         return at.stage->machine.grip.empty()
                    ? fmt::format(": machine {} has no grip", at.stage->machine.name)
                    : "";
     }},
    {"medium_density", unless_it_follows_all_motion},
    {"drag_coefficient",
     [](const Section& at) -> std::string {
         const std::string other = unless_it_follows_all_motion(at);
         if (!other.empty() || at.stage->sim.medium_density > 0) return other;
         return " without medium_density";
     }},
    {"directional_drag", unless_it_follows_all_motion},
    {"directional_drag_along",
     [](const Section& at) -> std::string {
         const std::string other = unless_it_follows_all_motion(at);
         if (!other.empty() || at.stage->sim.directional_drag > 0) return other;
         return " without directional_drag";
     }},
    {"gravity_strength",
     [](const Section& at) -> std::string {
         return at.stage->sim.gravity == Vec3::Zero() ? " without gravity" : "";
     }},
};

const std::vector<IdleKey> kOfRender = {
    {"tools",
     [](const Section& at) -> std::string {
         const bool any = at.scene.any_stage([](const StageSpec& s) {
             return !s.machine.tool.empty() || !s.machine.grip.empty() || !s.machine.blade.empty();
         });
         return any ? "" : ": no machine has a tool, a grip or a blade";
     }},
    {"hide",
     [](const Section& at) -> std::string {
         return at.scene.render.tools ? "" : " with tools = false";
     }},
    // Fields that are held may be drawn later, and then keep to it.
    {"legend",
     [](const Section& at) -> std::string {
         return at.scene.render.color || !at.scene.output.fields.empty() ? "" : " without color";
     }},
    {"color",
     [](const Section& at) -> std::string {
         return tells_nothing(at.node.find("color")->value.text, at.scene);
     }},
};

void judge(const std::vector<IdleKey>& keys, const Section& section, MistakeList& mistakes) {
    for (const auto& [key, why] : keys) {
        const Entry* given = section.node.find(key);
        if (given == nullptr) continue;
        const std::string reason = why(section);
        if (!reason.empty()) {
            mistakes.warn(given->value.place, fmt::format("{} has no effect{}", key, reason));
        }
    }
}

// Of a list, so each at its own place.
void judge_fields(const Node& output, const SceneSpec& scene, MistakeList& mistakes) {
    const Entry* fields = output.find("fields");
    if (fields == nullptr) return;
    for (const Node& item : fields->value.item) {
        const std::string why = tells_nothing(item.text, scene);
        if (why.empty()) continue;
        mistakes.warn(item.place, fmt::format("fields: {} shows nothing{}", item.text, why));
    }
}

}  // namespace

void warn_of_idle_keys(const Node& root, const SceneSpec& scene, MistakeList& mistakes) {
    static const Node absent;
    const auto section = [&](const Node& of, const char* name) -> const Node& {
        const Entry* entry = of.find(name);
        const bool is_there = entry != nullptr && entry->value.kind == Node::Kind::table;
        return is_there ? entry->value : absent;
    };
    const auto item = [&](const char* name, std::size_t n) -> const Node& {
        const Entry* entry = root.find(name);
        return entry != nullptr && n < entry->value.item.size() ? entry->value.item[n] : absent;
    };
    const BodySpec& work_piece = scene.work_piece();
    judge(kOfMeshes, {section(root, "mesh"), scene}, mistakes);
    judge(kOfMaterials, {section(root, "material"), scene, &work_piece.material}, mistakes);
    for (std::size_t n = 0; n < work_piece.inset.size(); ++n) {
        judge(kOfInsets, {item("inset", n), scene}, mistakes);
        judge(kOfMaterials, {item("inset", n), scene, &work_piece.inset[n].material}, mistakes);
    }
    for (std::size_t b = 1; b < scene.body.size(); ++b) {
        judge(kOfMeshes, {item("body", b - 1), scene}, mistakes);
        judge(kOfMaterials,
              {section(item("body", b - 1), "material"), scene, &scene.body[b].material}, mistakes);
    }
    judge(kOfSkins, {section(root, "skin"), scene}, mistakes);
    for (std::size_t s = 0; s < scene.stage.size(); ++s) {
        judge(kOfStages, {item("stage", s), scene, nullptr, &scene.stage[s]}, mistakes);
    }
    judge(kOfRender, {section(root, "render"), scene}, mistakes);
    judge_fields(section(root, "output"), scene, mistakes);
    if (const Entry* probes = root.find("probe")) {
        for (const Node& probe : probes->value.item) judge_fields(probe, scene, mistakes);
    }
    warn_of_doubtful_stages(root, scene, mistakes);
}

}  // namespace swage

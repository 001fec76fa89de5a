// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/machine_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/expression.h"
#include "base/portable_math.h"
#include "base/text.h"
#include "base/text_error.h"
#include "base/way_text.h"
#include "geometry/mesh_check.h"
#include "pipeline/limit_watch.h"
#include "pipeline/rounded_text.h"
#include "pipeline/stage_machine.h"

namespace swage {

namespace {

constexpr std::size_t kMostTold = 4;  // of a load's parts
constexpr int kLooks = 256;           // at strengths, over the stage

Vec3 in_machine(const WorkFrame& frame, const Vec3& in_world) {
    return frame.world_from_work.inverse() * in_world;
}

SurfaceComponent whole_of(const std::vector<SurfaceComponent>& parts) {
    SurfaceComponent whole{0, Vec3::Zero()};
    for (const SurfaceComponent& part : parts) {
        whole.area += part.area;
        whole.middle += part.area * part.middle;
    }
    if (whole.area > 0) whole.middle /= whole.area;
    return whole;
}

// To a thousandth of the box or so.
std::string place_text(const WorkFrame& frame, const Vec3& in_world) {
    const double unit = portable::pow(10, std::floor(portable::log10(frame.size.maxCoeff())) - 3);
    const Vec3 at = in_machine(frame, in_world);
    const auto text = [&](double x) { return length_text(unit * std::round(x / unit) + 0.0); };
    return fmt::format("[{}, {}, {}]", text(at[0]), text(at[1]), text(at[2]));
}

std::string part_text(const WorkFrame& frame, const SurfaceComponent& part) {
    return fmt::format("{} about {}", area_text(part.area), place_text(frame, part.middle));
}

Json part_json(const WorkFrame& frame, const SurfaceComponent& part) {
    const Vec3 at = in_machine(frame, part.middle);
    return {{"area_m2", part.area},
            {"middle_m", {part.middle[0], part.middle[1], part.middle[2]}},
            {"middle_by_machine_m", {at[0], at[1], at[2]}}};
}

Vec3 whole_force(const Load& load) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& one : load.force) sum += one;
    return sum;
}

struct StrengthRange {
    double least = 1, most = 1;

    double full() const { return -least > most ? least : most; }  // that acts the most
    double other() const { return -least > most ? most : least; }
};

// Of each load over the stage; 1 where an expression has no value at some time, which others tell.
std::vector<StrengthRange> strengths_of(const Machine& machine) {
    std::vector<StrengthRange> all(machine.load_strength.size());
    try {
        for (int n = 0; n <= kLooks; ++n) {
            const std::vector<double> now = strengths_at(machine, double(n) / kLooks);
            for (std::size_t l = 0; l < all.size(); ++l) {
                all[l].least = n == 0 ? now[l] : std::min(all[l].least, now[l]);
                all[l].most = n == 0 ? now[l] : std::max(all[l].most, now[l]);
            }
        }
    } catch (const Error&) {
        std::fill(all.begin(), all.end(), StrengthRange{});
    }
    return all;
}

}  // namespace

std::string axes_text(const WorkFrame& frame) {
    const auto [x, y, z] = world_axes(frame);
    if (x == WorldAxis::x && y == WorldAxis::y) return {};
    return fmt::format("the machine's x, y, z are the world's {}, {}, {}", name_of(x), name_of(y),
                       name_of(z));
}

Json axes_json(const WorkFrame& frame) {
    Json json = Json::array();
    for (const WorldAxis axis : world_axes(frame)) json.push_back(name_of(axis));
    return json;
}

std::vector<std::string> load_texts(const Machine& machine) {
    std::vector<std::string> texts;
    for (std::size_t n = 0; n < machine.load_on.size(); ++n) {
        const std::vector<SurfaceComponent>& parts = machine.load_on[n];
        std::string text = fmt::format("{} acts on {}", machine.apparatus.load[n].name,
                                       part_text(machine.frame, whole_of(parts)));
        if (parts.size() > 1) {
            text += fmt::format(", in {} separate parts:", parts.size());
            for (std::size_t p = 0; p < std::min(parts.size(), kMostTold); ++p) {
                text += (p == 0 ? " " : "; ") + part_text(machine.frame, parts[p]);
            }
            if (parts.size() > kMostTold) text += "; ...";
        }
        texts.push_back(text);
    }
    return texts;
}

Json loads_json(const Machine& machine) {
    Json json = Json::array();
    const std::vector<StrengthRange> strength = strengths_of(machine);
    for (std::size_t n = 0; n < machine.load_on.size(); ++n) {
        const double full = strength[n].full();
        const Load& pushes = machine.apparatus.load[n];
        Json load = {{"name", pushes.name}};
        if (pushes.force.empty()) {
            load["pressure_Pa"] = full * pushes.pressure;
        } else {
            const Vec3 force = full * whole_force(pushes);
            load["force_N"] = {force[0], force[1], force[2]};
        }
        load["strength_least"] = strength[n].least;
        load["strength_most"] = strength[n].most;
        load.update(part_json(machine.frame, whole_of(machine.load_on[n])));
        load["parts"] = Json::array();
        for (const SurfaceComponent& part : machine.load_on[n]) {
            load["parts"].push_back(part_json(machine.frame, part));
        }
        json.push_back(load);
    }
    return json;
}

std::vector<std::string> push_texts(const Machine& machine) {
    std::vector<std::string> texts;
    const std::vector<StrengthRange> strength = strengths_of(machine);
    for (std::size_t n = 0; n < strength.size(); ++n) {
        const Load& load = machine.apparatus.load[n];
        const bool is_force = !load.force.empty();
        const Vec3 unit_force = whole_force(load);
        const double unit = is_force ? unit_force.norm() : std::abs(load.pressure);
        const double full = strength[n].full(), other = strength[n].other();
        if (full * unit == 0) continue;
        const auto size = [&](double at) {
            return (full == other ? "" : "up to ") +
                   rounded_text(std::abs(at) * unit, is_force ? Quantity::force : Quantity::stress,
                                4);
        };
        const auto verb = [&](double at) { return at * load.pressure < 0 ? "sucks" : "presses"; };
        const bool changes = full * other < 0;
        std::string text = load.name + " ";
        if (is_force) {
            text += fmt::format("pushes with {} along the world's {}", size(full),
                                way_text((full * unit_force).normalized()));
            if (changes) text += fmt::format(", and {} the other way", size(other));
        } else {
            text += fmt::format("{} with {}", verb(full), size(full));
            if (changes) text += fmt::format(", and {} with {}", verb(other), size(other));
        }
        texts.push_back(text);
    }
    return texts;
}

constexpr double kOneSide = 0.99;  // cosine of what still is the same side

std::string tools_text(const StageSpec& stage, const WorkFrame& frame) {
    std::vector<std::string> names;
    std::optional<Vec3> from;  // by the machine; unit
    for (const ToolSpec& tool : stage.machine.tool) {
        if (tool.motion.stands()) continue;
        Vec3 way;
        try {
            for (int k = 0; k < 3; ++k) way[k] = -Formula(tool.touch[k].text, {}).evaluate({});
        } catch (const TextError&) {  // it goes by the work-piece
            return {};
        }
        if (way.isZero()) return {};
        way.normalize();
        if (from && from->dot(way) < kOneSide) return {};
        if (!from) from = way;
        const std::string& name = tool.repeat.number > 0 ? tool.repeat.name : tool.name;
        if (names.empty() || names.back() != name) names.push_back(name);
    }
    int along;
    if (!from || from->cwiseAbs().maxCoeff(&along) < kOneSide) return {};
    const WorldAxis side = world_axes(frame)[along];
    const bool turns = (*from)[along] < 0;
    const auto [x, y, z] = world_axes(frame);
    const auto opposite = [](WorldAxis axis) {
        const int n = static_cast<int>(axis) - 1;
        return static_cast<WorldAxis>((n ^ 1) + 1);
    };
    std::string text =
        fmt::format("{} come{} from the world's {} (the machine's {}{}, set by {})",
                    joined(names, " and "), names.size() == 1 ? "s" : "",
                    name_of(turns ? opposite(side) : side), turns ? "-" : "", "xyz"[along],
                    along == 0   ? "axis"
                    : along == 1 ? "up"
                                 : "axis and up");
    // What bends goes by the longest side; what presses can do without.
    const bool stands =
        x == WorldAxis::y && stage.axis == WorldAxis::automatic && stage.up == WorldAxis::automatic;
    if (along == 1 && stands && names.size() == 1) {
        text += ", as the longest side is upright; axis = \"x\" or \"z\" brings it from y";
    }
    return text;
}

namespace {

// As if the work-piece came to it as it is now; where it cannot be set up so, its frame alone,
// unless there are loads. None: not even that.
std::optional<Machine> later_machine(const StageSpec& stage, const Aggregate& work_piece,
                                     const std::vector<Material>& beside, const Box& skin,
                                     double coarser) {
    try {
        return stage_machine(stage, work_piece, beside, skin, coarser);
    } catch (const Error&) {
    }
    if (!stage.machine.load.empty()) return std::nullopt;
    try {
        Machine machine;
        machine.frame = stage_frame(stage, work_piece, skin);
        return machine;
    } catch (const Error&) {
        return std::nullopt;
    }
}

// What is pressed or drawn may have another longest side by then, and that may be up.
std::string axis_note(const StageSpec& stage, const WorkFrame& frame) {
    const bool may_be_refused = stage.axis == WorldAxis::automatic &&
                                stage.up != WorldAxis::automatic && !stage.machine.upright;
    if (!may_be_refused) return {};
    return fmt::format(
        "its axis is the longest side, and is refused where the stages before make that lie along "
        "up = \"{}\"; axis = \"{}\" keeps it",
        name_of(stage.up), name_of(world_axes(frame)[0]));
}

}  // namespace

std::vector<MachinePlace> machine_places(const SceneSpec& scene, const Machine& first,
                                         const Aggregate& work_piece,
                                         const std::vector<Material>& beside, const Box& skin,
                                         double coarser) {
    std::vector<MachinePlace> places;
    for (const StageSpec& stage : scene.stage) {
        std::optional<Machine> later;
        if (!places.empty()) {
            later = later_machine(stage, work_piece, beside, skin, coarser);
        }
        const Machine* machine = places.empty() ? &first : later ? &*later : nullptr;
        MachinePlace& place = places.emplace_back();
        place.stage = stage.name;
        place.limit = limit_texts(stage.machine);
        place.limits_json = limits_json(stage.machine);
        if (machine == nullptr) continue;
        place.axes = axes_text(machine->frame);
        place.axes_json = axes_json(machine->frame);
        place.load = load_texts(*machine);
        place.loads_json = loads_json(*machine);
        place.push = push_texts(*machine);
        place.tools = tools_text(stage, machine->frame);
        place.note = machine->notes;
        if (later) {
            if (std::string amiss = axis_note(stage, machine->frame); !amiss.empty()) {
                place.note.push_back(std::move(amiss));
            }
        }
    }
    return places;
}

std::vector<std::string> later_notes(const std::vector<MachinePlace>& places) {
    std::vector<std::pair<std::string, std::vector<std::string>>> found;
    for (std::size_t s = 1; s < places.size(); ++s) {
        for (const std::string& note : places[s].note) {
            auto same = std::find_if(found.begin(), found.end(),
                                     [&](const auto& one) { return one.first == note; });
            if (same == found.end()) same = found.insert(same, {note, {}});
            same->second.push_back(places[s].stage);
        }
    }
    std::vector<std::string> told;
    for (const auto& [note, stages] : found) {
        told.push_back(fmt::format("{}: {} (for the work-piece before the first stage)",
                                   joined(stages, " and "), note));
    }
    return told;
}

Json places_json(const std::vector<MachinePlace>& places) {
    Json json = Json::array();
    for (const MachinePlace& place : places) {
        json.push_back({{"name", place.stage},
                        {"axes", place.axes_json},
                        {"tools", place.tools},
                        {"loads", place.loads_json},
                        {"notes", place.note},
                        {"limits", place.limits_json}});
    }
    return json;
}

}  // namespace swage

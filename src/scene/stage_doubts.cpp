// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/stage_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/expression.h"
#include "base/text_error.h"
#include "base/way_text.h"
#include "machines/load_name.h"

namespace swage {

namespace {

// A number that does not depend on anything, and is 0.
bool is_zero(const Expression& one) {
    if (one.empty()) return false;
    try {
        const Formula formula(one.text, {});
        return formula.evaluate({}) == 0;
    } catch (const TextError&) {
        return false;
    }
}

// What follows the stage's time alone, and is 0 whenever it is looked at.
bool is_zero_throughout(const Expression& one, double duration) {
    constexpr int kLooks = 4096;
    if (one.empty()) return false;
    try {
        const Formula formula(one.text, {"t", "duration"});
        for (int n = 0; n <= kLooks; ++n) {
            const double values[] = {double(n) / kLooks, duration};
            if (formula.evaluate(values) != 0) return false;
        }
        return true;
    } catch (const TextError&) {
        return false;
    }
}

void judge_gravity(const Node& node, const StageSpec& stage, MistakeList& mistakes) {
    const Entry* given = node.find("gravity_strength");
    if (given == nullptr || stage.sim.gravity == Vec3::Zero()) return;
    if (!is_zero_throughout(stage.machine.gravity_strength, stage.duration)) return;
    mistakes.warn(given->value.place, "gravity does nothing: its strength is 0 throughout");
}

void judge_loads(const Node& node, const StageSpec& stage, MistakeList& mistakes) {
    const Entry* given = node.find("load");
    const std::size_t loads = given != nullptr ? given->value.item.size() : 0;
    if (loads > stage.machine.load.size()) return;
    for (std::size_t n = 0; n < loads; ++n) {
        // Those of the machine's file come first.
        const LoadSpec& load = stage.machine.load[stage.machine.load.size() - loads + n];
        const bool is_none = load.force
                                 ? std::all_of(load.force->begin(), load.force->end(), is_zero)
                                 : is_zero(load.pressure);
        if (!is_none && !is_zero_throughout(load.strength, stage.duration)) continue;
        mistakes.warn(given->value.item[n].place,
                      fmt::format("{} does nothing: its {} is 0{}", load_name(load.name),
                                  !is_none     ? "strength"
                                  : load.force ? "force"
                                               : "pressure",
                                  is_none || is_zero(load.strength) ? "" : " throughout"));
    }
}

// Which way is down in a stage, where anything says so.
std::optional<Vec3> down_of(const StageSpec& stage) {
    if (stage.sim.gravity != Vec3::Zero()) return stage.sim.gravity.normalized();
    if (!stage.machine.upright) return std::nullopt;
    return -direction_of(stage.up == WorldAxis::automatic ? WorldAxis::y : stage.up);
}
// Bodies do not turn between machines, so they would fall to another side.
void judge_downs(const Node& root, const SceneSpec& scene, MistakeList& mistakes) {
    constexpr double kAlike = 0.7;  // cosine of just beyond 45 degrees: slopes are meant
    const StageSpec* first = nullptr;
    const Entry* stages = root.find("stage");
    for (std::size_t s = 0; s < scene.stage.size(); ++s) {
        const StageSpec& stage = scene.stage[s];
        const std::optional<Vec3> down = down_of(stage);
        if (!down) continue;
        if (first == nullptr) first = &stage;
        const Vec3 there = *down_of(*first);
        if (down->dot(there) > kAlike) continue;
        Place place = stage.place;
        if (stages != nullptr && s < stages->value.item.size()) {
            const Entry* up = stages->value.item[s].find("up");
            const Entry* gravity = stages->value.item[s].find("gravity");
            // One number goes by what is up.
            const bool has_way = gravity != nullptr && gravity->value.kind == Node::Kind::array;
            const Entry* says = up != nullptr && !has_way ? up : gravity;
            if (says != nullptr) place = says->value.place;
        }
        mistakes.warn(place,
                      fmt::format("down is {} in stage {}, but {} in stage {}: unless that "
                                  "is meant, give both the same up and gravity",
                                  way_text(*down), stage.name, way_text(there), first->name));
    }
}

}  // namespace

void warn_of_doubtful_stages(const Node& root, const SceneSpec& scene, MistakeList& mistakes) {
    const Entry* stages = root.find("stage");
    for (std::size_t s = 0; s < scene.stage.size(); ++s) {
        if (stages == nullptr || s >= stages->value.item.size()) break;
        const StageSpec& stage = scene.stage[s];
        judge_loads(stages->value.item[s], stage, mistakes);
        judge_gravity(stages->value.item[s], stage, mistakes);
    }
    judge_downs(root, scene, mistakes);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/step_note.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/folded_bodies.h"
#include "sim/advance.h"

namespace swage {

namespace {

constexpr double kFarShorter = 4;     // a step than a body needs
constexpr std::size_t kMostTold = 4;  // factors by which steps are shorter

// "gear 4 times; ball-1 to ball-9 21 times".
std::string longer_text(const std::vector<std::string>& name, const std::vector<double>& steps,
                        double most) {
    std::map<long, std::vector<std::size_t>> longer;
    std::size_t count = 0;
    for (std::size_t b = 0; b < steps.size(); ++b) {
        if (most < kFarShorter * steps[b]) continue;
        longer[std::lround(most / steps[b])].push_back(b);
        ++count;
    }
    if (longer.size() > kMostTold) {
        return fmt::format("{} bodies {} to {} times", count, longer.begin()->first,
                           longer.rbegin()->first);
    }
    std::string text;
    for (const auto& [times, bodies] : longer) {
        text += fmt::format("{}{} {} times", text.empty() ? "" : "; ", bodies_text(name, bodies),
                            times);
    }
    return text;
}

}  // namespace

std::string step_note(const SceneSpec& scene, const CountedMatter& counted) {
    for (const StageSpec& stage : scene.stage) {
        if (!follows_all_motion(stage.sim.solver)) continue;
        std::vector<double> steps;
        for (std::size_t b = 0; b < counted.matter.size(); ++b) {
            steps.push_back(counted.steps_per_second(b, stage));
        }
        const std::vector<std::string> name = body_names(scene);
        const auto most = std::max_element(steps.begin(), steps.end());
        const std::string others = longer_text(name, steps, *most);
        if (others.empty()) continue;
        return fmt::format(
            "all steps are as short as {} needs, others would allow longer ones: {}; larger cells "
            "there, or a lower young_modulus that is still stiff beside theirs, take less time",
            name[std::size_t(most - steps.begin())], others);
    }
    return {};
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/part_look.h"

#include <algorithm>

#include "base/error.h"
#include "base/suggest.h"
#include "base/text.h"
#include "machines/repeat.h"

namespace swage {

std::optional<SurfaceMaterial> look_of(const DrawnPart& part, const RenderSettings& settings) {
    if (!settings.tools || part.surface.triangle.empty()) return std::nullopt;
    if (part.finish == Finish::endless && !settings.ground) return std::nullopt;  // stands for that
    const auto is_meant = [&](const std::string& name) { return is_called(part.name, name); };
    if (std::ranges::any_of(settings.hide, is_meant)) return std::nullopt;
    SurfaceMaterial look;
    look.name = part.name;
    look.color = part.color;
    look.roughness = part.finish == Finish::metal ? 0.3 : 0.95;
    look.metallic = part.finish == Finish::metal ? 1 : 0;
    return look;
}

void refuse_unknown_parts(const FrameStore& store, const RenderSettings& settings) {
    if (settings.hide.empty()) return;
    std::vector<std::string> known;
    for (int m = 0; m < store.machine_count(); ++m) {
        for (const DrawnPart& part : store.machine(m)) {
            if (std::ranges::find(known, part.name) == known.end()) known.push_back(part.name);
        }
    }
    for (const std::string& name : settings.hide) {
        const auto is_meant = [&](const std::string& part) { return is_called(part, name); };
        if (std::ranges::any_of(known, is_meant)) continue;
        fail(ExitCode::command_line, "\"{}\" is no tool, grip or blade of any machine of the run{}",
             name,
             hint_and(did_you_mean(name, known),
                      known.empty() ? "there are none" : "there are " + joined(known, ", ")));
    }
}

}  // namespace swage

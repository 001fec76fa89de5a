// SPDX-License-Identifier: GPL-3.0-or-later
// What a run's motion is exported as, whatever the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/machine_tracks.h"
#include "pipeline/piece_track.h"
#include "render/settings.h"

namespace swage {

struct ExportScene {
    std::string name;               // of what holds all else
    std::vector<std::string> body;  // names; further bodies are called by their number
    RenderSettings render = {};     // of its stills
    std::vector<StageFrames> stage = {};
    std::vector<NamedPieces> piece = {};  // after the last stage
    bool tools = true;  // as far as its stills have them

    RenderSettings shown() const {
        RenderSettings settings = render;
        settings.tools = render.tools && tools;
        return settings;
    }
    std::string body_name(std::size_t number) const {
        return number < body.size() ? body[number] : "body-" + std::to_string(number + 1);
    }
};

struct ExportOutcome {
    std::size_t bodies = 0, tools = 0;  // tools: grips and blades too
    std::uintmax_t bytes = 0;
    double expected = 0;             // bytes, before it was written; where disk lacks, it is told
    std::vector<std::string> image;  // files beside it that it needs
};

// Only an earlier file gives way to another: Error(foreign) where `is_ours` of its first bytes says
// that it is something else's, Error(output) where it cannot be read.
void refuse_foreign(const std::filesystem::path& file,
                    const std::function<bool(std::string_view)>& is_ours);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mistake.h"

#include <utility>

#include "base/text.h"

namespace swage {

std::string mistake_text(const Mistake& mistake) {
    if (mistake.file.empty()) return mistake.text;
    std::string place = mistake.file.string();
    if (mistake.line > 0) place += fmt::format(":{}:{}", mistake.line, mistake.column);
    return place + (mistake.warning ? ": warning: " : ": ") + mistake.text;
}

namespace {

std::string lines_of(const std::vector<Mistake>& mistakes) {
    std::vector<std::string> lines;
    for (const Mistake& mistake : mistakes) lines.push_back(mistake_text(mistake));
    return joined(lines, "\n");
}

}  // namespace

SceneError::SceneError(std::vector<Mistake> mistakes)
    : Error(exit_code(mistakes), lines_of(mistakes)), mistakes_(std::move(mistakes)) {}

ExitCode exit_code(const std::vector<Mistake>& mistakes) {
    ExitCode code = ExitCode::done;
    for (const Mistake& mistake : mistakes) {
        if (mistake.warning) continue;
        if (code == ExitCode::done || mistake.code < code) code = mistake.code;
    }
    return code;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mistake.h"

#include <algorithm>

namespace swage {

std::string place_text(const std::filesystem::path& file, int line, int column) {
    return line > 0 ? fmt::format("{}:{}:{}", file.string(), line, column) : file.string();
}

std::string mistake_text(const Mistake& mistake) {
    return place_text(mistake.file, mistake.line, mistake.column) +
           (mistake.warning ? ": warning: " : ": ") + mistake.text;
}

ExitCode exit_code(const std::vector<Mistake>& mistakes) {
    ExitCode code = ExitCode::done;
    for (const Mistake& mistake : mistakes) {
        if (mistake.warning) continue;
        if (code == ExitCode::done || mistake.code < code) code = mistake.code;
    }
    return code;
}

}  // namespace swage

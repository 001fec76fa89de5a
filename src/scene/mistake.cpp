// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mistake.h"

#include <algorithm>

namespace swage {

std::string mistake_text(const Mistake& mistake) {
    std::string text = mistake.file.string();
    if (mistake.line > 0) text += fmt::format(":{}:{}", mistake.line, mistake.column);
    return text + (mistake.warning ? ": warning: " : ": ") + mistake.text;
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

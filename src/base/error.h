// SPDX-License-Identifier: GPL-3.0-or-later
// One way to fail: an Error carries the exit code of the process and one sentence for the user.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace swage {

enum class ExitCode {
    done = 0,
    command_line = 2,
    scene = 3,
    mesh = 4,
    output = 5,      // writing or drawing
    stopped = 6,     // the simulation gave up
    resources = 7,   // refused: would need more memory, disk or time than there is
    foreign = 8,     // the output directory belongs to another run
};

class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

template <typename... Args>
[[noreturn]] void fail(ExitCode code, fmt::format_string<Args...> text, Args&&... args) {
    throw Error(code, fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace swage

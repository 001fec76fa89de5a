// SPDX-License-Identifier: GPL-3.0-or-later
// Messages to the user, all on stderr. Data goes to stdout and never through here.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace swage {

enum class LogLevel { quiet, normal, verbose };

void set_log_level(LogLevel level);
LogLevel log_level();
bool stderr_is_terminal();
bool stderr_has_color();  // a terminal, and NO_COLOR is not set

// One whole line each, control characters in it shown as what they are; safe to call from any
// thread.
void log_text(const std::string& line);
void log_error_text(const std::string& line);
void log_warning_text(const std::string& line);
// Where stderr is a terminal: a last line that stays last, and changes; then a whole line again.
void log_bar(const std::string& line);
void end_bar();

template <typename... Args>
void log_info(fmt::format_string<Args...> text, Args&&... args) {
    if (log_level() != LogLevel::quiet) log_text(fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void log_verbose(fmt::format_string<Args...> text, Args&&... args) {
    if (log_level() == LogLevel::verbose) log_text(fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void log_warning(fmt::format_string<Args...> text, Args&&... args) {
    log_warning_text(fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace swage

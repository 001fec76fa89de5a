// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>

#include "base/text.h"

namespace swage {

namespace {

LogLevel level = LogLevel::normal;
std::mutex line_mutex;
bool bar_is_drawn = false;

// Callers hold line_mutex. `head` may hold what colours it.
void put_line(const std::string& line, const std::string& head = {}) {
    if (bar_is_drawn) std::fputs("\r\x1b[K", stderr);
    bar_is_drawn = false;
    std::fputs((head + printable(line) + "\n").c_str(), stderr);
}

}  // namespace

void set_log_level(LogLevel new_level) { level = new_level; }
LogLevel log_level() { return level; }
bool stderr_is_terminal() { return isatty(STDERR_FILENO) == 1; }
bool stderr_has_color() {
    const char* no_color = std::getenv("NO_COLOR");
    return stderr_is_terminal() && (no_color == nullptr || *no_color == '\0');
}

void log_text(const std::string& line) {
    const std::lock_guard lock(line_mutex);
    put_line(line);
}

void log_error_text(const std::string& line) {
    const std::lock_guard lock(line_mutex);
    put_line(line, stderr_has_color() ? "\x1b[31merror:\x1b[0m " : "error: ");
}

void log_warning_text(const std::string& line) {
    const std::lock_guard lock(line_mutex);
    put_line(line, stderr_has_color() ? "\x1b[33mwarning:\x1b[0m " : "warning: ");
}

void log_bar(const std::string& line) {
    const std::lock_guard lock(line_mutex);
    std::fputs(("\r\x1b[K" + printable(line)).c_str(), stderr);
    std::fflush(stderr);
    bar_is_drawn = true;
}

void end_bar() {
    const std::lock_guard lock(line_mutex);
    if (bar_is_drawn) std::fputs("\n", stderr);
    bar_is_drawn = false;
}

}  // namespace swage

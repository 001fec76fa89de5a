// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>

#include "base/text.h"
#include "base/whole.h"

namespace swage {

namespace {

LogLevel level = LogLevel::normal;
std::mutex line_mutex;
bool bar_is_drawn = false;

double now_seconds() {
    using clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

// Callers hold line_mutex. `head` may hold what colours it.
void put_line(const std::string& line, const std::string& head = {}) {
    if (bar_is_drawn) std::fputs("\r\x1b[K", stderr);
    bar_is_drawn = false;
    std::fputs((head + printable(line) + "\n").c_str(), stderr);
}

std::string duration_text(double seconds) {
    const int s = to_int(seconds + 0.5);
    if (s < 60) return fmt::format("{} s", s);
    return fmt::format("{}:{:02d}", s / 60, s % 60);
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

Progress::Progress(std::string title, int total, int before)
    : title_(std::move(title)),
      total_(std::max(1, total)),
      before_(before),
      started_(now_seconds()) {}

Progress::~Progress() {
    const std::lock_guard lock(line_mutex);
    if (bar_is_drawn) std::fputs("\n", stderr);
    bar_is_drawn = false;
}

void Progress::advance(int done, const std::string& note) {
    if (level == LogLevel::quiet) return;
    const double now = now_seconds();
    const double elapsed = now - started_;
    const double left = done > before_ ? elapsed / (done - before_) * (total_ - done) : 0;
    const std::lock_guard lock(line_mutex);
    if (stderr_is_terminal()) {
        if (done < total_ && now - last_shown_ < 0.1) return;
        last_shown_ = now;
        const int width = 30, filled = static_cast<int>(1.0 * width * done / total_);
        std::string bar(static_cast<std::size_t>(filled), '=');
        bar.resize(width, ' ');
        const std::string text = fmt::format("\r\x1b[K{} [{}] {}/{}  {} left  {}", title_, bar,
                                             done, total_, duration_text(left), printable(note));
        std::fputs(text.c_str(), stderr);
        std::fflush(stderr);
        bar_is_drawn = true;
        return;
    }
    const int tenth = static_cast<int>(10LL * done / total_);
    if (tenth == last_tenth_) return;
    last_tenth_ = tenth;
    put_line(
        fmt::format("{}: {}/{}, {} left  {}", title_, done, total_, duration_text(left), note));
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "base/log.h"
#include "base/whole.h"

namespace swage {

namespace {

constexpr double kLong = 20;  // s, that one piece of the work takes before it is told

double now_seconds() {
    using clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

// As a clock shows it: a bar has less room than seconds_text() takes.
std::string clock_text(double seconds) {
    const int s = to_int(seconds + 0.5);
    if (s < 60) return fmt::format("{} s", s);
    return fmt::format("{}:{:02d}", s / 60, s % 60);
}

}  // namespace

std::string time_left_text(int done, int left, double taken, double waited) {
    std::string text;
    if (done > 0) {
        // What is at work is not done sooner than now.
        const double each = taken / done, next = left > 0 ? std::max(each - waited, 0.0) : 0;
        text = clock_text(each * std::max(left - 1, 0) + next) + " left";
    }
    if (waited < kLong) return text.empty() ? "begun" : text;
    return fmt::format("{}{}the next has taken {} so far", text, text.empty() ? "" : ", ",
                       clock_text(waited));
}

Progress::Progress(std::string title, int total, int before)
    : title_(std::move(title)),
      total_(std::max(1, total)),
      before_(before),
      started_(now_seconds()),
      done_(before),
      advanced_(started_),
      shown_(started_) {
    if (log_level() == LogLevel::quiet) return;
    try {
        watch_ = std::jthread([this](const std::stop_token& ends) { watch(ends); });
    } catch (const std::system_error&) {
        // No thread is to be had; the work needs none.
    }
}

Progress::~Progress() {
    if (watch_.joinable()) {
        watch_.request_stop();
        watch_.join();
    }
    end_bar();
}

void Progress::advance(int done, const std::string& note) {
    if (log_level() == LogLevel::quiet) return;
    const double now = now_seconds();
    const std::lock_guard lock(mutex_);
    done_ = done;
    note_ = note;
    advanced_ = now;
    if (stderr_is_terminal()) {
        if (done == total_ || now - shown_ >= 0.1) draw_bar(now);
        return;
    }
    const int tenth = static_cast<int>(10LL * done / total_);
    if (tenth != std::exchange(tenth_, tenth)) log_text(title_ + ": " + line(now));
}

std::string Progress::line(double now) const {
    const std::string left =
        time_left_text(done_ - before_, total_ - done_, advanced_ - started_, now - advanced_);
    return fmt::format("{}/{}, {}  {}", done_, total_, left, note_);
}

void Progress::draw_bar(double now) {
    shown_ = now;
    constexpr int kWidth = 30;
    std::string bar(static_cast<std::size_t>(1.0 * kWidth * done_ / total_), '=');
    bar.resize(kWidth, ' ');
    log_bar(fmt::format("{} [{}] {}", title_, bar, line(now)));
}

void Progress::watch(const std::stop_token& ends) {
    std::unique_lock lock(mutex_);
    double since = advanced_, next = kLong;
    while (!ends.stop_requested()) {
        never_.wait_for(lock, ends, std::chrono::seconds(1), [] { return false; });
        if (ends.stop_requested() || done_ >= total_) continue;
        const double now = now_seconds(), waited = now - advanced_;
        if (since != advanced_) {
            since = advanced_;
            next = kLong;
        }
        if (stderr_is_terminal()) {
            draw_bar(now);
        } else if (waited >= next) {
            next = 2 * waited;
            log_text(title_ + ": " + line(now));
        }
    }
}

}  // namespace swage

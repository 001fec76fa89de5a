// SPDX-License-Identifier: GPL-3.0-or-later
// How far long work has come: a bar with the time left when stderr is a terminal, else a plain line
// at each tenth; and, either way, that one piece of it takes long.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace swage {

// Where `done` pieces have taken so long [s], and the next has taken `waited`.
std::string time_left_text(int done, int left, double taken, double waited);

class Progress {
  public:
    // `before`: done already, and not in the time that is taken now.
    Progress(std::string title, int total, int before = 0);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance(int done, const std::string& note = {});

  private:
    std::string line(double now) const;
    void draw_bar(double now);
    void watch(const std::stop_token& ends);

    const std::string title_;
    const int total_, before_;
    const double started_;
    std::mutex mutex_;  // of what follows
    std::string note_;
    int done_;
    double advanced_;
    double shown_;
    int tenth_ = -1;
    std::condition_variable_any never_;
    std::jthread watch_;
};

}  // namespace swage

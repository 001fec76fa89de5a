// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds spent by named phase, in the order the phases first ran.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace swage {

class Stopwatch {
  public:
    using Clock = std::chrono::steady_clock;

    // Adds the life of the returned object to the phase.
    class Lap {
      public:
        Lap(Stopwatch& watch, std::string phase)
            : watch_(watch), phase_(std::move(phase)), start_(Clock::now()) {}
        ~Lap() {
            watch_.add(phase_, std::chrono::duration<double>(Clock::now() - start_).count());
        }
        Lap(const Lap&) = delete;
        Lap& operator=(const Lap&) = delete;

      private:
        Stopwatch& watch_;
        std::string phase_;
        Clock::time_point start_;
    };

    Lap lap(std::string phase) { return Lap(*this, std::move(phase)); }
    void add(const std::string& phase, double seconds) {
        for (auto& [name, total] : phases_) {
            if (name == phase) {
                total += seconds;
                return;
            }
        }
        phases_.emplace_back(phase, seconds);
    }
    const std::vector<std::pair<std::string, double>>& phases() const { return phases_; }

  private:
    std::vector<std::pair<std::string, double>> phases_;
};

}  // namespace swage

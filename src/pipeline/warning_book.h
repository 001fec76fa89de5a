// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings that come back frame after frame are told once, with the frames they came in.
#pragma once

#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

namespace swage {

class WarningBook {
  public:
    void add(int frame, const std::string& sentence) {
        auto [at, is_new] = frames_.try_emplace(sentence);
        if (is_new) order_.push_back(sentence);
        // It may come in several legs of a frame.
        if (is_new || at->second.back() != frame) at->second.push_back(frame);
    }
    std::vector<std::string> told(const std::string& stage) const {
        std::vector<std::string> lines;
        for (const std::string& sentence : order_) {
            const std::vector<int>& frames = frames_.at(sentence);
            lines.push_back(frames.size() == 1
                                ? fmt::format("{}, frame {}: {}", stage, frames[0], sentence)
                                : fmt::format("{}, {} frames from {} on: {}", stage, frames.size(),
                                              frames[0], sentence));
        }
        return lines;
    }

    template <typename Io>
    void visit(Io& io) {
        io(frames_, order_);
    }

  private:
    std::map<std::string, std::vector<int>> frames_;
    std::vector<std::string> order_;
};

}  // namespace swage

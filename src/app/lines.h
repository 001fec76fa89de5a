// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>

namespace swage {

// "  cells        about 1,200 of 5 mm", one below the other under a title.
class Lines {
  public:
    explicit Lines(const std::string& title) : text_(title + "\n") {}
    void add(const std::string& name, const std::string& value) {
        text_ += fmt::format("  {:<12} {}\n", name, value);
    }
    void add(const std::string& whole) { text_ += "  " + whole + "\n"; }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// As much of USD's text as swage writes, read back: what each attribute of each prim is, by time.
#pragma once

#include <map>
#include <string>
#include <vector>

class Usda {
  public:
    // Throws where braces do not fit.
    explicit Usda(const std::string& text);
    // What a prim is ("Mesh"), empty where there is none.
    std::string kind(const std::string& path) const;
    bool has(const std::string& attribute) const { return value_.count(attribute) > 0; }
    // Times of samples; none of what is so all along.
    std::vector<int> times(const std::string& attribute) const;
    // As a reader has it at a time where there is a sample, or behind one.
    const std::string& text(const std::string& attribute, int time = 1) const;
    std::vector<float> numbers(const std::string& attribute, int time) const;

  private:
    static constexpr int kAlways = -1;
    std::map<std::string, std::string> kind_;
    std::map<std::string, std::map<int, std::string>> value_;
};

// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/usda.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace {

std::string joined(const std::vector<std::string>& path) {
    std::string all;
    for (const std::string& one : path) all += "/" + one;
    return all;
}

}  // namespace

Usda::Usda(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> path;
    std::string prim, attribute;  // `attribute`: whose samples these lines are
    int depth = 0;
    for (std::string raw; std::getline(in, raw);) {
        const std::string line = raw.substr(std::min(raw.find_first_not_of(' '), raw.size()));
        if (line.rfind("def ", 0) == 0) {
            const std::size_t quote = line.find('"') + 1;
            prim = line.substr(quote, line.find('"', quote) - quote);
            kind_[joined(path) + "/" + prim] = line.substr(4, quote - 6);
        } else if (line == "{") {
            path.push_back(prim);
        } else if (line == "}" && !attribute.empty()) {
            attribute.clear();
        } else if (line == "}" && depth > 0) {
            --depth;  // of a dictionary
        } else if (line == "}") {
            if (path.empty()) throw std::runtime_error("a brace too many");
            path.pop_back();
        } else if (const auto samples = line.find(".timeSamples = {");
                   samples != std::string::npos) {
            attribute =
                joined(path) + "." + line.substr(line.find(' ') + 1, samples - line.find(' ') - 1);
            if (value_.count(attribute) > 0) throw std::runtime_error("said twice");
        } else if (!attribute.empty()) {
            const int time = std::atoi(line.c_str());
            if (!value_[attribute].emplace(time, line.substr(line.find(": ") + 2)).second) {
                throw std::runtime_error("a time twice");
            }
        } else if (const auto is = line.find(" = "); is != std::string::npos) {
            if (line.back() == '{') ++depth;
            const std::size_t name = line.rfind(' ', is - 1) + 1;
            value_[joined(path) + "." + line.substr(name, is - name)][kAlways] =
                line.substr(is + 3);
        }
    }
    if (!path.empty()) throw std::runtime_error("a brace is open");
}

std::string Usda::kind(const std::string& path) const {
    const auto at = kind_.find(path);
    return at == kind_.end() ? std::string() : at->second;
}

std::vector<int> Usda::times(const std::string& attribute) const {
    std::vector<int> times;
    for (const auto& [time, text] : value_.at(attribute)) {
        if (time != kAlways) times.push_back(time);
    }
    return times;
}

const std::string& Usda::text(const std::string& attribute, int time) const {
    const auto& all = value_.at(attribute);
    auto after = all.upper_bound(time);
    if (after == all.begin()) throw std::runtime_error("no sample yet");
    return (--after)->second;
}

std::vector<float> Usda::numbers(const std::string& attribute, int time) const {
    std::vector<float> numbers;
    const std::string& all = text(attribute, time);
    for (const char* at = all.c_str(); *at != '\0';) {
        char* end = nullptr;
        const float number = std::strtof(at, &end);
        if (end != at) numbers.push_back(number);
        at = end != at ? end : at + 1;
    }
    return numbers;
}

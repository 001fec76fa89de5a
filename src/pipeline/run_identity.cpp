// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_identity.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/file_contents.h"
#include "base/text.h"
#include "pipeline/json.h"
#include "scene/file_text.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kLongestRecord = 64 << 20;  // some kB a stage
constexpr const char* kKeepsStages = "output.keep_stages";

const RunInput* find_role(const RunIdentity& identity, const std::string& role) {
    for (const RunInput& input : identity.input) {
        if (input.role == role) return &input;
    }
    return nullptr;
}

// The lines of one text that another has not, as they are to be told; no blanks, no remarks.
std::string lines_beside(const std::string& text, const std::string& other) {
    constexpr std::size_t kTold = 3;
    const auto said_in = [](const std::string& all) {
        std::vector<std::string> said;
        for (const std::string& line : lines_of(all)) {
            const std::size_t begin = line.find_first_not_of(" \t");
            if (begin == std::string::npos || line[begin] == '#') continue;
            said.push_back(line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin));
        }
        return said;
    };
    std::vector<std::string> there = said_in(other), beside;
    for (const std::string& line : said_in(text)) {
        const auto known = std::find(there.begin(), there.end(), line);
        if (known == there.end()) {
            beside.push_back(line);
        } else {
            there.erase(known);
        }
    }
    if (beside.empty()) return "nothing more";
    const std::size_t more = beside.size() - std::min(beside.size(), kTold);
    beside.resize(beside.size() - more);
    return joined(beside, ", ") + (more > 0 ? fmt::format(" and {} more", more) : "");
}

// Not a file, but what came of one.
bool is_as_read(const RunInput& input) { return input.role.starts_with("what the "); }

std::string difference(const RunInput& now, const RunInput& then) {
    const auto told = [](const RunInput& of) {
        return of.file.empty() ? std::string("none") : of.file.string();
    };
    if (now.file != then.file) {
        return fmt::format("{} differs ({} now, {} then)", now.role, told(now), told(then));
    }
    if (now.text.empty() || then.text.empty()) {
        return fmt::format("{} differs: the content of {} has changed", now.role, told(now));
    }
    return fmt::format("{} differs: the content of {} has changed (now {}; then {})", now.role,
                       told(now), lines_beside(now.text, then.text),
                       lines_beside(then.text, now.text));
}

// Which keys of the scene say something else. What changes nothing of the results does not count.
void add_said(const std::vector<Said>& there, const std::vector<Said>& here,
              std::vector<std::string>& found) {
    constexpr std::size_t kTold = 5;
    using Values = std::map<std::string, std::array<const Said*, 2>>;  // by key, then and now
    Values values;
    for (const Said& one : there) values[one.key][0] = &one;
    for (const Said& one : here) values[one.key][1] = &one;
    std::vector<std::string> other;
    for (const auto& [key, both] : values) {
        const auto [then, now] = both;
        if (key == kKeepsStages || (then && now && then->value == now->value)) continue;
        const auto shown = [](const Said* said) { return said ? said->shown : "not there"; };
        // What is long is cut off.
        other.push_back(shown(now) == shown(then)
                            ? fmt::format("{} differs", key)
                            : fmt::format("{} is {} now, {} then", key, shown(now), shown(then)));
    }
    const std::size_t more = other.size() - std::min(other.size(), kTold);
    other.resize(other.size() - more);
    found.insert(found.end(), other.begin(), other.end());
    if (more > 0) found.push_back(fmt::format("and {} more", counted(more, "key", "keys")));
}

}  // namespace

bool keeps_stages(const RunIdentity& identity) {
    return std::none_of(identity.said.begin(), identity.said.end(), [](const Said& one) {
        return one.key == kKeepsStages && one.value == "false";
    });
}

bool is_said(const RunInput& input) { return input.role == "scene" || input.role == "--set"; }

std::string identity_text(const RunIdentity& identity) {
    Json json;
    json["program"] = "swage";
    json["version"] = identity.version;
    json["build"] = identity.build;
    for (const RunInput& input : identity.input) {
        Json one = {{"role", input.role}, {"file", input.file.string()}, {"hash", input.hash}};
        if (!input.text.empty()) one["text"] = input.text;
        json["inputs"].push_back(std::move(one));
    }
    for (const Said& one : identity.said) {
        json["scene"].push_back({one.key, one.value, one.shown});
    }
    json["stage_keys"] = identity.stage_key;
    return json_text(json);
}

RunIdentity read_identity(const fs::path& file) {
    RunIdentity identity;
    try {
        const Json json = parse_json(record_text(file, ExitCode::foreign));
        identity.version = json.at("version").get<std::string>();
        identity.build = json.value("build", "unknown");
        for (const Json& input : json.at("inputs")) {
            identity.input.push_back(
                {input.at("role").get<std::string>(), input.at("file").get<std::string>(),
                 input.at("hash").get<std::string>(), input.value("text", "")});
        }
        for (const Json& one : json.value("scene", Json::array())) {
            identity.said.push_back({one.at(0).get<std::string>(), one.at(1).get<std::string>(),
                                     one.at(2).get<std::string>()});
        }
        identity.stage_key = json.value("stage_keys", std::vector<std::string>());
    } catch (const Json::exception&) {
        fail(ExitCode::foreign,
             "{}: is damaged, so its run cannot be identified; remove it with "
             "its directory, or choose another --out",
             file.string());
    }
    return identity;
}

std::vector<std::string> differences(const RunIdentity& there, const RunIdentity& here) {
    std::vector<std::string> found;
    if (there.version != here.version) {
        found.push_back(fmt::format("swage {} made it, this is {}", there.version, here.version));
    } else if (there.build != here.build) {
        found.push_back(fmt::format("another build of swage {} made it ({}, this is {})",
                                    there.version, there.build, here.build));
    }
    if (!there.said.empty()) add_said(there.said, here.said, found);  // an older build said nothing
    for (const RunInput& input : here.input) {
        // What a file was read as differs by what else does, and is told where nothing is.
        if (is_said(input) || (is_as_read(input) && !found.empty())) continue;
        const RunInput* old = find_role(there, input.role);
        if (old == nullptr) {
            found.push_back(fmt::format("{} ({}) is new", input.role, input.file.string()));
        } else if (old->hash != input.hash) {
            found.push_back(difference(input, *old));
        }
    }
    for (const RunInput& input : there.input) {
        if (!is_said(input) && find_role(here, input.role) == nullptr) {
            found.push_back(
                fmt::format("{} ({}) is not read any more", input.role, input.file.string()));
        }
    }
    return found;
}

std::string record_text(const fs::path& file, ExitCode code) {
    std::optional<std::string> text = file_contents(file, kLongestRecord);
    if (!text) {
        fail(code, "{}: {}; swage run --fresh throws that run away", file.string(),
             why_unreadable(file).value_or("is too long to be from swage"));
    }
    return std::move(*text);
}

}  // namespace swage

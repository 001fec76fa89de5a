// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/overrides.h"

#include <algorithm>
#include <charconv>

#include "base/suggest.h"
#include "base/text.h"
#include "geometry/text_scan.h"
#include "scene/read_body.h"
#include "scene/read_load.h"
#include "scene/read_stage.h"

namespace swage {

namespace {

std::vector<std::string> parts_of(const std::string& path) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find('.', begin), path.size());
        parts.emplace_back(trimmed(std::string_view(path).substr(begin, end - begin)));
        begin = end + 1;
    }
    return parts;
}

std::string text_under(const Node& table, std::string_view key) {
    const Entry* entry = table.find(key);
    return entry != nullptr && entry->value.kind == Node::Kind::text ? entry->value.text : "";
}

// What messages call the n-th table of an array where it has no name; empty: nothing.
std::string usual_name(const std::string& of, std::size_t n, const std::string& machine) {
    if (of == "body") return usual_body_name(n + 2);  // after the work-piece
    if (of == "stage") return usual_stage_name(n + 1, machine);
    return of == "load" ? usual_load_name(n + 1) : "";
}

// Of `count` tables; `names`: what those are called that are called anything.
std::string which_there_are(std::size_t count, const std::vector<std::string>& names) {
    constexpr std::size_t kMostNames = 8;
    const std::string there = fmt::format("there {} {}: ", count == 1 ? "is" : "are", count);
    if (names.size() == 1 && count == 1) return there + names.front();
    if (names.empty()) return there + fmt::format("1 to {}, or * for all", count);
    return fmt::format("{}{} (1 to {} in the file's order; * for all)", there,
                       names.size() <= kMostNames
                           ? joined(names, ", ")
                           : fmt::format("{} to {}", names.front(), names.back()),
                       count);
}

// The tables of an array that `which` means.
std::vector<Node*> chosen(Node& array, const std::string& of, const std::string& which,
                          const Place& place, MistakeList& mistakes) {
    std::vector<Node*> found;
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(which.data(), which.data() + which.size(), number);
    const bool is_number = error == std::errc() && end == which.data() + which.size();
    std::vector<std::string> names, known;
    for (std::size_t n = 0; n < array.item.size(); ++n) {
        Node& item = array.item[n];
        if (item.kind != Node::Kind::table) continue;
        const std::string machine = text_under(item, "machine");
        std::string name = text_under(item, "name");
        if (name.empty()) name = usual_name(of, n, machine);
        const bool is_meant =
            is_number ? number == n + 1
                      : which == "*" || (!which.empty() && (which == name || which == machine));
        if (is_meant) found.push_back(&item);
        if (!name.empty()) names.push_back(name);
        for (const std::string& one : {name, machine}) {
            if (!one.empty()) known.push_back(one);
        }
    }
    if (found.empty()) {
        mistakes.add(place, fmt::format("there is no {} \"{}\"{}", of, which,
                                        hint_and(did_you_mean(which, known),
                                                 which_there_are(array.item.size(), names))));
    }
    return found;
}

bool is_choice(const std::string& part) {
    return part == "*" || part.find_first_not_of("0123456789") == std::string::npos;
}

// The tables under `key`; one that is absent is made, unless `next` chooses from several.
std::vector<Node*> descended(Node& table, const std::string& key, const std::string& next,
                             const Place& place, MistakeList& mistakes) {
    Entry* entry = table.find(key);
    if (entry == nullptr && is_choice(next)) {
        mistakes.add(place, fmt::format("there is no {} to override", key));
        return {};
    }
    if (entry == nullptr) {
        Node made;
        made.place = place;
        table.entry.push_back({key, place, std::move(made)});
        entry = &table.entry.back();
    }
    return {&entry->value};
}

// SECTION.KEY in its parts; empty where it is none, which is told.
std::vector<std::string> key_parts(const std::string& key, const Place& place,
                                   MistakeList& mistakes) {
    std::vector<std::string> parts = parts_of(key);
    const bool is_whole = std::none_of(parts.begin(), parts.end(),
                                       [](const std::string& part) { return part.empty(); });
    if (is_whole && parts.size() >= 2) return parts;
    mistakes.add(
        place,
        "write the key of an override as SECTION.KEY, such as material.name or stage.1.angle");
    return {};
}

// What the key's last part is to be set in; none where something else stands there, which is told.
std::vector<Node*> sections_of(const std::vector<std::string>& parts, Node& root,
                               const Place& place, MistakeList& mistakes) {
    std::vector<Node*> here = {&root};
    for (std::size_t n = 0; n + 1 < parts.size(); ++n) {
        std::vector<Node*> below;
        for (Node* node : here) {
            const std::vector<Node*> found =
                node->kind == Node::Kind::array
                    ? chosen(*node, parts[n - 1], parts[n], place, mistakes)
                    : descended(*node, parts[n], parts[n + 1], place, mistakes);
            below.insert(below.end(), found.begin(), found.end());
        }
        here = std::move(below);
        for (const Node* node : here) {
            if (node->kind == Node::Kind::table || node->kind == Node::Kind::array) continue;
            mistakes.add(place,
                         fmt::format("\"{}\" is {} and has no keys", parts[n], kind_text(*node)));
            return {};
        }
    }
    return here;
}

std::string which_text(const std::string& of, const std::string& last) {
    if (is_choice(last)) return fmt::format("which key of it? Write {}.{}.KEY", of, last);
    return fmt::format("which {0}? Write {0}.1.{1}, or {0}.*.{1} for all", of, last);
}

void apply(const std::string& text, Node& root, MistakeList& mistakes) {
    const auto source = std::make_shared<const Source>(Source{"--set " + text, text});
    const Place place{source, 0, 0};
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
        mistakes.add(place,
                     "write an override as KEY=VALUE, such as stage.1.angle=45 deg; one with "
                     "blanks needs quotes in a shell: --set 'KEY=VALUE'");
        return;
    }
    const std::vector<std::string> parts = key_parts(text.substr(0, equals), place, mistakes);
    if (parts.empty()) return;
    const std::string& last = parts.back();
    const Node value = parse_value(trimmed(std::string_view(text).substr(equals + 1)), place);
    for (Node* node : sections_of(parts, root, place, mistakes)) {
        if (node->kind == Node::Kind::array) {
            mistakes.add(place, which_text(parts[parts.size() - 2], last));
            return;
        }
        if (Entry* entry = node->find(last)) {
            entry->value = value;
            entry->place = place;
        } else {
            node->entry.push_back({last, place, value});
        }
    }
}

}  // namespace

void apply_overrides(const std::vector<std::string>& overrides, Node& root, MistakeList& mistakes) {
    for (const std::string& text : overrides) apply(text, root, mistakes);
}

}  // namespace swage

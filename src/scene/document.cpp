// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/document.h"

#include <toml++/toml.h>

#include <algorithm>

#include "base/hash.h"
#include "base/text.h"
#include "scene/file_text.h"
#include "scene/syntax.h"

namespace swage {

namespace {

constexpr std::uint64_t kLargestFile = std::uint64_t{64} << 20;
constexpr int kSyntaxMistakes = 20;  // after so many, reading is given up

Place place_of(const toml::source_region& region, const std::shared_ptr<const Source>& source) {
    return {source, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

bool stands_before(const Entry& a, const Entry& b) {
    return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
}

Node converted(const toml::node& from, const std::shared_ptr<const Source>& source) {
    Node node;
    node.place = place_of(from.source(), source);
    if (const toml::table* table = from.as_table()) {
        for (auto&& [key, value] : *table) {
            node.entry.push_back(
                {std::string(key.str()), place_of(key.source(), source), converted(value, source)});
        }
        std::stable_sort(node.entry.begin(), node.entry.end(), stands_before);
    } else if (const toml::array* array = from.as_array()) {
        node.kind = Node::Kind::array;
        for (const toml::node& item : *array) node.item.push_back(converted(item, source));
    } else if (const auto text = from.value_exact<std::string>()) {
        node.kind = Node::Kind::text;
        node.text = *text;
    } else if (const auto whole = from.value_exact<std::int64_t>()) {
        node.kind = Node::Kind::whole;
        node.number = static_cast<double>(*whole);
    } else if (const auto real = from.value_exact<double>()) {
        node.kind = Node::Kind::real;
        node.number = *real + 0.0;
    } else if (const auto truth = from.value_exact<bool>()) {
        node.kind = Node::Kind::truth;
        node.truth = *truth;
    } else {
        node.kind = Node::Kind::date;
    }
    return node;
}

void blank_line(std::string& text, int line) {
    const std::string_view found = line_of(text, line);
    const std::size_t begin = static_cast<std::size_t>(found.data() - text.data());
    std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(begin), found.size(), ' ');
}

void set_place(Node& node, const Place& place) {
    node.place = place;
    for (Entry& entry : node.entry) {
        entry.place = place;
        set_place(entry.value, place);
    }
    for (Node& item : node.item) set_place(item, place);
}

std::optional<Document> parsed(std::string text, const std::filesystem::path& shown,
                               MistakeList& mistakes) {
    Document document;
    document.source = std::make_shared<const Source>(Source{shown, text});
    for (int count = 0;; ++count) {
        if (const auto at = too_deep_key(text)) {
            mistakes.add({document.source, at->first, at->second},
                         fmt::format("a key of more than {} parts", kMostKeyParts));
            return std::nullopt;
        }
        try {
            const toml::table table = toml::parse(std::string_view(text));
            document.root = converted(table, document.source);
            return document;
        } catch (const toml::parse_error& error) {
            const SyntaxMistake broken{static_cast<int>(error.source().begin.line),
                                       static_cast<int>(error.source().begin.column),
                                       std::string(error.description())};
            SyntaxAdvice advice = explain_syntax(text, broken);
            mistakes.add({document.source, broken.line, advice.column}, advice.text);
            document.is_complete = false;
            if (!advice.can_go_on || count >= kSyntaxMistakes) return std::nullopt;
            blank_line(text, broken.line);
        }
    }
}

// A value for comparison; no longer than a hash where it is long.
std::string value_of(const Node& node, const std::map<const Node*, double>& number) {
    using Kind = Node::Kind;
    constexpr std::size_t kLong = 200;
    const auto known = number.find(&node);
    if (known != number.end()) return fmt::format("{:a}", known->second);
    switch (node.kind) {
        case Kind::truth:
            return node.truth ? "true" : "false";
        case Kind::whole:
        case Kind::real:
            return fmt::format("{:a}", node.number);
        case Kind::array: {
            std::string all;
            for (const Node& one : node.item) all += value_of(one, number) + ",";
            return all.size() > kLong ? hash_text(hash_of(all)) : "[" + all + "]";
        }
        case Kind::table: {
            std::string all;
            for (const Entry& one : node.entry) all += one.key + "=" + value_of(one.value, number);
            return "{" + all + "}";
        }
        default:
            return node.text.size() > kLong ? hash_text(hash_of(node.text))
                                            : fmt::format("{}:{}", node.text.size(), node.text);
    }
}

std::string shown_value(const Node& node) {
    using Kind = Node::Kind;
    constexpr std::size_t kShown = 60;
    std::string text = node.text;
    if (node.kind == Kind::truth) text = node.truth ? "true" : "false";
    if (node.kind == Kind::whole || node.kind == Kind::real) text = fmt::format("{}", node.number);
    if (node.kind == Kind::array) {
        for (const Node& one : node.item) {
            if (text.size() > kShown) break;
            text += (text.empty() ? "[" : ", ") + shown_value(one);
        }
        text += text.empty() ? "[]" : "]";
    }
    if (text.size() <= kShown) return text;
    std::size_t end = kShown;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    return text.substr(0, end) + "...";
}

void add_said(const Node& node, const std::string& key, const std::map<const Node*, double>& number,
              std::vector<Said>& all) {
    const auto below = [&](const std::string& name) {
        return key.empty() ? name : key + "." + name;
    };
    if (node.kind == Node::Kind::table) {
        for (const Entry& one : node.entry) add_said(one.value, below(one.key), number, all);
        return;
    }
    const bool holds_tables = std::any_of(node.item.begin(), node.item.end(), [](const Node& item) {
        return item.kind == Node::Kind::table;
    });
    if (!holds_tables) {
        all.push_back({key, value_of(node, number), shown_value(node)});
        return;
    }
    for (std::size_t n = 0; n < node.item.size(); ++n) {
        const std::string one = below(std::to_string(n + 1));
        if (node.item[n].entry.empty()) all.push_back({one, "{}", "{}"});
        add_said(node.item[n], one, number, all);
    }
}

}  // namespace

const Entry* Node::find(std::string_view key) const {
    for (const Entry& one : entry) {
        if (one.key == key) return &one;
    }
    return nullptr;
}

Entry* Node::find(std::string_view key) {
    return const_cast<Entry*>(static_cast<const Node*>(this)->find(key));
}

TextPlace text_place(const Place& place) {
    return {place.source == nullptr ? std::filesystem::path() : place.source->file, place.line,
            place.column};
}

Mistake mistake_at(const TextPlace& place, const std::string& text, ExitCode code) {
    return {place.file, place.line, place.column, text, false, code};
}

Mistake mistake_at(const Place& place, const std::string& text, ExitCode code) {
    return mistake_at(text_place(place), text, code);
}

Place place_inside(const Node& node, std::size_t at) {
    Place place = node.place;
    if (place.line == 0 || place.source == nullptr) return place;
    std::string_view line = line_of(place.source->text, place.line);
    const auto is_middle = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
    for (int column = 1; column < place.column && !line.empty(); ++column) {
        do line.remove_prefix(1);
        while (!line.empty() && is_middle(line[0]));
    }
    if (line.empty() || (line[0] != '"' && line[0] != '\'')) return place;
    if (line.compare(1, node.text.size(), node.text) != 0) return place;
    const std::string_view before = std::string_view(node.text).substr(0, at);
    const auto middles = std::count_if(before.begin(), before.end(), is_middle);
    place.column += 1 + static_cast<int>(before.size()) - static_cast<int>(middles);
    return place;
}

std::vector<Said> said_in(const Node& root, const std::map<const Node*, double>& number) {
    std::vector<Said> all;
    add_said(root, "", number, all);
    std::sort(all.begin(), all.end(), [](const Said& a, const Said& b) { return a.key < b.key; });
    return all;
}

std::string kind_text(const Node& node) {
    switch (node.kind) {
        case Node::Kind::table:
            return "a table";
        case Node::Kind::array:
            return "an array";
        case Node::Kind::text:
            return "text";
        case Node::Kind::whole:
            return "a whole number";
        case Node::Kind::real:
            return "a number";
        case Node::Kind::truth:
            return "true or false";
        case Node::Kind::date:
            return "a date";
    }
    return "";
}

void MistakeList::put(Mistake mistake) {
    mistake.text = printable(mistake.text);  // it may quote the file
    if (!mistake.warning) ++errors_;
    if (is_full()) {
        ++left_out_;
    } else {
        found_.push_back(std::move(mistake));
    }
}

void MistakeList::add(const Place& place, const std::string& text, ExitCode code) {
    put(mistake_at(place, text, code));
}

void MistakeList::warn(const Place& place, const std::string& text) {
    Mistake warning = mistake_at(place, text, ExitCode::scene);
    warning.warning = true;
    put(std::move(warning));
}

void MistakeList::add(std::vector<Mistake> mistakes) {
    for (Mistake& mistake : mistakes) put(std::move(mistake));
}

std::vector<Mistake> MistakeList::take(const std::filesystem::path& first) {
    std::vector<std::filesystem::path> order = {first};
    for (const Mistake& one : found_) {
        if (std::find(order.begin(), order.end(), one.file) == order.end()) {
            order.push_back(one.file);
        }
    }
    const auto rank = [&](const Mistake& one) {
        return std::tuple(std::find(order.begin(), order.end(), one.file), one.line, one.column);
    };
    std::stable_sort(found_.begin(), found_.end(),
                     [&](const Mistake& a, const Mistake& b) { return rank(a) < rank(b); });
    if (left_out_ > 0) {
        found_.push_back({found_.front().file, 0, 0, fmt::format("and {} more", left_out_),
                          errors_ == 0, ExitCode::scene});
    }
    return std::move(found_);
}

std::optional<Document> read_document(const std::filesystem::path& file,
                                      const std::filesystem::path& shown, MistakeList& mistakes) {
    const auto nameless = std::make_shared<const Source>(Source{shown, ""});
    std::optional<std::string> text = read_text(file, {nameless, 0, 0}, kLargestFile, mistakes);
    if (!text) return std::nullopt;
    return parsed(std::move(*text), shown, mistakes);
}

std::optional<Document> read_piped_document(const std::filesystem::path& shown,
                                            MistakeList& mistakes) {
    const auto nameless = std::make_shared<const Source>(Source{shown, ""});
    std::optional<std::string> text = read_standard_input({nameless, 0, 0}, kLargestFile, mistakes);
    if (!text) return std::nullopt;
    return parsed(std::move(*text), shown, mistakes);
}

Node parse_value(std::string_view text, const Place& place) {
    Node node;
    node.kind = Node::Kind::text;
    node.text = std::string(text);
    if (too_deep_key(text)) {
        set_place(node, place);
        return node;
    }
    try {
        const toml::table table = toml::parse("value = " + std::string(text));
        if (table.size() == 1) node = converted(*table.get("value"), place.source);
    } catch (const toml::parse_error&) {
        // "45 deg" is no TOML: it is the text itself
    }
    set_place(node, place);
    return node;
}

std::filesystem::path shown_path(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::path here = std::filesystem::current_path(error);
    if (error) return file;
    const std::filesystem::path relative = file.lexically_relative(here);
    const bool is_below = !relative.empty() && *relative.begin() != "..";
    return is_below ? relative : file;
}

}  // namespace swage

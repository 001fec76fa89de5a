// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/syntax.h"

#include <algorithm>
#include <optional>

#include "base/ascii.h"
#include "base/suggest.h"
#include "base/units.h"
#include "geometry/text_scan.h"

namespace swage {

namespace {

bool is_key_letter(char c) { return goes_on_name(c) || c == '-' || c == '.'; }

struct KeyLine {  // KEY = VALUE
    std::string key;
    std::string value;  // without a comment
    int key_column, value_column;
};

std::optional<KeyLine> as_key_line(std::string_view line) {
    std::size_t at = line.find_first_not_of(" \t");
    if (at == std::string_view::npos) return std::nullopt;
    const std::size_t begin = at;
    while (at < line.size() && is_key_letter(line[at])) ++at;
    const std::size_t end = at;
    while (at < line.size() && (line[at] == ' ' || line[at] == '\t')) ++at;
    if (end == begin || at >= line.size() || line[at] != '=') return std::nullopt;
    std::string_view value = line.substr(at + 1);
    if (value.find('"') == std::string_view::npos && value.find('\'') == std::string_view::npos) {
        value = value.substr(0, value.find('#'));
    }
    const std::string_view inner = trimmed(value);
    const std::size_t column =
        inner.empty() ? at + 1 : static_cast<std::size_t>(inner.data() - line.data());
    return KeyLine{std::string(line.substr(begin, end - begin)), std::string(inner),
                   static_cast<int>(begin) + 1, static_cast<int>(column) + 1};
}

// The first line of the same section that gives the same key, before `line`; or the first with
// the same header. 0: none was found.
int first_giver(std::string_view file_text, int line, const std::optional<KeyLine>& key) {
    const std::string_view header = trimmed(line_of(file_text, line));
    int found = 0, number = 1;
    for (std::size_t begin = 0; number < line && begin < file_text.size(); ++number) {
        const std::size_t end = std::min(file_text.find('\n', begin), file_text.size());
        const std::string_view text = trimmed(file_text.substr(begin, end - begin));
        begin = end + 1;
        if (key) {
            if (!text.empty() && text.front() == '[') {
                found = 0;  // another section
            } else if (const auto earlier = as_key_line(text);
                       found == 0 && earlier && earlier->key == key->key) {
                found = number;
            }
        } else if (found == 0 && text == header) {
            found = number;
        }
    }
    return found;
}

// What is wrong with a value that begins like a number; empty: nothing that is known here.
std::string number_advice(const KeyLine& line) {
    const std::string& value = line.value;
    const std::size_t sign = value[0] == '-' || value[0] == '+' ? 1 : 0;
    try {
        const auto number = leading_number(value);
        if (!number) return {};
        const std::string_view rest = trimmed(std::string_view(value).substr(number->size));
        if (rest.size() > 1 && rest[0] == ',' && rest[1] >= '0' && rest[1] <= '9') {
            std::string meant = value;
            std::replace(meant.begin(), meant.end(), ',', '.');
            return fmt::format("{} has a decimal comma; write {}", value, meant);
        }
        const auto unit = leading_unit(rest);
        if (unit && unit->size == rest.size()) {
            return fmt::format("a value with a unit needs quotes: {} = \"{}\"", line.key, value);
        }
        if (!rest.empty()) return fmt::format("{} is not a number", value);
        if (value[sign] == '0' && value.size() > sign + 1 && value[sign + 1] != '.') {
            return fmt::format("a number cannot begin with 0: write {}", number->value);
        }
        if (value[sign] == '.') return fmt::format("write {}", number->value);
        if (value.back() == '.') return fmt::format("a digit is missing after the decimal point");
    } catch (const TextError& error) {
        return error.what();
    }
    return {};
}

std::string value_advice(const KeyLine& line) {
    const std::string& value = line.value;
    if (value.empty()) return fmt::format("{} has no value", line.key);
    const char first = value[0];
    if (is_digit(first) || first == '.' || first == '-' || first == '+') {
        return number_advice(line);
    }
    if (first == '"' || first == '\'') {
        const bool is_open = value.find(first, 1) == std::string::npos;
        return is_open ? "the closing quote is missing" : "";
    }
    if (is_letter(first)) {
        for (const char* word : {"true", "yes", "on"}) {
            if (edit_distance(value, word) == 0) return "write true";
        }
        for (const char* word : {"false", "no", "off"}) {
            if (edit_distance(value, word) == 0) return "write false";
        }
        const bool is_plain = std::all_of(value.begin(), value.end(), [](char c) {
            return is_key_letter(c) || c == ' ' || c == '/';
        });
        if (is_plain) return fmt::format("text needs quotes: {} = \"{}\"", line.key, value);
    }
    return {};
}

std::string plain(std::string text) {
    const std::size_t colon = text.find(": ");
    if (text.rfind("Error while parsing", 0) == 0 && colon != std::string::npos) {
        text = text.substr(colon + 2);
    }
    std::string shown;
    for (char c : text) {
        if (c == '\n') {
            shown += "the end of the line";
        } else {
            shown += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return "cannot be parsed: " + shown;
}

}  // namespace

std::optional<std::pair<int, int>> too_deep_key(std::string_view file_text) {
    int line = 1, column = 1, dots = 0, key_column = 1;
    bool in_key = false;
    std::string_view quote;  // what ends the text that is being passed over
    for (std::size_t at = 0; at < file_text.size(); ++at) {
        const char c = file_text[at];
        const std::string_view rest = file_text.substr(at);
        std::size_t taken = 1;
        if (c == '\n') {
            ++line;
            column = 0;
            dots = 0;
            in_key = false;
            if (quote.size() == 1) quote = {};
        } else if (!quote.empty()) {
            if (c == '\\' && quote[0] == '"') {
                taken = rest.size() > 1 && rest[1] != '\n' ? 2 : 1;
            } else if (rest.starts_with(quote)) {
                taken = quote.size();
                // Two more may belong to the text itself.
                while (quote.size() == 3 && taken < 5 && taken < rest.size() &&
                       rest[taken] == quote[0])
                    ++taken;
                quote = {};
            }
        } else if (c == '#') {
            taken = std::min(rest.find('\n'), rest.size());
        } else {
            const bool is_quote = c == '"' || c == '\'';
            if (is_quote) {
                quote =
                    rest.substr(0, rest.starts_with("\"\"\"") || rest.starts_with("'''") ? 3 : 1);
                taken = quote.size();
            }
            const bool goes_on = is_quote || is_key_letter(c) || c == ' ' || c == '\t' ||
                                 static_cast<unsigned char>(c) >= 0x80;
            if (!goes_on) {
                dots = 0;
                in_key = false;
            } else if (!in_key && c != ' ' && c != '\t') {
                in_key = true;
                key_column = column;
            }
            if (c == '.' && ++dots >= kMostKeyParts) return std::pair(line, key_column);
        }
        for (std::size_t n = 0; n < taken; ++n)
            column += (static_cast<unsigned char>(rest[n]) & 0xC0) != 0x80;
        at += taken - 1;
    }
    return std::nullopt;
}

std::string_view line_of(std::string_view file_text, int line) {
    std::size_t begin = 0;
    for (int number = 1; number < line; ++number) {
        begin = file_text.find('\n', begin);
        if (begin == std::string_view::npos) return {};
        ++begin;
    }
    return file_text.substr(begin, file_text.find('\n', begin) - begin);
}

SyntaxAdvice explain_syntax(std::string_view file_text, const SyntaxMistake& mistake) {
    const std::string_view line = line_of(file_text, mistake.line);
    const std::optional<KeyLine> key = as_key_line(line);
    const std::string_view bare = trimmed(line);
    if (mistake.description.find("cannot redefine") != std::string::npos) {
        const bool is_header = !bare.empty() && bare.front() == '[';
        const int first = first_giver(file_text, mistake.line, key);
        if (key || is_header) {
            const std::string what = is_header ? std::string(bare) : "\"" + key->key + "\"";
            return {key ? key->key_column : mistake.column,
                    first > 0 ? fmt::format("{} is given twice, first on line {}", what, first)
                              : fmt::format("{} is given twice, or in two ways", what),
                    key.has_value()};
        }
    }
    if (key) {
        const std::string advice = value_advice(*key);
        // An array or a table in braces may go on over lines, and so may what is wrong with it.
        const char first = key->value.empty() ? ' ' : key->value[0];
        const bool is_alone = first != '[' && first != '{' && key->value.find("\"\"\"") != 0 &&
                              key->value.find("'''") != 0;
        if (!advice.empty()) return {key->value_column, advice, is_alone};
        return {mistake.column, plain(mistake.description), is_alone};
    }
    return {mistake.column, plain(mistake.description), false};
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_text.h"

#include <fmt/compile.h>

#include "base/ascii.h"
#include "base/text.h"

namespace swage {

std::string usd_identifier(std::string_view name, std::set<std::string>& taken) {
    std::string plain;
    for (const char c : name) {
        const bool goes_on = (static_cast<unsigned char>(c) & 0xc0) == 0x80;  // a letter of UTF-8
        if (!goes_on) plain.push_back(goes_on_name(c) ? c : '_');
    }
    if (plain.empty() || is_digit(plain[0])) plain.insert(0, 1, '_');
    std::string unique = plain;
    for (int n = 2; !taken.insert(unique).second; ++n) unique = fmt::format("{}_{}", plain, n);
    return unique;
}

std::string usd_string(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted.push_back('\\');
        if (static_cast<unsigned char>(c) >= ' ' && c != '\x7f') quoted.push_back(c);
    }
    return quoted + "\"";
}

std::string usd_asset(std::string_view path) {
    if (path.find('@') == std::string_view::npos) return fmt::format("@{}@", path);
    constexpr std::string_view kQuote = "@@@";
    std::string quoted(kQuote);
    while (!path.empty()) {
        const bool is_quote = path.starts_with(kQuote);
        const std::string_view next = path.substr(0, is_quote ? kQuote.size() : 1);
        if (is_quote) quoted.push_back('\\');
        quoted.append(next);
        path.remove_prefix(next.size());
    }
    return quoted.append(kQuote);
}

std::string usd_prim(std::string_view kind, const std::string& name, const std::string& identifier,
                     std::string_view about) {
    std::string more;
    if (identifier != name) {
        more += fmt::format("    customData = {{\n        string name = {}\n    }}\n",
                            usd_string(name));
    }
    if (!about.empty()) more += fmt::format("    {}\n", about);
    const std::string head = fmt::format("def {} \"{}\"", kind, identifier);
    return more.empty() ? head : head + " (\n" + more + ")";
}

void UsdText::line(std::string_view text) {
    for (const std::string& one : lines_of(std::string(text))) {
        if (!one.empty()) indent();
        put(one);
        put("\n");
    }
}

void UsdText::open(std::string_view head) {
    if (!bytes_.ends_with("{\n")) put("\n");
    line(head);
    line("{");
    ++depth_;
}

void UsdText::close() {
    --depth_;
    line("}");
}

void UsdText::finish() {
    flush();
    file_.finish();
}

void UsdText::number(int value) {
    const fmt::format_int digits(value);
    bytes_.append(digits.data(), digits.size());
}

void UsdText::number(float value) {
    fmt::format_to(std::back_inserter(bytes_), FMT_COMPILE("{}"), value + 0.0f);  // no "-0"
}

void UsdText::place(const Vec3& exact) {
    const Vec3 p = exact.array() + 0.0;
    put(fmt::format("({}, {}, {})", p.x(), p.y(), p.z()));
}

void UsdText::flush() {
    file_.put(bytes_);
    bytes_.clear();
}

}  // namespace swage

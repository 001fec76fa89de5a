// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace swage {

// NOTE: fmt::join over strings makes GCC 12 warn of what is not there.
std::string joined(const std::vector<std::string>& items, const char* separator) {
    std::string text;
    for (const std::string& item : items) {
        if (&item != &items.front()) text += separator;
        text += item;
    }
    return text;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

std::string counted(std::size_t count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string printable(std::string_view text) {
    std::string shown;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
        const bool is_low =
            (byte(at) < 0x20 && text[at] != '\n' && text[at] != '\t') || byte(at) == 0x7f;
        // U+0080 to U+009F: of these, too, some begin a command to the terminal.
        const bool is_high =
            byte(at) == 0xc2 && at + 1 < text.size() && byte(at + 1) >= 0x80 && byte(at + 1) < 0xa0;
        if (is_low) {
            shown += fmt::format("\\x{:02x}", byte(at));
        } else if (is_high) {
            shown += fmt::format("\\x{:02x}", byte(++at));
        } else {
            shown += text[at];
        }
    }
    return shown;
}

std::string count_text(double count) {
    std::string digits = fmt::format("{:.0f}", count);
    for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) {
        digits.insert(static_cast<std::size_t>(at), 1, ',');
    }
    return digits;
}

std::string bytes_text(double bytes) {
    const char* units[] = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB"};
    int unit = 0;
    while (bytes >= 1024 && unit < 5) {
        bytes /= 1024;
        ++unit;
    }
    return fmt::format("{:.{}f} {}", bytes, unit == 0 || bytes >= 100 ? 0 : 1, units[unit]);
}

std::string seconds_text(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    // Rounded before it is parted: 119.7 s are 2 min 0 s, not 1 min 60 s.
    const double whole = std::round(seconds);
    if (whole < 60) return fmt::format("{:.0f} s", whole);
    const double minutes = std::floor(whole / 60);
    if (minutes < 60) return fmt::format("{:.0f} min {:.0f} s", minutes, whole - 60 * minutes);
    const double all_minutes = std::round(seconds / 60), hours = std::floor(all_minutes / 60);
    return fmt::format("{} h {:.0f} min", count_text(hours), all_minutes - 60 * hours);
}

}  // namespace swage

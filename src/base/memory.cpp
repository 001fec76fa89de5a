// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// The number that comes first in a file, or next after a word; `otherwise`: there is none.
double number_in(const fs::path& file, double otherwise, const std::string& word = {}) {
    std::ifstream in(file);
    for (std::string read; read != word && in >> read;) {
    }
    double value = 0;
    return in >> value ? value : otherwise;
}

struct GroupRoom {
    double whole = kUnlimited, free = kUnlimited;
};

// What one version calls the same. Its `kept` files are let go of where memory is asked for.
struct GroupFiles {
    const char *limit, *taken, *kept[3];
};
constexpr GroupFiles kFirst = {"memory.limit_in_bytes",
                               "memory.usage_in_bytes",
                               {"total_inactive_file", "total_active_file", nullptr}};
constexpr GroupFiles kSecond = {
    "memory.max", "memory.current", {"inactive_file", "active_file", "slab_reclaimable"}};

// Of a group and all that it is in, up to `top`. A container may show itself as the top, under
// names that are of the machine outside.
void narrow(GroupRoom& room, const fs::path& top, const fs::path& group, const GroupFiles& files) {
    for (fs::path at = group.lexically_normal().relative_path();; at = at.parent_path()) {
        const fs::path folder = top / at;
        const double limit = number_in(folder / files.limit, kUnlimited);
        double taken = number_in(folder / files.taken, 0);
        for (const char* kept : files.kept) {
            if (kept != nullptr) taken -= number_in(folder / "memory.stat", 0, kept);
        }
        room.whole = std::min(room.whole, limit);
        room.free = std::min(room.free, limit - std::max(0.0, taken));
        if (at.empty()) break;
    }
}

// The lines of /proc/self/cgroup: number, controllers, group; "0::/group" in version 2.
GroupRoom group_room(const fs::path& root) {
    GroupRoom room;
    const fs::path mounted = root / "sys/fs/cgroup";
    std::ifstream in(root / "proc/self/cgroup");
    for (std::string line; std::getline(in, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers =
            fmt::format(",{},", line.substr(first + 1, second - first - 1));
        const std::string group = line.substr(second + 1);
        if (controllers == ",,") narrow(room, mounted, group, kSecond);
        if (controllers.find(",memory,") != std::string::npos) {
            narrow(room, mounted / "memory", group, kFirst);
        }
    }
    return room;
}

}  // namespace

double whole_memory(const fs::path& root) {
    const double machine = 1024 * number_in(root / "proc/meminfo", kUnlimited, "MemTotal:");
    return std::min(machine, group_room(root).whole);
}

double free_memory(const fs::path& root) {
    const double machine = 1024 * number_in(root / "proc/meminfo", kUnlimited, "MemAvailable:");
    return std::max(0.0, std::min(machine, group_room(root).free));
}

std::uint64_t address_space_in_use() {
    const double pages = number_in("/proc/self/statm", 0);
    return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace swage

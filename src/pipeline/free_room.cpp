// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/free_room.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/text.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// The number that comes first in a file, or next after a word; `otherwise`: there is none.
double number_in(const fs::path& file, double otherwise, const std::string& word = {}) {
    std::ifstream in(file);
    for (std::string read; read != word && in >> read;) {
    }
    double value = 0;
    return in >> value ? value : otherwise;
}

}  // namespace

double free_memory() {
    constexpr double kUnlimited = std::numeric_limits<double>::infinity();
    double bytes = 1024 * number_in("/proc/meminfo", kUnlimited, "MemAvailable:");
    // Of a group of processes; what it keeps of files it lets go of where that is asked for.
    const fs::path group = "/sys/fs/cgroup";
    double taken = number_in(group / "memory.current", 0);
    for (const char* kept : {"inactive_file", "active_file", "slab_reclaimable"}) {
        taken -= number_in(group / "memory.stat", 0, kept);
    }
    bytes = std::min(bytes, number_in(group / "memory.max", kUnlimited) - std::max(0.0, taken));
    return std::max(0.0, bytes);
}

double free_addresses() {
    rlimit limit = {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
        return std::numeric_limits<double>::infinity();
    }
    const double page = static_cast<double>(::sysconf(_SC_PAGESIZE));
    const double taken = page * number_in("/proc/self/statm", 0);
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - taken);
}

double free_disk(fs::path folder) {
    std::error_code error;
    while (!folder.empty() && !fs::exists(folder, error) && folder != folder.parent_path()) {
        folder = folder.parent_path();
    }
    const fs::space_info space = fs::space(folder.empty() ? "." : folder, error);
    return error ? std::numeric_limits<double>::infinity() : static_cast<double>(space.available);
}

void refuse_threads(int count) {
    const double wanted = kThreadAddresses * count, left = free_addresses();
    if (wanted <= left) return;
    fail(
        ExitCode::resources,
        "{} threads need about {} of addresses, and the limit on them (ulimit -v) leaves {}: fewer "
        "--threads need less",
        count, bytes_text(wanted), bytes_text(left));
}

}  // namespace swage

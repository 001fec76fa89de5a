// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/free_room.h"

#include <sys/resource.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/text.h"

namespace swage {

namespace fs = std::filesystem;

double free_addresses() {
    rlimit limit = {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
        return std::numeric_limits<double>::infinity();
    }
    return std::max(
        0.0, static_cast<double>(limit.rlim_cur) - static_cast<double>(address_space_in_use()));
}

double free_disk(fs::path folder) {
    std::error_code error;
    while (!folder.empty() && !fs::exists(folder, error) && folder != folder.parent_path()) {
        folder = folder.parent_path();
    }
    const fs::space_info space = fs::space(folder.empty() ? "." : folder, error);
    // What is no disk (/proc, /sys) has no room that could be told: writing says why it cannot.
    return error || space.capacity == 0 ? std::numeric_limits<double>::infinity()
                                        : static_cast<double>(space.available);
}

void give_back_memory() {
#if defined(__GLIBC__)
    ::malloc_trim(0);
#endif
}

void refuse_threads(int count) {
    const double wanted = kThreadAddresses * count, left = free_addresses();
    if (wanted <= left) return;
    fail(ExitCode::resources, "{} about {} of address space, and its limit (ulimit -v) leaves {}{}",
         count == 1 ? "a thread needs" : fmt::format("{} threads need", count), bytes_text(wanted),
         bytes_text(left), count == 1 ? "" : ": fewer --threads need less");
}

}  // namespace swage

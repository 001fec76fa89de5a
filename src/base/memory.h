// SPDX-License-Identifier: GPL-3.0-or-later
// Memory of the machine and of the groups of processes (Linux cgroups, version 1 and 2) that this
// one belongs to, whose limits may be lower [byte]; infinite where nobody says.
#pragma once

#include <cstdint>
#include <filesystem>

namespace swage {

// `root`: where /proc and /sys are looked for.
double whole_memory(const std::filesystem::path& root = "/");  // that the process can ever have
double free_memory(const std::filesystem::path& root = "/");   // that may still be allocated

std::uint64_t address_space_in_use();

}  // namespace swage

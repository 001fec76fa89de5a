// SPDX-License-Identifier: GPL-3.0-or-later
// What the machine, and limits on the process, leave it [byte].
#pragma once

#include <filesystem>

#include "base/memory.h"  // free_memory

namespace swage {

inline constexpr double kThreadAddresses = 32e6;  // of each thread, which count where limited

double free_addresses();                         // infinite without a limit
double free_disk(std::filesystem::path folder);  // which need not be there yet

// To the machine, what this process holds and does not use. NOTE: else what a simulation took stays
// beside what its pictures take.
void give_back_memory();

// Throws Error(resources) where so many threads find no room. NOTE: what starts a thread in vain
// ends the process in places where nobody can say so.
void refuse_threads(int count);

}  // namespace swage

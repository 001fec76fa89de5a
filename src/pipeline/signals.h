// SPDX-License-Identifier: GPL-3.0-or-later
// SIGINT, SIGTERM, SIGHUP, SIGUSR1 and SIGXCPU: the first asks the run to end at its next safe
// point (base/interrupt.h), a second SIGINT or SIGTERM ends the process at once. What does not come
// to a safe point in time is ended by a watching thread, which first removes unfinished files; it
// waits on while finished frames would go with them.
#pragma once

#include <filesystem>

#include "base/interrupt.h"

namespace swage {

// Once, at the start of the process.
void watch_for_interrupts();

// The directory whose unfinished files of this process the watcher removes (with its
// sub-folders); empty: none.
void set_unfinished_work(const std::filesystem::path& directory);

// Whether frames are finished that stand in an unfinished file yet.
void set_frames_at_stake(bool are_at_stake);

// Ends the process from any thread, without waiting for others and without its unfinished files.
[[noreturn]] void leave_at_once(int code);

}  // namespace swage

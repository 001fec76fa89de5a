// SPDX-License-Identifier: GPL-3.0-or-later
// SIGINT and SIGTERM: the first asks the run to end after the file at hand, the second ends the
// process at once. A run that does not come to a safe point in time is ended by a watching thread,
// which first removes unfinished files.
#pragma once

#include <exception>
#include <filesystem>

namespace swage {

// Thrown at a safe point after a signal; the process then exits with 128 + signal.
class Interrupted : public std::exception {
  public:
    explicit Interrupted(int signal) : signal_(signal) {}
    int signal() const { return signal_; }
    const char* what() const noexcept override { return "interrupted"; }

  private:
    int signal_;
};

// Once, at the start of the process.
void watch_for_interrupts();

// A safe point: throws Interrupted when a signal has come.
void throw_if_interrupted();

// The directory whose unfinished files of this process the watcher removes (with its
// sub-folders); empty: none.
void set_unfinished_work(const std::filesystem::path& directory);

// Removes temporaries left in a directory tree by processes that wrote files whole; `pid` 0: by
// any.
void remove_temporaries(const std::filesystem::path& directory, long pid);

}  // namespace swage

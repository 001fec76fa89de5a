// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs, found at run time and fed through a pipe: an argument list, never a shell line.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_handle.h"

namespace swage {

// Whether `name` is an executable file in PATH (or, when it has a slash, that file).
bool program_exists(const std::string& name);

// To be called before a child is started. Whoever ignores the end of children hands that on to what
// it starts, and nobody can then wait for a child of it.
void expect_children();
// Waits for a child of this process and gives what waitpid() says of it; nothing, and errno, where
// nobody can know how it ended.
std::optional<int> wait_for(pid_t child);
// False where it still runs after so many seconds, or once somebody asks this process to end. It is
// still to be waited for.
bool ends_within(pid_t child, double seconds);
// First thing in a forked child that starts no program: it ends with its parent, and leaves no
// image of its memory where it crashes.
void become_child(pid_t parent);

// To be called where the process ends without its destructors, also by a signal's handler.
void kill_programs();

// A running program whose standard input we write. Its standard output is thrown away, its
// standard error kept. It stands in a process group of its own, so that an interrupt from the
// terminal reaches only us and we decide how it ends.
class PipedProgram {
  public:
    static constexpr double kPatience = 120;  // [s]

    // argument[0] is looked up in PATH. Throws Error(output) when it cannot be started. `patience`:
    // how long it may take nothing of what is written [s].
    explicit PipedProgram(const std::vector<std::string>& argument, double patience = kPatience);
    // Kills the program when finish() was not called.
    ~PipedProgram();
    PipedProgram(const PipedProgram&) = delete;
    PipedProgram& operator=(const PipedProgram&) = delete;

    // False when the program has stopped listening, or was killed as it took nothing for too long;
    // no signal is raised.
    bool write(const void* bytes, std::size_t size);
    bool write(std::string_view text) { return write(text.data(), text.size()); }

    bool has_taken_nothing() const { return has_taken_nothing_; }

    // Ends the input, waits, and gives the exit status: 128 + n when ended by signal n, -1 when
    // that is not known.
    int finish();
    // But kills it after so many seconds, or once somebody asks this process to end.
    int finish_within(double seconds);

    // The last lines that the program wrote to standard error; the last non-empty one of them.
    std::string error_tail() const;
    std::string last_error_line() const;

  private:
    int status_of_end();
    bool takes_more() const;

    pid_t process_ = -1;
    double patience_;
    bool has_taken_nothing_ = false;
    FileHandle input_;   // our end of the pipe
    FileHandle errors_;  // a file in memory, so that a talkative program never blocks
};

}  // namespace swage

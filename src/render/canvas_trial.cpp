// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/canvas_trial.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/file_contents.h"
#include "base/file_handle.h"
#include "base/interrupt.h"
#include "base/process.h"
#include "render/canvas.h"
#include "render/targets.h"

namespace swage {

namespace {

constexpr std::size_t kLongestReason = 4096;  // which a pipe holds
constexpr int kPatience = 60;                 // [s]; a window opens in one or two

[[noreturn]] void try_here(const RenderSettings& settings, int threads, int to_parent,
                           pid_t parent) {
    become_child(parent);
    try {
        Canvas canvas(settings.gl, threads);
        canvas.make_current();
        try_targets(canvas.gl(), settings);
    } catch (const std::exception& error) {
        const std::size_t size = std::min(std::strlen(error.what()), kLongestReason);
        [[maybe_unused]] const ssize_t written = ::write(to_parent, error.what(), size);
    }
    ::_exit(0);
}

}  // namespace

void try_canvas(const RenderSettings& settings, int threads) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return;  // then it is tried where it is wanted
    const FileHandle from_child(ends[0]);
    FileHandle to_parent(ends[1]);
    expect_children();
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) return;
    if (child == 0) try_here(settings, threads, to_parent.id(), parent);
    to_parent.close();
    const bool hangs = !ends_within(child, kPatience);
    if (hangs) ::kill(child, SIGKILL);
    const std::optional<int> ended = wait_for(child);
    std::string reason(kLongestReason, '\0');
    reason.resize(read_up_to(from_child.id(), reason.data(), reason.size()).value_or(0));
    if (!reason.empty()) fail(ExitCode::output, "{}", reason);
    throw_if_interrupted();
    if (hangs) {
        fail(ExitCode::output,
             "OpenGL did not open within {} s: does GALLIUM_DRIVER, or another variable that "
             "drivers read, name what waits for a server? --no-render does without it",
             kPatience);
    }
    if (ended && *ended != 0) {
        fail(ExitCode::output,
             "OpenGL {} when it was opened: does GALLIUM_DRIVER, or another variable that drivers "
             "read, name a missing driver? --no-render works without it",
             WIFSIGNALED(*ended) ? fmt::format("crashed ({})", ::strsignal(WTERMSIG(*ended)))
                                 : fmt::format("ended its process ({})", WEXITSTATUS(*ended)));
    }
}

}  // namespace swage

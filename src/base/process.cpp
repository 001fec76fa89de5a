// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "base/error.h"
#include "base/interrupt.h"

extern char** environ;

namespace swage {

namespace {

bool is_executable_file(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
           ::access(path.c_str(), X_OK) == 0;
}

// Programs that are running.
std::array<std::atomic<pid_t>, 16> running{};

void exchange_running(pid_t from, pid_t to) {
    for (std::atomic<pid_t>& one : running) {
        if (pid_t expected = from; one.compare_exchange_strong(expected, to)) return;
    }
}

// Writing to a pipe that nobody reads raises SIGPIPE, whose default ends us. It is held back for
// this thread during the write and taken off the queue, so the program's own handling stays.
class PipeSignalGuard {
  public:
    PipeSignalGuard() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        sigset_t pending;
        sigpending(&pending);
        was_pending_ = sigismember(&pending, SIGPIPE) == 1;
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~PipeSignalGuard() {
        const timespec at_once{0, 0};
        if (!was_pending_) {
            while (sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
            }
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    PipeSignalGuard(const PipeSignalGuard&) = delete;
    PipeSignalGuard& operator=(const PipeSignalGuard&) = delete;

  private:
    sigset_t pipe_, before_;
    bool was_pending_;
};

}  // namespace

bool program_exists(const std::string& name) {
    if (name.empty()) return false;
    if (name.find('/') != std::string::npos) return is_executable_file(name);
    const char* path = std::getenv("PATH");
    const std::string folders = path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin";
    for (std::size_t begin = 0; begin <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', begin), folders.size());
        const std::string folder = folders.substr(begin, end - begin);
        if (is_executable_file((folder.empty() ? "." : folder) + "/" + name)) return true;
        begin = end + 1;
    }
    return false;
}

void expect_children() {
    struct sigaction now {};
    if (::sigaction(SIGCHLD, nullptr, &now) != 0) return;
    if (now.sa_handler != SIG_IGN && (now.sa_flags & SA_NOCLDWAIT) == 0) return;
    ::signal(SIGCHLD, SIG_DFL);
}

std::optional<int> wait_for(pid_t child) {
    int status = 0;
    pid_t ended = -1;
    do {
        ended = ::waitpid(child, &status, 0);
    } while (ended < 0 && errno == EINTR);
    return ended == child ? std::optional(status) : std::nullopt;
}

bool ends_within(pid_t child, double seconds) {
    constexpr int kLooksPerSecond = 200;
    for (double looks = seconds * kLooksPerSecond;; --looks) {
        siginfo_t ended{};
        const int failed = ::waitid(P_PID, id_t(child), &ended, WEXITED | WNOHANG | WNOWAIT);
        if ((failed != 0 && errno != EINTR) || ended.si_pid == child) return true;
        if (looks <= 0 || asked_to_stop() != 0) return false;
        const timespec pause{0, 1'000'000'000 / kLooksPerSecond};
        ::nanosleep(&pause, nullptr);
    }
}

void become_child(pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);  // it was too late for that
    const rlimit none = {0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
}

PipedProgram::PipedProgram(const std::vector<std::string>& argument, double patience)
    : patience_(patience) {
    if (argument.empty()) fail(ExitCode::output, "there is no program to start");
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
        fail(ExitCode::output, "cannot make a pipe to {}: {}", argument[0], std::strerror(errno));
    }
    const FileHandle to_program(ends[0]);
    input_ = FileHandle(ends[1]);
    ::fcntl(input_.id(), F_SETFL, O_NONBLOCK);  // of our end alone
    errors_ = FileHandle(::memfd_create("errors", MFD_CLOEXEC));

    posix_spawn_file_actions_t action;
    posix_spawn_file_actions_init(&action);
    posix_spawn_file_actions_adddup2(&action, to_program.id(), STDIN_FILENO);
    posix_spawn_file_actions_addopen(&action, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (errors_.is_open()) {
        posix_spawn_file_actions_adddup2(&action, errors_.id(), STDERR_FILENO);
    } else {
        posix_spawn_file_actions_addopen(&action, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    }
    posix_spawnattr_t attribute;
    posix_spawnattr_init(&attribute);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attribute, &none);
    posix_spawnattr_setsigdefault(&attribute, &all);
    posix_spawnattr_setpgroup(&attribute, 0);
    posix_spawnattr_setflags(
        &attribute, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);

    std::vector<char*> argv;
    for (const std::string& a : argument) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    expect_children();
    const int error = posix_spawnp(&process_, argv[0], &action, &attribute, argv.data(), environ);
    posix_spawn_file_actions_destroy(&action);
    posix_spawnattr_destroy(&attribute);
    if (error != 0) {
        process_ = -1;
        fail(ExitCode::output, "cannot start {}: {}", argument[0], std::strerror(error));
    }
    exchange_running(0, process_);
}

PipedProgram::~PipedProgram() {
    if (process_ > 0) ::kill(-process_, SIGKILL);
    finish();
}

void kill_programs() {
    for (const std::atomic<pid_t>& one : running) {
        if (const pid_t process = one; process > 0) ::kill(-process, SIGKILL);
    }
}

bool PipedProgram::write(const void* bytes, std::size_t size) {
    if (!input_.is_open()) return false;
    const PipeSignalGuard guard;
    const char* from = static_cast<const char*>(bytes);
    while (size > 0) {
        const ssize_t written = ::write(input_.id(), from, size);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0 && errno == EAGAIN) {
            if (takes_more()) continue;
            has_taken_nothing_ = true;
            ::kill(-process_, SIGKILL);
        }
        if (written < 0) {
            input_.close();
            return false;
        }
        from += written;
        size -= static_cast<std::size_t>(written);
    }
    return true;
}

// Waits until it does; false where that takes too long.
bool PipedProgram::takes_more() const {
    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::chrono::duration<double>(patience_);
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
        if (left.count() <= 0) return false;
        pollfd wait = {input_.id(), POLLOUT, 0};
        const int ready =
            ::poll(&wait, 1, static_cast<int>(std::min<long long>(left.count(), 1000)));
        if (ready > 0 || (ready < 0 && errno != EINTR)) return true;  // or the write says why not
    }
}

int PipedProgram::finish() {
    input_.close();
    return status_of_end();
}

int PipedProgram::finish_within(double seconds) {
    input_.close();
    if (process_ > 0 && !ends_within(process_, seconds)) ::kill(-process_, SIGKILL);
    return status_of_end();
}

int PipedProgram::status_of_end() {
    if (process_ <= 0) return -1;
    // Forgotten before it is gone: its number may be another's then, which nobody is to kill.
    siginfo_t ended{};
    while (::waitid(P_PID, id_t(process_), &ended, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
    }
    exchange_running(process_, 0);
    const std::optional<int> status = wait_for(process_);
    process_ = -1;
    if (!status) return -1;
    return WIFSIGNALED(*status) ? 128 + WTERMSIG(*status) : WEXITSTATUS(*status);
}

std::string PipedProgram::error_tail() const {
    constexpr off_t kKept = 4096;
    struct stat status {};
    if (!errors_.is_open() || ::fstat(errors_.id(), &status) != 0) return {};
    const off_t from = std::max<off_t>(0, status.st_size - kKept);
    std::string text(static_cast<std::size_t>(status.st_size - from), '\0');
    const ssize_t got = ::pread(errors_.id(), text.data(), text.size(), from);
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return text;
}

std::string PipedProgram::last_error_line() const {
    const std::string text = error_tail();
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    if (end == std::string::npos) return {};
    const std::size_t before = text.find_last_of("\r\n", end);
    return text.substr(before == std::string::npos ? 0 : before + 1,
                       end - (before == std::string::npos ? 0 : before + 1) + 1);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/signals.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <mutex>
#include <thread>

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/process.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr int kPatienceMilliseconds = 1500;   // until a safe point
constexpr int kFarewellMilliseconds = 30000;  // from there, to write what is finished
constexpr long kOneAsking = 250;              // ms, in which whoever asks asks once

int wake_pipe[2] = {-1, -1};
pid_t owner = 0;
std::mutex unfinished_mutex;
fs::path unfinished;
std::atomic<bool> frames_at_stake = false;
std::atomic<long> first_asked = 0;  // [ms]
static_assert(std::atomic<long>::is_always_lock_free, "a signal handler writes it");

long milliseconds_now() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000 + now.tv_nsec / 1'000'000;
}

extern "C" void take_signal(int signal) {
    // A forked child has no watching thread.
    if (::getpid() != owner) ::_exit(128 + signal);
    // Two threads may each take one.
    const long now = milliseconds_now();
    long first = 0;
    if (!first_asked.compare_exchange_strong(first, now)) {
        // Shell and kernel both send the one, and the system the others again and again; `timeout`
        // sends its signal to the process and to its group.
        const bool insists = signal == SIGINT || signal == SIGTERM;
        if (!insists || now - first < kOneAsking) return;
    }
    ask_to_stop(signal);
    const int error = errno;  // of what was interrupted, which is yet to look at it
    const char byte = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake_pipe[1], &byte, 1);
    errno = error;
}

// Whether one came in time.
bool wait_for_signal(int timeout_milliseconds) {
    pollfd wait{wake_pipe[0], POLLIN, 0};
    while (::poll(&wait, 1, timeout_milliseconds) < 0) {
    }
    char byte;
    if (wait.revents != 0) {
        [[maybe_unused]] const ssize_t got = ::read(wake_pipe[0], &byte, 1);
    }
    return wait.revents != 0;
}

void watch() {
    wait_for_signal(-1);
    log_text("stopping after the current work; interrupt again to stop at once");
    bool again = wait_for_signal(kPatienceMilliseconds);
    // One body's skin, cut or molding may take long and has no safe point inside.
    while (!again && !is_stopping() && frames_at_stake) {
        again = wait_for_signal(kPatienceMilliseconds);
    }
    if (!again && is_stopping()) wait_for_signal(kFarewellMilliseconds);
    leave_at_once(128 + asked_to_stop());
}

}  // namespace

void watch_for_interrupts() {
    if (::pipe2(wake_pipe, O_CLOEXEC | O_NONBLOCK) != 0) return;
    owner = ::getpid();
    std::thread(watch).detach();
    struct sigaction action = {};
    action.sa_handler = take_signal;
    action.sa_flags = SA_RESTART;
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
    // A terminal that closes, which nohup ignores; what batch systems send some time before they
    // end a job.
    for (const int signal : {SIGHUP, SIGUSR1, SIGXCPU}) {
        struct sigaction before = {};
        if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {
            ::sigaction(signal, &action, nullptr);
        }
    }
    // A closed pipe and a file as large as it may be are write errors like any other.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

void set_unfinished_work(const fs::path& directory) {
    const std::lock_guard lock(unfinished_mutex);
    unfinished = directory;
}

void leave_at_once(int code) {
    {
        const std::lock_guard lock(unfinished_mutex);
        if (!unfinished.empty()) remove_temporaries(unfinished, ::getpid());
    }
    kill_programs();
    ::_exit(code);
}

void set_frames_at_stake(bool are_at_stake) { frames_at_stake = are_at_stake; }

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/interrupt.h"

#include <atomic>

namespace swage {

namespace {

std::atomic<int> first_signal = 0;
std::atomic<bool> stopping = false;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler writes it");

}  // namespace

void ask_to_stop(int signal) {
    int none = 0;
    first_signal.compare_exchange_strong(none, signal);
}

int asked_to_stop() { return first_signal.load(std::memory_order_relaxed); }

void throw_if_interrupted() {
    if (const int signal = asked_to_stop(); signal != 0) {
        stopping = true;
        throw Interrupted(signal);
    }
}

bool is_stopping() { return stopping; }

}  // namespace swage

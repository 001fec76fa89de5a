// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace swage {

namespace {
int configured_threads = 0;
std::unique_ptr<tbb::global_control> limit;

// Of 2, 4, 8 ... threads, up to all: each that looks in vain for work costs those that have it.
using Arenas = std::vector<std::unique_ptr<tbb::task_arena>>;
Arenas make_arenas() {
    Arenas made;
    for (int size = 2; size < 2 * thread_count(); size *= 2) {
        made.push_back(std::make_unique<tbb::task_arena>(std::min(size, thread_count())));
    }
    return made;
}
Arenas arena = make_arenas();

[[maybe_unused]] tbb::task_arena& arena_for(std::size_t threads) {
    std::size_t n = 0;
    while (n + 1 < arena.size() && (std::size_t{2} << n) < threads) ++n;
    return *arena[n];
}

[[maybe_unused]] bool is_in_arena() {
    return tbb::this_task_arena::current_thread_index() != tbb::task_arena::not_initialized;
}
}  // namespace

void set_thread_count(int count) {
    configured_threads = std::max(0, count);
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(thread_count()));
    arena = make_arenas();
}

int thread_count() {
    if (configured_threads > 0) return configured_threads;
    return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    parallel_for(count, count, body);
}

void parallel_for(std::size_t count, std::size_t threads,
                  const std::function<void(std::size_t)>& body) {
    if (count <= 1 || threads <= 1 || thread_count() == 1) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
#if defined(__SANITIZE_THREAD__)
    // The sanitizer does not see into libtbb and would report its own hand-over of work.
    std::atomic<std::size_t> next = 0;
    std::vector<std::exception_ptr> thrown(static_cast<std::size_t>(thread_count()));
    const auto work = [&](std::exception_ptr& mine) {
        try {
            for (std::size_t i = next++; i < count; i = next++) body(i);
        } catch (...) {
            mine = std::current_exception();
            next = count;
        }
    };
    std::vector<std::thread> helper;
    for (std::size_t n = 1; n < thrown.size(); ++n) helper.emplace_back(work, std::ref(thrown[n]));
    work(thrown[0]);
    for (std::thread& thread : helper) thread.join();
    for (const std::exception_ptr& one : thrown) {
        if (one) std::rethrow_exception(one);
    }
#else
    const auto loop = [&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
            },
            tbb::simple_partitioner());
    };
    // Who waits within a loop takes up nothing else of the loop around it: calls would pile up.
    is_in_arena() ? tbb::this_task_arena::isolate(loop) : arena_for(threads).execute(loop);
#endif
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace swage {

namespace {
// To ask is to read a file, which takes as long as many a loop.
int core_count() {
    static const int count = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    return count;
}

int configured_threads = 0;
std::unique_ptr<tbb::global_control> limit;
std::unique_ptr<tbb::task_arena> arena = std::make_unique<tbb::task_arena>(thread_count());

// That a thread is within a loop. TBB's own answer is no: it counts a thread in from its first
// loop on.
thread_local int loops_around = 0;
struct WithinLoop {
    WithinLoop() { ++loops_around; }
    ~WithinLoop() { --loops_around; }
};
}  // namespace

void set_thread_count(int count) {
    configured_threads = std::clamp(count, 0, std::max(16, core_count()));
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(thread_count()));
    arena = std::make_unique<tbb::task_arena>(thread_count());
}

int thread_count() { return configured_threads > 0 ? configured_threads : core_count(); }

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
    // Isolated twice: a loop is not left half done where one beside it fails, both within a third;
    // and who waits for it takes up nothing else of the loop around it, for calls would pile up.
    tbb::task_group_context alone(tbb::task_group_context::isolated);
    const auto loop = [&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                const WithinLoop within;
                for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
            },
            tbb::simple_partitioner(), alone);
    };
    loops_around > 0 ? tbb::this_task_arena::isolate(loop) : arena->execute(loop);
#endif
}

}  // namespace swage

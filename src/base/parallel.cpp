// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <thread>

#if defined(__SANITIZE_THREAD__)
// The thread sanitizer does not see into libtbb, so the hand-over of work is told to it by hand.
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#define SWAGE_TSAN_ACQUIRE(p) __tsan_acquire(p)
#define SWAGE_TSAN_RELEASE(p) __tsan_release(p)
#else
#define SWAGE_TSAN_ACQUIRE(p) (void)(p)
#define SWAGE_TSAN_RELEASE(p) (void)(p)
#endif

namespace swage {

namespace {
int configured_threads = 0;
std::unique_ptr<tbb::global_control> limit;
}  // namespace

void set_thread_count(int count) {
    configured_threads = std::max(0, count);
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(thread_count()));
}

int thread_count() {
    if (configured_threads > 0) return configured_threads;
    return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    if (count <= 1 || thread_count() == 1) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    char begin = 0, end = 0;
    SWAGE_TSAN_RELEASE(&begin);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            SWAGE_TSAN_ACQUIRE(&begin);
            for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
            SWAGE_TSAN_RELEASE(&end);
        },
        tbb::simple_partitioner());
    SWAGE_TSAN_ACQUIRE(&end);
}

}  // namespace swage

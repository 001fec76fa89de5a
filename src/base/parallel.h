// SPDX-License-Identifier: GPL-3.0-or-later
// Parallel loops whose results do not depend on the number of threads: the caller cuts the work
// into chunks by its size alone, never by the number of threads, and sums chunk results in order.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace swage {

// Threads that later loops may use; 0 asks for as many as there are cores. More than there are
// cores may be asked for, up to 16.
void set_thread_count(int count);
int thread_count();

// Calls body(0) ... body(count - 1), each exactly once, in no fixed order. With one thread, or one
// chunk, it is a plain loop. Loops may hold others. An exception reaches the caller, one of them
// where there are several: none should be what a user reads.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);
// The same where there is work for so many threads, a plain loop where that is one: chunks may be
// hardly worth handing over (some 20 us are), or hold loops of their own.
void parallel_for(std::size_t count, std::size_t threads,
                  const std::function<void(std::size_t)>& body);

// The sum over chunks of partial(chunk), added in the order of the chunks.
template <typename Partial>
double ordered_sum(std::size_t chunk_count, std::size_t threads, const Partial& partial) {
    std::vector<double> part(chunk_count, 0.0);
    parallel_for(chunk_count, threads, [&](std::size_t chunk) { part[chunk] = partial(chunk); });
    double sum = 0;
    for (double p : part) sum += p;
    return sum;
}
template <typename Partial>
double ordered_sum(std::size_t chunk_count, const Partial& partial) {
    return ordered_sum(chunk_count, chunk_count, partial);
}

}  // namespace swage

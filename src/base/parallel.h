// SPDX-License-Identifier: GPL-3.0-or-later
// Parallel loops whose results do not depend on the number of threads: the caller cuts the work
// into chunks by its size alone, never by the number of threads, and sums chunk results in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <type_traits>
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

// How many chunks of `size` cover 0 ... count - 1; the last may be smaller.
inline std::size_t chunks_of(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
}

// Calls act(begin, end) for each chunk.
template <typename Act>
void parallel_chunks(std::size_t count, std::size_t size, const Act& act) {
    parallel_for(chunks_of(count, size), [&](std::size_t chunk) {
        act(chunk * size, std::min(count, (chunk + 1) * size));
    });
}

// Calls act(0) ... act(count - 1), those of a chunk in order.
template <typename Act>
void parallel_each(std::size_t count, std::size_t size, const Act& act) {
    parallel_chunks(count, size, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) act(n);
    });
}

// What of(begin, end) gives for each chunk, in their order.
template <typename Of>
auto parallel_parts(std::size_t count, std::size_t size, const Of& of) {
    using Part = decltype(of(count, count));
    static_assert(!std::is_same_v<Part, bool>, "threads may not share a vector<bool>");
    std::vector<Part> part(chunks_of(count, size));
    parallel_chunks(count, size, [&](std::size_t begin, std::size_t end) {
        part[begin / size] = of(begin, end);
    });
    return part;
}

// All that find(begin, end, found) appends to `found`, in the order of the chunks.
template <typename T, typename Find>
std::vector<T> parallel_collect(std::size_t count, std::size_t size, const Find& find) {
    const auto parts = parallel_parts(count, size, [&](std::size_t begin, std::size_t end) {
        std::vector<T> found;
        find(begin, end, found);
        return found;
    });
    std::size_t total = 0;
    for (const std::vector<T>& part : parts) total += part.size();
    std::vector<T> all;
    all.reserve(total);
    for (const std::vector<T>& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

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
// The sum of term(0) ... term(count - 1), first those of each chunk.
template <typename Term>
double ordered_sum_of(std::size_t count, std::size_t size, const Term& term) {
    return ordered_sum(chunks_of(count, size), [&](std::size_t chunk) {
        const std::size_t end = std::min(count, (chunk + 1) * size);
        double sum = 0;
        for (std::size_t n = chunk * size; n < end; ++n) sum += term(n);
        return sum;
    });
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "tests/catch.h"

using namespace swage;

TEST_CASE("a loop calls each number once, and loops within it too") {
    for (const int cores : {1, 2, 3, 9}) {
        set_thread_count(cores);
        for (const std::size_t threads : {0, 1, 2, 5, 100}) {
            for (const std::size_t count : {0, 1, 2, 7, 40}) {
                std::vector<std::vector<std::atomic<int>>> calls(count);
                for (auto& row : calls) row = std::vector<std::atomic<int>>(13);
                parallel_for(count, threads, [&](std::size_t i) {
                    parallel_for(13, [&](std::size_t j) { ++calls[i][j]; });
                });
                bool once = true;
                for (const auto& row : calls) {
                    for (const auto& one : row) once = once && one == 1;
                }
                INFO(cores << " cores, " << threads << " threads, " << count << " calls");
                CHECK(once);
            }
        }
    }
    set_thread_count(0);
}

TEST_CASE("as many threads take part in each loop as were asked for") {
    for (const int asked : {6, 2}) {
        set_thread_count(asked);
        for (int again = 0; again < 3; ++again) {
            std::atomic<int> within = 0, most = 0;
            const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
            parallel_for(40, [&](std::size_t) {
                const int now = ++within;
                for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
                }
                while (most < asked && std::chrono::steady_clock::now() < deadline) {
                    std::this_thread::yield();
                }
                --within;
            });
            CHECK(most == asked);
        }
    }
    set_thread_count(0);
}

TEST_CASE("a loop within one that fails is done whole") {
    set_thread_count(4);
    for (int again = 0; again < 50; ++again) {
        std::atomic<int> begun = 0, whole = 0;
        CHECK_THROWS_WITH(parallel_for(4,
                                       [&](std::size_t i) {
                                           if (i == 3) throw std::runtime_error("3");
                                           ++begun;
                                           std::atomic<int> calls = 0;
                                           parallel_for(200, [&](std::size_t) {
                                               std::this_thread::yield();
                                               ++calls;
                                           });
                                           whole += calls == 200;
                                       }),
                          "3");
        CHECK(whole == begun);
    }
    set_thread_count(0);
}

TEST_CASE("what is thrown in a loop reaches its caller, and loops go on after it") {
    for (const int cores : {1, 4}) {
        set_thread_count(cores);
        const auto loop = [] {
            parallel_for(30, [](std::size_t i) {
                parallel_for(5, [&](std::size_t j) {
                    if (i == 17 && j == 3) throw std::runtime_error("17");
                });
            });
        };
        CHECK_THROWS_WITH(loop(), "17");
        std::atomic<int> calls = 0;
        parallel_for(30, [&](std::size_t) { ++calls; });
        CHECK(calls == 30);
    }
    set_thread_count(0);
}

TEST_CASE("chunks cover all numbers once, and what they give stands in their order") {
    for (const int cores : {1, 3}) {
        set_thread_count(cores);
        for (const std::size_t count : {0, 1, 4, 5, 8, 23}) {
            constexpr std::size_t kSize = 4;
            INFO(cores << " cores, " << count << " numbers");
            using Chunk = std::pair<std::size_t, std::size_t>;
            std::vector<Chunk> all;
            for (std::size_t n = 0; n < count; n += kSize) {
                all.emplace_back(n, std::min(count, n + kSize));
            }
            CHECK(chunks_of(count, kSize) == all.size());
            std::vector<Chunk> called(all.size());
            parallel_chunks(count, kSize, [&](std::size_t begin, std::size_t end) {
                called[begin / kSize] = {begin, end};
            });
            CHECK(called == all);
            const auto both = [](std::size_t begin, std::size_t end) { return Chunk(begin, end); };
            CHECK(parallel_parts(count, kSize, both) == all);
            std::vector<int> calls(count);
            parallel_each(count, kSize, [&](std::size_t n) { ++calls[n]; });
            CHECK(calls == std::vector<int>(count, 1));
            std::vector<std::size_t> odd;
            for (std::size_t n = 1; n < count; n += 2) odd.push_back(n);
            const auto find = [](std::size_t begin, std::size_t end,
                                 std::vector<std::size_t>& found) {
                for (std::size_t n = begin; n < end; ++n) {
                    if (n % 2 == 1) found.push_back(n);
                }
            };
            CHECK(parallel_collect<std::size_t>(count, kSize, find) == odd);
        }
    }
    set_thread_count(0);
}

TEST_CASE("a sum has the same bits for any number of threads") {
    const auto part = [](std::size_t n) { return 1.0 / (3.0 + double(n)); };
    set_thread_count(1);
    const double alone = ordered_sum(1000, part), by_chunks = ordered_sum_of(1000, 32, part);
    for (const int cores : {2, 3, 8}) {
        set_thread_count(cores);
        CHECK(ordered_sum(1000, part) == alone);
        CHECK(ordered_sum(1000, 2, part) == alone);
        CHECK(ordered_sum_of(1000, 1, part) == alone);
        CHECK(ordered_sum_of(1000, 1000, part) == alone);
        CHECK(ordered_sum_of(1000, 32, part) == by_chunks);
    }
    set_thread_count(0);
}

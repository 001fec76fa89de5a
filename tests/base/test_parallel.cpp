// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

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

TEST_CASE("a sum has the same bits for any number of threads") {
    const auto part = [](std::size_t n) { return 1.0 / (3.0 + double(n)); };
    set_thread_count(1);
    const double alone = ordered_sum(1000, part);
    for (const int cores : {2, 3, 8}) {
        set_thread_count(cores);
        CHECK(ordered_sum(1000, part) == alone);
        CHECK(ordered_sum(1000, 2, part) == alone);
    }
    set_thread_count(0);
}

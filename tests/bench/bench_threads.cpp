// SPDX-License-Identifier: GPL-3.0-or-later
// Whole explicit steps with one thread and with two, four and so on, up to one a core, taken in
// turns, by the clock on the wall: medians of the ratios. With `busy` one more thread spins on the
// last core meanwhile.
// usage: bench_threads [busy] [cells ...]
#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "base/parallel.h"
#include "sim/block_steps.h"
#include "tests/bench/bent_bar.h"

using namespace swage;

namespace {

// 1, 2, 4 and so on, the number of cores last; two at least.
std::vector<int> thread_counts() {
    const int cores = std::max(2, static_cast<int>(std::thread::hardware_concurrency()));
    std::vector<int> counts;
    for (int n = 1; n < cores; n *= 2) counts.push_back(n);
    counts.push_back(cores);
    return counts;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

void compare(const char* name, double cells, const Material& material) {
    Aggregate m = test::bent_bar(static_cast<int>(std::round(std::cbrt(cells / 2.4))), material);
    m.particle_position.x[0] +=
        1e-3 * m.lattice.spacing;  // without strain it would fly in one step
    const Apparatus nothing;
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.gravity = {0, 0, -9.81};
    BlockSolver solver({&m}, nothing, settings);
    // A whole block at least: what is done once a block is not to weigh more than it does.
    const int steps = std::max(64, static_cast<int>(4e6 / cells));
    const double frame = (steps - 0.5) * explicit_step(m, settings);
    Drive from, to;
    const std::vector<int> counts = thread_counts();
    std::vector<double> one;
    std::vector<std::vector<double>> faster(counts.size());
    for (int n = 0; n < 9; ++n) {
        double alone = 0;
        for (std::size_t c = 0; c < counts.size(); ++c) {
            set_thread_count(counts[c]);
            from.time = to.time;
            to.time += frame;
            const auto start = std::chrono::steady_clock::now();
            const long taken = solver.advance(from, to).steps;
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            const double seconds = took.count() / static_cast<double>(taken);
            if (c == 0) alone = seconds;
            if (n > 0) faster[c].push_back(alone / seconds);  // the first round warms up
        }
        if (n > 0) one.push_back(alone);
    }
    fmt::print("{:<16}{:>9} cells: {:9.3f} ms a step with one thread; times as fast:", name,
               m.cell_fill.size(), 1e3 * median(one));
    for (std::size_t c = 1; c < counts.size(); ++c) {
        fmt::print(" {:.2f} with {}{}", median(faster[c]), counts[c],
                   c + 1 < counts.size() ? "," : "\n");
    }
}

}  // namespace

int main(int argc, char** argv) {
    const bool busy = argc > 1 && std::string(argv[1]) == "busy";
    std::atomic<bool> stop{false};
    std::thread spinner;
    if (busy) {
        spinner = std::thread([&] {
            while (!stop) {
            }
        });
        cpu_set_t last;
        CPU_ZERO(&last);
        CPU_SET(std::thread::hardware_concurrency() - 1, &last);
        pthread_setaffinity_np(spinner.native_handle(), sizeof last, &last);
    }
    const Material elastic{.young_modulus = 1e6, .poisson_ratio = 0.3, .damping_ratio = 0};
    Material flowing = elastic, springs = elastic, damped;
    flowing.yield_stress = 1e3, flowing.hardening = 1e4;
    springs.mechanics = Mechanics::springs;
    damped = springs;
    damped.damping_ratio = 0.02;
    for (double cells : test::given_sizes(argc, argv, busy ? 2 : 1)) {
        compare("elastic", cells, elastic);
        compare("flowing", cells, flowing);
        compare("springs", cells, springs);
        compare("springs, damped", cells, damped);
    }
    stop = true;
    if (spinner.joinable()) spinner.join();
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What the springs path costs a connection and a step, one thread: its forces alone, and whole
// explicit steps with nothing else acting, where the material is elastic, loses energy in every
// swing, can break, does both, and flows. usage: bench_springs [particles ...]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "sim/block_steps.h"
#include "sim/lattice_forces.h"
#include "sim/vector_clones.h"
#include "tests/bench/bent_bar.h"

using namespace swage;

namespace {

const Material kPlain{
    .mechanics = Mechanics::springs, .young_modulus = 1e6, .density = 1000, .damping_ratio = 0};

Material damped(Material m) {
    m.damping_ratio = 0.02;
    return m;
}
Material breaking(Material m) {
    m.strength = 1e5, m.toughness = 1e4;
    return m;
}
Material flowing(Material m) {
    m.yield_stress = 1e3, m.hardening = 1e4;
    return m;
}

Aggregate bar(double particles, const Material& material) {
    return test::bent_bar(static_cast<int>(std::round(std::cbrt(particles / 2.4))) - 1, material);
}

// Of this thread's own processor time, so that other work on the machine counts less: the least of
// several.
double least_seconds(int rounds, const std::function<void()>& act) {
    double least = 1e300;
    for (int n = 0; n < rounds; ++n) {
        timespec start, stop;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
        act();
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &stop);
        least = std::min(least, double(stop.tv_sec - start.tv_sec) +
                                    1e-9 * double(stop.tv_nsec - start.tv_nsec));
    }
    return least;
}

double force_ns(double particles, const Material& material) {
    const Aggregate m = bar(particles, material);
    LatticeForces forces(m);
    Vec3Array f;
    forces.find(m, Flow::trial, f);
    const int repeats = std::max(1, static_cast<int>(1e5 / particles));
    const double seconds = least_seconds(15, [&] {
        for (int n = 0; n < repeats; ++n) forces.find(m, Flow::trial, f);
    });
    return 1e9 * seconds / repeats / static_cast<double>(m.connection_count());
}

double step_ns(double particles, const Material& material) {
    Aggregate m = bar(particles, material);
    const Apparatus nothing;
    const SimSettings settings{.solver = Solver::explicit_steps};
    BlockSolver solver({&m}, nothing, settings);
    // A whole block at least: what is done once a block is not to weigh more than it does.
    const int steps = std::max(64, static_cast<int>(1e6 / particles));
    const double frame = (steps - 0.5) * explicit_step(m, settings);
    Drive from, to;
    to.time = frame;
    long taken = solver.advance(from, to).steps;
    const double seconds = least_seconds(5, [&] {
        from.time = to.time;
        to.time += frame;
        taken = solver.advance(from, to).steps;
    });
    return 1e9 * seconds / static_cast<double>(taken) / static_cast<double>(m.connection_count());
}

}  // namespace

int main(int argc, char** argv) {
    set_thread_count(1);
    fmt::print("ns a connection{:>21}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "forces", "step", "damped",
               "breaking", "both", "flowing");
    for (double particles : test::given_sizes(argc, argv)) {
        for (int width : {8, 4}) {
            limit_vector_width(width);
            if (vector_width() != width) continue;
            fmt::print(
                "{:>9.0f} particles, {} lanes{:>10.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}"
                "{:>9.2f}\n",
                particles, width, force_ns(particles, kPlain), step_ns(particles, kPlain),
                step_ns(particles, damped(kPlain)), step_ns(particles, breaking(kPlain)),
                step_ns(particles, damped(breaking(kPlain))), step_ns(particles, flowing(kPlain)));
        }
        limit_vector_width(0);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Nanoseconds a cell for one evaluation of the cell law's forces: elastic, rubber and yielding,
// blocks and a ball, one thread; and the same by springs. Median of several.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/lattice_forces.h"

using namespace swage;

namespace {

Aggregate molded(const std::string& shape, std::map<std::string, double> size, double spacing,
                 const Material& material) {
    MoldSettings settings;
    settings.spacing = spacing;
    return mold(make_shape(shape, std::move(size)).mesh, material, settings);
}

// Strains of about a hundredth, which yield where the material can.
void deform(Aggregate& m) {
    const double a = m.lattice.spacing;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p) / a;
        const Vec3 u(std::sin(0.7 * x.y() + 0.3 * x.z()), std::cos(0.5 * x.x()),
                     std::sin(0.4 * x.y()));
        m.particle_position.set(p, m.particle_reference.at(p) + 0.02 * a * u);
    }
}

double median_ns(Aggregate& matter) {
    LatticeForces forces(matter);
    deform(matter);
    Vec3Array f;
    forces.find(matter, Flow::trial, f);
    forces.commit(matter);
    const std::size_t cells = matter.cell_fill.size();
    std::vector<double> time;
    for (int n = 0; n < 9; ++n) {
        const int repeats = static_cast<int>(std::max<std::size_t>(1, 2'000'000 / cells));
        const auto start = Stopwatch::Clock::now();
        for (int r = 0; r < repeats; ++r) forces.find(matter, Flow::trial, f);
        const std::chrono::duration<double> took = Stopwatch::Clock::now() - start;
        time.push_back(took.count() / repeats / static_cast<double>(cells) * 1e9);
    }
    std::sort(time.begin(), time.end());
    return time[time.size() / 2];
}

}  // namespace

int main() {
    Material elastic{.young_modulus = 1e6, .poisson_ratio = 0.3};
    Material rubber = elastic, yielding = elastic, springs = elastic;
    rubber.elasticity = Elasticity::neo_hookean;
    yielding.yield_stress = 2e3;
    yielding.hardening = 1e4;
    springs.mechanics = Mechanics::springs;
    fmt::print("ns a cell, guard included{:>22}{:>10}{:>10}{:>10}\n", "elastic", "rubber",
               "yielding", "springs");
    set_thread_count(1);
    for (double spacing : {1.0 / 16, 1.0 / 36, 1.0 / 78}) {
        for (const std::string shape : {"bar", "sphere"}) {
            std::map<std::string, double> size;
            if (shape == "bar") {
                size = {{"length", 2.4}, {"height", 1}, {"width", 1}, {"rounding", 0}};
            } else {
                size = {{"diameter", 1.6}};
            }
            std::string line;
            std::size_t cells = 0;
            for (const Material& material : {elastic, rubber, yielding, springs}) {
                Aggregate matter = molded(shape, size, spacing, material);
                cells = matter.cell_fill.size();
                line += fmt::format("{:>10.1f}", median_ns(matter));
            }
            fmt::print("{:<8}{:>9} cells{:>24}\n", shape, cells, line);
        }
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Nanoseconds for one evaluation of the forces inside the matter: a cell by the cell law, elastic,
// rubber, foam, flowing, flowing along a curve of some 400 points, and with a back stress, as
// committed and flowing back from there, in blocks and balls and by each width of vectors that the
// machine has; a connection by springs; two threads against one;
// bytes. Medians, beside the bars that were set. Arguments: the numbers of cells to try, or none
// for 1e4, 1e5 and 1e6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "geometry/make_shape.h"
#include "laws/flow_forms.h"
#include "mold/mold.h"
#include "sim/lattice_forces.h"
#include "sim/vector_clones.h"
#include "tests/bench/bent_bar.h"

using namespace swage;

namespace {

Aggregate molded(const std::string& shape, double cells, const Material& material) {
    const bool bar = shape == "bar";
    const std::map<std::string, double> size =
        bar ? std::map<std::string, double>{{"length", 2.4},
                                            {"height", 1},
                                            {"width", 1},
                                            {"rounding", 0}}
            : std::map<std::string, double>{{"diameter", 1.66}};
    MoldSettings settings;
    settings.spacing = 1 / std::round(std::cbrt(cells / 2.4));
    return mold(make_shape(shape, size).mesh, material, settings);
}

// Strains of about a hundredth, which yield where the material can.
void deform(Aggregate& m, double share = 1) {
    const double a = m.lattice.spacing;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p) / a;
        const Vec3 u(std::sin(0.7 * x.y() + 0.3 * x.z()), std::cos(0.5 * x.x()),
                     std::sin(0.4 * x.y()));
        m.particle_position.set(p, m.particle_reference.at(p) + share * 0.02 * a * u);
    }
}

// Of this thread's own processor time, so that other work on the machine counts less: the least.
double least_ns(std::size_t items, const std::function<void()>& act) {
    act();
    double least = 1e300;
    for (int n = 0; n < 25; ++n) {
        const int repeats = static_cast<int>(std::max<std::size_t>(1, 500'000 / items));
        timespec start, stop;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
        for (int r = 0; r < repeats; ++r) act();
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &stop);
        const double took =
            1e9 * double(stop.tv_sec - start.tv_sec) + double(stop.tv_nsec - start.tv_nsec);
        least = std::min(least, took / repeats / static_cast<double>(items));
    }
    return least;
}

const Material kElastic{.young_modulus = 1e6, .poisson_ratio = 0.3};

Material rubber() {
    Material m = kElastic;
    m.elasticity = Elasticity::neo_hookean;
    return m;
}
Material foam() {
    Material m = kElastic;
    m.elasticity = Elasticity::storakers;
    return m;
}
Material flowing() {
    Material m = kElastic;
    m.yield_stress = 2e3;
    m.hardening = 1e4;
    return m;
}
Material curved() {
    Material m = kElastic;
    m.flow_along(points_of(SwiftForm{6e3, 0.004, 0.2}));
    return m;
}

Material shifting() {
    Material m = flowing();
    m.back_stress = 1e3, m.back_strain = 0.01;
    return m;
}

double cell_ns(Aggregate& matter, double then = 1) {
    LatticeForces forces(matter);
    deform(matter);
    Vec3Array f;
    forces.find(matter, Flow::trial, f);
    forces.commit(matter);
    deform(matter, then);
    return least_ns(matter.cell_fill.size(), [&] { forces.find(matter, Flow::trial, f); });
}

void kernels(double cells) {
    for (const std::string shape : {"bar", "sphere"}) {
        Aggregate elastic = molded(shape, cells, kElastic);
        Aggregate soft = elastic, foamy = elastic, flows = elastic, curves = elastic,
                  shifts = elastic;
        soft.material = rubber();
        foamy.material = foam();
        flows.material = flowing();
        curves.material = curved();
        shifts.material = shifting();
        for (int width : {8, 4}) {
            limit_vector_width(width);
            if (vector_width() != width) continue;
            fmt::print(
                "{:<8}{:>9} cells, vectors of {}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}{:>10.1f}"
                "{:>10.1f}{:>10.1f}\n",
                shape, elastic.cell_fill.size(), width, cell_ns(elastic), cell_ns(soft),
                cell_ns(foamy), cell_ns(flows), cell_ns(curves), cell_ns(shifts),
                cell_ns(shifts, 0));
        }
        limit_vector_width(0);
    }
}

}  // namespace

int main(int argc, char** argv) {
    set_thread_count(1);
    fmt::print("ns a cell, guard included{:>22}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "elastic",
               "rubber", "foam", "flowing", "curve", "back", "reversed");
    for (double cells : test::given_sizes(argc, argv)) kernels(cells);
}

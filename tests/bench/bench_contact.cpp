// SPDX-License-Identifier: GPL-3.0-or-later
// Milliseconds of one step's contact on one core: two plates of a hundred thousand surface points
// that lie on each other (bar: 15 ms a step), and the same as parts of one body; and the search
// anew by the grid and by trees of spheres. Of this thread's own processor time, the least of
// several.
#include <fmt/format.h>

#include <ctime>
#include <functional>

#include "base/parallel.h"
#include "geometry/near_pairs.h"
#include "sim/body_contact.h"
#include "tests/shared/cells.h"
#include "tests/shared/sphere_pairs.h"

using namespace swage;

namespace {

double least_ms(int times, const std::function<void()>& act) {
    double least = 1e300;
    for (int n = 0; n < times; ++n) {
        timespec start, stop;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
        act();
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &stop);
        least = std::min(least, 1e3 * double(stop.tv_sec - start.tv_sec) +
                                    1e-6 * double(stop.tv_nsec - start.tv_nsec));
    }
    return least;
}

void time_steps(const char* what, const std::vector<Aggregate*>& bodies) {
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.self_contact = bodies.size() == 1;
    BodyContact contact(bodies, settings);
    const std::vector<char> asleep(bodies.size(), 0);
    const double search = least_ms(3, [&] { contact.renew_all(asleep); });
    std::vector<Vec3Array> force;
    std::vector<Vec3Array*> forces;
    for (const Aggregate* body : bodies) force.push_back(body->particle_velocity);
    for (Vec3Array& one : force) forces.push_back(&one);
    std::vector<ContactSums> sums;
    const double step = least_ms(9, [&] {
        contact.add_forces(forces, Vec3::Zero(), 1e-5, asleep, sums);
        contact.commit(asleep);
        contact.renew(asleep);
    });
    fmt::print("{}, {} points in contact: {:.1f} ms a step (bar 15), {:.1f} ms a search\n", what,
               bodies.size() == 1 ? sums[0].contacts / 2 : sums[0].contacts, step, search);
}

}  // namespace

int main() {
    set_thread_count(1);
    constexpr int kSide = 112;
    constexpr double kSpacing = 0.1;
    const Material material{.young_modulus = 1e6, .density = 1000};
    Aggregate low = test::make_block(kSide, 3, kSide, kSpacing, material), high = low;
    for (double& y : high.particle_position.y) y += 2.99 * kSpacing;
    time_steps("two bodies", {&low, &high});
    Aggregate both = test::make_cells(Vec3::Zero(), Vec3i(kSide, 9, kSide), kSpacing, material,
                                      [](const Vec3i& at) { return at.y() < 3 || at.y() > 5; });
    for (std::size_t p = 0; p < both.particle_count(); ++p) {
        if (both.particle_reference.at(p).y() > 4 * kSpacing) {
            both.particle_position.y[p] -= 3.01 * kSpacing;
        }
    }
    time_steps("one body", {&both});

    std::vector<Vec3> point;
    std::vector<Box> box;
    for (std::size_t p = 0; p < low.surface.size(); ++p) point.push_back(low.surface_position(p));
    for (std::size_t c = 0; c < high.cell_fill.size(); ++c) {
        box.emplace_back();
        for (ParticleId p : high.lattice.cell_corners(static_cast<CellId>(c))) {
            box.back().grow(high.particle_position.at(p));
        }
    }
    std::size_t pairs = 0;
    const double grid = least_ms(3, [&] { pairs = near_pairs(point, box).size(); });
    const double tree =
        least_ms(3, [&] { pairs = test::near_pairs_by_spheres(point, box).size(); });
    fmt::print("{} points, {} boxes, {} pairs: grid {:.1f} ms, trees of spheres {:.1f} ms\n",
               point.size(), box.size(), pairs, grid, tree);
}

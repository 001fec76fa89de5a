// SPDX-License-Identifier: GPL-3.0-or-later
// The size that S2 measured: 187 objects, 1325 connections, a skin of 1094 points, 10 steps a
// frame, 10 frames a second (S2.18). Here the nearest block of springs, one thread, skin included:
// frames a second (bar 10,000), and where a frame's time goes. Medians of this thread's own time.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/moving_body.h"
#include "skin/mount.h"
#include "tests/shared/block.h"

using namespace swage;

namespace {

double median_us(int rounds, int repeats, const std::function<void()>& act) {
    std::vector<double> took;
    for (int n = 0; n < rounds; ++n) {
        timespec start, stop;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
        for (int r = 0; r < repeats; ++r) act();
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &stop);
        took.push_back((1e6 * double(stop.tv_sec - start.tv_sec) +
                        1e-3 * double(stop.tv_nsec - start.tv_nsec)) /
                       repeats);
    }
    std::nth_element(took.begin(), took.begin() + rounds / 2, took.end());
    return took[rounds / 2];
}

// This many, even over the block's surface.
std::vector<Vec3> skin_points(const Vec3& half, std::size_t count) {
    std::vector<Vec3> points;
    for (int n = 1; points.size() < count; ++n) {
        points.clear();
        for (int axis = 0; axis < 3; ++axis) {
            for (int end = 0; end < 2; ++end) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const int nu = static_cast<int>(n * half[u]), nv = static_cast<int>(n * half[v]);
                for (int i = 0; i <= nu; ++i) {
                    for (int j = 0; j <= nv; ++j) {
                        Vec3 p;
                        p[axis] = end ? half[axis] : -half[axis];
                        p[u] = half[u] * (2.0 * i / std::max(1, nu) - 1);
                        p[v] = half[v] * (2.0 * j / std::max(1, nv) - 1);
                        points.push_back(p);
                    }
                }
            }
        }
    }
    points.resize(count);
    return points;
}

void measure(const char* what, double damping, bool floor) {
    constexpr int kSteps = 10;
    const Material material{.mechanics = Mechanics::springs,
                            .young_modulus = 1e6,
                            .density = 1000,
                            .damping_ratio = damping};
    Aggregate m = test::make_block(7, 4, 4, 0.1, material);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, Vec3(0.3, 0.5, 0.2).cross(m.particle_reference.at(p)));
    }
    const std::size_t connections = m.connection_count();
    const Mount mount = mount_mesh(skin_points({.35, .2, .2}, 1094), m, SkinKind::mount);
    std::vector<Vec3> skin;
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    Apparatus apparatus;
    Drive from, to;
    if (floor) {
        settings.gravity = {0, -9.81, 0};
        apparatus.tool.push_back({"floor", BoxShape{Vec3(9, 2, 9), 0}, 0.3});
        from.world_from_tool.push_back({Quat::Identity(), {0, -1.2, 0}});
        to = from;
    }
    Simulation simulation(m, apparatus, settings);
    const double frame = (kSteps - 0.5) * explicit_step(m, settings);
    long steps = 0;
    const auto advance = [&](double time) {
        from.time = to.time;
        to.time += time;
        steps = simulation.advance(from, to).steps;
    };
    for (int n = 0; n < 100; ++n) advance(frame);
    const double whole = median_us(31, 40, [&] {
        advance(frame);
        skin_positions(mount, m, skin);
    });
    const long each = steps;
    const double skinning = median_us(31, 40, [&] { skin_positions(mount, m, skin); });
    const double step = median_us(31, 1, [&] { advance(100 * frame); }) / double(steps);
    fmt::print(
        "{:<22}{} particles, {} connections, {} points: {:.0f} frames a second (bar 10000); a "
        "frame of {} steps {:.1f} us: skin {:.1f}, steps {} x {:.2f}, rest {:.1f}\n",
        what, m.particle_count(), connections, skin.size(), 1e6 / whole, each, whole, skinning,
        each, step, whole - skinning - double(each) * step);
}

}  // namespace

int main(int argc, char**) {
    set_thread_count(1);
    measure("free, undamped", 0, false);
    measure("free, damped", 0.05, false);
    if (argc > 1)
        for (;;) measure("free, damped", 0.05, false);
}

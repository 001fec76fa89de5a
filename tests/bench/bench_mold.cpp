// SPDX-License-Identifier: GPL-3.0-or-later
// Molding a 100,000-triangle mesh into 100,000 cells; the bar is 2 s.
#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "mold/mold.h"
#include "tests/shared/meshes.h"

using namespace swage;

int main() {
    const TriMesh knot = test::knot_mesh(500, 100);
    TriMesh ball = test::sphere_mesh(1, 6);
    for (Vec3& p : ball.position)
        p *= 1 + 0.05 * std::sin(9 * p.x()) * std::sin(9 * p.y()) * std::sin(9 * p.z());
    const auto measure = [](const char* name, const TriMesh& mesh, double spacing, int threads) {
        set_thread_count(threads);
        MoldSettings settings;
        settings.spacing = spacing;
        double best = 1e9;
        Aggregate matter;
        for (int n = 0; n < 3; ++n) {
            const auto start = Stopwatch::Clock::now();
            matter = mold(mesh, {}, settings);
            const std::chrono::duration<double> time = Stopwatch::Clock::now() - start;
            best = std::min(best, time.count());
        }
        fmt::print(
            "mold {}: {} triangles, {} cells, {} particles, {} surface points, {} threads: "
            "{:.3f} s, {:.1f} MiB, volume off by {:.1e}\n",
            name, mesh.triangle.size(), matter.cell_fill.size(), matter.particle_count(),
            matter.surface.size(), threads, best, matter.bytes() / 1048576.0,
            matter.volume() / signed_volume(mesh) - 1);
    };
    for (int threads : {1, 2}) {
        measure("knot", knot, 0.0285, threads);
        measure("ball", ball, 0.0344, threads);
    }
    return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Skinning 100,000 vertices, one frame: the surface of a block of 100,000 cells. And the boundary
// made anew around a block and a ball of as many cells.
#include <chrono>
#include <cstdio>
#include <functional>

#include "base/parallel.h"
#include "skin/boundary.h"
#include "skin/mount.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

double best_milliseconds(int rounds, const std::function<void()>& work) {
    double best = 1e30;
    for (int n = 0; n < rounds; ++n) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> taken =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, taken.count());
    }
    return best;
}

}  // namespace

int main() {
    Aggregate matter = test::make_block(100, 32, 32, 0.01, Material{});
    std::vector<Vec3> vertices;  // even over the surface, side by side in memory as in most meshes
    const Vec3 half(.5, .16, .16);
    for (int axis = 0; axis < 3; ++axis) {
        for (int end = 0; end < 2; ++end) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const int nu = static_cast<int>(2 * half[u] / 0.0039);
            const int nv = static_cast<int>(2 * half[v] / 0.0039);
            for (int i = 0; i <= nu; ++i) {
                for (int j = 0; j <= nv; ++j) {
                    Vec3 p;
                    p[axis] = end ? half[axis] : -half[axis];
                    p[u] = half[u] * (2.0 * i / nu - 1);
                    p[v] = half[v] * (2.0 * j / nv - 1);
                    vertices.push_back(p);
                }
            }
        }
    }
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 x = matter.particle_reference.at(p);
        matter.particle_position.set(p, x + Vec3(0, .4 * x.x() * x.x(), .1 * x.x() * x.y()));
    }
    for (SkinKind kind : {SkinKind::mount, SkinKind::frame4}) {
        const char* name = kind == SkinKind::mount ? "mount" : "frame4";
        Mount mount;
        set_thread_count(1);
        const double bind =
            best_milliseconds(3, [&] { mount = mount_mesh(vertices, matter, kind); });
        std::vector<Vec3> position;
        const double frame =
            best_milliseconds(50, [&] { skin_positions(mount, matter, position); });
        std::printf(
            "%-7s %zu vertices, %zu particles used: bind %.1f ms, frame %.2f ms, one core\n", name,
            vertices.size(), mount.particle.size(), bind, frame);
    }
    const Aggregate ball = test::make_shape([](const Vec3& p) { return p.norm() - 1; },
                                            Vec3::Constant(-1.008), Vec3i::Constant(56), .036);
    set_thread_count(0);
    const std::pair<const char*, const Aggregate*> bodies[] = {{"block", &matter}, {"ball", &ball}};
    for (const auto& [name, body] : bodies) {
        TriMesh mesh;
        const double taken = best_milliseconds(5, [&] { mesh = boundary_skin(*body).mesh; });
        std::printf("boundary of a %s, %zu cells: %zu triangles, %.0f ms, %d threads\n", name,
                    body->cell_fill.size(), mesh.triangle.size(), taken, thread_count());
    }
}

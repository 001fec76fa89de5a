// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/moments.h"

#include <algorithm>
#include <tuple>

#include "base/noise.h"
#include "tests/mold/checks.h"

using namespace swage;
using namespace swage::test;

namespace {

struct Inertia {
    double mass = 0;
    Vec3 first = Vec3::Zero();  // about the origin
    Mat3 second = Mat3::Zero();
    Vec3 centre() const { return first / mass; }
    Mat3 about_centre() const { return second - first * first.transpose() / mass; }
};

// By tetrahedra from the origin over the triangles (Mirtich 1996).
Inertia inertia_of(const TriMesh& mesh, double density) {
    Inertia sum;
    for (const Corners& t : mesh.triangle) {
        const Vec3 a = mesh.position[t[0]], b = mesh.position[t[1]], c = mesh.position[t[2]];
        const double mass = density * a.dot(b.cross(c)) / 6;
        const Vec3 all = a + b + c;
        sum.mass += mass;
        sum.first += mass / 4 * all;
        sum.second +=
            mass / 20 *
            (a * a.transpose() + b * b.transpose() + c * c.transpose() + all * all.transpose());
    }
    return sum;
}

Inertia inertia_of(const Aggregate& matter) {
    Inertia sum;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 x = matter.particle_position.at(p);
        sum.mass += matter.particle_mass[p];
        sum.first += matter.particle_mass[p] * x;
        sum.second += matter.particle_mass[p] * x * x.transpose();
    }
    return sum;
}

// Of each entry of the second moments about the centre, over the largest.
double farthest_off(const Inertia& have, const Inertia& wanted) {
    const Mat3 of = wanted.about_centre();
    return (have.about_centre() - of).cwiseAbs().maxCoeff() / of.diagonal().maxCoeff();
}

// A particle's without any matching: an eighth of its cells'.
std::vector<double> equal_shares(const Aggregate& matter) {
    std::vector<double> share(matter.particle_count(), 0.0);
    const double corner = matter.material.density * matter.lattice.cell_volume() / 8;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            for (int c = 0; c < 8; ++c) {
                share[run.corner(n, c)] += corner * matter.cell_fill[run.first + n];
            }
        }
    }
    return share;
}

// Of all orientations alike: a quaternion's direction (by what falls into the ball).
Pose random_pose(int number) {
    for (std::uint64_t n = 1000 * static_cast<std::uint64_t>(number);; n += 4) {
        const Quat q(noise(n), noise(n + 1), noise(n + 2), noise(n + 3));
        if (q.norm() > 1 || q.norm() < 0.1) continue;
        return {q.normalized(), Vec3(noise(n + 4), noise(n + 5), noise(n + 6))};
    }
}

}  // namespace

TEST_CASE("mass lies where the mesh has it, so that bodies turn as they would") {
    const std::vector<std::tuple<const char*, TriMesh, int>> meshes = {
        // and cells that suffice
        {"sphere", sphere_mesh(0.7, 3), 4},
        {"torus", torus_mesh(1, 0.3, 40, 20), 4},
        {"cube", box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), 3},
        {"bar", box_mesh({-2, -0.5, -0.5}, {2, 0.5, 0.5}), 2},
        {"turned bar", moved(box_mesh({-2, -0.5, -0.5}, {2, 0.5, 0.5}), some_turn()), 7},
        {"turned torus", moved(torus_mesh(1, 0.3, 40, 20), some_turn()), 7},
        {"bumpy knot", knot_mesh(300, 24), 4},
    };
    for (const auto& [name, mesh, enough] : meshes) {
        double before = 1e9;
        for (int across : {1, 2, 3, 4, 5, 7, 11, 16}) {
            INFO(name << ", " << across << " cells across");
            const Aggregate matter = mold_across(mesh, across);
            const Inertia wanted = inertia_of(mesh, matter.material.density);
            const Inertia have = inertia_of(matter);
            CHECK((have.centre() - wanted.centre()).norm() < 1e-6);
            const double off = farthest_off(have, wanted);
            if (across >= enough) CHECK(off < 0.01);
            if (across == 16) CHECK(off < 1.5e-4);
            CHECK(off < before);
            before = std::max(off, 4e-3);
        }
    }
}

TEST_CASE("the centre of mass is the mesh's however coarse the cells and however it is turned") {
    TriMesh tetrahedron;
    tetrahedron.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    tetrahedron.triangle = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const std::vector<std::pair<const char*, TriMesh>> meshes = {
        {"box", box_mesh({0, 0, 0}, {1, 0.7, 1.3})},
        {"tetrahedron", tetrahedron},
        {"ball", sphere_mesh(0.7, 2)},
        {"needle", box_mesh({0, 0, 0}, {12, 0.5, 0.4})},
        {"plate", box_mesh({0, 0, 0}, {5, 4, 0.3})},
    };
    for (const auto& [name, mesh] : meshes) {
        for (int turn = 0; turn < 20; ++turn) {
            const TriMesh turned = moved(mesh, random_pose(turn));
            for (int across : {1, 2, 3, 4}) {
                INFO(name << ", turn " << turn << ", " << across << " cells across");
                const Aggregate matter = mold_across(turned, across);
                const double off = (matter.centre() - matter_centroid(matter)).norm();
                CHECK(off < 1e-6 * matter.lattice.spacing);
                CHECK(matter.mass() ==
                      Approx(matter.material.density * matter.volume()).epsilon(1e-12));
                const std::vector<double> shared = equal_shares(matter);
                double least = 1;
                for (std::size_t p = 0; p < shared.size(); ++p) {
                    least = std::min(least, matter.particle_mass[p] / shared[p]);
                }
                CHECK(least > (across < 3 ? 0.29 : 0.57));  // steps are as long as its root
            }
        }
    }
}

TEST_CASE("matter that lies thin on the outside of its cells keeps its centre, or says that not") {
    // A sheet with a post that makes it a cell thick: of the sheet's cells, a thirtieth is filled.
    const auto sheet_with_post = [](double thick) {
        TriMesh mesh = box_mesh({0, 0, 0}, {6, 6, thick});
        const int first = static_cast<int>(mesh.position.size());
        const TriMesh post = box_mesh({0, 0, thick}, {0.05, 0.05, 1});
        mesh.position.insert(mesh.position.end(), post.position.begin(), post.position.end());
        for (const Corners& t : post.triangle) {
            mesh.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
        return mesh;
    };
    MoldSettings settings;
    settings.across = 1;
    const auto off_centre = [](const std::vector<std::string>& told) {
        return std::any_of(told.begin(), told.end(), [](const std::string& line) {
            return line.find("the centre of mass lies") != std::string::npos;
        });
    };
    std::vector<std::string> told;
    const Aggregate thin = mold(sheet_with_post(0.033), {}, settings, {}, &told);
    CHECK((thin.centre() - matter_centroid(thin)).norm() < 1e-6);
    CHECK_FALSE(off_centre(told));

    // A foil of lead on a foam, which has all the mass: its particles above would weigh nothing.
    Material foam, lead;
    foam.density = 0.1, lead.density = 11000;
    told.clear();
    const Aggregate foiled = mold(box_mesh({0, 0, 0}, {6, 6, 1}), foam, settings,
                                  {{box_mesh({-1, -1, -1}, {7, 7, 0.01}), lead}}, &told);
    CHECK(off_centre(told));
    for (double m : foiled.particle_mass) CHECK(m > 0);
}

TEST_CASE("whole cells have the moments of a box to round-off") {
    for (int across : {3, 4, 5, 8}) {
        const TriMesh cube = box_mesh({2, 0, -1}, {3, 1, 0});
        const Aggregate matter = mold_across(cube, across);
        CHECK(farthest_off(inertia_of(matter), inertia_of(cube, matter.material.density)) < 1e-9);
        // As along one axis as along the others, and to either side.
        const double end = matter.particle_mass.front();
        const auto [least, most] =
            std::minmax_element(matter.particle_mass.begin(), matter.particle_mass.end());
        for (int c = 0; c < 8; ++c) {
            const int n = across + 1, i = c & 1 ? across : 0, j = c & 2 ? across : 0,
                      k = c & 4 ? across : 0;
            CHECK(matter.particle_mass[i + n * (j + n * k)] == Approx(end).epsilon(1e-9));
        }
        CHECK(end == *least);
        CHECK(*most < 1.6 * matter.mass() / (across * across * across));
    }
}

TEST_CASE("where nothing can be reached by moving mass it stays as it is") {
    // All particles of a sheet of one cell lie equally far from its middle.
    const TriMesh sheet = box_mesh({0, 0, 0}, {8, 8, 1});
    const Aggregate matter = mold_across(sheet, 1);
    const Inertia wanted = inertia_of(sheet, matter.material.density), have = inertia_of(matter);
    const Mat3 w = wanted.about_centre(), h = have.about_centre();
    CHECK(h(0, 0) == Approx(w(0, 0)).epsilon(1e-6));
    CHECK(h(1, 1) == Approx(w(1, 1)).epsilon(1e-6));
    CHECK(h(2, 2) == Approx(3 * w(2, 2)).epsilon(1e-6));
    const std::size_t half = matter.particle_count() / 2;
    for (std::size_t p = 0; p < half; ++p) {
        CHECK(matter.particle_mass[p] == Approx(matter.particle_mass[p + half]).epsilon(1e-9));
    }
}

TEST_CASE("a heavy core turns as it would") {
    Material light, lead;
    light.density = 1000, lead.density = 11000;
    const TriMesh bar = box_mesh({-2, -0.5, -0.5}, {2, 0.5, 0.5}),
                  core = box_mesh({-1.3, -0.22, -0.17}, {0.4, 0.31, 0.24});
    MoldSettings settings;
    settings.across = 5;
    const Aggregate matter = mold(bar, light, settings, {{core, lead}});
    Inertia wanted = inertia_of(bar, 1000);
    const Inertia more = inertia_of(core, 10000);
    wanted.mass += more.mass, wanted.first += more.first, wanted.second += more.second;
    const Inertia have = inertia_of(matter);
    CHECK(have.mass == Approx(wanted.mass).epsilon(1e-6));
    CHECK((have.centre() - wanted.centre()).norm() < 1e-6);
    CHECK(farthest_off(have, wanted) < 2e-3);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <random>

#include "base/parallel.h"
#include "laws/cell_rest.h"
#include "laws/volume_guard.h"
#include "sim/cell_volume.h"
#include "sim/crushed_cells.h"
#include "sim/flowed_stretch.h"
#include "sim/lattice_forces.h"
#include "sim/sever.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/force_checks.h"
#include "tests/sim/power_iteration.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1;

// A block with random fills, centroids and positions; rows longer than a batch of lanes and not a
// multiple of it.
Aggregate shaken_block(const Material& material, int seed, double by = 0.08) {
    Aggregate m = make_block(11, 3, 2, kSpacing, material);
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
        m.cell_fill[c] = static_cast<float>(0.55 + 0.45 * draw(engine));
        Eigen::Vector3f centroid;
        for (int i = 0; i < 3; ++i) centroid[i] = static_cast<float>(0.3 * draw(engine));
        m.cell_centroid.set(c, centroid);
    }
    for (auto* x : {&m.particle_position.x, &m.particle_position.y, &m.particle_position.z}) {
        for (double& v : *x) v += by * kSpacing * draw(engine);
    }
    return m;
}

// Severs everything that crosses the plane x = 0.02.
void cut(Aggregate& m) {
    const double far = 10;
    sever(m, crossed_connections(
                 m, {{Vec3(0.02, -far, -far), Vec3(0.02, far, -far), Vec3(0.02, far, far)},
                     {Vec3(0.02, -far, -far), Vec3(0.02, far, far), Vec3(0.02, -far, far)}}));
}

double largest_force(const Aggregate& m) {
    LatticeForces forces(m);
    Vec3Array f;
    forces.find(m, Flow::none, f);
    double most = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) most = std::max(most, f.at(p).norm());
    return most;
}

const Material kMaterials[] = {
    {.young_modulus = 1e5, .poisson_ratio = 0.4},
    {.elasticity = Elasticity::neo_hookean, .young_modulus = 1e5, .poisson_ratio = 0.45},
    {.elasticity = Elasticity::storakers, .young_modulus = 1e5, .poisson_ratio = 0.3},
    {.mechanics = Mechanics::springs, .young_modulus = 1e5},
};

}  // namespace

TEST_CASE("the lattice's forces are minus the gradient of its energy, whole or cut") {
    for (const Material& material : kMaterials) {
        for (bool severed : {false, true}) {
            Aggregate m = shaken_block(material, 3);
            if (severed) cut(m);
            LatticeForces forces(m);
            Vec3Array f;
            forces.find(m, Flow::trial, f);
            double largest = 0;
            for (std::size_t p = 0; p < f.size(); ++p) largest = std::max(largest, f.at(p).norm());
            const double h = 1e-4 * kSpacing;
            for (std::size_t p = 0; p < m.particle_count(); p += 5) {
                const auto at = [&](double by) {
                    m.particle_position.y[p] += by;
                    const double energy = forces.elastic_energy(m);
                    m.particle_position.y[p] -= by;
                    return energy;
                };
                const double slope = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
                CHECK(f.y[p] == Approx(-slope).margin(1e-8 * largest));
            }
        }
    }
}

TEST_CASE("forces inside matter neither push nor turn it, and vanish under a rigid motion") {
    for (const Material& material : kMaterials) {
        Aggregate m = shaken_block(material, 5);
        LatticeForces forces(m);
        Vec3Array f;
        forces.find(m, Flow::trial, f);
        const auto [sum, torque, size] = balance_of(m, f);
        CHECK(sum.norm() < 1e-13 * size);
        CHECK(torque.norm() < 1e-13 * size);
        const Pose moved{Quat(Eigen::AngleAxisd(2, Vec3(1, 2, 3).normalized())), Vec3(3, -1, 2)};
        for (std::size_t p = 0; p < f.size(); ++p) {
            m.particle_position.set(p, moved * m.particle_reference.at(p));
        }
        forces.find(m, Flow::trial, f);
        for (std::size_t p = 0; p < f.size(); ++p) {
            CHECK(f.at(p).norm() < 1e-12 * material.young_modulus * kSpacing * kSpacing);
        }
    }
}

TEST_CASE("a cut leaves no force between the sides, and cells away from it as they were") {
    for (const Material& material : kMaterials) {
        Aggregate m = shaken_block(material, 7);
        LatticeForces whole(m);
        Vec3Array before, after;
        whole.find(m, Flow::trial, before);
        cut(m);
        LatticeForces halves(m);
        halves.find(m, Flow::trial, after);
        Vec3 left = Vec3::Zero();
        double size = 0;
        for (std::size_t p = 0; p < after.size(); ++p) {
            const double x = m.particle_reference.at(p).x();
            if (x < 0.02) left += after.at(p);
            size += after.at(p).norm();
            if (std::abs(x - 0.02) > 2 * kSpacing) {
                CHECK((after.at(p) - before.at(p)).norm() <= 1e-12 * before.at(p).norm());
            }
        }
        CHECK(left.norm() < 1e-13 * size);
    }
}

TEST_CASE("matter that has flowed carries nothing where a blade has been, however far it flowed") {
    Material material{.young_modulus = 1e5, .poisson_ratio = 0.3};
    material.yield_stress = 1e3;
    const double stretch = 1.5;
    Mat3 gradient = Vec3(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch)).asDiagonal();
    gradient(0, 1) = 0.4;  // sheared too, which leaves the volume as it is
    Aggregate m = make_block(7, 3, 2, kSpacing, material);
    m.cell_fill[5] = 0.5f;
    m.cell_centroid.set(5, {0.1f, 0.2f, -0.1f});
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, gradient * m.particle_reference.at(p));
    }
    // What it would flow by if it went there; then all of its strain is plastic.
    for (int n = 0; n < 40; ++n) {
        LatticeForces forces(m);
        forces.commit(m);
        for (float& alpha : m.cell_history.hardening()) alpha = 1e-6f;
        m.material.yield_stress *= 0.5;
    }
    const double whole = material.young_modulus * m.volume();
    const double full = material.young_modulus * kSpacing * kSpacing;
    CHECK(largest_force(m) < 1e-6 * full);
    CHECK(LatticeForces(m).elastic_energy(m) < 1e-12 * whole);
    Aggregate severed = m;
    cut(severed);
    CHECK(largest_force(severed) < 1e-6 * full);
    CHECK(LatticeForces(severed).elastic_energy(severed) < 1e-12 * whole);
}

TEST_CASE("a cell that was bent for good is at rest where it lay when a connection is severed") {
    Material material{.young_modulus = 1e5, .poisson_ratio = 0.3};
    material.yield_stress = 1e9;
    Aggregate m = make_block(1, 1, 1, kSpacing, material);
    m.cell_fill[0] = 0.7f;
    m.cell_centroid.set(0, {0.1f, -0.2f, 0.05f});
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> draw(-1, 1);
    auto& row = m.cell_history.row;
    for (int n = 0; n < 6; ++n) row[n] = {static_cast<float>(0.1 * draw(engine))};
    m.cell_history.hardening() = {1.0f};
    float& last = row[2][0];
    last = 0;
    for (int n = 0; n < 20; ++n) {  // to a volume of one
        last += static_cast<float>(1 - flowed_stretch(m, 0).determinant());
    }
    for (int n = 6; n < 18; ++n) row[n] = {static_cast<float>(0.3 * kSpacing * draw(engine))};
    const auto triple = [&](int n) {
        return Triple<double>{row[n][0], row[n + 1][0], row[n + 2][0]};
    };
    const CellRest<double> rest = cell_rest(
        CellHistory<double>{{row[0][0], row[1][0], row[2][0], row[3][0], row[4][0], row[5][0]},
                            {triple(6), triple(9), triple(12), triple(15)},
                            1.0},
        Triple<double>{2 * 0.1f, 2 * -0.2f, 2 * 0.05f}, kSpacing);
    const Symmetric<double>& c = rest.metric;
    Mat3 metric;
    metric << c.xx, c.xy, c.zx, c.xy, c.yy, c.yz, c.zx, c.yz, c.zz;
    const Mat3 stretch = Eigen::SelfAdjointEigenSolver<Mat3>(metric).operatorSqrt();
    const auto corner = m.lattice.cell_corners(0);
    for (int n = 0; n < 8; ++n) {
        const Triple<double>& z = rest.corner[n];
        m.particle_position.set(corner[n], stretch * Vec3(z.x, z.y, z.z));
    }
    const double full = material.young_modulus * kSpacing * kSpacing;
    CHECK(largest_force(m) < 1e-6 * full);
    m.connection[0].weight.set(0, 0);
    CHECK(largest_force(m) < 1e-6 * full);
}

TEST_CASE("the bound on stiffness is above the stiffest motion, and not twice above in the bulk") {
    for (double ratio : {0.0, 0.25, 0.4, 0.49}) {
        const Material material{.young_modulus = 1e5, .poisson_ratio = ratio};
        for (bool ragged : {false, true}) {
            Aggregate m =
                ragged ? shaken_block(material, 9, 0) : make_block(9, 7, 8, kSpacing, material);
            const std::vector<double> bound = LatticeForces(m).stiffness_bound(m);
            // With M the bound: the eigenvalue of M^-1 K must not exceed one.
            const double value = largest_value(m, bound, 150);
            INFO("nu " << ratio << (ragged ? " ragged" : " block"));
            CHECK(value < 1.0);
            if (!ragged) CHECK(value > 0.5);
        }
    }
}

TEST_CASE("every bit of the forces is the same at any number of threads") {
    Material material = kMaterials[0];
    material.yield_stress = 2e3;
    Aggregate m = make_block(41, 23, 29, kSpacing, material);
    std::mt19937 engine(2);
    std::uniform_real_distribution<double> draw(-1, 1);
    for (double& v : m.particle_position.y) v += 0.1 * kSpacing * draw(engine);
    std::vector<double> first;
    for (int threads : {1, 2, 3, 8}) {
        set_thread_count(threads);
        LatticeForces forces(m);
        Vec3Array f;
        forces.find(m, Flow::trial, f);
        if (first.empty()) first = f.x;
        CHECK(f.x == first);
    }
    set_thread_count(0);
}

namespace {

// Several slabs, rows of 43 cells, some of them partly filled, some that have flowed, some crushed.
Aggregate large_block(Material material) {
    material.young_modulus = 1e5;
    Aggregate m = make_block(43, 25, 24, kSpacing, material);
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> draw(-1, 1);
    for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
        if (c / 43 % 3 == 0 && c % 43 < 20) {
            m.cell_fill[c] = static_cast<float>(0.55 + 0.45 * draw(engine));
            m.cell_centroid.set(c, {static_cast<float>(0.3 * draw(engine)), 0, 0});
        }
    }
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        const double squeeze = x.z() > 0.9 ? 0.45 : 1;
        m.particle_position.set(
            p, Vec3(x.x() * squeeze, x.y(), x.z()) +
                   0.03 * kSpacing * Vec3(draw(engine), draw(engine), draw(engine)));
    }
    return m;
}

// The first particle whose force differs in any bit, or -1.
int first_difference(const Vec3Array& a, const Vec3Array& b) {
    for (std::size_t p = 0; p < std::max(a.size(), b.size()); ++p) {
        if (a.at(p) != b.at(p)) return static_cast<int>(p);
    }
    return -1;
}

}  // namespace

TEST_CASE("vectors of any width give the same bytes") {
    for (Material material : kMaterials) {
        for (double yield : {2e3, std::numeric_limits<double>::infinity()}) {
            material.yield_stress = yield;
            Aggregate m = large_block(material);
            LatticeForces forces(m);
            forces.commit(m);
            cut(m);
            forces.connections_changed(m);
            Vec3Array expected;
            forces.find(m, Flow::trial, expected);
            for (int width : {4, 2}) {
                limit_vector_width(width);
                Vec3Array f;
                forces.find(m, Flow::trial, f);
                CHECK(first_difference(f, expected) == -1);
            }
            limit_vector_width(0);
        }
    }
}

TEST_CASE("the sweep misses no cell that the volume guard acts on") {
    Aggregate m = large_block(kMaterials[0]);
    CellSweep sweep(m);
    Vec3Array f;
    sweep.forces(m, Flow::trial, f);
    Vec3Array all = f;
    add_guard_forces(m, Flow::trial, all);
    add_guard_forces(m, Flow::trial, sweep.crushed_runs(), f);
    CHECK(first_difference(f, all) == -1);
    CHECK(smallest_cell_volume(m) < kGuardedVolume);
    std::size_t runs = 0;
    for (const auto& slab : sweep.crushed_runs()) runs += slab.size();
    CHECK(runs > 0);
    CHECK(runs < m.lattice.cell_run.size() / 2);
}

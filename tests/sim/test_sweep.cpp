// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"
#include "sim/cell_volume.h"
#include "sim/lattice_sweep.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

namespace {

// A smooth displacement that is neither uniform nor symmetric.
void deform(Aggregate& m, double size) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        m.particle_position.set(p,
                                x + size * Vec3(std::sin(31 * x.y() + x.z()), std::cos(17 * x.x()),
                                                std::sin(13 * x.x() * x.y() + 7 * x.z())));
    }
}

Vec3Array forces_of(const Aggregate& m) {
    Vec3Array f;
    LatticeSweep(m).forces(m, lattice_law(m), nullptr, f);
    return f;
}

}  // namespace

TEST_CASE("lattice forces are the gradient of the elastic energy") {
    Aggregate m = test::make_block(3, 2, 2, 0.1, Material{});
    deform(m, 0.004);
    const LatticeLaw law = lattice_law(m);
    const Vec3Array f = forces_of(m);
    const double h = 1e-7;
    for (std::size_t p = 0; p < m.particle_count(); p += 5) {
        for (std::vector<double>* x :
             {&m.particle_position.x, &m.particle_position.y, &m.particle_position.z}) {
            const double here = (*x)[p];
            (*x)[p] = here + h;
            const double up = elastic_energy(m, law);
            (*x)[p] = here - h;
            const double down = elastic_energy(m, law);
            (*x)[p] = here;
            const std::vector<double>& component = x == &m.particle_position.x   ? f.x
                                                   : x == &m.particle_position.y ? f.y
                                                                                 : f.z;
            CHECK(component[p] == Approx(-(up - down) / (2 * h)).epsilon(1e-5).margin(1e-4));
        }
    }
}

TEST_CASE("a body at rest or moved rigidly feels no force") {
    Material steel{.young_modulus = 210e9, .density = 7850};
    Aggregate m = test::make_block(4, 3, 2, 0.01, steel);
    const double scale = steel.young_modulus * 0.01 * 0.01;
    Vec3Array f = forces_of(m);
    for (std::size_t p = 0; p < f.size(); ++p) CHECK(f.at(p).norm() < 1e-12 * scale);
    const Pose pose{Quat(Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized())), Vec3(0.3, 0.1, 2)};
    for (std::size_t p = 0; p < f.size(); ++p) {
        m.particle_position.set(p, pose * m.particle_reference.at(p));
    }
    f = forces_of(m);
    for (std::size_t p = 0; p < f.size(); ++p) CHECK(f.at(p).norm() < 1e-12 * scale);
}

TEST_CASE("uniform strain gives Hooke's stress with Young's modulus and a Poisson's ratio of 1/4") {
    // Patch test: small uniaxial stretch with the matching contraction leaves free sides free.
    const double e = 1e-6, young = 5e6;
    for (int cells : {1, 2, 5}) {
        Aggregate m = test::make_block(4, cells, cells, 0.1, Material{.young_modulus = young});
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3 x = m.particle_reference.at(p);
            m.particle_position.set(p, {x.x() * (1 + e), x.y() * (1 - e / 4), x.z() * (1 - e / 4)});
        }
        const Vec3Array f = forces_of(m);
        double end = 0;
        for (std::size_t p = 0; p < f.size(); ++p) {
            const double x = m.particle_reference.x[p];
            if (x > 0.19) {
                end -= f.x[p];
            } else if (std::abs(x) < 0.15) {
                CHECK(f.at(p).norm() < 1e-4 * young * e * 0.01);
            }
        }
        CHECK(end == Approx(young * e * std::pow(0.1 * cells, 2)).epsilon(1e-4));
    }
}

TEST_CASE("a severed connection carries no force") {
    Aggregate m = test::make_block(3, 2, 2, 0.1, Material{});
    for (auto& c : m.connection) std::fill(c.weight.begin(), c.weight.end(), 0.0f);
    deform(m, 0.01);
    const Vec3Array f = forces_of(m);
    for (std::size_t p = 0; p < f.size(); ++p) CHECK(f.at(p) == Vec3::Zero());
}

TEST_CASE("the volume guard is the gradient of its energy and leaves cells above half alone") {
    Aggregate m = test::make_block(2, 2, 2, 0.1, Material{});
    deform(m, 0.02);
    Vec3Array none;
    none.resize(m.particle_count());
    for (double& y : m.particle_position.y) y *= 0.75;
    add_guard_forces(m, none);
    for (std::size_t p = 0; p < none.size(); ++p) CHECK(none.at(p) == Vec3::Zero());
    for (double& y : m.particle_position.y) y *= 0.3;
    Vec3Array f;
    f.resize(m.particle_count());
    add_guard_forces(m, f);
    CHECK(guard_energy_of(m) > 0);
    const double h = 1e-7;
    for (std::size_t p = 0; p < m.particle_count(); p += 4) {
        double& y = m.particle_position.y[p];
        const double here = y;
        y = here + h;
        const double up = guard_energy_of(m);
        y = here - h;
        const double down = guard_energy_of(m);
        y = here;
        CHECK(f.y[p] == Approx(-(up - down) / (2 * h)).epsilon(1e-5).margin(1e-4));
    }
}

TEST_CASE("forces have the same bits at any thread count") {
    Aggregate m = test::make_block(64, 24, 22, 0.01, Material{.yield_stress = 2e4});
    deform(m, 2e-4);
    std::uint64_t expected = 0;
    for (int threads : {1, 2, 3, 8}) {
        set_thread_count(threads);
        Aggregate probe = m;
        probe.particle_position = forces_of(m);
        if (threads == 1) expected = state_hash(probe);
        CHECK(state_hash(probe) == expected);
    }
    set_thread_count(0);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/parallel.h"
#include "laws/spring_damper.h"
#include "sim/crushed_cells.h"
#include "sim/lattice_sweep.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

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
    LatticeSweep(m).forces(m, nullptr, f);
    return f;
}

}  // namespace

TEST_CASE("lattice forces are the gradient of the elastic energy") {
    Aggregate m = test::make_block(3, 2, 2, 0.1, Material{});
    deform(m, 0.004);
    const Vec3Array f = forces_of(m);
    const double h = 1e-7;
    for (std::size_t p = 0; p < m.particle_count(); p += 5) {
        for (std::vector<double>* x :
             {&m.particle_position.x, &m.particle_position.y, &m.particle_position.z}) {
            const double here = (*x)[p];
            (*x)[p] = here + h;
            const double up = elastic_energy(m);
            (*x)[p] = here - h;
            const double down = elastic_energy(m);
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
            const double x = m.particle_reference.at(p).x();
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
    for (auto& c : m.connection) c.weight = SparseArray<float>(m.particle_count(), 0.0f);
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
    add_guard_forces(m, Flow::trial, none);
    for (std::size_t p = 0; p < none.size(); ++p) CHECK(none.at(p) == Vec3::Zero());
    for (double& y : m.particle_position.y) y *= 0.3;
    Vec3Array f;
    f.resize(m.particle_count());
    add_guard_forces(m, Flow::trial, f);
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

namespace {

// A body full of gaps, over several slabs: three of ten cells are missing, some connections are
// severed, and some have flowed.
Aggregate sponge() {
    std::vector<Vec3i> cells;
    std::uint32_t state = 7;
    const auto next = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
    for (int k = 0; k < 26; ++k) {
        for (int j = 0; j < 28; ++j) {
            for (int i = 0; i < 45; ++i) {
                const bool hollow = i > 11 && i < 16 + j % 7;
                if (!hollow && (next() % 10 < 7 || j < 6)) cells.emplace_back(i, j, k);
            }
        }
    }
    const std::vector<float> fill(cells.size(), 1.0f);
    Aggregate m = test::make_matter({0, 0, 0}, 0.1, {45, 28, 26}, cells, fill);
    for (auto& c : m.connection) {
        c.plastic.resize(m.particle_count());
        for (std::size_t p = 0; p < c.weight.size(); ++p) {
            if (next() % 40 == 0) c.weight.set(p, 0);
            if (next() % 30 == 0) c.plastic[p] = 1e-3f * static_cast<float>(next() % 100);
        }
    }
    deform(m, 0.01);
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_velocity.set(p, 1e-3 * Vec3(next() % 100, next() % 90, next() % 80));
    }
    return m;
}

double farthest_apart(const Vec3Array& a, const Vec3Array& b) {
    double most = 0;
    for (std::size_t p = 0; p < a.size(); ++p) most = std::max(most, (a.at(p) - b.at(p)).norm());
    return most;
}

bool same_bytes(const Vec3Array& a, const Vec3Array& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

}  // namespace

TEST_CASE("each connection pulls its two ends, whatever is missing around it, at any width") {
    Aggregate m = sponge();
    const double stiffness = lattice_stiffness(m);
    DampingBranches branches = damping_branches(0.1, 10, 2000);
    const double step = 4e-4;
    BranchStep steps{.count = branches.count, .step = step};
    for (int j = 0; j < branches.count; ++j) steps.forward[j] = damping_step(branches, j, step);
    for (const bool flowed : {true, false}) {
        if (!flowed) {
            for (auto& c : m.connection) c.plastic.clear();
        }
        LatticeSweep sweep(m);
        // Two steps without moving, connection by connection.
        Vec3Array pulls;
        pulls.resize(m.particle_count());
        double largest = 0, first = 0, second = 0;  // work
        for (const Span& span : m.lattice.span) {
            const double length = reference_length(m.lattice, span.direction);
            for (int n = 0; n < span.count; ++n) {
                const ParticleId lower = span.lower + n, upper = span.upper + n;
                const ConnectionArrays& c = m.connection[span.direction];
                const Vec3 way = m.particle_position.at(upper) - m.particle_position.at(lower);
                const Vec3 speed = m.particle_velocity.at(upper) - m.particle_velocity.at(lower);
                const double k = stiffness * double(c.weight[lower]);
                const double rest = length * (1 + c.plastic_of(lower));
                const double gone2 = (step * speed).squaredNorm();
                const double turn = 0.5 * gone2 * std::max(0.0, 1 - gone2 / way.squaredNorm());
                const double stretch = (step * speed.dot(way) - turn) / way.norm() / length;
                double tension = spring_tension(SpringDamper{k, 0, rest}, way.norm(), 0.0);
                for (int j = 0; j < branches.count; ++j) {
                    const auto [keep, gain] = steps.forward[j];
                    tension += k * length * (keep * gain + gain) * stretch;
                    const double square = k * length * length * gain * stretch * stretch;
                    first += 0.5 * square;
                    second += 0.5 * (2 + keep) * square;
                }
                const Vec3 pull = tension / way.norm() * way;
                pulls.add(lower, pull), pulls.add(upper, -pull);
                if (k > 0) largest = std::max(largest, way.norm() / rest - 1);
            }
        }
        Vec3Array expected;
        for (int width : {8, 4, 2}) {
            limit_vector_width(width);
            std::vector<float> strain(sweep.branch_floats(branches.count), 0.0f);
            steps.strain = &strain;
            Vec3Array f;
            for (const double work : {first, second}) {
                CHECK(sweep.forces(m, nullptr, f, &steps, 0.999 * largest) ==
                      Approx(work).epsilon(1e-5));
            }
            CHECK(farthest_apart(f, pulls) < 1e-6 * stiffness * m.lattice.spacing);
            if (width == 8) expected = f;
            CHECK(same_bytes(f, expected));
            std::size_t stretched = 0;
            for (const auto& slab : sweep.stretched_runs()) stretched += slab.size();
            CHECK(stretched > 0);
            CHECK(stretched < 20);
        }
        limit_vector_width(0);
    }
}

TEST_CASE("forces inside a body of any outline are in balance, over however many slabs") {
    const double size = GENERATE(7.3, 9.1, 11.7, 14.2);  // cells from the middle
    const bool plate = GENERATE(false, true);
    const Vec3 tilt = Vec3(1, .31, .47).normalized();
    const auto distance = [&](const Vec3& p) {
        return plate ? std::max(p.norm() - 1.8 * size, std::abs(p.dot(tilt)) - 3) : p.norm() - size;
    };
    const int cells = static_cast<int>(std::ceil((plate ? 3.6 : 2) * size)) + 2;
    Aggregate m =
        test::make_shape(distance, Vec3::Constant(-0.5 * cells + 0.13), Vec3i::Constant(cells), 1);
    REQUIRE(m.particle_count() > 1500);
    deform(m, 0.03);
    const double stiffness = lattice_stiffness(m);
    Vec3Array pulls;
    pulls.resize(m.particle_count());
    for (const Span& span : m.lattice.span) {
        const double length = reference_length(m.lattice, span.direction);
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            const Vec3 way = m.particle_position.at(upper) - m.particle_position.at(lower);
            const double k = stiffness * double(m.connection[span.direction].weight[lower]);
            const Vec3 pull =
                spring_tension(SpringDamper{k, 0, length}, way.norm(), 0.0) / way.norm() * way;
            pulls.add(lower, pull), pulls.add(upper, -pull);
        }
    }
    CHECK(farthest_apart(forces_of(m), pulls) < 1e-9 * stiffness);
}

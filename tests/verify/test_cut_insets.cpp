// SPDX-License-Identifier: GPL-3.0-or-later
// What a blade leaves of a body of two materials: springs as stiff as what they run through.
#include <random>

#include "geometry/box_mesh.h"
#include "mold/mold.h"
#include "sim/lattice_forces.h"
#include "sim/rest_lengths.h"
#include "sim/sever.h"
#include "tests/catch.h"
#include "tests/sim/force_checks.h"
#include "tests/sim/shake.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.25;

// Along a plane that holds its length.
void cut(Aggregate& m) {
    const double far = 10, y = 0.4;
    sever(m,
          crossed_connections(m, {{Vec3(-far, y, -far), Vec3(far, y, -far), Vec3(far, y, far)},
                                  {Vec3(-far, y, -far), Vec3(far, y, far), Vec3(-far, y, far)}}));
}

// A bar, of another material from `boundary` on.
Aggregate cut_bar(const Material& left, const Material& right, double boundary,
                  bool severed = true) {
    MoldSettings settings;
    settings.spacing = kSpacing;
    const Vec3 size(4, 1, 0.75);
    std::vector<Inset> insets;
    if (boundary < size.x()) insets = {{box_mesh({boundary, 0, 0}, size), right}};
    Aggregate m = mold(box_mesh(Vec3::Zero(), size), left, settings, insets);
    if (severed) cut(m);
    return m;
}

Material with_modulus(double modulus) { return {.young_modulus = modulus, .poisson_ratio = 0.25}; }

double largest_of(const Vec3Array& f) {
    double largest = 0;
    for (std::size_t p = 0; p < f.size(); ++p) largest = std::max(largest, f.at(p).norm());
    return largest;
}

}  // namespace

TEST_CASE("a cut bar of two materials keeps each part's stiffness") {
    const double boundary = 2;  // between cells
    const Material soft = with_modulus(1e5), stiff = with_modulus(3e7);
    Aggregate both = cut_bar(soft, stiff, boundary), left = cut_bar(soft, soft, 9),
              right = cut_bar(stiff, stiff, 9);
    REQUIRE(both.particle_count() == left.particle_count());
    Vec3Array f[3];
    int n = 0;
    for (Aggregate* m : {&both, &left, &right}) {
        test::shake(*m, 0.05 * kSpacing);
        LatticeForces(*m).find(*m, Flow::trial, f[n++]);
    }
    int seen = 0;
    for (std::size_t p = 0; p < both.particle_count(); ++p) {
        const double x = both.particle_reference.at(p).x() - boundary;
        if (std::abs(x) < 0.1 * kSpacing) continue;
        const Vec3 alone = f[x < 0 ? 1 : 2].at(p);
        CHECK((f[0].at(p) - alone).norm() <= 1e-9 * alone.norm());
        ++seen;
    }
    CHECK(seen > 200);
}

TEST_CASE("a cut bar of two materials pushes by minus the gradient of its energy") {
    Material soft = with_modulus(1e5), stiff = with_modulus(3e6);
    soft.yield_stress = 500, stiff.yield_stress = 5e3, stiff.hardening = 1e5;
    for (bool flowed : {false, true}) {
        // The boundary in the midst of cells.
        Aggregate m = cut_bar(soft, stiff, 2.1, false);
        REQUIRE(!m.mixed_cell.empty());
        test::shake(m, 0.02 * kSpacing);
        if (flowed) CHECK(LatticeForces(m).commit(m).plastic > 0);
        m.material.yield_stress = m.inset[0].yield_stress = 1e9;  // and no more
        cut(m);
        LatticeForces forces(m);
        Vec3Array f;
        forces.find(m, Flow::none, f);
        const double largest = largest_of(f), h = 1e-4 * kSpacing;
        for (std::size_t p = 0; p < m.particle_count(); p += 3) {
            const double slope = test::energy_slope(forces, m, p, 0, h);
            CHECK(std::abs(f.x[p] + slope) < 1e-7 * largest);
        }
    }
}

TEST_CASE("the bound on stiffness is above the stiffest motion of a cut bar of two materials") {
    Aggregate m = cut_bar(with_modulus(1e5), with_modulus(3e7), 2.1);
    LatticeForces forces(m);
    const std::vector<double> bound = forces.stiffness_bound(m);
    // Power iteration on the stiffness by the bound.
    const Vec3Array rest = m.particle_position;
    Vec3Array way, f;
    way.resize(m.particle_count());
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> draw(-1, 1);
    for (std::size_t p = 0; p < way.size(); ++p) {
        way.set(p, {draw(engine), draw(engine), draw(engine)});
    }
    const double h = 1e-7 * kSpacing;
    double most = 0;
    for (int round = 0; round < 80; ++round) {
        const double scale = 1 / largest_of(way);
        for (std::size_t p = 0; p < way.size(); ++p) {
            way.set(p, scale * way.at(p));
            m.particle_position.set(p, rest.at(p) + h * way.at(p));
        }
        forces.find(m, Flow::trial, f);
        double over = 0, under = 0;
        for (std::size_t p = 0; p < way.size(); ++p) {
            over -= way.at(p).dot(f.at(p)) / h;
            under += bound[p] * way.at(p).squaredNorm();
            way.set(p, -1 / (h * bound[p]) * f.at(p));
        }
        most = over / under;
    }
    CHECK(most < 1);
    CHECK(most > 0.3);
}

TEST_CASE("what flowed before the cut stays bent after it, across the boundary too") {
    const Vec3 strain(1e-3, -4e-4, -6e-4);
    Material yields = with_modulus(1e6), stiff = with_modulus(1e7);
    yields.yield_stress = stiff.yield_stress = 1e3;
    double left[2];
    for (int flowed : {0, 1}) {
        Aggregate m = cut_bar(yields, stiff, 2.1);
        for (std::size_t p = 0; p < m.particle_count(); ++p) {
            const Vec3 grown = strain.array().exp();
            m.particle_position.set(p, grown.cwiseProduct(m.particle_reference.at(p)));
        }
        if (flowed != 0) {
            m.cell_history.assign(m.cell_fill.size());
            m.cell_history.hardening().assign(m.cell_fill.size(), 1e-3f);
            for (int i = 0; i < 3; ++i) {
                const float e = static_cast<float>(std::expm1(-strain[i]));
                m.cell_history.row[i].assign(m.cell_fill.size(), e);
                for (MixedCell& cell : m.mixed_cell) cell.flowed[0][i] = cell.flowed[1][i] = e;
            }
        }
        Vec3Array f;
        LatticeForces(m).find(m, Flow::none, f);
        left[flowed] = largest_of(f);
    }
    CHECK(left[1] < 2e-3 * left[0]);
}

TEST_CASE(
    "where a blade severs a cell of two materials that has flowed, it is at rest as it lies") {
    Material soft = with_modulus(1e5), stiff = with_modulus(3e6);
    soft.yield_stress = stiff.yield_stress = 1e9;
    for (bool flowed : {false, true}) {
        Aggregate m = cut_bar(soft, stiff, 2.1, false);
        test::shake(m, 0.02 * kSpacing);
        LatticeForces forces(m);
        for (MixedCell& cell : m.mixed_cell) cell.flowed[0].back() = flowed ? 1e-3f : 0.0f;
        cut(m);
        forces.connections_changed(m, true);
        int severed = 0;
        for (const MixedCell& cell : m.mixed_cell) {
            const auto corner = m.lattice.cell_corners(cell.cell);
            if (cell_is_whole(m, {corner[0], corner[2], corner[4], corner[6]})) continue;
            ++severed;
            const CellSet* set = m.set_of(cell.cell);
            REQUIRE((set != nullptr) == flowed);
            if (!flowed) continue;
            const SlotLengths rest = rest_lengths(m, cell.cell, &cell);
            for (int slot = 0; slot < kCellConnectionCount; ++slot) {
                const CellConnection& c = kCellConnection[slot];
                const ParticleId lower = corner[c.corner], upper = corner[upper_corner(c)];
                if (m.connection[c.direction].weight[lower] <= 0) continue;
                const Vec3 way = m.particle_position.at(upper) - m.particle_position.at(lower);
                CHECK(rest[slot] * (1 + set->strain[slot]) == Approx(way.norm()).epsilon(1e-6));
            }
        }
        CHECK(severed > 0);
    }
}

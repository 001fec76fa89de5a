// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <random>

#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/body_contact.h"
#include "sim/cell_place.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;

namespace {

// What a body says of a place to a point that begins to meet it there.
struct Met {
    CellPlace at;
    bool is_known = false;
    RestSurface::Depth depth{};
};

Met met(ContactSide& side, const Vec3& x) {
    const Lattice& lattice = side.matter().lattice;
    double nearest = std::numeric_limits<double>::infinity();
    Met found;
    CellPlace& at = found.at;
    for (CellId cell : side.rim()) {
        const Vec3i site = lattice.cell_site(cell);
        const Vec3 middle =
            lattice.origin + lattice.spacing * (site.cast<double>() + Vec3::Constant(0.5));
        if (!side.is_whole(cell) || (middle - x).squaredNorm() >= nearest) continue;
        nearest = (middle - x).squaredNorm();
        at.cell = cell;
        at.site = site;
    }
    const auto particle = lattice.cell_corners(at.cell);
    for (int c = 0; c < 8; ++c) at.corner[c] = side.patch().slot_of(particle[c]);
    CellCorners corner(side.patch(), at);
    for (int c = 0; c < 8; ++c) {
        corner.copy[c] = side.patch().motion_of(particle[c]);
        corner.now[c] = &corner.copy[c];
    }
    CellGradient gradient;
    found.is_known = find_place(side, vec4(x), at, corner, gradient) && side.may_hold(at.cell);
    if (found.is_known) found.depth = side.depth(at.site, at.cell, at.place);
    return found;
}

// How deep it says that the place lies; infinite where it does not meet it.
double met_depth(ContactSide& side, const Vec3& x) {
    const Met found = met(side, x);
    if (!found.is_known) return -std::numeric_limits<double>::infinity();
    return -found.depth.distance / found.depth.gradient.norm();
}

}  // namespace

TEST_CASE("what goes into a body from any side meets it at its surface, not deep in it at once",
          "[stress]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    double worst = 0;
    double early = 0;
    int met = 0;
    for (const double angle : {0.3, 0.55}) {
        TriMesh mesh = make_shape("bar", {{"length", 0.1}, {"height", 0.1}, {"width", 0.1}}).mesh;
        const Mat3 turn = Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()).toRotationMatrix();
        for (Vec3& x : mesh.position) x = turn * x;
        MoldSettings settings;
        settings.across = 8;
        Aggregate matter = mold(mesh, {}, settings);
        const double a = matter.lattice.spacing;
        ContactSide side(matter, false, nullptr);
        for (int n = 0; n < 1500; ++n) {
            const std::size_t p = random() % matter.surface.size();
            const Vec3 normal = matter.surface.normal(p);
            const Vec3 foot =
                matter.surface_reference(p) + 0.3 * a * Vec3(any(random), any(random), any(random));
            double depth = -1, above = 0;
            for (double way = 0.4; way > -0.4 && !(depth > 0); way -= 0.004) {
                const Vec3 x = foot + way * a * normal;
                depth = met_depth(side, x);
                above = ((turn.transpose() * x).cwiseAbs().maxCoeff() - 0.05) / a;
            }
            if (!(depth > 0)) continue;
            ++met;
            worst = std::max(worst, depth);
            early = std::max(early, above);
        }
    }
    CHECK(met > 2000);
    CHECK(worst < 0.02);
    CHECK(early < 0.06);
}

namespace {

// By how much depth jumps at most between both sides of the planes between cells, about the cells
// that look at a cut through (cut, 0, 0) [cells].
double worst_jump(const char* shape, double cut, double lean, int& places) {
    MoldSettings settings;
    settings.across = 5;
    Aggregate matter = mold(make_shape(shape, {}).mesh, {}, settings);
    const Lattice& lattice = matter.lattice;
    const double a = lattice.spacing;
    test::sever_plane(matter, Vec3(cut * a, 0, 0), Vec3(1, lean, 0).normalized());
    ContactSide side(matter, false, nullptr);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-0.45, 1.45);
    double worst = 0;
    for (CellId cell : side.rim()) {
        const Vec3i site = lattice.cell_site(cell);
        bool looks_at_cut = false;
        for (int face = 0; face < 6; ++face) {
            const Vec3i step = Vec3i::Unit(face >> 1) * (face & 1 ? 1 : -1);
            const CellId next = lattice.cell_at(site + step);
            looks_at_cut = looks_at_cut || (next >= 0 && !side.is_whole(next));
        }
        if (!looks_at_cut || !side.is_whole(cell)) continue;
        for (int n = 0; n < 30; ++n) {
            Vec3 place(any(random), any(random), any(random));
            const auto at = [&](double p) {
                place[n % 3] = p;
                return met(side, lattice.origin + a * (site.cast<double>() + place));
            };
            const double plane = n / 3 % 2;
            const Met before = at(plane - 1e-5), after = at(plane + 1e-5);
            if (!before.is_known || !after.is_known) continue;
            ++places;
            worst = std::max(worst, std::abs(std::min(before.depth.distance, 0.0) -
                                             std::min(after.depth.distance, 0.0)));
        }
    }
    return worst;
}

}  // namespace

// Slivers beyond the last cells, in which it is guessed by one cell, jump by as much.
TEST_CASE("where a cut meets a body's surface depth does not jump from one cell to the next",
          "[stress]") {
    const double lean = GENERATE(0., 0.2);
    int places = 0;
    CHECK(worst_jump("calf", 2.3, lean, places) < 0.05);
    CHECK(places > 500);
}

TEST_CASE("what slides from one cell to the next beside a cut is not pressed in by another guess",
          "[stress]") {
    MoldSettings settings;
    settings.across = 5;
    Aggregate matter = mold(make_shape("calf", {}).mesh, {}, settings);
    const double a = matter.lattice.spacing;
    test::sever_plane(matter, Vec3(2.3 * a, 0, 0), Vec3::UnitX());
    // Where a sliver ends, that cell says that a place lies outside and the next one that it is in.
    const Vec3i site(10, 8, 3);
    Aggregate block = test::make_block(1, 1, 1, 0.1 * a, {});
    const auto stand = [&](double x) {
        const Vec3 low = matter.lattice.origin + a * (site.cast<double>() + Vec3(x, 0.49, 1.065));
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            const Vec3 at = block.particle_reference.at(p) - block.particle_reference.at(0) + low;
            block.particle_position.set(p, at);
        }
    };
    SimSettings sim;
    sim.solver = Solver::explicit_steps;
    BodyContact contact({&matter, &block}, sim);
    const std::vector<char> awake = {0, 0};
    std::vector<Vec3Array> force(2);
    const auto stored = [&] {
        force[0].resize(matter.particle_count()), force[1].resize(block.particle_count());
        std::vector<ContactSums> sums;
        contact.add_forces({&force[0], &force[1]}, Vec3::Zero(), 1e-6, awake, sums);
        contact.commit(awake);
        return sums[0].stored + sums[1].stored;
    };
    stand(0.85);
    contact.renew_all(awake);
    REQUIRE(contact.candidates() > 0);
    const double grazes = stored();
    stand(1.01);  // nobody has pushed it: it has no speed
    CHECK(stored() < 2 * grazes);
}

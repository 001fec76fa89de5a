// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <random>

#include "geometry/make_shape.h"
#include "mold/mold.h"
#include "sim/cell_place.h"
#include "tests/catch.h"

using namespace swage;

namespace {

// How deep a body says that a place lies, as a point that begins to meet it there would be told;
// infinite where it does not meet it.
double met_depth(ContactSide& side, const Vec3& x) {
    const Lattice& lattice = side.matter().lattice;
    double nearest = std::numeric_limits<double>::infinity();
    CellPlace at;
    for (CellId cell : side.rim()) {
        const Vec3i site = lattice.cell_site(cell);
        const Vec3 middle =
            lattice.origin + lattice.spacing * (site.cast<double>() + Vec3::Constant(0.5));
        if ((middle - x).squaredNorm() >= nearest) continue;
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
    if (!find_place(side, vec4(x), at, corner, gradient) || !side.may_hold(at.cell)) {
        return -std::numeric_limits<double>::infinity();
    }
    const RestSurface::Depth depth = side.depth(at.site, at.cell, at.place);
    return -depth.distance / depth.gradient.norm();
}

}  // namespace

TEST_CASE("what goes into a body from any side meets it at its surface, not deep in it at once") {
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

// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces without a whole cell that hold matter only here and there.
#include "sim/thin_piece.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

TEST_CASE("of a thin piece nothing is inside that lies outside of what was molded, however far") {
    // A slab whose upper face rises by 0.08 in its last cells, cut level so that only at one end
    // there is matter above; and a second time along it.
    constexpr double kCell = 0.1, kCut = 0.35, kSlope = 0.08;
    const bool is_parted = GENERATE(false, true);
    const auto outside_of_slab = [](const Vec3& x) {  // all in cells
        return std::max({(x.z() - 0.3 - kSlope * x.x()) / std::sqrt(1 + kSlope * kSlope),
                         std::abs(x.x()) - 6, std::abs(x.y()) - 3, -4 - x.z()});
    };
    Aggregate slab = make_shape([&](const Vec3& x) { return kCell * outside_of_slab(x / kCell); },
                                kCell * Vec3(-7, -4, -5), Vec3i(14, 8, 7), kCell);
    sever_plane(slab, Vec3(0, 0, kCut * kCell), Vec3::UnitZ());
    if (is_parted) sever_plane(slab, Vec3(0, 0.3 * kCell, 0), Vec3::UnitY());
    const RestSurface molded(slab);
    const ThinNear near(slab);
    int pieces = 0, outside = 0, inside = 0;
    for (const std::vector<ParticleId>& particles : thin_pieces(slab)) {
        const std::unique_ptr<ThinPiece> piece = ThinPiece::find(slab, molded, near, particles);
        if (!piece) continue;
        ++pieces;
        const std::unique_ptr<ContactSide> side = piece->contact_side();
        const Aggregate& matter = piece->matter();
        for (const CellRun& run : matter.lattice.cell_run) {
            for (int n = 0; n < run.count; ++n) {
                const Vec3i site(run.i + n, run.j, run.k);
                for (int c = 0; c < 125; ++c) {
                    const Vec3 place(0.25 * (c % 5), 0.25 * (c / 5 % 5), 0.25 * (c / 25));
                    const Vec3 at = matter.lattice.origin / kCell + site.cast<double>() + place;
                    const double off = std::max(outside_of_slab(at), kCut - at.z());
                    const double told = side->depth(site, static_cast<CellId>(run.first + n), place,
                                                    Eigen::Vector3f::Zero())
                                            .distance;
                    INFO(at.transpose() << ", " << off << " outside, told " << told);
                    if (off > 0.3) CHECK(told >= 0);
                    outside += off > 0.3;
                    inside += off < -0.1 && told < 0;
                }
            }
        }
    }
    CHECK(pieces == (is_parted ? 2 : 1));
    CHECK(outside > 50);
    CHECK(inside > 10);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>
#include <set>

#include "base/math.h"
#include "matter/aggregate.h"
#include "matter/open_faces.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;

namespace {

// A shape with holes and gaps in its rows.
std::vector<Vec3i> ring_of_cells() {
    std::vector<Vec3i> cells;
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 5; ++j) {
            for (int i = 0; i < 6; ++i) {
                if (j >= 1 && j <= 3 && i >= 2 && i <= 3) continue;
                cells.emplace_back(i, j, k);
            }
        }
    }
    return cells;
}

}  // namespace

TEST_CASE("every active cell finds its own corners, also across holes") {
    const auto cells = ring_of_cells();
    const Lattice lattice = make_lattice(Vec3::Zero(), 1.0, Vec3i(6, 5, 2), cells);
    std::vector<Vec3i> site;
    for (const ParticleRun& run : lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) site.emplace_back(run.i + n, run.j, run.k);
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
        CHECK(lattice.cell_at(cells[c]) == static_cast<int>(c));
        CHECK(lattice.cell_site(static_cast<CellId>(c)) == cells[c]);
        const auto corner = lattice.cell_corners(static_cast<CellId>(c));
        for (int n = 0; n < 8; ++n) {
            CHECK(site[corner[n]] == cells[c] + Vec3i(n & 1, n >> 1 & 1, n >> 2 & 1));
        }
    }
    CHECK(lattice.cell_at(2, 2, 0) == -1);
    CHECK(lattice.cell_at(-1, 0, 0) == -1);
    CHECK(lattice.cell_at(6, 0, 0) == -1);
}

TEST_CASE("spans hold each pair of neighbouring particles exactly once") {
    const Lattice lattice = make_lattice(Vec3::Zero(), 1.0, Vec3i(6, 5, 2), ring_of_cells());
    std::vector<Vec3i> site;
    for (const ParticleRun& run : lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) site.emplace_back(run.i + n, run.j, run.k);
    }
    std::set<std::pair<int, int>> seen;
    for (const Span& span : lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const Vec3i way = site[span.upper + n] - site[span.lower + n];
            const auto& f = kForward[span.direction];
            CHECK(way == Vec3i(f[0], f[1], f[2]));
            CHECK(seen.insert({span.lower + n, span.upper + n}).second);
        }
    }
    std::size_t expected = 0;
    for (std::size_t a = 0; a < site.size(); ++a) {
        for (std::size_t b = 0; b < site.size(); ++b) {
            for (const auto& f : kForward) expected += site[b] - site[a] == Vec3i(f[0], f[1], f[2]);
        }
    }
    CHECK(seen.size() == expected);
}

TEST_CASE("a body without connections across a plane is two pieces") {
    Aggregate m = test::make_block(6, 2, 2, 0.1, Material{});
    CHECK(find_pieces(m).count == 1);
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const double from = m.particle_reference.at(span.lower + n).x();
            const double to = m.particle_reference.at(span.upper + n).x();
            if ((from < 0.05) != (to < 0.05)) {
                m.connection[span.direction].weight.set(span.lower + n, 0);
            }
        }
    }
    const Pieces pieces = find_pieces(m);
    CHECK(pieces.count == 2);
    CHECK(pieces.particle_piece.front() == 0);
    CHECK(pieces.particle_piece[6] == 1);
}

TEST_CASE("which cells are whole is the same asked of all at once and one by one") {
    Aggregate m = test::make_block(21, 19, 23, 0.1, Material{});
    std::mt19937 random(1);
    for (const int more : {0, 1, 40, 4000}) {
        for (int n = 0; n < more; ++n) {
            const Span& span = m.lattice.span[random() % m.lattice.span.size()];
            m.connection[span.direction].weight.set(
                span.lower + random() % static_cast<unsigned>(span.count), 0);
        }
        const std::vector<char> whole = whole_cells(m);
        REQUIRE(whole.size() == m.cell_fill.size());
        std::size_t wrong = 0, broken = 0;
        for (std::size_t c = 0; c < whole.size(); ++c) {
            const auto cell = static_cast<CellId>(c);
            wrong += cell_is_whole(m, m.lattice.cell_row(cell)) != (whole[c] != 0);
            broken += whole[c] == 0;
        }
        CHECK(wrong == 0);
        CHECK((broken > 0) == (more > 0));
    }
}

TEST_CASE("the state hash sees every bit that a later step depends on") {
    const Aggregate m = test::make_block(2, 2, 2, 0.1, Material{});
    Aggregate other = m;
    CHECK(state_hash(m) == state_hash(other));
    other.particle_position.x[3] = std::nextafter(other.particle_position.x[3], 1.0);
    CHECK(state_hash(m) != state_hash(other));
    other = m;
    for (auto& c : other.connection) c.plastic.resize(m.particle_count());
    CHECK(state_hash(m) == state_hash(other));  // none is all zero
    other.connection[4].plastic[0] = 1e-30f;
    CHECK(state_hash(m) != state_hash(other));
}

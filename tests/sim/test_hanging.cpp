// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs by a hinge is told from what is held.
#include <cmath>
#include <utility>

#include "sim/hanging.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1;

// 12 x 3 x 3 cells along x, from -0.6 to 0.6.
Aggregate bar() { return make_block(12, 3, 3, kSpacing, {}); }

// What still joins both sides of a cut: a hinge about the left side's lowest or highest line of
// particles along z, or all connections but one of each cell.
enum class Left { low_hinge, high_hinge, most };

bool stays(Left left, int direction, double y) {
    const bool crosses = direction == 3 || direction == 4;  // the ways across x and y
    switch (left) {
        case Left::low_hinge: return crosses ? direction == 3 && y < -0.099 : y < -0.149;
        case Left::high_hinge: return crosses ? direction == 4 && y > 0.099 : y > 0.149;
        case Left::most: return direction != 3;
    }
    return false;
}

// In the middle of the cells at x.
void cut(Aggregate& m, double x, Left left) {
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const Vec3 a = m.particle_reference.at(span.lower + n),
                       b = m.particle_reference.at(span.upper + n);
            if ((a.x() < x) == (b.x() < x)) continue;
            if (stays(left, span.direction, 0.5 * (a + b).y())) continue;
            m.connection[span.direction].weight.set(span.lower + n, 0);
        }
    }
}

std::vector<HeldPoint> held_beyond(const Aggregate& m, double left, double right) {
    std::vector<HeldPoint> held;
    const auto beyond = [&](const Vec3& x) { return x.x() < left || x.x() > right; };
    for (int point : points_where(m, beyond)) {
        held.push_back(held_point(m.surface, point, 1e4 * Mat3::Identity()));
    }
    return held;
}

// How many particles hang, and where their middle is along x.
std::pair<int, double> hanging(const Aggregate& m, const std::vector<HeldPoint>& held) {
    const Pieces firm = find_firm_pieces(m, held);
    std::vector<char> hangs(static_cast<std::size_t>(firm.count), 0);
    for (int n : find_hanging(m, find_pieces(m), firm, held)) hangs[n] = 1;
    int count = 0;
    double middle = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        if (!hangs[firm.particle_piece[p]]) continue;
        ++count;
        middle += m.particle_reference.at(p).x();
    }
    return {count, count > 0 ? middle / count : 0.0};
}

}  // namespace

TEST_CASE("a door hangs, and what is joined in every direction does not") {
    for (Left left : {Left::low_hinge, Left::high_hinge, Left::most}) {
        Aggregate m = bar();
        cut(m, 0.05, left);
        const auto held = held_beyond(m, -0.59, 1);
        CHECK(find_firm_pieces(m, held).count == 2);
        const auto [count, middle] = hanging(m, held);
        CHECK(count == (left == Left::most ? 0 : 6 * 16));
        if (count > 0) CHECK(middle == Approx(0.35));
        // Nothing moves against what holds both sides.
        CHECK(hanging(m, held_beyond(m, -0.59, 0.59)).first == 0);
        // Where nothing is held all go together, unless there is a hinge.
        CHECK(hanging(m, {}).first == (left == Left::most ? 0 : 13 * 16));
    }
    Aggregate whole = bar();
    CHECK(find_firm_pieces(whole, {}).count == 1);
    CHECK(hanging(whole, {}).first == 0);
}

TEST_CASE("an arch of three hinges stands, one of four does not") {
    Aggregate m = bar();
    cut(m, -0.35, Left::low_hinge);
    cut(m, 0.35, Left::high_hinge);
    CHECK(hanging(m, held_beyond(m, -0.59, 0.59)).first == 0);
    // Held at one end it falls.
    const auto [all, middle] = hanging(m, held_beyond(m, -0.59, 1));
    CHECK(all == 10 * 16);
    CHECK(middle == Approx(0.15));
    cut(m, -0.15, Left::low_hinge);
    CHECK(hanging(m, held_beyond(m, -0.59, 0.59)).first == 0);
    cut(m, 0.15, Left::high_hinge);
    CHECK(find_firm_pieces(m, {}).count == 5);
    const auto [count, between] = hanging(m, held_beyond(m, -0.59, 0.59));
    CHECK(count == 7 * 16);
    CHECK(std::abs(between) < 1e-9);
}

TEST_CASE("a particle of no whole cell hangs by less than three ways, or not at all") {
    for (int ways : {0, 1, 2, 3}) {
        Aggregate m = bar();
        const auto corner = static_cast<ParticleId>(m.particle_count() - 1);
        int kept = 0;
        for (const Span& span : m.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                if (span.upper + n != corner && span.lower + n != corner) continue;
                const bool stays = span.direction < kEdgeCount && kept < ways;
                kept += stays;
                if (!stays) m.connection[span.direction].weight.set(span.lower + n, 0);
            }
        }
        REQUIRE(kept == ways);
        const auto [count, middle] = hanging(m, held_beyond(m, -0.59, 1));
        CHECK(count == (ways < 3));
        if (count > 0) CHECK(middle == Approx(0.6));
    }
}

TEST_CASE("what has no whole cell is firm where it is joined in every direction") {
    Aggregate m = bar();
    // Of every cell one connection is gone, of the way 3 across.
    m.connection[3].weight = SparseArray<float>(m.particle_count(), 0.0f);
    CHECK(find_firm_pieces(m, {}).count < 20);
    CHECK(hanging(m, held_beyond(m, -0.59, 1)).first == 0);
}

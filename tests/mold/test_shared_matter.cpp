// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/shared_matter.h"

#include <map>

#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kCell = 0.1 * 0.1 * 0.1;

// What each part of `from` shares with each of `to`, in cells.
std::map<std::pair<int, int>, double> shares_of(const Aggregate& from, const Aggregate& to) {
    std::map<std::pair<int, int>, double> found;
    for_each_shared(from, matter_parts(from), to, matter_parts(to), [&](const SharedMatter& one) {
        found[{one.from, one.to}] += one.volume / kCell;
    });
    return found;
}

Aggregate cells_at(const Vec3& origin, const Vec3i& count) {
    std::vector<Vec3i> cells;
    for (int k = 0; k < count.z(); ++k) {
        for (int j = 0; j < count.y(); ++j) {
            for (int i = 0; i < count.x(); ++i) cells.emplace_back(i, j, k);
        }
    }
    return make_matter(origin, 0.1, count, cells, std::vector<float>(cells.size(), 1));
}

}  // namespace

TEST_CASE("matter is shared with what lies where it is, all of it though it stick out a little") {
    const Aggregate anew = make_block(6, 2, 2, 0.1, {});
    // How far it is moved along x, in cells; beyond 5 none of the last cell lies in a new one.
    for (const double far : {0.0, 0.25, 1.0, 1.25}) {
        Aggregate old = make_block(6, 2, 2, 0.1, {});
        deform(old, [&](const Vec3& x) { return Vec3(x + Vec3(0.1 * far, 0, 0)); });
        const auto shared = shares_of(old, anew);
        for (int c = 0; c < 24; ++c) {
            INFO("cell " << c << " moved by " << far);
            double sum = 0;
            for (int to = 0; to < 24; ++to) {
                const auto at = shared.find({c, to});
                const double share = at == shared.end() ? 0 : at->second;
                sum += share;
                // What sticks out goes to the end of its own row.
                double wanted = 0;
                if (to / 6 == c / 6) {
                    const double low = c % 6 + far, high = low + 1;
                    wanted =
                        std::max(0.0, std::min(high, to % 6 + 1.0) - std::max(low, to % 6 + 0.0));
                    if (to % 6 == 5 && low < 7) wanted += std::max(0.0, high - std::max(low, 6.0));
                }
                CHECK(share == Approx(wanted).margin(1e-9));
            }
            CHECK(sum == Approx(1).epsilon(1e-9));
        }
    }
    Aggregate away = make_block(6, 2, 2, 0.1, {});
    deform(away, [](const Vec3& x) { return Vec3(x + Vec3(0.72, 0, 0)); });
    CHECK(shares_of(away, anew).empty());
}

TEST_CASE("what fills a part of a turned cell is as thin along the new axes as it lies there") {
    // A quarter of a cell at its low face along x, which the turn makes y.
    Aggregate old = make_matter({-0.05, -0.05, -0.05}, 0.1, {1, 1, 1}, {{0, 0, 0}}, {0.25f});
    old.cell_centroid = SparseArray<Eigen::Vector3f>(1, Eigen::Vector3f(-0.375f, 0, 0));
    Mat3 turn;
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    deform(old, [&](const Vec3& x) { return Vec3(turn * x); });
    // It lies from -0.05 to -0.025 along y: new cells end at -0.0245.
    const Aggregate anew = cells_at({-0.05, -0.1245, -0.05}, {1, 2, 1});
    const auto shared = shares_of(old, anew);
    REQUIRE(shared.size() == 1);
    CHECK(shared.at({0, 0}) == Approx(0.25));
}

TEST_CASE("each side of a torn cell is shared with what lies where that side is") {
    Aggregate old = make_block(5, 2, 2, 0.1, {});
    sever_plane(old, Vec3(0.01, 0, 0), Vec3::UnitX());
    Mat3 turn;
    turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    for (std::size_t p = 0; p < old.particle_count(); ++p) {
        const Vec3 at = old.particle_reference.at(p);
        if (at.x() > 0) old.particle_position.set(p, turn * at + Vec3(0.5, 0, 0));
    }
    // Its right side from 0 to 0.05 along y: whole in that cell whose other half lies before or
    // beyond that.
    const double low = GENERATE(-0.1, -0.15);
    const Aggregate anew = cells_at({0.4, low, -0.1}, {2, 4, 2});
    const auto shared = shares_of(old, anew);
    for (int k : {0, 1}) {
        for (int j : {0, 1}) {
            INFO("row " << j << ", layer " << k << ", new cells from " << low);
            const int torn = 2 + 5 * j + 10 * k, there = (1 - j) + 2 * 1 + 8 * k;
            double sum = 0;
            for (int to = 0; to < 16; ++to) {
                const auto at = shared.find({torn, to});
                const double share = at == shared.end() ? 0 : at->second;
                CHECK(share == Approx(to == there ? 0.5 : 0).margin(1e-9));
                sum += share;
            }
            CHECK(sum == Approx(0.5).epsilon(1e-9));
        }
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <set>

#include "base/units.h"
#include "geometry/box_mesh.h"
#include "mold/mold.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kRoot = 10, kLength = 40, kProng = 10;

// Two prongs along x, one above the other, that hang together below kRoot.
TriMesh fork_mesh(double gap) {
    const double low = kProng, high = kProng + gap, top = 2 * kProng + gap;
    const std::vector<Vec2> outline = {{0, 0},        {kLength, 0},    {kLength, low}, {kRoot, low},
                                       {kRoot, high}, {kLength, high}, {kLength, top}, {0, top}};
    TriMesh mesh;
    for (double z : {0.0, kProng}) {
        for (const Vec2& p : outline) mesh.position.push_back({p.x(), p.y(), z});
    }
    for (const Corners& t :
         std::vector<Corners>{{0, 1, 3}, {1, 2, 3}, {0, 3, 4}, {0, 4, 7}, {4, 5, 6}, {4, 6, 7}}) {
        mesh.triangle.push_back({t[0], t[2], t[1]});
        mesh.triangle.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    }
    for (int n = 0; n < 8; ++n) {
        const int next = (n + 1) % 8;
        mesh.triangle.push_back({n, next, next + 8});
        mesh.triangle.push_back({n, next + 8, n + 8});
    }
    return mesh;
}

// What the mold tells of gaps that its cells fill; nothing if there are none.
std::string told_of_gap(const TriMesh& mesh, double spacing, Aggregate* matter = nullptr) {
    MoldSettings settings;
    settings.spacing = spacing;
    std::vector<std::string> told;
    Aggregate molded = mold(mesh, {}, settings, {}, &told);
    if (matter != nullptr) *matter = std::move(molded);
    for (const std::string& line : told) {
        if (line.find("a gap in the mesh") != std::string::npos) return line;
    }
    return {};
}
bool tells(const TriMesh& mesh, Aggregate* matter = nullptr) {
    return !told_of_gap(mesh, 1, matter).empty();
}

// Whether the prongs share a particle or a cell well beyond their root.
bool hangs_together(const Aggregate& matter, double middle) {
    std::set<ParticleId> side[2];
    for (CellId cell = 0; cell < CellId(matter.cell_fill.size()); ++cell) {
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        const Vec3 low = matter.particle_reference.at(corner[0]);
        if (low.x() < kRoot + 1) continue;
        if (low.y() < middle - 1e-6 && low.y() + 1 > middle + 1e-6) return true;
        side[low.y() + 0.5 > middle].insert(corner.begin(), corner.end());
    }
    return std::ranges::any_of(side[0], [&](ParticleId p) { return side[1].contains(p); });
}

}  // namespace

TEST_CASE("a gap that cells fill is told, and one that they keep open is not") {
    int open = 0, filled = 0;
    for (double gap = 0.3; gap < 3.1; gap += 0.23) {
        INFO("a gap of " << gap << " cells");
        Aggregate matter;
        const bool told = tells(fork_mesh(gap), &matter);
        const bool joined = hangs_together(matter, kProng + 0.5 * gap);
        CHECK(told == joined);
        ++(joined ? filled : open);
    }
    CHECK(open > 2);
    CHECK(filled > 2);
}

TEST_CASE("the spacing that is said to keep a gap open does") {
    int told = 0;
    for (double gap = 0.913; gap < 2; gap += 0.0217) {
        const std::string line = told_of_gap(fork_mesh(gap), 1);
        if (line.empty()) continue;
        INFO(gap << ": " << line);
        ++told;
        const std::string before = "spacing = \"";
        const std::size_t at = line.find(before);
        REQUIRE(at != std::string::npos);
        const std::string advised = line.substr(
            at + before.size(), line.find('"', at + before.size()) - at - before.size());
        const double spacing = parse_quantity(advised, Quantity::length);
        CHECK(spacing <= 0.5 * gap * (1 + 1e-6));
        CHECK(told_of_gap(fork_mesh(gap), spacing) == "");
    }
    CHECK(told > 20);
}

TEST_CASE("a gap is told of however it lies to the cells, and no wide one is") {
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 2, 3)}) {
        for (double angle : {0.3, 0.7, 1.2}) {
            const Pose turned{Quat(Eigen::AngleAxisd(angle, axis.normalized())),
                              Vec3(0.3, 0.2, 0.1)};
            INFO("about " << axis.transpose() << " by " << angle);
            CHECK(tells(moved(fork_mesh(0.5), turned)));
            CHECK_FALSE(tells(moved(fork_mesh(3.5), turned)));  // more than 2 along any diagonal
        }
    }
}

TEST_CASE("what has no gap is not said to have one, however thin or askew") {
    const Pose askew{Quat(Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized())), Vec3(0.3, 0.2, 0.1)};
    CHECK_FALSE(tells(sphere_mesh(4.3, 4)));
    CHECK_FALSE(tells(torus_mesh(9, 2.2, 60, 24)));
    for (double thick : {1.05, 1.3, 3.1}) {
        CAPTURE(thick);
        const TriMesh plate = box_mesh({0, 0, 0}, {20, 15, thick});
        CHECK_FALSE(tells(plate));
        CHECK_FALSE(tells(moved(plate, askew)));
        CHECK_FALSE(tells(moved(box_mesh({0, 0, 0}, {20, thick, thick}), askew)));
    }
    // A groove of less than a cell's depth is no gap.
    const TriMesh shallow = fork_mesh(0.5);
    TriMesh groove = shallow;
    for (Vec3& p : groove.position) {
        if (p.x() == kRoot) p.x() = kLength - 0.5;
    }
    CHECK_FALSE(tells(groove));
}

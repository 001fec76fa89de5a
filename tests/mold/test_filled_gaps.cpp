// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>
#include <set>

#include "base/units.h"
#include "geometry/box_mesh.h"
#include "mold/filled_gaps.h"
#include "mold/mold.h"
#include "mold/prepare.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kRoot = 10, kLength = 40, kProng = 10;

// What stands on an outline in x and y, z from 0 to `high`; `face` are its triangles.
TriMesh prism(const std::vector<Vec2>& outline, const std::vector<Corners>& face, double high) {
    const int count = static_cast<int>(outline.size());
    TriMesh mesh;
    for (double z : {0.0, high}) {
        for (const Vec2& p : outline) mesh.position.push_back({p.x(), p.y(), z});
    }
    for (const Corners& t : face) {
        mesh.triangle.push_back({t[0], t[2], t[1]});
        mesh.triangle.push_back({t[0] + count, t[1] + count, t[2] + count});
    }
    for (int n = 0; n < count; ++n) {
        const int next = (n + 1) % count;
        mesh.triangle.push_back({n, next, next + count});
        mesh.triangle.push_back({n, next + count, n + count});
    }
    return mesh;
}

// Two prongs along x, one above the other, that hang together below kRoot.
TriMesh fork_mesh(double gap, double thick = kProng) {
    const double low = kProng, high = kProng + gap, top = 2 * kProng + gap;
    return prism({{0, 0},
                  {kLength, 0},
                  {kLength, low},
                  {kRoot, low},
                  {kRoot, high},
                  {kLength, high},
                  {kLength, top},
                  {0, top}},
                 {{0, 1, 3}, {1, 2, 3}, {0, 3, 4}, {0, 4, 7}, {4, 5, 6}, {4, 6, 7}}, thick);
}

// A block with a notch from above that narrows to nothing.
TriMesh notch_mesh(double wide, double deep) {
    return prism({{0, 0},
                  {40, 0},
                  {40, 20},
                  {20 + wide / 2, 20},
                  {20, 20 - deep},
                  {20 - wide / 2, 20},
                  {0, 20}},
                 {{0, 1, 4}, {1, 2, 3}, {1, 3, 4}, {0, 4, 6}, {4, 5, 6}}, 12);
}

// What the mold says of a gap that its cells fill; nothing: there is none.
std::string told_of(const TriMesh& mesh, double spacing = 1, Aggregate* matter = nullptr) {
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
    return !told_of(mesh, 1, matter).empty();
}

bool advises(const std::string& told) { return told.find("keeps it open") != std::string::npos; }

// Whether the prongs of a fork that stands so share a particle beyond what hangs together.
bool share_particles(const Aggregate& matter, const Pose& fork, double gap) {
    constexpr int kPlaces = 8;      // of a cell, along each axis
    constexpr double kReach = 0.9;  // of a cell, from its middle, and some more
    const Pose back = fork.inverse();
    std::set<ParticleId> side[2];
    for (CellId cell = 0; cell < CellId(matter.cell_fill.size()); ++cell) {
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        const Vec3 low = matter.particle_reference.at(corner[0]);
        const Vec3 middle = back * Vec3(low + Vec3::Constant(0.5));
        if (middle.x() < kRoot + 4 - kReach) continue;
        const bool reaches[2] = {middle.y() < kProng + kReach, middle.y() > kProng + gap - kReach};
        bool holds[2] = {false, false};
        for (int n = 0; n < kPlaces * kPlaces * kPlaces; ++n) {
            if (holds[0] >= reaches[0] && holds[1] >= reaches[1]) break;  // all that it can
            const Vec3i step(n % kPlaces, n / kPlaces % kPlaces, n / kPlaces / kPlaces);
            const Vec3 p = back * Vec3(low + (step.cast<double>() + Vec3::Constant(0.5)) / kPlaces);
            if (p.x() < kRoot + 4 || p.x() > kLength || p.z() < 0 || p.z() > kProng) continue;
            holds[0] |= p.y() > 0 && p.y() < kProng;
            holds[1] |= p.y() > kProng + gap && p.y() < 2 * kProng + gap;
        }
        for (int s : {0, 1}) {
            if (holds[s]) side[s].insert(corner.begin(), corner.end());
        }
    }
    return std::ranges::any_of(side[0], [&](ParticleId p) { return side[1].contains(p); });
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
        const std::string line = told_of(fork_mesh(gap), 1);
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
        CHECK(told_of(fork_mesh(gap), spacing) == "");
    }
    CHECK(told > 20);
}

TEST_CASE("a gap askew to the cells wants finer ones, by how far they reach across it") {
    for (const Vec3& across : {Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(1, 2, 0), Vec3(1, -1, 1)}) {
        INFO("across " << across.transpose());
        const Pose pose{Quat(Quat::FromTwoVectors(Vec3(0, 1, 0), across)), Vec3::Zero()};
        const TriMesh mesh = moved(fork_mesh(1.2), pose);
        const MoldFrame frame = frame_over(box_of(mesh.position), 1);
        const std::vector<FilledGap> gaps = filled_gaps(mesh, share_cells(mesh, frame), frame);
        REQUIRE(gaps.size() == 1);
        CHECK(gaps[0].width == Approx(1.2).epsilon(0.02));
        const double reach = across.normalized().lpNorm<1>();
        CHECK(gaps[0].spacing == Approx(1.2 / (2 * reach)).epsilon(0.02));
    }
}

TEST_CASE("without its lattice a mold tells the same of gaps") {
    TriMesh open = fork_mesh(1.2);
    open.triangle.pop_back();
    for (const TriMesh& mesh :
         {fork_mesh(0.3), fork_mesh(1.2), fork_mesh(2.4), notch_mesh(3, 12), open}) {
        for (const double spacing : {1.0, 0.7}) {
            MoldSettings settings;
            settings.spacing = spacing;
            CHECK(filled_gap_text(mesh, settings) == told_of(mesh, spacing));
            settings.kind = MoldKind::block;
            CHECK(filled_gap_text(mesh, settings) == "");
        }
    }
    CHECK(told_of(open) != "");
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

TEST_CASE("a gap aslant to the cells is told of as far as they join its sides", "[stress]") {
    const auto normal_to = [](const Vec3& way) {
        return Pose{Quat(Quat::FromTwoVectors(Vec3(0, 1, 0), way)), Vec3(0.3, 0.2, 0.1)};
    };
    std::vector<Pose> poses = {normal_to({-1, 1, 0}), normal_to({1, 1, 1}), normal_to({0, 1, 1}),
                               normal_to({-1, 2, 1})};
    std::mt19937 random(5);
    const auto next = [&] { return static_cast<double>(random() % 1000) / 500 - 1; };
    for (int n = 0; n < 12; ++n) {
        const Quat turn(next(), next(), next(), next());
        poses.push_back({turn.normalized(), Vec3(0.3, 0.2, 0.1)});
    }
    for (const Pose& pose : poses) {
        const Vec3 normal = pose.rotation * Vec3(0, 1, 0);
        for (double gap : {0.3, 0.5, 0.8, 1.2}) {
            INFO("a gap of " << gap << " cells across " << normal.transpose());
            CHECK(tells(moved(fork_mesh(gap), pose)));
        }
        for (double gap : {1.7, 2.3, 2.9, 3.5}) {
            INFO("a gap of " << gap << " cells across " << normal.transpose());
            Aggregate matter;
            const bool told = tells(moved(fork_mesh(gap), pose), &matter);
            CHECK(told == share_particles(matter, pose, gap));
        }
    }
}

TEST_CASE("a slot through a sheet of one cell is told of") {
    for (double thick : {1.0, 1.4, 2.0}) {
        CAPTURE(thick);
        CHECK(tells(fork_mesh(1.5, thick)));
        CHECK_FALSE(tells(fork_mesh(3.1, thick)));
    }
}

TEST_CASE("of a gap that closes up no spacing is said to keep it open") {
    const std::string open = told_of(fork_mesh(0.8));
    CHECK(advises(open));
    for (double wide : {1.0, 2.0, 4.0, 10.0}) {
        INFO("a notch " << wide << " cells wide");
        const std::string notch = told_of(notch_mesh(wide, 12));
        CHECK(!notch.empty());
        CHECK_FALSE(advises(notch));
    }
    // Prongs that touch: two sides in one place.
    const std::string shut = told_of(fork_mesh(0));
    CHECK(!shut.empty());
    CHECK_FALSE(advises(shut));
    CHECK(shut.find("touch") != std::string::npos);
}

TEST_CASE("where parts of a mesh cross is no gap") {
    // Two bars across each other, one askew.
    const Pose askew{Quat(Eigen::AngleAxisd(0.6, Vec3(0, 0, 1))), Vec3(0.3, 0.2, 0.1)};
    CHECK_FALSE(tells(together(box_mesh({0, 0, 0}, {30, 8, 8}),
                               moved(box_mesh({10, -12, 1.3}, {16, 18, 6.7}), askew))));
}

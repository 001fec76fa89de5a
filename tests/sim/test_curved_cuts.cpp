// SPDX-License-Identifier: GPL-3.0-or-later
// Faces that a blade has laid open whose path is round.
#include <numbers>

#include "sim/contact_side.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/loads_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kA = 0.1;  // a cell

// A cylinder along z, or along another axis.
test::Distance cylinder(const Vec3& middle, const Vec3& axis, double radius) {
    return [=](const Vec3& x) {
        const Vec3 way = x - middle;
        return (way - axis.dot(way) * axis).norm() - radius;
    };
}

}  // namespace

TEST_CASE("faces of a round cut lie on it, and depth is told from there, on both sides") {
    const double radius = GENERATE(6, 9, 14, 20, 40, 100);
    const Vec3 axis = GENERATE(Vec3(0, 0, 1), Vec3(0.3, 0.2, 1)).normalized();
    CAPTURE(radius, axis.transpose());
    Aggregate block = make_block(14, 12, 8, kA, kSpringy);
    const test::Distance cut = cylinder(Vec3(0.13, 0.07 + radius, 0) * kA, axis, radius * kA);
    sever_along(block, cut);
    ContactSide side(block, true, nullptr);
    const auto is_inner = [](const Vec3& x) {
        return (x.cwiseAbs() - kA * Vec3(5, 4, 2)).maxCoeff() < 0;
    };
    int points[2] = {0, 0};
    double worst = 0, turned = 0;
    for (std::size_t p = side.own_points(); p < side.points().size(); ++p) {
        if (!side.meets(int(p)) || side.is_loose(int(p))) continue;
        const Vec3 x = side.points().reference(p, block.particle_reference);
        if (!is_inner(x)) continue;
        worst = std::max(worst, std::abs(cut(x)) / kA);
        const double faces = side.points().normal(p).dot(gradient_of(cut, x, 1e-4 * kA));
        turned = std::max(turned, 1 - std::abs(faces));
        ++points[faces > 0];
    }
    CHECK(worst < 0.01);
    CHECK(turned < 0.001);
    CHECK(points[0] > 30);
    CHECK(points[1] > 30);
    double off[2] = {0, 0}, tilt[2] = {0, 0}, jump = 0;
    int places[2] = {0, 0};
    for (CellId cell : side.rim()) {
        if (!side.is_whole(cell)) continue;
        const Vec3i site = block.lattice.cell_site(cell);
        const Vec3 low = block.lattice.origin + kA * site.cast<double>();
        const double outward = cut(low + kA * Vec3::Constant(0.5)) < 0 ? 1 : -1;
        for (int n = 0; n < 125; ++n) {
            const Vec3 place = 0.3 * Vec3(n % 5, n / 5 % 5, n / 25) - Vec3::Constant(0.1);
            const Vec3 x = low + kA * place;
            const double far = outward * cut(x) / kA;
            if (!is_inner(x) || std::abs(far) > 0.5) continue;
            const auto depth = side.depth(site, cell, place);
            double& worst_off = off[outward > 0];
            worst_off = std::max(worst_off, std::abs(depth.distance - far));
            const Vec3 normal = outward * gradient_of(cut, x, 1e-4 * kA);
            tilt[outward > 0] = std::max(tilt[outward > 0], (depth.gradient - normal).norm());
            ++places[outward > 0];
            for (int d = 0; d < 3; ++d) {  // the neighbour's word on the same place
                const CellId next = block.lattice.cell_at(site + Vec3i::Unit(d));
                if (next < 0 || !side.is_whole(next)) continue;
                const Vec3 there = place - Vec3::Unit(d);
                if (there[d] < -0.3) continue;
                jump = std::max(jump,
                                std::abs(side.depth(site + Vec3i::Unit(d), next, there).distance -
                                         depth.distance));
            }
        }
    }
    CHECK(off[1] < 0.01);
    CHECK(off[0] < 0.01);
    CHECK(tilt[1] < 0.01);
    CHECK(tilt[0] < 0.01);
    CHECK(jump < 0.01);
}

TEST_CASE("a lens cut out of a block swings in its bowl like a pendulum") {
    constexpr double kRadius = 7;  // cells
    Material matter = kSpringy;
    matter.young_modulus = 2e7;
    matter.damping_ratio = 0.05;
    matter.friction = 0;
    Aggregate block = make_block(18, 8, 3, kA, matter);
    const Vec3 middle = Vec3(0.07, 1.6 + kRadius, 0) * kA;
    sever_along(block, cylinder(middle, Vec3::UnitZ(), kRadius * kA));
    const Pieces pieces = find_pieces(block);
    REQUIRE(pieces.count == 2);
    Apparatus apparatus;
    apparatus.grip.push_back(
        hold(block, points_where(block, [&](const Vec3& x) { return x.y() < -0.29; })));
    constexpr double kG = 50, kTilt = 0.07;
    SimSettings settings = motion_settings();
    settings.self_contact = true;
    settings.gravity = kG * Vec3(std::sin(kTilt), -std::cos(kTilt), 0);
    // Of the lens about the bowl's axis.
    const int lens = pieces.particle_piece[std::size_t(block.particle_count()) - 10];
    double inertia = 0, moment = 0;
    const auto turned = [&] {  // mean angle about the axis
        Vec3 sum = Vec3::Zero();
        inertia = 0;
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            if (pieces.particle_piece[p] != lens) continue;
            const Vec3 way = block.particle_position.at(p) - middle;
            sum += block.particle_mass[p] * way;
            inertia += block.particle_mass[p] * (way.x() * way.x() + way.y() * way.y());
        }
        moment = sum.norm();
        return std::atan2(sum.x(), -sum.y());
    };
    const double before = turned();
    const double period = 2 * std::numbers::pi * std::sqrt(inertia / (kG * moment));
    Simulation simulation(block, apparatus, settings);
    constexpr int kFrames = 8;
    FrameReport report;
    for (int f = 0; f < kFrames; ++f) {
        const auto at = [&](int frame) {
            return drive_of(apparatus, 0.5 * period * frame / kFrames, 1);
        };
        report = simulation.advance(at(f), at(f + 1));
        const double expected =
            (kTilt - before) * (1 - std::cos(std::numbers::pi * (f + 1) / kFrames));
        CHECK(turned() - before == Approx(expected).epsilon(0.05).margin(0.003));
    }
    CHECK(std::abs(report.remainder) < 0.01 * report.gravity_work);
}

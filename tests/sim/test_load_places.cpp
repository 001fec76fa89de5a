// SPDX-License-Identifier: GPL-3.0-or-later
// Where loads and gravity act, and the way of what they act on.

#include "sim/load_set.h"
#include "sim/sever.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

std::vector<int> top_of(const Aggregate& matter) {
    return points_where(matter, [](const Vec3& x) { return x.y() > 0.0749; });
}

std::vector<ParticleId> beyond(const Aggregate& matter, double x) {
    std::vector<ParticleId> found;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        if (matter.particle_reference.at(p).x() > x) found.push_back(static_cast<ParticleId>(p));
    }
    return found;
}

void check_way(const std::vector<LoadSum>& from, const std::vector<LoadSum>& to, const Vec3& way) {
    REQUIRE(from.size() == to.size());
    for (std::size_t n = 0; n < from.size(); ++n) {
        INFO("load " << n);
        const Vec3 gone = (to[n].centre - to[n].jump) - (from[n].centre - from[n].jump);
        CHECK((gone - way).norm() < 1e-12);
    }
}

}  // namespace

TEST_CASE("where less of the matter is pushed from now on, nothing has gone any way by that") {
    Aggregate matter = make_block(12, 3, 3, 0.05, kSoft);
    const auto end = points_where(matter, [](const Vec3& x) { return x.x() > 0.2999; });
    Apparatus apparatus;
    apparatus.load.push_back(force_on(matter, top_of(matter), {0, -1, 0}));
    apparatus.load.push_back(force_on(matter, end, {0, -1, 0}));
    Load pressure = pressure_on(matter, 10);
    pressure.point = top_of(matter), pressure.closed = false;
    apparatus.load.push_back(pressure);
    SimSettings settings;
    settings.gravity = {0, -9.81, 0};
    const Drive now = drive_of(apparatus, 1, 1);
    LoadSet loads(apparatus, settings);
    loads.start(matter, now);
    const auto sums = [&] { return loads.sums(matter, now); };
    const auto shift = [&](const Vec3& way) {
        for (std::size_t p = 0; p < matter.particle_count(); ++p)
            matter.particle_position.add(p, way);
    };
    const auto start = sums();
    for (const LoadSum& one : start) CHECK(one.jump.isZero(0));

    // What lies on cells that are cut acts where it did.
    sever_plane(matter, Vec3(0.126, 0, 0), Vec3::UnitX());
    loads.connections_changed(matter);
    const auto cut = sums();
    check_way(start, cut, Vec3::Zero());
    for (int n : {0, 2}) CHECK(cut[n].jump.norm() < 1e-6);
    shift({0.01, 0.02, 0.03});
    check_way(start, sums(), {0.01, 0.02, 0.03});

    // A half is left alone: of the end there is nothing left.
    const auto before = sums();
    loads.leave_alone(matter, beyond(matter, 0.026));
    const auto half = sums();
    check_way(before, half, Vec3::Zero());
    for (int n : {0, 2, 3}) CHECK(half[n].jump.x() < -0.1);
    CHECK(half[1].jump.isZero(0));
    CHECK(half[1].centre == before[1].centre);
    CHECK(half[1].force.isZero(0));
    shift({0, -0.01, 0});
    const auto moved = sums();
    CHECK(moved[1].centre == before[1].centre);
    for (int n : {0, 2, 3}) {
        CHECK(((moved[n].centre - half[n].centre) - Vec3(0, -0.01, 0)).norm() < 1e-12);
    }

    // All is: everything stays where it was.
    loads.leave_alone(matter, beyond(matter, -1));
    shift({1, 1, 1});
    check_way(moved, sums(), Vec3::Zero());
    for (const LoadSum& one : sums()) {
        CHECK(one.force.isZero(0));
        CHECK(one.torque.isZero(0));
    }
    for (int n : {0, 2, 3}) CHECK((sums()[n].centre - moved[n].centre).norm() < 1e-12);
}

TEST_CASE("force along the way of what it acts on is the work, though a piece is left alone") {
    Material material = kSoft;
    material.young_modulus = 5e5;
    Aggregate matter = make_block(12, 3, 3, 0.05, material);
    sever_plane(matter, Vec3(0.026, 0, 0), Vec3::UnitX());
    Apparatus apparatus;
    apparatus.name = "hold";
    apparatus.grip.push_back(
        hold(matter, points_where(matter, [](const Vec3& x) { return x.x() < -0.2999; })));
    apparatus.load.push_back(force_on(matter, top_of(matter), {5, -20, 3}));
    SimSettings settings;
    settings.gravity = {0, -9.81, 0};
    Simulation simulation(matter, apparatus, settings);
    constexpr int kFrames = 4;
    const auto at = [&](int n) { return drive_of(apparatus, n, double(n) / kFrames); };
    std::vector<ToolLoad> last = simulation.loads(at(0));
    std::vector<double> work(last.size(), 0.0);
    for (int n = 1; n <= kFrames; ++n) {
        const FrameReport report = simulation.advance(at(n - 1), at(n));
        REQUIRE(report.warning.size() == (n == 1));  // a piece would fall
        for (std::size_t l = 0; l < last.size(); ++l) {
            const auto place = [](const ToolLoad& load) -> Vec3 {
                return load.pose.translation - load.jump;
            };
            const Vec3 way = place(report.load[l]) - place(last[l]);
            work[l] += 0.5 * (last[l].force + report.load[l].force).dot(way);
        }
        last = report.load;
    }
    REQUIRE(last.size() == 3);
    for (int l : {1, 2}) {
        CHECK(last[l].pose.translation.x() < -0.1);
        CHECK(last[l].work > 1e-4);
        CHECK(work[l] == Approx(last[l].work).epsilon(1e-9));
    }
}

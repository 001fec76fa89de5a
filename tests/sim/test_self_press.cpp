// SPDX-License-Identifier: GPL-3.0-or-later
// A body that comes to rest against itself.
#include <numeric>

#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/given_up.h"
#include "sim/own_overlap.h"
#include "sim/self_contact.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/force_checks.h"
#include "tests/sim/machines.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.05;

Material soft(double friction = 0.3) {
    return {.young_modulus = 1e6, .poisson_ratio = 0.25, .density = 1000, .friction = friction};
}

double box_distance(const Vec3& x, const Vec3& low, const Vec3& high) {
    const Vec3 q = (x - 0.5 * (low + high)).cwiseAbs() - 0.5 * (high - low);
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

// A block of 0.6 x 0.4 x 0.2 m with a slot 0.1 high and 0.4 m deep from one end along x: its arms
// are 0.15 m thick.
Aggregate make_c(const Material& material, bool slot = true) {
    const Vec3 half(0.3, 0.2, 0.1);
    Aggregate m = make_shape(
        [&](const Vec3& x) {
            const double block = box_distance(x, -half, half);
            const double gap = box_distance(x, Vec3(-0.1, -0.05, -1), Vec3(1, 0.05, 1));
            return slot ? std::max(block, -gap) : block;
        },
        -half, Vec3i(12, 8, 4), kSpacing);
    m.material = material;
    return m;
}

SimSettings settings_of(bool meets) {
    SimSettings s;
    s.self_contact = meets;
    s.tolerance = 1e-3;
    return s;
}

struct Pressed {
    std::vector<double> force, overlap;  // of the plate [N]; in spacings
    FrameReport last;
    std::uint64_t hash = 0;
};

// What sever_plane() would sever, load has broken.
void break_plane(Aggregate& m, const Vec3& point, const std::function<bool(const Vec3&)>& where) {
    const Aggregate sound = m;
    sever_plane(m, point, Vec3::UnitY(), where);
    m.cut = sound.cut;
    for (std::size_t d = 0; d < m.connection.size(); ++d) {
        ConnectionArrays& all = m.connection[d];
        all.damage.resize(all.weight.size(), 0.0f);
        for (std::size_t p = 0; p < all.weight.size(); ++p) {
            if (sound.connection[d].weight[p] > 0 && !(all.weight[p] > 0)) all.damage[p] = 1;
        }
    }
}

bool anywhere(const Vec3&) { return true; }
bool at_its_rim(const Vec3& x) { return x.x() > 0.1; }

// Between plates much larger than itself, by `down` of its height in so many frames.
Pressed press(Aggregate& body, double height, double down, int frames,
              const SimSettings& settings) {
    const Press press{height};
    Apparatus apparatus = press.apparatus();
    for (Tool& tool : apparatus.tool) {
        tool.shape = BoxShape{Vec3(3 * height, height, 3 * height), height / 20};
    }
    Simulation simulation(body, apparatus, settings);
    Pressed result;
    for (int f = 0; f < frames; ++f) {
        result.last = simulation.advance(press.drive_at(f, down * f / frames),
                                         press.drive_at(f + 1, down * (f + 1) / frames));
        result.force.push_back(-result.last.load[1].force.y());
        result.overlap.push_back(own_overlap(body) / body.lattice.spacing);
    }
    result.hash = state_hash(body);
    return result;
}

double slope_at(const std::vector<double>& force, std::size_t n) {
    return force[n + 1] - force[n - 1];
}

}  // namespace

TEST_CASE("stiff plates press the block, not their contact") {
    const auto modulus = [](double own, double asked) {
        Aggregate block = make_block(4, 8, 4, 0.1, soft(0));
        SimSettings settings = settings_of(false);
        settings.contact_stiffness = asked;
        const Press press{0.8};
        Apparatus apparatus = press.apparatus();
        for (Tool& tool : apparatus.tool) {
            tool.contact_stiffness = own;
            tool.friction = 0;
        }
        Simulation simulation(block, apparatus, settings);
        const FrameReport r = simulation.advance(press.drive_at(0, 0), press.drive_at(1, 0.001));
        return -r.load[1].force.y() / (0.4 * 0.4) / 0.001 / block.material.young_modulus;
    };
    // Two contacts in series with 8 cells: 1 / (1 + 2 / 8 stiffness).
    CHECK(modulus(0, 0) == Approx(1 / 1.125).epsilon(0.01));
    CHECK(modulus(20, 0) == Approx(1 / 1.0125).epsilon(0.01));
    CHECK(modulus(20, 2) == Approx(1 / 1.125).epsilon(0.01));
}

TEST_CASE("a C pressed shut bears as a block does from then on") {
    Aggregate block = make_c(soft(), false), c = make_c(soft()), ghost = make_c(soft());
    const Pressed whole = press(block, 0.4, 0.1, 4, settings_of(false));
    const Pressed shut = press(c, 0.4, 0.375, 15, settings_of(true));
    const Pressed open = press(ghost, 0.4, 0.375, 15, settings_of(false));
    // Until its arms meet it bears the same, and stiffens by as much as lies on each other then.
    for (std::size_t n = 0; n < 4; ++n) CHECK(shut.force[n] == Approx(open.force[n]).epsilon(2e-3));
    CHECK(open.overlap.back() > 0.8);
    CHECK(shut.overlap.back() < 0.35);
    for (std::size_t n = 0; n < 10; ++n) CHECK(shut.overlap[n] < 0.05);
    INFO("block " << slope_at(whole.force, 2) << ", open " << slope_at(open.force, 12) << ", shut "
                  << slope_at(shut.force, 12));
    CHECK(slope_at(open.force, 12) < 0.6 * slope_at(whole.force, 2));
    CHECK(slope_at(shut.force, 12) == Approx(slope_at(whole.force, 2)).epsilon(0.2));
    CHECK(std::abs(shut.last.remainder) < 3e-3 * shut.last.work);
    CHECK(shut.last.friction > open.last.friction);
}

TEST_CASE("halves of a cut bar bear as the whole one does when pressed together") {
    const auto pressed = [](bool cut, bool meets) {
        Aggregate bar = make_block(5, 8, 5, 0.1, soft());
        if (cut) sever_plane(bar, Vec3(0, 0.05, 0), Vec3::UnitY());
        return press(bar, 0.8, 0.1, 5, settings_of(meets));
    };
    const Pressed whole = pressed(false, false), two = pressed(true, true),
                  ghost = pressed(true, false);
    for (std::size_t n = 0; n < 5; ++n) {
        // What gives in the faces of the cut is a tenth of the bar.
        CHECK(two.force[n] > 0.75 * whole.force[n]);
        CHECK(two.force[n] < whole.force[n]);
        CHECK(two.overlap[n] < 0.08);
        CHECK(ghost.force[n] < 1);
    }
    CHECK(std::abs(two.last.remainder) < 3e-3 * two.last.work);
}

TEST_CASE("what a blade has parted is met by its faces, half a cell before what is whole") {
    for (const double by : {-0.02, 0.01, 0.03, 0.06, 0.1}) {
        Aggregate bar = make_block(5, 8, 5, 0.1, soft());
        sever_plane(bar, Vec3(0, 0.05, 0), Vec3::UnitY());
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            if (bar.particle_reference.at(p).y() > 0.05) bar.particle_position.y[p] -= by;
        }
        CHECK(own_overlap(bar) == Approx(std::max(by, 0.0)).margin(1e-9));
    }
}

TEST_CASE("a cut body that cracks elsewhere still meets itself in the cut") {
    const Vec3 cut(0, 0.05, 0), crack(0, 0.25, 0);
    const auto pressed = [&](bool cracks, bool meets) {
        Aggregate bar = make_block(5, 8, 5, 0.1, soft());
        sever_plane(bar, cut, Vec3::UnitY());
        if (cracks) break_plane(bar, crack, at_its_rim);
        return press(bar, 0.8, 0.1, 5, settings_of(meets));
    };
    const Pressed sound = pressed(false, true), cracked = pressed(true, true),
                  ghost = pressed(true, false);
    for (std::size_t n = 0; n < 5; ++n) {
        CHECK(cracked.force[n] > 0.9 * sound.force[n]);
        CHECK(cracked.force[n] < 1.01 * sound.force[n]);
        CHECK(ghost.force[n] < 1);
    }
    CHECK(std::abs(cracked.last.remainder) < 3e-3 * cracked.last.work);
}

TEST_CASE("whether faces meet while they are shut is told for each of them") {
    const Vec3 low(0, -0.25, 0), high(0, 0.25, 0);
    const auto overlap = [&](bool is_cut, double low_by, double high_by) {
        Aggregate bar = make_block(5, 8, 5, 0.1, soft());
        if (is_cut) sever_plane(bar, low, Vec3::UnitY());
        if (!is_cut) break_plane(bar, low, anywhere);
        break_plane(bar, high, anywhere);
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            const double y = bar.particle_reference.at(p).y();
            if (y < low.y()) bar.particle_position.y[p] += low_by;
            if (y > high.y()) bar.particle_position.y[p] -= high_by;
        }
        return own_overlap(bar);
    };
    // A crack presses by itself while it is shut, a cut does not.
    CHECK(overlap(false, 0.04, 0.04) == 0);
    CHECK(overlap(true, 0, 0.04) == Approx(0).margin(1e-9));
    CHECK(overlap(true, 0.04, 0) == Approx(0.04).margin(1e-9));
    CHECK(overlap(true, 0.02, 0.04) == Approx(0.02).margin(1e-9));
}

TEST_CASE("forces of a body on itself are the slope of their energy, and in balance") {
    Aggregate c = make_c(soft(0));
    // The arms go through each other, most at their ends, askew and ruffled.
    for (std::size_t p = 0; p < c.particle_count(); ++p) {
        const Vec3 x = c.particle_reference.at(p);
        const double side = x.y() > 0 ? 1 : -1, out = std::max(0.0, x.x() + 0.1);
        c.particle_position.add(
            p, Vec3(0.02 * std::sin(40 * x.z()), -side * 0.2 * out + 0.004 * std::sin(31 * x.x()),
                    0.01 * side + 0.003 * std::cos(57 * x.y())));
    }
    SelfContact self(c, settings_of(true));
    Vec3Array force;
    force.resize(c.particle_count());
    self.add_forces(force);
    REQUIRE(self.sums().contacts > 100);
    const auto [sum, moment, size] = balance_of(c, force);
    CHECK(sum.norm() < 1e-8 * size);  // weights are floats
    CHECK(moment.norm() < 1e-8 * size);
    Vec3Array unused;
    unused.resize(c.particle_count());
    const double h = 1e-4 * kSpacing;
    int pressed = 0;
    for (std::size_t p = 0; p < c.particle_count(); p += 7) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto stored = [&](const Aggregate&) {
                self.add_forces(unused);
                return self.sums().stored;
            };
            const double slope = slope_of(stored, c, p, axis, h);
            CHECK(force.at(p)[axis] == Approx(-slope).margin(1e-5 * size / 100));
            pressed += std::abs(slope) > 1e-3 * size;
        }
    }
    CHECK(pressed > 10);
}

TEST_CASE("points that are let be meet their body no more, whatever is taken back") {
    Aggregate c = make_c(soft());
    SelfContact self(c, settings_of(true));
    const auto shut = [&](double by) {  // each arm, at its end
        for (std::size_t p = 0; p < c.particle_count(); ++p) {
            const Vec3 x = c.particle_reference.at(p);
            const double out = std::max(0.0, x.x() + 0.1) / 0.4;
            c.particle_position.set(p, x - Vec3(0, (x.y() > 0 ? 1 : -1) * by * out, 0));
        }
    };
    self.begin_move();
    shut(0.05 + 0.3 * kSpacing);
    REQUIRE(self.presses());
    const int all = static_cast<int>(self.pressed().size());
    const double deepest = self.sums().penetration;
    REQUIRE(all > 20);
    for (const PressedPlaces& both : self.pressed()) {
        double apart = 0;  // along y
        for (int n = 0; n < 16; ++n) {
            apart += both.weight[n] * c.particle_position.at(both.particle[n]).y();
        }
        CHECK(std::accumulate(both.weight.begin(), both.weight.end(), 0.0) ==
              Approx(0).margin(1e-6));
        CHECK(std::abs(apart) < 1e-6);  // the same place
        CHECK(both.stiffness > 0);
    }
    CHECK(self.let_be(2 * deepest) == 0);
    const int deep = self.let_be(0.5 * deepest);
    CHECK(deep > 0);
    CHECK(deep < all);
    CHECK(self.let_be(0.5 * deepest) == 0);
    shut(0);  // where it began
    self.take_back();
    shut(0.05 + 0.3 * kSpacing);
    REQUIRE(self.presses());
    CHECK(self.pressed().size() == std::size_t(all - deep));
    CHECK(self.sums().penetration < 0.7 * deepest);
    // Others go on meeting it.
    shut(0.05 + 0.5 * kSpacing);
    REQUIRE(self.presses());
    CHECK(self.sums().penetration > 0.8 * deepest);
}

TEST_CASE(
    "a try that is taken back leaves contact as it was, but for what points held that are let be") {
    for (const bool lets_be : {true, false}) {
        Aggregate bar = make_block(5, 8, 5, 0.1, soft());
        sever_plane(bar, Vec3(0, 0.05, 0), Vec3::UnitY());
        SelfContact self(bar, settings_of(true));
        const auto press = [&](double by) {  // most at one side
            for (std::size_t p = 0; p < bar.particle_count(); ++p) {
                const Vec3 x = bar.particle_reference.at(p);
                const double down = x.y() > 0.05 ? by * (x.x() + 0.35) : 0;
                bar.particle_position.set(p, x - Vec3(0, down, 0));
            }
        };
        press(0.05);
        REQUIRE(self.presses());
        self.commit();
        const double held = self.sums().stored;
        self.begin_move();
        press(0.1);
        REQUIRE(self.presses());
        REQUIRE(self.sums().stored > 3 * held);
        if (lets_be) REQUIRE(self.let_be(0.6 * self.sums().penetration) > 0);
        press(0.05);
        const double gone = self.take_back();
        // All the same where nothing is found anew before it is asked.
        CHECK(self.sums().stored == Approx(held - gone).epsilon(1e-12));
        CHECK((gone > 0.3 * held) == lets_be);
        CHECK(gone < 0.95 * held);
        REQUIRE(self.presses());
        CHECK(self.sums().stored == Approx(held - gone).epsilon(1e-9));
    }
}

TEST_CASE("what points held that are let be is booked, and no error") {
    Aggregate bar = make_block(5, 8, 5, 0.1, soft());
    sever_plane(bar, Vec3(0, 0.05, 0), Vec3::UnitY());
    bar.cut.clear();  // nobody knows where the blade went: it is lost sooner where it goes on
    SimSettings settings = settings_of(true);
    settings.contact_stiffness = 0.5;
    settings.iteration_limit = 100;
    settings.halving_limit = 0;
    const Press press{0.8};
    const Apparatus apparatus = press.apparatus();
    Simulation simulation(bar, apparatus, settings);
    FrameReport held;
    for (int f = 0; f < 5; ++f) {
        held =
            simulation.advance(press.drive_at(f, 0.03 * f), press.drive_at(f + 1, 0.03 * (f + 1)));
    }
    REQUIRE(held.contact > 100);
    REQUIRE(std::abs(held.remainder) < 3e-3 * held.work);
    // So far at once that it comes to rest nowhere, and stays.
    FrameReport after;
    try {
        after = simulation.advance(press.drive_at(5, 0.15), press.drive_at(6, 0.4));
    } catch (const GivenUp& given_up) {
        after = given_up.report();
    }
    REQUIRE(after.elastic == held.elastic);
    CHECK(after.contact < 0.7 * held.contact);
    CHECK(after.set_free == Approx(held.contact - after.contact).epsilon(1e-6));
    CHECK(after.remainder == Approx(held.remainder).epsilon(1e-3));
}

TEST_CASE("what presses in a fold goes on without a jump as its sides slide along each other",
          "[stress]") {
    // The strip lies on itself; the crease, at rest 2 cells thick, is drawn along the upper side.
    Aggregate strip = make_block(40, 2, 4, kSpacing, soft(0));
    const auto stored = [&](double slide) {
        deform(strip, [&](const Vec3& x) -> Vec3 {
            const double s = x.x() - slide, thick = x.y() + kSpacing;
            if (s < 0) return Vec3(s, thick, x.z());
            return Vec3(-s, -thick + 0.3 * kSpacing, x.z());
        });
        SelfContact self(strip, settings_of(true));
        Vec3Array force;
        force.resize(strip.particle_count());
        self.add_forces(force);
        return self.sums().stored;
    };
    double last = stored(0), most = 0, largest = 0;
    for (double slide = 0.01; slide < 2; slide += 0.01) {
        const double now = stored(slide * kSpacing);
        most = std::max(most, std::abs(now - last));
        largest = std::max(largest, now);
        last = now;
    }
    INFO("largest " << largest << ", jumps by " << most);
    CHECK(largest > 0);
    CHECK(most < 0.02 * largest);
}

TEST_CASE("a body pressed against itself has the same bits at any thread count") {
    std::vector<std::uint64_t> hash;
    for (int threads : {1, 2, 3}) {
        set_thread_count(threads);
        Aggregate c = make_c(soft());
        hash.push_back(press(c, 0.4, 0.2, 4, settings_of(true)).hash);
    }
    set_thread_count(0);
    CHECK(hash[0] == hash[1]);
    CHECK(hash[0] == hash[2]);
}

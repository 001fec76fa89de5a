// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"
#include "sim/contact_side.h"
#include "sim/own_overlap.h"
#include "sim/sever.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/kinetic_energy.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

Material soft() {
    return {.young_modulus = 1e6, .poisson_ratio = 0.25, .density = 1000, .damping_ratio = 0};
}

// A strip along x into a U whose legs, 0.1 thick, are 0.3 apart.
void bend_to_u(Aggregate& strip) {
    const double bend = 0.2, arc = std::numbers::pi * bend;
    deform(strip, [&](const Vec3& x) -> Vec3 {
        const double s = x.x(), y = x.y();
        if (std::abs(s) < arc / 2) {
            const double angle = s / bend;
            return Vec3((bend - y) * std::cos(angle), (bend - y) * std::sin(angle), x.z());
        }
        const double side = s < 0 ? -1 : 1;
        return Vec3(-(std::abs(s) - arc / 2), side * (bend - y), x.z());
    });
}

}  // namespace

TEST_CASE("a strip that folds onto itself does not pass through itself") {
    Material m = soft();
    m.young_modulus = 2e5;
    for (bool meets : {true, false}) {
        Aggregate strip = make_block(48, 2, 4, 0.05, m);
        SimSettings settings = motion_settings();
        settings.self_contact = meets;
        bend_to_u(strip);  // its legs go for each other
        for (std::size_t p = 0; p < strip.particle_count(); ++p) {
            const Vec3 x = strip.particle_position.at(p);
            if (x.x() < -0.2) strip.particle_velocity.set(p, Vec3(0, x.y() < 0 ? 2.5 : -2.5, 0));
        }
        const Apparatus nothing;
        Simulation simulation(strip, nothing, settings);
        double nearest = 1;
        for (int f = 0; f < 40; ++f) {
            simulation.advance(still(0.006 * f), still(0.006 * (f + 1)));
            double low = 0, high = 0;  // of the last quarter of each leg
            int count = 0;
            for (std::size_t p = 0; p < strip.particle_count(); ++p) {
                const double s = strip.particle_reference.at(p).x();
                if (std::abs(s) < 0.9) continue;
                (s < 0 ? low : high) += strip.particle_position.y[p];
                ++count;
            }
            nearest = std::min(nearest, 2 * (high - low) / count);
        }
        INFO("nearest " << nearest);
        CHECK((nearest > 0.05) == meets);
    }
}

TEST_CASE("a body that has gone into itself is told how deep, a bent one is not") {
    Aggregate strip = make_block(48, 2, 4, 0.05, soft());
    CHECK(own_overlap(strip) == 0);
    bend_to_u(strip);
    CHECK(own_overlap(strip) < 0.01);
    for (std::size_t p = 0; p < strip.particle_count(); ++p) {
        if (strip.particle_position.x[p] > -0.2) continue;
        double& y = strip.particle_position.y[p];
        y -= y < 0 ? -0.165 : 0.165;
    }
    CHECK(own_overlap(strip) == Approx(0.03).margin(0.005));
}

TEST_CASE("pieces after a cut do not pass through each other") {
    Material m = soft();
    for (bool meets : {true, false}) {
        Aggregate block = make_block(5, 8, 5, 0.1, m);
        sever_plane(block, Vec3(0, 0.05, 0), Vec3::UnitY());
        REQUIRE(find_pieces(block).count == 2);
        SimSettings settings = motion_settings();
        settings.self_contact = meets;
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            if (block.particle_reference.at(p).y() > 0.05) {
                block.particle_velocity.set(p, Vec3(0, -3, 0));
            }
        }
        const double start = kinetic_energy(block);
        const Apparatus nothing;
        Simulation simulation(block, nothing, settings);
        double nearest = 1;
        FrameReport r;
        for (int f = 0; f < 50; ++f) {
            r = simulation.advance(still(0.004 * f), still(0.004 * (f + 1)));
            double top = 0, foot = 0;
            int tops = 0, feet = 0;
            for (std::size_t p = 0; p < block.particle_count(); ++p) {
                const bool up = block.particle_reference.at(p).y() > 0.05;
                (up ? top : foot) += block.particle_position.y[p];
                ++(up ? tops : feet);
            }
            nearest = std::min(nearest, top / tops - foot / feet);
        }
        INFO("nearest " << nearest << ", energy " << (r.kinetic + r.elastic) / start);
        CHECK((nearest > 0.3) == meets);
        CHECK(r.kinetic + r.elastic < 1.01 * start);
    }
}

TEST_CASE("pieces after a cut do not pass through each other either where one has cracked") {
    std::vector<double> nearest;
    for (const bool cracks : {false, true}) {
        Aggregate block = make_block(5, 8, 5, 0.1, soft());
        sever_plane(block, Vec3(0, 0.05, 0), Vec3::UnitY());
        if (cracks) {  // one edge at its top
            for (ConnectionArrays& all : block.connection) all.damage.resize(all.weight.size());
            const ParticleId last = static_cast<ParticleId>(block.particle_count()) - 2;
            block.connection[0].weight.set(last, 0);
            block.connection[0].damage[last] = 1;
        }
        SimSettings settings = motion_settings();
        settings.self_contact = true;
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            if (block.particle_reference.at(p).y() > 0.05) {
                block.particle_velocity.set(p, Vec3(0, -1, 0));
            }
        }
        const Apparatus nothing;
        Simulation simulation(block, nothing, settings);
        double least = 1;
        for (int f = 0; f < 20; ++f) {
            simulation.advance(still(0.004 * f), still(0.004 * (f + 1)));
            double gap = 0;  // of the particles beside the cut
            int count = 0;
            for (std::size_t p = 0; p < block.particle_count(); ++p) {
                const double y = block.particle_reference.at(p).y() - 0.05;
                if (std::abs(y) > 0.06) continue;
                gap += (y > 0 ? 1 : -1) * block.particle_position.y[p];
                count += y > 0;
            }
            least = std::min(least, gap / count);
        }
        nearest.push_back(least);
    }
    INFO("sound " << nearest[0] << ", cracked " << nearest[1]);
    CHECK(nearest[0] > 0.03);
    CHECK(nearest[1] == Approx(nearest[0]).epsilon(0.02));
}

TEST_CASE("what is connected to a point is the same, told break by break or all at once") {
    const Aggregate sound = make_block(30, 6, 12, 0.05, soft());
    Aggregate block = sound;
    ContactSide side(block, true, nullptr);
    const auto check = [&](const char* what) {
        side.connections_changed();
        Aggregate same = block;
        const ContactSide anew(same, true, nullptr);
        REQUIRE(anew.own_points() == side.own_points());
        int differ = 0, neighbours = 0;
        for (int p = 0; p < static_cast<int>(side.own_points()); ++p) {
            const Vec3 at = (side.points().reference(std::size_t(p), block.particle_reference) -
                             block.lattice.origin) /
                            block.lattice.spacing;
            const Vec3i middle = at.array().floor().cast<int>();
            for (int n = 0; n < 9 * 9 * 9; ++n) {
                const Vec3i site = middle + Vec3i(n % 9, n / 9 % 9, n / 81) - Vec3i::Constant(4);
                differ += side.is_neighbour(p, site) != anew.is_neighbour(p, site);
                neighbours += side.is_neighbour(p, site);
            }
        }
        INFO(what);
        CHECK(differ == 0);
        return neighbours;
    };
    const int all = check("whole");
    const auto cut = [&](double x, double z) {
        sever_plane(block, Vec3(x, 0, 0), Vec3::UnitX(),
                    [&](const Vec3& at) { return at.z() < z; });
    };
    cut(-0.5, 1);
    const int once = check("one cut, right through");
    CHECK(once < all);
    cut(0.21, -0.1);
    cut(0.21, 0.02);
    const int twice = check("another, half way");
    CHECK(twice < once);
    // A slit is gone round within reach of its end, and not beyond.
    cut(0.21, 0.2);
    CHECK(check("and through") < twice);
    block.connection = sound.connection;
    CHECK(check("all taken back") == all);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What stays in the remainder of the books when two random blocks collide: of 1 to 6 cells along
// each axis, any size, place, turn, spin, stiffness, density, friction and restitution. Each case
// is drawn from its number. `bench_collisions [CASES [STEP_SAFETY]]` prints the worst, and what
// half of all and 19 of 20 stay below.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "base/error.h"
#include "sim/advance.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr int kFrames = 40;

struct Collision {
    double remainder = 0;  // the most, over the energy at first
    double contact = 0;    // the most that contacts held, likewise
    long rejected = 0;
    std::string about, stopped;
};

class Draw {
  public:
    explicit Draw(int number) : random_(static_cast<std::uint32_t>(number)) {}
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(random_() >> 5) / double(1u << 27));
    }
    double scaled(double low, double high) {
        return std::exp(between(std::log(low), std::log(high)));
    }
    int cells() { return 1 + static_cast<int>(random_() % 6); }
    Vec3 vector() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
    Quat turn() {
        const Eigen::Vector4d q(between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1));
        return Quat(q.normalized());
    }

  private:
    std::mt19937 random_;
};

double set_off(Aggregate& m, const Vec3& velocity, const Vec3& spin) {
    const Vec3 centre = m.centre();
    double energy = 0;
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 v = velocity + spin.cross(m.particle_position.at(p) - centre);
        m.particle_velocity.set(p, v);
        energy += 0.5 * m.particle_mass[p] * v.squaredNorm();
    }
    return energy;
}

Collision collide(int number, double safety) {
    Draw draw(number);
    Material one = kSpringy;
    one.restitution = draw.between(0, 1) < 0.3 ? 1 : draw.between(0, 1);
    one.friction = draw.between(0, 1) < 0.3 ? 0 : draw.between(0, 0.8);
    one.poisson_ratio = draw.between(0, 0.45);
    Material other = one;
    other.young_modulus *= draw.scaled(0.3, 3);
    other.density *= draw.scaled(0.3, 3);
    const double size[] = {0.1, draw.scaled(0.04, 0.3)};
    std::vector<Aggregate> block;
    double reach[2];
    Collision result;
    for (int b = 0; b < 2; ++b) {
        const Vec3i n(draw.cells(), draw.cells(), draw.cells());
        const double spacing = size[b] / n.maxCoeff();
        block.push_back(make_block(n.x(), n.y(), n.z(), spacing, b == 0 ? one : other));
        reach[b] = 0.5 * spacing * n.cast<double>().norm();
        result.about +=
            fmt::format("{} x {} x {} of {:.3g} mm, ", n.x(), n.y(), n.z(), 1e3 * spacing);
    }
    const Vec3 toward = draw.vector().normalized();
    place(block[0], {draw.turn(), Vec3::Zero()});
    place(block[1], {draw.turn(), toward * (reach[0] + reach[1] + 0.01) +
                                      0.3 * std::min(reach[0], reach[1]) * draw.vector()});
    const double speed = draw.scaled(0.5, 4), mass = block[0].mass() + block[1].mass();
    const double energy =
        set_off(block[0], speed * block[1].mass() / mass * toward, 10 * draw.vector()) +
        set_off(block[1], -speed * block[0].mass() / mass * toward, 10 * draw.vector());
    result.about += fmt::format("{:.3g} m/s, friction {:.2g}, restitution {:.2g}", speed,
                                one.friction, one.restitution);
    SimSettings settings = motion_settings();
    if (safety > 0) settings.step_safety = safety;
    const Apparatus nothing;
    Simulation simulation({&block[0], &block[1]}, nothing, settings);
    const double frame = 3 * (reach[0] + reach[1] + 0.05) / speed / kFrames;
    try {
        for (int n = 0; n < kFrames; ++n) {
            const FrameReport r = simulation.advance(still(frame * n), still(frame * (n + 1)));
            result.rejected += r.rejected;
            result.contact = std::max(result.contact, r.contact / energy);
            if (std::abs(r.remainder) > std::abs(result.remainder) * energy) {
                result.remainder = r.remainder / energy;
            }
        }
    } catch (const Error& error) {
        result.stopped = error.what();
    }
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    const int cases = argc > 1 ? std::atoi(argv[1]) : 1000;
    const double safety = argc > 2 ? std::atof(argv[2]) : 0;
    std::vector<std::pair<double, std::string>> worst;
    int stopped = 0, met = 0;
    for (int n = 0; n < cases; ++n) {
        const Collision c = collide(n, safety);
        met += c.contact > 1e-3;
        stopped += !c.stopped.empty();
        worst.emplace_back(std::abs(c.remainder),
                           fmt::format("{:+.3f} % case {}: {}; {} steps taken back {}",
                                       100 * c.remainder, n, c.about, c.rejected, c.stopped));
    }
    std::sort(worst.begin(), worst.end(), std::greater<>());
    for (std::size_t n = 0; n < std::min<std::size_t>(worst.size(), 10); ++n) {
        fmt::print("{}\n", worst[n].second);
    }
    if (worst.empty()) return 0;
    fmt::print(
        "{} of {} met, {} stopped; of the energy at first half left less than {:.3g} % in "
        "the remainder, 19 of 20 less than {:.3g} %, all less than {:.3g} %\n",
        met, cases, stopped, 100 * worst[worst.size() / 2].first,
        100 * worst[worst.size() / 20].first, 100 * worst[0].first);
    return stopped > 0;
}

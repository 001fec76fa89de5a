// SPDX-License-Identifier: GPL-3.0-or-later
// Which bodies take their steps together where energy chooses these: all that may come to meet.
#include "sim/energy_steps.h"
#include "tests/catch.h"
#include "tests/sim/motion.h"

using namespace swage;
using namespace swage::test;

namespace {

const Apparatus kNothing;

// In the first frame.
long groups_of(const std::vector<EnergySteps::Tried>& tried) {
    return std::count_if(tried.begin(), tried.end(),
                         [](const auto& one) { return one.kept && one.time == 0; });
}

}  // namespace

TEST_CASE("steps that energy chooses see what heavy bodies throw light ones at") {
    // Each strikes the next, lighter one, which leaves it up to twice as fast: 3.5 times in all.
    const auto thrown = [](double gap, int frames) {
        const double a = 0.08;
        const std::vector<double> density = {20000, 600, 20, 20000}, modulus = {1e6, 3e5, 3e4, 1e6},
                                  at = {0, 0.082, 0.164, 0.244 + gap};
        std::vector<Aggregate> body;
        for (int n = 0; n < 4; ++n) {
            Material material = kSpringy;
            material.young_modulus = modulus[n];
            material.density = density[n];
            material.friction = 0;
            material.restitution = 1;
            body.push_back(make_block(1, 1, 1, a, material));
            place(body[n], {Quat::Identity(), Vec3(at[n], 0, 0)});
        }
        for (double& v : body[0].particle_velocity.x) v = 2;
        std::vector<Aggregate*> bodies;
        for (Aggregate& m : body) bodies.push_back(&m);
        EnergySteps steps(bodies, kNothing, motion_settings(Solver::energy_stepped));
        std::vector<EnergySteps::Tried> tried;
        steps.record(&tried);
        double astray = 0;
        for (int n = 0; n < frames; ++n) {
            const MoveOutcome outcome =
                steps.advance(still(0.1 / frames * n), still(0.1 / frames * (n + 1)));
            for (const BodyOutcome& one : outcome.body) {
                astray += one.after.sum() - one.before.sum() - one.done() + one.lost();
            }
        }
        const auto groups = std::count_if(
            tried.begin(), tried.end(), [](const auto& one) { return one.kept && one.time == 0; });
        return std::tuple{groups, body[2].mean_velocity().x(), astray};
    };
    REQUIRE(std::get<0>(thrown(0.6, 1)) == 1);  // it does not quite get there
    const auto [groups, back, astray] = thrown(0.5, 1);
    CHECK(groups == 1);
    CHECK(back < -4);
    CHECK(back == Approx(std::get<1>(thrown(0.5, 10))).epsilon(0.05));
    CHECK(std::abs(astray) < 1e-3 * 0.5 * 20000 * 0.08 * 0.08 * 0.08 * 4);
}

TEST_CASE("steps that energy chooses see what pressed bodies are thrown at as they part") {
    for (const double gap : {0.06, 0.01}) {  // it does not quite get there, or it does
        CAPTURE(gap);
        std::vector<Aggregate> body(3, make_block(1, 1, 1, 0.02, kSpringy));
        place(body[1], {Quat::Identity(), Vec3(0.018, 0, 0)});
        place(body[2], {Quat::Identity(), Vec3(0.038 + gap, 0, 0)});
        EnergySteps steps({&body[0], &body[1], &body[2]}, kNothing,
                          motion_settings(Solver::energy_stepped));
        std::vector<EnergySteps::Tried> tried;
        steps.record(&tried);
        steps.advance(still(0), still(0.03));
        REQUIRE(groups_of(tried) == 1);
        Vec3 sum = Vec3::Zero();
        for (const Aggregate& m : body) sum += m.mean_velocity();
        CHECK(sum.norm() < 1e-12);
        CHECK((body[2].mean_velocity().x() > 0.1) == (gap < 0.05));
    }
}

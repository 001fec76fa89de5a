// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that energy chooses (Joukhadar and Laugier 1996) against fixed ones, on a body that falls
// onto a floor and bounces, over the stiffness of the contact (S0 figure 9). A fixed step is safe
// when the energy goes no farther astray at any time of the motion than by the chosen steps.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sim/energy_steps.h"
#include "sim/vector_sums.h"
#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

// One cell, whose swings die away soon: the papers' ball.
struct Drop {
    static constexpr double kSide = 0.1, kModulus = 1e6, kDensity = 1000, kGravity = 9.81;
    static constexpr double kHeight = 0.05, kTime = 0.25;  // it comes down after 0.1 s
    static constexpr double kEnergy = kDensity * kSide * kSide * kSide * kGravity * kHeight;

    Aggregate matter;
    Apparatus floor;
    SimSettings settings;

    // Stiffness: of the whole face that lands [N/m].
    Drop(double stiffness, Solver solver, double damping) {
        Material material;
        material.young_modulus = kModulus;
        material.density = kDensity;
        material.damping_ratio = damping;
        material.restitution = 1;  // a spring, as in the paper
        matter = block_of(Vec3::Constant(kSide), kSide, material);
        for (double& y : matter.particle_position.y) y += 0.5 * kSide + kHeight;
        floor.name = "floor";
        floor.tool.push_back({"floor", BoxShape{Vec3(10, 1, 10), 0}, 0});
        settings.solver = solver;
        settings.gravity = {0, -kGravity, 0};
        settings.contact_stiffness = stiffness / (kModulus * kSide);
    }
    Drive at(double time) const {
        return at_time(time, {{Quat::Identity(), {0, -0.5, 0}}});
    }
};

struct Chosen {
    std::vector<EnergySteps::Tried> tried;
    long kept = 0, forces = 0;  // of these; evaluations of the forces
    double astray = 0;          // most that the energy was, of what the fall gives
};

Chosen by_energy(double stiffness, double damping) {
    Drop drop(stiffness, Solver::energy_stepped, damping);
    EnergySteps steps({&drop.matter}, drop.floor, drop.settings);
    Chosen chosen;
    steps.record(&chosen.tried);
    steps.advance(drop.at(0), drop.at(Drop::kTime));
    double sum = 0;
    for (const EnergySteps::Tried& one : chosen.tried) {
        ++chosen.forces;
        if (!one.kept) continue;
        ++chosen.kept;
        sum += one.astray;
        chosen.astray = std::max(chosen.astray, std::abs(sum) / Drop::kEnergy);
    }
    return chosen;
}

enum class Formula { paper, symplectic };

// The number of steps of this length, or 0 where the energy goes farther astray than that.
long by_fixed_step(double stiffness, double damping, Formula formula, double step, double most) {
    const bool symplectic = formula == Formula::symplectic;
    Drop drop(stiffness, Solver::energy_stepped, damping);
    MovingBody body(drop.matter, 0, drop.floor, drop.settings);
    BodyOutcome outcome(drop.floor, body.pushes().count());
    const long count = std::lround(std::ceil(Drop::kTime / step));
    step = Drop::kTime / double(count);
    Drive before = drop.at(0);
    body.start(before, outcome);
    const double lag = symplectic ? step : 0, start = body.stored(before, lag).sum();
    body.begin_block(outcome);
    Vec3Array earlier;
    for (long n = 1; n <= count; ++n) {
        const Drive now = drop.at(double(n) * step);
        const Vec3Array from = drop.matter.particle_position;
        body.begin_step(before);
        if (symplectic) {
            body.move(n == 1 ? 0.5 * step : step, step);
            body.find_forces(now, step, outcome);
        } else {
            carry_on(body, step, step, earlier);
            find_forces_of_step(body, now, from, step, outcome);
        }
        const double way = farthest_move(from, drop.matter.particle_position);
        if (!(way < 0.5 * Drop::kSide)) return 0;
        body.finish_step(before, now, step, outcome);
        body.renew_candidates(before, now, std::sqrt(3.0) * way);
        before = now;
        if (n % 8 > 0 && n < count) continue;
        BodyOutcome ended = outcome;
        body.end_block(ended);
        const double astray = body.stored(now, lag).sum() - start - ended.done() + ended.lost();
        if (!(std::abs(astray) <= most * Drop::kEnergy)) return 0;
    }
    return count;
}

// Evaluations of the forces that the longest safe fixed step needs; 0: none was found.
long safe_forces(double stiffness, double damping, Formula formula, double most) {
    double longest = 0, step = 0.01;
    long count = 0;
    const auto try_step = [&](double length) {
        const long steps = by_fixed_step(stiffness, damping, formula, length, most);
        if (steps > 0) longest = length, count = steps;
        return steps > 0;
    };
    constexpr double kRatio = 2;
    while (!try_step(step) && step > 1e-8) step /= kRatio;
    if (count == 0) return 0;
    double high = longest * kRatio;
    for (int n = 0; n < 2; ++n) {
        const double middle = std::sqrt(longest * high);
        if (!try_step(middle)) high = middle;
    }
    return count;
}

Plot history(double stiffness, const Chosen& chosen, long fixed) {
    Plot plot;
    plot.title = fmt::format("contact of {:.0e} N/m", stiffness);
    plot.abscissa = "time [s]";
    plot.ordinate = "step [s]";
    Plot::Line line{"steps kept", {}, false}, level{"longest safe fixed step", {}, true};
    for (const EnergySteps::Tried& one : chosen.tried) {
        if (one.kept) line.point.emplace_back(one.time, one.step);
    }
    const double step = fixed > 0 ? Drop::kTime / double(fixed) : 0;
    if (fixed > 0) level.point = {{0, step}, {Drop::kTime, step}};
    plot.line = {line, level};
    return plot;
}

void chosen_steps(bool brief, Values& values) {
    constexpr double kDamping = 0.1;
    for (const double stiffness : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8}) {
        if (brief && stiffness > 1e4) break;
        const std::string at = fmt::format("{:.0e} N/m: ", stiffness);
        const Chosen chosen = by_energy(stiffness, kDamping);
        values.add(as_share(at + "steps taken back, share", 0, 0,
                            double(chosen.tried.size()) / double(chosen.kept) - 1, 0.5));
        values.add(as_share(at + "energy astray, share", 0, 0, chosen.astray, 2e-3));
        const long paper = safe_forces(stiffness, kDamping, Formula::paper, chosen.astray);
        values.add(
            at_least(at + "gain over a fixed step", 0, 1, double(paper) / double(chosen.forces)));
        values.draw(history(stiffness, chosen, paper));
        if (brief || stiffness == 1e3 || stiffness == 1e5 || stiffness == 1e7) continue;
        Value loose = at_least(at + "over a symplectic one at 1 %", 0, 1,
                               double(safe_forces(stiffness, kDamping, Formula::symplectic, 0.01)) /
                                   double(chosen.forces));
        loose.bound = std::numeric_limits<double>::infinity();
        values.add(loose);
    }
    if (brief) return;
    // Where nothing damps, swings inside the body hold the step down after the first bounce.
    constexpr double kStiffness = 1e6;
    const Chosen chosen = by_energy(kStiffness, 0);
    const std::string at = fmt::format("{:.0e} N/m, undamped: ", kStiffness);
    Value plain = at_least(
        at + "gain over a fixed step", 0, 1,
        double(safe_forces(kStiffness, 0, Formula::paper, chosen.astray)) / double(chosen.forces));
    plain.bound = std::numeric_limits<double>::infinity();
    values.add(plain);
    Value loose = at_least(
        at + "over a symplectic one at 1 %", 0, 1,
        double(safe_forces(kStiffness, 0, Formula::symplectic, 0.01)) / double(chosen.forces));
    loose.bound = std::numeric_limits<double>::infinity();
    values.add(loose);
}

}  // namespace

void add_chosen_step_cases(std::vector<Case>& cases) {
    cases.push_back({"chosen-steps", "steps that energy chooses, over the stiffness of a contact",
                     "S0 figure 9", 0, true, chosen_steps});
}

}  // namespace swage

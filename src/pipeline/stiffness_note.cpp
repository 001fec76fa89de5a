// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stiffness_note.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/text.h"
#include "sim/limited_stiffness.h"
#include "sim/moving_body.h"

namespace swage {

namespace {

constexpr double kWhole = 0.9;         // a share of what is asked that is as good as all
constexpr double kShortest = 1 << 16;  // that steps are made shorter by

double step_of(const StageSpec& stage, const std::vector<NamedMatter>& bodies) {
    double step = std::numeric_limits<double>::infinity();
    for (const NamedMatter& body : bodies) {
        step = std::min(step, explicit_step(*body.matter, stage.sim));
    }
    return step;
}

// Of several, the one that has least.
void keep_worse(std::optional<LimitedPoints>& worst, LimitedPoints&& points) {
    if (!worst || points.share() < worst->share()) worst = std::move(points);
}

bool are_alike(const Material& one, const Material& other) {
    return one.mechanics == other.mechanics && one.young_modulus == other.young_modulus &&
           one.poisson_ratio == other.poisson_ratio;
}

// Whether steps leave both as much, against whatever they press: all that counts is equal.
bool are_alike(const Aggregate& one, const Aggregate& other) {
    if (one.lattice.spacing != other.lattice.spacing || one.particle_mass != other.particle_mass ||
        one.cell_material != other.cell_material ||
        one.material_count() != other.material_count() || !(one.surface == other.surface)) {
        return false;
    }
    for (std::size_t m = 0; m < one.material_count(); ++m) {
        if (!are_alike(one.material_at(m), other.material_at(m))) return false;
    }
    for (std::size_t d = 0; d < one.connection.size(); ++d) {
        if (one.connection[d].weight.all() != other.connection[d].weight.all()) return false;
    }
    return true;
}

// Of all pairs that have least. Many bodies are mostly copies of few.
std::optional<LimitedPoints> worst_between(const std::vector<NamedMatter>& bodies,
                                           const SimSettings& settings, double step) {
    struct Kind {
        MeetingBody body;
        bool several = false;
    };
    std::vector<Kind> kind;
    for (const NamedMatter& body : bodies) {
        const auto same = std::find_if(kind.begin(), kind.end(), [&](const Kind& known) {
            return are_alike(known.body.matter, *body.matter);
        });
        if (same == kind.end()) {
            kind.push_back({*body.matter});
        } else {
            same->several = true;
        }
    }
    std::optional<LimitedPoints> worst;
    for (std::size_t a = 0; a < kind.size(); ++a) {
        for (std::size_t b = kind[a].several ? a : a + 1; b < kind.size(); ++b) {
            keep_worse(worst, points_between(kind[a].body, kind[b].body, settings, step));
        }
    }
    return worst;
}

double shorter_by(const LimitedPoints& points) {
    double low = 1, high = 1;
    while (points.share(high) < kWhole && high < kShortest) high *= 2;
    for (int n = 0; n < 30; ++n) {
        const double mid = 0.5 * (low + high);
        (points.share(mid) < kWhole ? low : high) = mid;
    }
    return high;
}

// Of what is 1 at most, to two digits, downward.
double rounded_down(double value) {
    double digit = 1;
    while (value < 10 * digit) digit /= 10;
    return digit * std::floor(value / digit * (1 + 1e-12));
}

}  // namespace

std::string stiffness_note(const StageSpec& stage, const std::vector<NamedMatter>& bodies) {
    const SimSettings& sim = stage.sim;
    const bool asks = sim.contact_stiffness > 0,
               asks_of_grips = sim.grip_stiffness != SimSettings{}.grip_stiffness;
    if (sim.solver != Solver::explicit_steps || !(asks || asks_of_grips)) return {};
    const double step = step_of(stage, bodies);
    std::optional<LimitedPoints> tools, between, grips;
    if (asks) between = worst_between(bodies, sim, step);
    for (const NamedMatter& body : bodies) {
        const Aggregate& matter = *body.matter;
        if (asks && !stage.machine.tool.empty()) {
            keep_worse(tools, points_at_tools(matter, sim, step));
        }
        if (asks_of_grips && !stage.machine.grip.empty()) {
            keep_worse(grips, points_in_grips(matter, sim, step));
        }
    }
    double shorter = 1;
    const auto acts_as = [&](const std::optional<LimitedPoints>& points, double asked,
                             const char* where) -> std::string {
        if (!points || points->share() >= kWhole) return {};
        shorter = std::max(shorter, shorter_by(*points));
        return fmt::format("about {:.2g}{}", asked * points->share(), where);
    };
    std::vector<std::string> contacts, all;
    for (const std::string& one : {acts_as(tools, sim.contact_stiffness, " under tools"),
                                   acts_as(between, sim.contact_stiffness, " between bodies")}) {
        if (!one.empty()) contacts.push_back(one);
    }
    if (!contacts.empty()) {
        all.push_back(fmt::format("contact_stiffness = {:g} acts as {}", sim.contact_stiffness,
                                  joined(contacts, " and ")));
    }
    const std::string held = acts_as(grips, sim.grip_stiffness, "");
    if (!held.empty()) {
        all.push_back(fmt::format("grip_stiffness = {:g} acts as {}", sim.grip_stiffness, held));
    }
    if (all.empty()) return {};
    const std::string told =
        fmt::format("steps at step_safety = {:g} are too long for the stiffness given, {}",
                    sim.step_safety, joined(all, ", "));
    if (shorter >= kShortest) return told;  // no step that can be taken gives it
    const double safety = rounded_down(sim.step_safety / shorter), times = sim.step_safety / safety;
    return fmt::format("{}: step_safety = {:.2g} reaches it, with {:.{}f} times as many steps",
                       told, safety, times, times < 10 ? 1 : 0);
}

double stiffness_share_at_tools(const StageSpec& stage, const std::vector<NamedMatter>& bodies) {
    if (stage.sim.solver != Solver::explicit_steps) return 1;
    const Aggregate& work_piece = *bodies.front().matter;
    return points_at_tools(work_piece, stage.sim, step_of(stage, bodies)).share();
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/books_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/motion_guard.h"
#include "sim/static_forces.h"
#include "sim/surface_modulus.h"

namespace swage {

namespace {

constexpr double kLittleGain = 0.01;  // of the energy in play: no matter
constexpr double kMostOfTaken = 0.2;  // likewise, of what friction and flow took
constexpr double kSnapped = 0.05;     // likewise, lost in one frame at rest

// Tools and grips carry what they hold so far, at most [m]; between frames they go straight.
double way_of(const StageEnd& end) {
    const double reach = 0.5 * end.machine.frame.size.norm();
    double way = 0, farthest = 0;
    const auto look = [&](const std::vector<Pose>& from, const std::vector<Pose>& to) {
        for (std::size_t n = 0; n < from.size(); ++n) {
            farthest = std::max(farthest, (to[n].translation - from[n].translation).norm() +
                                              reach * turn_between(from[n], to[n]).norm());
        }
    };
    Drive from = drive_at(end.machine, 0, end.stage.duration);
    for (int n = 1; n <= end.stage.frames; ++n) {
        Drive to =
            drive_at(end.machine, static_cast<double>(n) / end.stage.frames, end.stage.duration);
        farthest = 0;
        look(from.world_from_tool, to.world_from_tool);
        look(from.world_from_grip, to.world_from_grip);
        way += farthest;
        from = std::move(to);
    }
    return way;
}

// What rounding, and of equilibria what they leave of forces, may leave open in the books [J].
//
// Stored: strains of 1e-8, which are differences of numbers about 1.
//
// Work: places x are known to u |x|, u = 2^-52. No particle lies nearer to its balance than that,
// so each may be left with a force of u |x| times what holds it: E a in the lattice, of which there
// are V/a^3, and g E A/a by grips of stiffness g on patches A (sim/grip_set.h). At worst all of
// these point one way; those within a body balance, so that tools and grips bear their sum
// u |x| E (V/a^2 + g A/a), and on a way s do s times that of work that goes nowhere.
//
// Parted: a point in a grip whose cell is parted is held by another cell at a place in it that is
// kept in floats (matter/surface_points.h), 2^-24 of a cell off, which its spring, of g E A/a,
// stores.
//
// An equilibrium leaves a share of a push, which is this at least; tools and grips bear it on.
double unresolved(const StageEnd& end) {
    constexpr double kPlace = 0.5 * std::numeric_limits<float>::epsilon();
    const WorkFrame& frame = end.machine.frame;
    const double way = way_of(end);
    const double off = std::numeric_limits<double>::epsilon() *
                       (frame.world_from_work.translation.norm() + 0.5 * frame.size.norm() + way);
    double sum = 0;
    for (std::size_t b = 0; b < end.bodies.size(); ++b) {
        const Aggregate& matter = end.bodies[b].matter;
        double modulus = 0, gripped = 0;
        for (std::size_t m = 0; m < matter.material_count(); ++m) {
            modulus =
                std::max(modulus, pressed_modulus(matter.material_at(m), end.stage.sim.solver));
        }
        for (const Grip& grip : end.machine.apparatus.grip) {
            if (grip.body != static_cast<int>(b)) continue;
            for (int p : grip.point) gripped += matter.surface.area(static_cast<std::size_t>(p));
        }
        const double a = matter.lattice.spacing, volume = matter.volume();
        const double held = volume / (a * a) + end.stage.sim.grip_stiffness * gripped / a;
        sum += modulus * (1e-16 * volume + off * held * way);
        if (end.totals.severed + end.totals.broken > 0) {
            sum += 0.5 * modulus * end.stage.sim.grip_stiffness * gripped * a * kPlace * kPlace;
        }
        if (!in_motion(end.stage.sim.solver)) {
            sum += end.totals.residual * least_push(matter) * way;
        }
    }
    return sum;
}

// What flow gave on the whole, where bodies hold none of it in a back stress [J].
double flow_gave(const StageEnd& end) {
    for (const WorkPiece& body : end.bodies) {
        for (std::size_t m = 0; m < body.matter.material_count(); ++m) {
            if (body.matter.material_at(m).shifts()) return 0;
        }
    }
    return std::max(0.0, -end.last.plastic);
}

std::string flow_text(const StageEnd& end, double by_flow, double share) {
    bool springs = false;
    for (const WorkPiece& body : end.bodies) {
        springs = springs ||
                  (body.matter.yields() && body.matter.material.mechanics == Mechanics::springs);
    }
    return fmt::format(
        "the energy books do not close: plastic flow has given {:.3g} J, {:.3g} % of the energy "
        "involved is from nowhere, and it should only take some; {}",
        by_flow, 100 * share,
        springs ? "springs that flow far fold within single cells, which mechanics = \"cells\" "
                  "does not"
        : in_motion(end.stage.sim.solver) ? "try a lower step_safety or smaller cells"
                                          : "try more frames or smaller cells");
}

std::string fracture_text(const StageEnd& end, double by_fracture, double share) {
    const bool mixed = std::any_of(end.bodies.begin(), end.bodies.end(), [](const WorkPiece& body) {
        return !body.matter.mixed_cell.empty();
    });
    return fmt::format(
        "the energy books do not close: fracture has given {:.3g} J, {:.3g} % of the energy "
        "involved is from nowhere, and it should only take some; cells beside a break hold more "
        "as springs than they did before{}: try smaller cells",
        by_fracture, 100 * share, mixed ? ", those of two unlike materials most" : "");
}

std::string cut_text(double by_cuts, double share) {
    return fmt::format(
        "the energy books do not close: cutting has given {:.3g} J, {:.3g} % of the energy "
        "involved is from nowhere, and it should only take some: try smaller cells or, where a "
        "stage before has pressed or drawn the matter far, remold = true",
        by_cuts, 100 * share);
}

// The energy involved [J]: what the bodies began with and were given, what the books hold by now or
// the most that was stored on the way. What contacts held at the start and were let go of has no
// part in it: it is booked as what is gone, and may be far more than all that the stage does.
double in_play(const Books& first, const Books& b, double stored) {
    const double in = first.kinetic + first.elastic + std::abs(b.work) + std::abs(b.load_work) +
                      std::abs(b.gravity_work);
    const double out = b.kinetic + b.elastic + b.contact + b.plastic + b.damped + b.friction +
                       b.drag + std::abs(b.severed_energy) + std::max(0.0, b.fracture) +
                       std::max(0.0, b.set_free - b.contact_at_start);
    return std::max({in, out, stored});
}

// The share of that which is missing or too much. Cuts, fracture and flow take energy: what they
// give is from nowhere.
double unaccounted(double play, const Books& b, double least, double by_flow) {
    const double gap =
        b.remainder + std::min(0.0, b.fracture) + std::min(0.0, b.severed_energy) - by_flow;
    return play > least && std::abs(gap) > least ? gap / play : 0;
}

// A body that snaps through or slips at rest comes to where it would with inertia only if that has
// nowhere else to go. Empty: none did, of which anyone need know.
std::string snapped(const StageEnd& end, double play, double least) {
    const StageTotals& totals = end.totals;
    if (totals.snapped <= std::max(kSnapped * play, least)) return {};
    return fmt::format(
        "{:.3g} J, {:.2g} % of the energy involved, were lost at once in frame {}: something "
        "snapped "
        "through or slipped there, and equilibria go on from where that comes to rest, as if it "
        "had "
        "no inertia (solver = \"explicit\" gives it that)",
        totals.snapped, 100 * totals.snapped / play, totals.snapped_in);
}

std::string how_to_close(Solver solver, const Books& last) {
    if (!in_motion(solver)) {
        const double by_loads = std::abs(last.load_work), by_weight = std::abs(last.gravity_work);
        const double by_tools = std::abs(last.work);
        return fmt::format(
            "the work of {} is inaccurate between frames that are far apart: try "
            "more frames",
            by_tools >= std::max(by_loads, by_weight) ? "tools"
            : by_loads >= by_weight                   ? "loads"
                                                      : "gravity");
    }
    if (solver == Solver::implicit_steps) {
        return "implicit steps damp by themselves: try more frames, which shorten the steps, or "
               "solver = \"explicit\"";
    }
    const std::string shorter = solver == Solver::energy_stepped
                                    ? "solver = \"explicit\" with a low step_safety"
                                    : "a lower step_safety";
    return "try " + shorter +
           ", more cells or, where bodies are pressed deep into each other, a larger "
           "contact_stiffness";
}

}  // namespace

std::vector<std::string> judge_books(const StageEnd& end) {
    const SimSettings& sim = end.stage.sim;
    std::vector<std::string> told;
    const double by_flow = flow_gave(end), least = unresolved(end),
                 play = in_play(end.first, end.last, end.totals.stored);
    const double share = unaccounted(play, end.last, least, by_flow);
    const double taken = end.last.friction + end.last.plastic;
    // At rest, what snaps or slips through is lost, and no mistake.
    const bool is_open = in_motion(sim.solver) ? std::abs(share) > kMostGain : share < -kMostGain;
    const double by_fracture = std::max(0.0, -end.last.fracture),
                 by_cuts = std::max(0.0, -end.last.severed_energy),
                 most = std::max({by_flow, by_fracture, by_cuts});
    if (is_open && share < 0 && most > -end.last.remainder) {
        told.push_back(most == by_cuts       ? cut_text(by_cuts, -share)
                       : most == by_fracture ? fracture_text(end, by_fracture, -share)
                                             : flow_text(end, by_flow, -share));
    } else if (is_open) {
        told.push_back(
            fmt::format("the energy books do not close: {:.3g} % of the energy involved is {}; {}",
                        100 * std::abs(share), share > 0 ? "lost" : "from nowhere",
                        how_to_close(sim.solver, end.last)));
    } else if (!in_motion(sim.solver) && share < -kLittleGain &&
               taken > kLittleGain * (end.last.remainder / share) &&
               -end.last.remainder > kMostOfTaken * taken) {
        told.push_back(
            fmt::format("friction and flow took {:.3g} J, but tools, loads and stored energy gave "
                        "{:.3g} J less; {}",
                        taken, -end.last.remainder, how_to_close(sim.solver, end.last)));
    }
    if (std::string one = snapped(end, play, least); !in_motion(sim.solver) && !one.empty()) {
        told.push_back(std::move(one));
    }
    return told;
}

}  // namespace swage

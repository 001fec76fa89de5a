// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text.h"
#include "sim/cell_volume.h"
#include "sim/flowed_volume.h"
#include "sim/gripped_pieces.h"
#include "sim/motion_guard.h"
#include "sim/own_overlap.h"
#include "sim/static_forces.h"
#include "sim/surface_modulus.h"

namespace swage {

namespace {

constexpr double kLittleGain = 0.01;  // of the energy in play: no matter
constexpr double kMostOfTaken = 0.2;  // likewise, of what friction and flow took
constexpr double kSwollen = 0.01;     // of its volume that a skin may be off by untold
constexpr double kShrunk = 0.01;      // likewise, that flow may change it by
constexpr double kOverlap = 0.5;      // spacings that a body may lie in itself untold

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
// An equilibrium leaves a share of a push, which is this at least; tools and grips bear it on.
double unresolved(const StageEnd& end) {
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

// Of what the bodies began with and were given, of what the books hold by now or of the most that
// was stored on the way, the share that is missing or too much. Fracture and flow take energy: what
// they give is from nowhere. What contacts held at the start and were let go of has no part in it:
// it is booked as what is gone, and may be far more than all that the stage does.
double unaccounted(const Books& first, const Books& b, double stored, double least,
                   double by_flow) {
    const double in = first.kinetic + first.elastic + std::abs(b.work) + std::abs(b.load_work) +
                      std::abs(b.gravity_work);
    const double out = b.kinetic + b.elastic + b.contact + b.plastic + b.damped + b.friction +
                       b.drag + std::abs(b.severed_energy) + std::max(0.0, b.fracture) +
                       std::max(0.0, b.set_free - b.contact_at_start);
    const double play = std::max({in, out, stored}),
                 gap = b.remainder + std::min(0.0, b.fracture) - by_flow;
    return play > least && std::abs(gap) > least ? gap / play : 0;
}

// What a body starts deep in, which throws it so, and what can be done about it.
std::string how_deep(const Books& last, const StageEnd& end, const std::string& thrown) {
    const bool later = end.first_frame > 2;  // the first frame of all is the start
    if (end.bodies.size() == 1 && last.among_at_start > 0.5 * last.contact_at_start) {
        return fmt::format(
            "starts pressed into itself, or its pieces into each other, which throws them apart "
            "with {}: {}",
            thrown,
            later ? "smaller cells reduce this; without self_contact = true they pass through each "
                    "other"
                  : "its mesh intersects itself there");
    }
    return fmt::format(
        "starts pressed into what it touches, which throws it off with {}: {}", thrown,
        later ? "leave a gap to the machine's tools, or let the stage before leave it further away"
              : "move it further away with `at`");
}

// What contacts and grips hold as a stage in motion begins is let go of at once, and no mistake
// where it lifts a body by less than a cell, moves it by less in all of the stage, or a second, or
// is little beside how it flies. A body that is pressed by right is strained, and holds more
// itself. Of several, the one that is thrown fastest. Empty: none is.
std::string pressed_at_start(const StageEnd& end) {
    if (!in_motion(end.stage.sim.solver)) return {};
    std::size_t worst = 0, count = 0;
    double fastest = 0, thrown_by = 0;
    for (std::size_t b = 0; b < end.last.body.size(); ++b) {
        const Aggregate& matter = end.bodies[b].matter;
        const double energy = end.last.body[b].contact_at_start, mass = matter.mass();
        const double a = matter.lattice.spacing, slowly = a / std::max(1.0, end.stage.duration);
        const double harmless =
            mass * std::max(end.stage.sim.gravity.norm() * a, 0.5 * slowly * slowly);
        const Books& first = end.first.body[b];
        if (energy <= std::max({harmless, first.elastic, 0.01 * first.kinetic})) continue;
        ++count;
        const double speed = std::sqrt(2 * energy / mass);
        if (speed > fastest) worst = b, fastest = speed, thrown_by = energy;
    }
    if (count == 0) return {};
    std::string thrown =
        fmt::format("{:.3g} J, at up to {}", thrown_by, quantity_text(fastest, Quantity::speed));
    if (count > 1) {
        thrown += fmt::format(", as {} {}", count == 2 ? "does" : "do",
                              counted(count - 1, "other body", "other bodies"));
    }
    return fmt::format("{} {}", end.bodies[worst].name,
                       how_deep(end.last.body[worst], end, thrown));
}

// What to look for at the end: folds and pieces that nothing has kept apart, and at rest also
// whether what meets is held.
bool may_lie_in_itself(const StageEnd& end) {
    return !in_motion(end.stage.sim.solver) || !end.stage.sim.self_contact;
}

// How deep a body lies in itself, and what is to be said of that, if anything.
std::pair<double, std::string> lies_in_itself(const StageEnd& end, WorkPiece& body) {
    const SimSettings& sim = end.stage.sim;
    const double overlap = own_overlap(body.matter);
    if (overlap <= kOverlap * body.matter.lattice.spacing) return {overlap, {}};
    const std::string name = name_among(end.bodies, body);
    const bool folded = sim.self_contact || find_pieces(body.matter).count == 1;
    return {
        overlap,
        fmt::format(
            "{}, by {} at the end: {}",
            folded ? name + " has passed into itself" : "pieces of " + name + " overlap each other",
            length_text(overlap),
            sim.self_contact ? "it is pressed together harder than its contact_stiffness can hold"
                             : "self_contact = true in this stage prevents that")};
}

// Flow that keeps the volume, and a skin that does not. Empty: as large as it should be.
std::string swollen(const StageEnd& end, const WorkPiece& body) {
    const double by = swollen_by(body).value_or(0);
    if (std::abs(by) <= kSwollen) return {};
    const bool frame4 = body.mount.kind == SkinKind::frame4;
    return fmt::format(
        "the skin of {} encloses {:.2g} % {} than its matter, which flows at one volume: {}",
        name_among(end.bodies, body), 100 * std::abs(by), by > 0 ? "more" : "less",
        frame4 ? "skin.kind = \"mount\" keeps it"
               : "it has folded within single cells, and smaller ones make it less");
}

// Matter that has less or more of its volume by what flowed in the stage. Empty: hardly.
std::string shrunk(const StageEnd& end, std::size_t body) {
    const WorkPiece& piece = end.bodies[body];
    const double by = flowed_volume(piece.matter) / end.volumes_before[body].flowed - 1;
    if (std::abs(by) <= kShrunk) return {};
    const bool springs = piece.matter.material.mechanics == Mechanics::springs;
    return fmt::format(
        "the matter of {} has {} {:.2g} % of its volume by flow, which should keep "
        "it: {}",
        name_among(end.bodies, piece), by < 0 ? "lost" : "gained", 100 * std::abs(by),
        springs ? "springs that flow far fold within single cells; mechanics = "
                  "\"cells\" keeps it"
                : "try more frames or smaller cells");
}

// Nothing has flowed, the matter is in pieces, and the skin takes up more or less than it did.
std::string stretched(const StageEnd& end, std::size_t b) {
    if (end.last.plastic > 0) return {};
    const double by = stretched_by(end.bodies[b], end.volumes_before[b]).value_or(0);
    if (std::abs(by) <= kSwollen) return {};
    return fmt::format(
        "the skin of {} encloses {:.2g} % {} than {}: parts of it are stretched from one piece to "
        "another; smaller cells or skin.kind = \"boundary\" avoid that",
        name_among(end.bodies, end.bodies[b]), 100 * std::abs(by), by > 0 ? "more" : "less",
        end.totals.severed > 0 ? "before the cut" : "as the stage began");
}

// What has cracked does not know inside from outside.
std::string inside_out(const StageEnd& end, const WorkPiece& piece) {
    const std::size_t cells = cracked_inside_out(piece.matter);
    if (cells == 0) return {};
    return fmt::format(
        "{} of {} that had cracked {} pressed until inside out, and {} too little since: try "
        "less pressure, smaller cells or a greater toughness",
        counted(cells, "cell", "cells"), name_among(end.bodies, piece), cells == 1 ? "was" : "were",
        cells == 1 ? "bears" : "bear");
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

// Why no blade has severed anything: what goes through a cell may pass between its particles.
std::string why_nothing_is_cut(const StageEnd& end) {
    if (end.totals.entered == 0) {
        return "the blade met no matter: it passed beside the work-piece or through a gap in it";
    }
    return fmt::format(
        "the blade went into matter but severed nothing: what is narrower than a cell, {}, or goes "
        "in by less than one, passes between particles; smaller cells or a wider blade avoid that",
        length_text(end.totals.entered));
}

// "a", "a and b", "a, b and c"; of more, the first.
std::string names_text(std::vector<std::string> names) {
    constexpr std::size_t kTold = 3;
    if (names.size() == 1) return names.front();
    std::string last = names.back();
    if (names.size() > kTold) last = counted(names.size() - kTold, "other", "others");
    names.resize(std::min(kTold, names.size() - 1));
    return joined(names, ", ") + " and " + last;
}

// Parts of the machine that in the end have done none of what they are there for, beside others
// that have, and pieces that nothing holds.
std::vector<std::string> idle_parts(const StageEnd& end) {
    const Apparatus& apparatus = end.machine.apparatus;
    std::vector<std::string> told, blunt, empty;
    const std::size_t first = apparatus.tool.size() + apparatus.grip.size();
    const std::size_t told_of = std::min(end.last.load.size(), first + apparatus.blade.size());
    for (std::size_t n = 0; first + n < told_of && end.totals.severed > 0; ++n) {
        if (end.last.load[first + n].severed == 0) blunt.push_back(apparatus.blade[n].name);
    }
    if (!blunt.empty()) {
        told.push_back(fmt::format(
            "{} cut nothing: {} met no matter, or only what another blade cuts between the same "
            "particles; smaller cells tell blades apart",
            names_text(blunt), blunt.size() == 1 ? "it" : "they"));
    }
    if (apparatus.grip.empty()) return told;
    const std::size_t held = static_cast<std::size_t>(apparatus.grip.front().body);
    const GrippedPieces gripped = find_gripped_pieces(end.bodies[held].matter, apparatus);
    for (std::size_t n = 0; n < apparatus.grip.size(); ++n) {
        const bool is_empty = std::ranges::all_of(
            gripped.at[n], [](int piece) { return piece == GrippedPieces::kNone; });
        if (is_empty) empty.push_back(apparatus.grip[n].name);
    }
    if (!empty.empty()) {
        told.push_back(
            fmt::format("{} {} nothing: cuts or cracks run through every cell under {}, "
                        "which smaller cells avoid",
                        names_text(empty), empty.size() == 1 ? "holds" : "hold",
                        empty.size() == 1 ? "it" : "them"));
    }
    const auto loose = std::ranges::count(gripped.by, GrippedPieces::kNone);
    if (loose > 0 && end.totals.severed > 0 && !in_motion(end.stage.sim.solver)) {
        told.push_back(fmt::format(
            "{} of its {} pieces {} in no grip: where nothing else moves {}, {} where {} cut off",
            loose, gripped.pieces.count, loose == 1 ? "is" : "are", loose == 1 ? "it" : "them",
            loose == 1 ? "it stays" : "they stay", loose == 1 ? "it was" : "they were"));
    }
    return told;
}

}  // namespace

StageVerdict judge_stage(const StageEnd& end, int pieces_before, StageEnded ended) {
    const std::string& name = end.stage.name;
    const SimSettings& sim = end.stage.sim;
    const bool whole = ended == StageEnded::wholly;
    StageVerdict verdict;
    const auto warn = [&](const std::string& sentence) {
        verdict.warning.push_back(name + ": " + sentence);
    };
    if (whole && !end.machine.apparatus.tool.empty() && !end.totals.touched) {
        warn(in_motion(sim.solver)
                 ? "its tools never touched the work-piece"
                 : "none of its tools presses on the work-piece at the end of any frame: none "
                   "reached it, or they separated within a frame, as happens where nothing holds "
                   "it");
    }
    if (whole && !end.machine.apparatus.blade.empty() && end.totals.severed == 0) {
        warn(why_nothing_is_cut(end));
    }
    if (whole && end.totals.severed > 0 && piece_count(end.bodies) == pieces_before) {
        warn(
            fmt::format("the blade severed {} connections but separated nothing: owing to its "
                        "place, width or path it passed through only a part of the work-piece",
                        end.totals.severed));
    }
    if (whole) {
        for (const std::string& one : idle_parts(end)) warn(one);
    }
    if (const std::string pressed = pressed_at_start(end); !pressed.empty()) warn(pressed);
    const double by_flow = flow_gave(end);
    const double share =
        unaccounted(end.first, end.last, end.totals.stored, unresolved(end), by_flow);
    const double taken = end.last.friction + end.last.plastic;
    // At rest, what snaps or slips through is lost, and no mistake.
    const bool is_open = in_motion(sim.solver) ? std::abs(share) > kMostGain : share < -kMostGain;
    const double by_fracture = std::max(0.0, -end.last.fracture);
    if (is_open && share < 0 && std::max(by_flow, by_fracture) > -end.last.remainder) {
        warn(by_flow > by_fracture ? flow_text(end, by_flow, -share)
                                   : fracture_text(end, by_fracture, -share));
    } else if (is_open) {
        warn(fmt::format("the energy books do not close: {:.3g} % of the energy involved is {}; {}",
                         100 * std::abs(share), share > 0 ? "lost" : "from nowhere",
                         how_to_close(sim.solver, end.last)));
    } else if (!in_motion(sim.solver) && share < -kLittleGain &&
               taken > kLittleGain * (end.last.remainder / share) &&
               -end.last.remainder > kMostOfTaken * taken) {
        warn(
            fmt::format("friction and flow took {:.3g} J, but tools, loads and stored energy gave "
                        "{:.3g} J less; {}",
                        taken, -end.last.remainder, how_to_close(sim.solver, end.last)));
    }
    for (std::size_t b = 0; b < end.bodies.size(); ++b) {
        if (ended == StageEnded::interrupted) break;
        for (const std::string& told : {swollen(end, end.bodies[b]), stretched(end, b),
                                        shrunk(end, b), inside_out(end, end.bodies[b])}) {
            if (!told.empty()) warn(told);
        }
    }
    if (may_lie_in_itself(end) && ended != StageEnded::interrupted) {
        for (WorkPiece& body : end.bodies) {
            const auto [overlap, told] = lies_in_itself(end, body);
            verdict.overlap = std::max(verdict.overlap, overlap);
            if (!told.empty()) warn(told);
        }
    }
    return verdict;
}

}  // namespace swage

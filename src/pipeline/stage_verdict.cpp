// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_verdict.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "sim/motion_guard.h"
#include "sim/own_overlap.h"

namespace swage {

namespace {

constexpr double kOverlap = 0.5;  // spacings that a body may lie in itself untold

// Below this energies are round-off [J]: strains of 1e-8, which are differences of numbers about 1.
double round_off(const std::vector<WorkPiece>& bodies) {
    double sum = 0;
    for (const WorkPiece& body : bodies) {
        const Material& m = body.matter.material;
        sum += 1e-16 * m.young_modulus * body.matter.mass() / m.density;
    }
    return sum;
}

// Of what the bodies began with and were given, or of what the books hold by now, the share that is
// missing or too much. Fracture takes energy: what it gives is from nowhere.
double unaccounted(const Books& first, const Books& b, double least) {
    const double in = first.kinetic + first.elastic + std::abs(b.work) + std::abs(b.load_work) +
                      std::abs(b.gravity_work);
    const double out = b.kinetic + b.elastic + b.contact + b.plastic + b.damped + b.friction +
                       b.drag + std::abs(b.severed_energy) + std::max(0.0, b.fracture) + b.set_free;
    const double play = std::max(in, out);
    return play > least ? (b.remainder + std::min(0.0, b.fracture)) / play : 0;
}

std::string how_to_close(Solver solver) {
    if (solver == Solver::quasistatic) {
        return "between frames that lie far apart the work of tools is misjudged: try more frames";
    }
    if (solver == Solver::implicit_steps) {
        return "implicit steps damp by themselves: try more frames, which shorten them, or solver "
               "= \"explicit\"";
    }
    const std::string shorter = solver == Solver::energy_stepped
                                    ? "solver = \"explicit\" with a low step_safety"
                                    : "a lower step_safety";
    return "try " + shorter +
           ", more cells, or, where bodies are pressed deep into each other, a larger "
           "contact_stiffness";
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
        warn(sim.solver == Solver::quasistatic
                 ? "none of its tools bears on the work-piece at the end of any frame: none "
                   "reached it, or they parted again within a frame, as they do where nothing "
                   "holds it"
                 : "its tools never touched the work-piece");
    }
    if (whole && !end.machine.apparatus.blade.empty() && end.totals.severed == 0) {
        warn(
            "the blade has met no matter: it passed beside the work-piece, or through a gap in it");
    }
    if (whole && end.totals.severed > 0 && piece_count(end.bodies) == pieces_before) {
        warn(fmt::format(
            "the blade has severed {} connections and parted nothing: it passed through a part of "
            "the work-piece only, by its place, its width or its way",
            end.totals.severed));
    }
    if (const double share = unaccounted(end.first, end.last, round_off(end.bodies));
        // At rest, what snaps or slips through is lost, and no mistake.
        sim.solver == Solver::quasistatic ? share < -kMostGain : std::abs(share) > kMostGain) {
        warn(fmt::format("the energy books do not close: {:.3g} % of the energy in play is {}; {}",
                         100 * std::abs(share), share > 0 ? "lost" : "from nowhere",
                         how_to_close(sim.solver)));
    }
    if (sim.solver == Solver::quasistatic && (end.last.pieces == 1 || sim.self_contact) &&
        ended != StageEnded::interrupted) {
        Aggregate& body = end.bodies.front().matter;
        verdict.overlap = own_overlap(body);
        if (verdict.overlap > kOverlap * body.lattice.spacing) {
            warn(fmt::format("the work-piece has gone into itself, by {} at the end: {}",
                             length_text(verdict.overlap),
                             sim.self_contact
                                 ? "it is pressed together harder than its contact_stiffness holds"
                                 : "self_contact = true in this stage keeps it from that"));
        }
    }
    return verdict;
}

}  // namespace swage

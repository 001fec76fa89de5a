// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_cuts.h"

#include <algorithm>

#include "pipeline/blade_entry.h"
#include "pipeline/settled_cut.h"
#include "sim/blade_way.h"
#include "sim/sever.h"

namespace swage {

namespace {

bool is_any(const std::vector<char>& blades) {
    return std::ranges::any_of(blades, [](char one) { return one != 0; });
}

}  // namespace

StageCuts::StageCuts(const StageSpec& stage, const Machine& machine, const StageWay& way,
                     std::vector<WorkPiece>& bodies, StageTotals& totals, WarningBook& warnings)
    : stage_(stage),
      machine_(machine),
      way_(way),
      bodies_(bodies),
      totals_(totals),
      warnings_(warnings),
      settled_(bodies.size(), Blades(machine.apparatus.blade.size(), 0)),
      through_(settled_),
      first_way_(bodies.size(), std::vector<Vec3>(machine.apparatus.blade.size(), Vec3::Zero())) {}

bool StageCuts::is_cut(std::size_t body) const { return is_any(marked(body, kCut)); }

StageCuts::Blades StageCuts::marked(std::size_t body, char as) const {
    Blades blades = settled_[body];
    for (char& one : blades) one = one == as;
    return blades;
}

void StageCuts::plan(Simulation& simulation, const FrameReport& last, int number) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        look_for_blades_out(b, way_.leg_ahead());
        const Blades open = marked(b, 0);
        if (!is_any(open)) continue;
        const std::vector<Drive> leg = way_of(open, way_met(b, way_.leg_ahead(), last));
        const Blades come = reaching(simulation, b, open, leg);
        if (is_any(come)) {
            settle(simulation, b, come, last, number);
        } else {
            look_for_blades(b, leg);
        }
    }
}

void StageCuts::plan_anew(Simulation& simulation, const FrameReport& last, int number) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const Blades cut = marked(b, kCut), grazed = marked(b, kGrazed);
        if (is_any(cut)) {
            simulation.plan_cuts(b, way_.ahead(), way_.steps(), cut);
            keep_what_is_not_shown(b, simulation, bodies_[b], cut);
        }
        if (is_any(grazed)) settle(simulation, b, grazed, last, number);
    }
}

// Those of them that would sever anything on this leg.
StageCuts::Blades StageCuts::reaching(const Simulation& simulation, std::size_t body,
                                      const Blades& of, std::span<const Drive> leg) const {
    Blades come(of.size(), 0);
    if (!simulation.blades_reach(body, leg)) return come;
    for (std::size_t n = 0; n < of.size(); ++n) {
        if (!of[n]) continue;
        Blades alone(of.size(), 0);
        alone[n] = 1;
        come[n] = simulation.blades_reach(body, way_of(alone, leg));
    }
    return come;
}

// The blades' way as a body meets it: where nothing holds that, it flies on. What it touches as the
// stage begins is known only once it has moved.
std::vector<Drive> StageCuts::way_met(std::size_t body, std::span<const Drive> way,
                                      const FrameReport& last) const {
    const Apparatus& apparatus = machine_.apparatus;
    const bool flies = in_motion(stage_.sim.solver) && !is_gripped(apparatus, body) &&
                       !(last.body[body].contact > 0);
    if (!flies) return {way.begin(), way.end()};
    const bool is_alone = apparatus.tool.empty() && bodies_.size() == 1;
    const bool falls = is_alone || way_.gone() > 0;
    return way_in_flight(bodies_[body].matter, apparatus, way,
                         falls ? stage_.sim.gravity : Vec3::Zero());
}

void StageCuts::settle(Simulation& simulation, std::size_t body, const Blades& blades,
                       const FrameReport& last, int number) {
    const bool is_cut = settle_cut(machine_, way_met(body, way_.ahead(), last), way_.steps(),
                                   blades, body, simulation, bodies_[body], number, warnings_);
    for (std::size_t n = 0; n < blades.size(); ++n) {
        if (!blades[n]) continue;
        settled_[body][n] = is_cut ? kCut : kGrazed;
        first_way_[body][n] = way_ahead(n);
    }
    if (!is_cut) totals_.entered = bodies_[body].matter.lattice.spacing;
}

Vec3 StageCuts::way_ahead(std::size_t blade) const {
    return way_between(machine_.apparatus.blade[blade], way_.now().world_from_blade[blade],
                       way_.next().world_from_blade[blade]);
}

std::vector<StageCuts::Blades> StageCuts::coming_again() const {
    std::vector<Blades> again = through_;
    for (std::size_t b = 0; b < again.size(); ++b) {
        for (std::size_t n = 0; n < again[b].size(); ++n) {
            again[b][n] = again[b][n] && way_ahead(n).dot(first_way_[b][n]) > 0;
        }
    }
    return again;
}

// Those that move beside what they have cut, and no more in it.
void StageCuts::look_for_blades_out(std::size_t body, std::span<const Drive> leg) {
    for (std::size_t n = 0; n < through_[body].size(); ++n) {
        if (settled_[body][n] != kCut || through_[body][n]) continue;
        Blades alone(through_[body].size(), 0);
        alone[n] = 1;
        const auto swept = swept_triangles(machine_.apparatus, way_of(alone, leg));
        through_[body][n] = passes_beside(swept, bodies_[body].matter);
    }
}

// Where nothing is severed: whether there is matter that blades go into on this leg.
void StageCuts::look_for_blades(std::size_t body, std::span<const Drive> leg) {
    if (totals_.entered > 0 || totals_.severed > 0) return;
    if (enters_matter(swept_triangles(machine_.apparatus, leg), bodies_[body].matter)) {
        totals_.entered = bodies_[body].matter.lattice.spacing;
    }
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "machines/start_notes.h"
#include "pipeline/books_verdict.h"
#include "pipeline/boundary_note.h"
#include "pipeline/thin_pieces_note.h"
#include "sim/cell_volume.h"
#include "sim/flowed_volume.h"
#include "sim/gripped_pieces.h"
#include "sim/own_overlap.h"
#include "sim/standing_contacts.h"

namespace swage {

namespace {

constexpr double kSwollen = 0.01;  // of its volume that a skin may be off by untold
constexpr double kSame = 1e-3;     // and what that may change by in a stage untold
constexpr double kShrunk = 0.01;   // likewise, that flow may change it by
constexpr double kOverlap = 0.5;   // spacings that a body may lie in itself or another untold

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
// itself. Of several, the one that is thrown fastest, beside those that have been told to lie deep
// in something. Empty: none is.
std::string pressed_at_start(const StageEnd& end) {
    if (!in_motion(end.stage.sim.solver)) return {};
    std::size_t worst = 0, count = 0;
    double fastest = 0, thrown_by = 0;
    for (std::size_t b = 0; b < end.last.body.size(); ++b) {
        if (end.told_deep[b]) continue;
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

// What of bodies lies deeper in another than contact should let it: the worst of it, beside what
// lay so as the stage began, which has been told. Empty: none does.
std::string lies_in_another(const StageEnd& end) {
    const std::vector<double> depth = overlaps_of(end.bodies, end.stage.sim);
    const auto spacing = [&](std::size_t b) { return end.bodies[b].matter.lattice.spacing; };
    std::size_t worst = 0, into = 0;
    double most = kOverlap;
    for (std::size_t b = 0; b < depth.size(); ++b) {
        for (std::size_t c = 0; c < b; ++c) {
            // The deepest of both is the same point.
            if (!(depth[b] > 0) || depth[b] != depth[c]) continue;
            const double cell = std::max(spacing(b), spacing(c));
            if (std::min(end.overlaps_before[b], end.overlaps_before[c]) > kOverlap * cell) {
                continue;
            }
            if (depth[b] > most * cell) most = depth[b] / cell, worst = b, into = c;
        }
    }
    if (worst == into) return {};
    return fmt::format(
        "{} and {} lie {} deep in each other at the end: they met faster, or are pressed together "
        "harder, than contact holds; more cells, a larger contact_stiffness or a lower speed avoid "
        "that",
        end.bodies[into].name, end.bodies[worst].name, length_text(depth[worst]));
}

// Why a skin is off its matter's volume.
std::string how_it_folds(const WorkPiece& body) {
    const double usual = *SkinSettings().longest_edge;
    double longest = 0;  // spacings
    for (const Corners& t : body.skin.triangle) {
        for (int n = 0; n < 3; ++n) {
            const Vec3 edge = body.skin.position[t[n]] - body.skin.position[t[(n + 1) % 3]];
            longest = std::max(longest, edge.norm() / body.matter.lattice.spacing);
        }
    }
    if (longest <= 1.01 * usual) {
        return "it has folded within single cells, and smaller ones make it less";
    }
    return fmt::format(
        "its triangles are as long as {:.2g} cells, between which it stays flat: [skin] divide = "
        "{} makes it less",
        longest, usual);
}

// Flow that keeps the volume, and a skin that does not. Empty: as large as it should be.
std::string swollen(const StageEnd& end, const WorkPiece& body) {
    const double by = swollen_by(body).value_or(0);
    if (std::abs(by) <= kSwollen) return {};
    const bool frame4 = body.mount.kind == SkinKind::frame4;
    return fmt::format(
        "the skin of {} encloses {:.2g} % {} than its matter, which flows at one volume: {}",
        name_among(end.bodies, body), 100 * std::abs(by), by > 0 ? "more" : "less",
        frame4 ? "skin.kind = \"mount\" keeps it" : how_it_folds(body));
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

// A piece whose skin takes up more or less than its matter, by what the stage has done; what was so
// has been told.
std::string piece_swollen(const StageEnd& end, std::size_t b) {
    const std::optional<PieceOff> off = piece_off(end.bodies[b]);
    if (!off || std::abs(off->by) <= kSwollen) return {};
    if (std::abs(off->by - end.volumes_before[b].piece) < kSame) return {};
    return fmt::format(
        "the skin of {}{} encloses {:.2g} % {} than its matter: {}",
        off->is_of_several ? "a piece of " : "", name_among(end.bodies, end.bodies[b]),
        100 * std::abs(off->by), off->by > 0 ? "more" : "less",
        off->spans ? "parts of it are stretched from one piece to another; smaller cells or "
                     "skin.kind = \"boundary\" avoid that"
                   : "cells that a cut or a break runs through are springs, which keep no volume; "
                     "smaller ones make it less");
}

// A boundary that the stage has left off its matter's volume; what was so has been told.
std::string boundary_left_off(const StageEnd& end, std::size_t b) {
    const double before = end.volumes_before[b].off.value_or(0);
    const double off = boundary_off(end.bodies[b]).value_or(0);
    if (std::abs(off - before) < kSame) return {};
    return boundary_note(end.bodies, end.bodies[b]);
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

// What moves past an edge between two places of its way is not swept by it.
std::string carried_past(const std::string& passed, bool one) {
    return fmt::format(
        "{} passed the edge uncut, as the body itself moved {} past it: move the blade faster than "
        "the body, or let the body fly freely against its way (more frames do not help)",
        passed, one ? "it" : "them");
}

// Why no blade has severed anything: what goes through a cell may pass between its particles.
std::string why_nothing_is_cut(const StageEnd& end) {
    std::size_t standing = 0;
    const std::size_t blades = end.machine.apparatus.blade.size();
    for (std::size_t n = 0; n < blades; ++n) standing += blade_stands(end.machine, n);
    if (standing == blades) {
        return fmt::format(
            "blades cut only by their own motion, and {}: what moves against {} is not cut",
            blades == 1 ? "this one stands still" : "these stand still",
            blades == 1 ? "it" : "them");
    }
    const std::size_t passed = end.totals.passed;
    if (passed > 0) {
        return "the blade severed nothing: " +
               carried_past(counted(passed, "connection", "connections"), passed == 1);
    }
    if (end.totals.entered == 0) {
        return "the blade met no matter: it passed beside the work-piece or through a gap in it";
    }
    return fmt::format(
        "the blade went into matter but severed nothing: what is narrower than a cell, {}, or goes "
        "in by less than one, passes between particles; smaller cells or a wider blade avoid that",
        length_text(end.totals.entered));
}

// What a blade has found on its way that had been through and out again, and what had moved since.
// It cuts none of that; less than a tenth of all cuts may be crumbs that it left the first time.
std::string uncut_again(const StageEnd& end) {
    const std::size_t again = end.totals.passed_again;
    if (10 * again <= static_cast<std::size_t>(end.totals.severed)) return {};
    return fmt::format(
        "{} passed uncut a blade that had come out and goes through again: in one stage a blade "
        "cuts along the path on which it first meets a body; give each of its strokes a stage of "
        "its own",
        counted(again, "connection", "connections"));
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
        const std::size_t passed = end.totals.passed;
        warn(fmt::format(
            "the blade severed {} connections but separated nothing: {}", end.totals.severed,
            passed > 0 ? carried_past(counted(passed, "other", "others"), passed == 1)
                       : "owing to its place, width or path it passed through only a part of the "
                         "work-piece"));
    }
    if (const std::string again = uncut_again(end); !again.empty()) warn(again);
    if (whole) {
        for (const std::string& one : idle_parts(end)) warn(one);
    }
    if (end.totals.severed > 0) {
        for (const std::string& one : thin_pieces_notes(end.bodies, sim)) warn(one);
    }
    if (const std::string pressed = pressed_at_start(end); !pressed.empty()) warn(pressed);
    for (const std::string& one : judge_books(end)) warn(one);
    for (std::size_t b = 0; b < end.bodies.size(); ++b) {
        if (ended == StageEnded::interrupted) break;
        for (const std::string& told :
             {swollen(end, end.bodies[b]), piece_swollen(end, b), boundary_left_off(end, b),
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
    if (ended != StageEnded::interrupted) {
        if (const std::string told = lies_in_another(end); !told.empty()) warn(told);
    }
    return verdict;
}

std::vector<double> overlaps_of(std::vector<WorkPiece>& bodies, const SimSettings& sim) {
    if (!in_motion(sim.solver) || bodies.size() < 2) return std::vector<double>(bodies.size(), 0);
    std::vector<Aggregate*> matter;
    for (WorkPiece& body : bodies) matter.push_back(&body.matter);
    std::vector<double> depth;
    for (const ContactSums& one : standing_contacts(matter, sim)) depth.push_back(one.penetration);
    return depth;
}

}  // namespace swage

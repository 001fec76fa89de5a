// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/thin_pieces_note.h"

#include <algorithm>

#include "base/text.h"

namespace swage {

namespace {

constexpr double kLittle = 0.01;  // of a body's mass, of which nothing is said

std::string note_of(const std::vector<WorkPiece>& bodies, const WorkPiece& body) {
    const Aggregate& matter = body.matter;
    if (matter.breaks()) return {};
    const Pieces pieces = find_pieces(matter);
    if (pieces.count < 2) return {};
    std::vector<char> is_thin(static_cast<std::size_t>(pieces.count), 1);
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const auto row = matter.lattice.cell_row(run.first + n);
            if (cell_is_whole(matter, row)) is_thin[std::size_t(pieces.particle_piece[row[0]])] = 0;
        }
    }
    const auto count = std::count(is_thin.begin(), is_thin.end(), 1);
    double mass = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        if (is_thin[std::size_t(pieces.particle_piece[p])]) mass += matter.particle_mass[p];
    }
    if (mass < kLittle * matter.mass()) return {};
    return fmt::format(
        "{} of the {} pieces of {} {} no whole cell: other pieces sink into {} by up to half a "
        "cell{}; smaller cells, or cuts further apart, avoid that",
        count, pieces.count, name_among(bodies, body), count == 1 ? "holds" : "hold",
        count == 1 ? "it" : "them", count == 1 ? "" : ", and they into each other wholly");
}

}  // namespace

std::vector<std::string> thin_pieces_notes(const std::vector<WorkPiece>& bodies,
                                           const SimSettings& sim) {
    std::vector<std::string> notes;
    for (const WorkPiece& body : bodies) {
        if (!sim.self_contact || in_motion(sim.solver)) break;  // sim/thin_piece.h
        std::string note = note_of(bodies, body);
        if (!note.empty()) notes.push_back(std::move(note));
    }
    return notes;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// A cut, settled once a blade is about to reach a body: in its matter and, along the same path, in
// its skin, of which both part the same pieces.
#pragma once

#include <span>
#include <vector>

#include "machines/machine.h"
#include "pipeline/warning_book.h"
#include "pipeline/work_piece.h"
#include "sim/advance.h"

namespace swage {

// Plans the cuts of the marked blades in the coming frames, of `steps` drives each, in the
// simulation's body of that number, and cuts its skin. What the skin does not part, as its piece is
// less than a cell (skin/cut_mesh.h), stays in the matter with what it would be cut from; so do
// crumbs, but for those that the skin parts and that can carry it as they turn. False where nothing
// else would be cut: then the skin is as it was.
bool settle_cut(const Machine& machine, std::span<const Drive> way, int steps,
                const std::vector<char>& blades, std::size_t body, Simulation& simulation,
                WorkPiece& piece, int frame, WarningBook& warnings);

// Of a skin that was cut so before, of cuts that were planned since: the same.
// False where nothing else would be cut.
bool keep_what_is_not_shown(std::size_t body, Simulation& simulation, const WorkPiece& piece,
                            const std::vector<char>& blades);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// What bodies take up, by their matter and by their skins.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/json_name.h"
#include "pipeline/work_piece.h"

namespace swage {

struct BodyVolume {
    double matter;                   // present_volume() [m3]
    double flowed;                   // flowed_volume()
    std::optional<double> skin;      // what it encloses, where it is closed [m3]
    std::optional<double> off = {};  // boundary_off()
    double piece = 0;                // piece_off(); 0 of a whole body
};
std::vector<BodyVolume> body_volumes(const std::vector<WorkPiece>& bodies);

// By what share of its volume a boundary encloses more than its matter (below 0: less) as it was
// made, where that is known. Of other skins nothing.
std::optional<double> boundary_off(const WorkPiece& body);

// By body, as a stage began and now.
Json volumes_json(const std::vector<WorkPiece>& bodies, const std::vector<BodyVolume>& at_start);

// Flow keeps the volume of matter. Of a whole body of cells that have flowed, by what share of its
// volume its skin has grown more than its matter (below 0: less), where that is known.
std::optional<double> swollen_by(const WorkPiece& body);

// Cuts and breaks make no volume. Of a body that they have parted the piece that is most off, but
// for crumbs: by what share of its volume the skin has grown more than its matter since both were
// made (below 0: less). Nothing of a whole body, and where that is not known.
struct PieceOff {
    double by = 0;
    bool spans = false;          // several pieces share a part of the skin, and count as one
    bool is_of_several = false;  // there are others
};
std::optional<PieceOff> piece_off(const WorkPiece& body);

}  // namespace swage

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

// Cuts and breaks make no volume. By what share of its volume a skin that spans pieces of matter,
// and is not made anew, has grown more than that since `before` (below 0: less), where that is
// known.
std::optional<double> stretched_by(const WorkPiece& body, const BodyVolume& before);

}  // namespace swage

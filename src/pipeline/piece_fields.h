// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of a work-piece's matter on its skin, as they are now.
#pragma once

#include "matter/skin_field.h"
#include "pipeline/work_piece.h"

namespace swage {

SkinFieldValues fields_on_skin(const WorkPiece& piece, const std::vector<SkinField>& fields);
// Of each body.
std::vector<SkinFieldValues> fields_on_skins(const std::vector<WorkPiece>& bodies,
                                             const std::vector<SkinField>& fields);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of a work-piece's matter, as they are now, on its skin or at other places of it.
#pragma once

#include "matter/skin_field.h"
#include "pipeline/work_piece.h"

namespace swage {

SkinFieldValues fields_at(const Mount& mount, const Aggregate& matter,
                          const std::vector<SkinField>& fields);
SkinFieldValues fields_on_skin(const WorkPiece& piece, const std::vector<SkinField>& fields);
// Of each body.
std::vector<SkinFieldValues> fields_on_skins(const std::vector<WorkPiece>& bodies,
                                             const std::vector<SkinField>& fields);

}  // namespace swage

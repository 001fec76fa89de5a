// SPDX-License-Identifier: GPL-3.0-or-later
// What is settled about a mold before any cell is made.
#pragma once

#include "mold/frame.h"
#include "mold/mold.h"

namespace swage {

// Of the positions that triangles use. Throws Error(mesh) without any.
Box surface_box(const TriMesh& mesh);

// Throws FinenessError(resources) naming cells, bytes and limit.
void refuse_too_many_cells(const TriMesh& mesh, const MoldSettings& settings);

// What a mold tells of gaps that its cells fill, without the lattice; empty: nothing. Takes 0.3 s
// and 60 MB a million cells.
std::string filled_gap_text(const TriMesh& mesh, const MoldSettings& settings);

}  // namespace swage

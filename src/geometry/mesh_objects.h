// SPDX-License-Identifier: GPL-3.0-or-later
// The objects that a mesh of several pieces is in a file.
#pragma once

#include <string>
#include <vector>

#include "geometry/trimesh.h"

namespace swage {

struct MeshObjects {
    std::vector<std::string> name;
    std::vector<int> triangle;  // one a triangle, into name; empty: each part is one
};

// `piece`: a number a triangle, from 0 on, in the order in which they are to be named. Pieces of
// one part alone have its name, those that have several, and what else is of these, `body`'s; of
// several of one name each is called NAME_piece_1 and so on. What is in one piece, each part by
// itself or all together, stays as its parts say.
MeshObjects objects_of_pieces(const TriMesh& mesh, const std::vector<int>& piece,
                              const std::string& body);

}  // namespace swage

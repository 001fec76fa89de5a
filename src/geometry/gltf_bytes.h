// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of glTF files: a document alone, or GLB's chunks (glTF 2.0, section 4.4); and bytes
// that stand in a document as text (RFC 4648, section 4).
#pragma once

#include <string>
#include <string_view>

#include "geometry/mesh_read_child.h"

namespace swage {

std::string to_base64(const std::string& bytes);
std::string from_base64(std::string_view text);  // what is no digit is passed over

// Of a GLB file: a header of 12 bytes, then chunks of a length, a kind and bytes.
struct GltfParts {
    std::string json;
    std::string rest;  // what follows the JSON chunk, whole
};

// False where the file is no glTF 2 file of either kind.
bool take_apart(const MeshSource& source, GltfParts& parts);
// What the chunks that follow the JSON begin with; `rest` has 8 bytes at least.
std::string first_chunk(const std::string& rest);
// As the source came. Throws Error(mesh): larger than a GLB file can be.
void put_together(GltfParts parts, MeshSource& source);

}  // namespace swage

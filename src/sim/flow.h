// SPDX-License-Identifier: GPL-3.0-or-later
// Whether forces and tangents are asked for with what flows or without.
#pragma once

namespace swage {

enum class Flow {
    trial,  // what yields or softens goes on from the committed history
    none,   // nothing flows or softens further
};

}  // namespace swage

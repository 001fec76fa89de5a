// SPDX-License-Identifier: GPL-3.0-or-later
// What forces and tangents are asked for with, and whether they still stand for what is there.
#pragma once

namespace swage {

enum class Flow {
    trial,  // what yields or softens goes on from the committed history
    none,   // nothing flows or softens further
};

// What was found last, for whoever goes on by what was seen there.
enum class Forces {
    fresh,  // with what flows, at these very positions: what was seen is all that matters
    stale,  // maybe elsewhere
};

}  // namespace swage

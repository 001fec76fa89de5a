// SPDX-License-Identifier: GPL-3.0-or-later
// Places of the matter that a user asked to follow ([[probe]]), for the curves and run.json.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"

namespace swage {

struct ProbePlace {
    std::string name;
    Vec3 place;                      // [m], where the matter is now
    std::vector<SkinField> field{};  // of the matter there, as the scene asks
    std::vector<double> value{};     // of each, in its unit (matter/skin_field.h)

    template <typename Io>
    void visit(Io& io) {
        io(name, place, field, value);
    }
};

// Binds the probes of a body that was just molded and not placed yet. Throws SceneError where one
// lies beside the matter.
Mount mount_probes(const BodySpec& body, const TriMesh& mesh, const Aggregate& matter);

// Of all bodies, in the order of the scene.
std::vector<ProbePlace> probe_places(const std::vector<BodySpec>& specs,
                                     const std::vector<WorkPiece>& bodies);

}  // namespace swage

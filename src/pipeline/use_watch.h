// SPDX-License-Identifier: GPL-3.0-or-later
// How much of what they can bear the bodies of a stage used, at the most of all its frames
// (sim/strength_use.h).
#pragma once

#include <string>
#include <vector>

#include "pipeline/json.h"
#include "pipeline/work_piece.h"
#include "sim/strength_use.h"

namespace swage {

class UseWatch {
  public:
    // As the stage begins.
    explicit UseWatch(const std::vector<WorkPiece>& bodies);

    // After each frame.
    void look(int frame, const std::vector<WorkPiece>& bodies);

    template <typename Io>
    void visit(Io& io) {  // what looking changes
        for (OfBody& of : body_) io(of.use, of.yield, of.strength);
    }

    // For run.json: of each body by its name what may flow and what may break; `bodies` as the
    // stage ends.
    Json json(const std::vector<WorkPiece>& bodies) const;

  private:
    struct Peak : Used {
        using IsPlain = Peak;
        int frame = 0;
    };
    struct OfBody {
        StrengthUse use;
        Peak yield, strength;
    };
    std::vector<OfBody> body_;
};

// Of a stage's record, a line for each body that uses any: "bend, bar: yields ...".
std::vector<std::string> use_texts(const Json& stage);

}  // namespace swage

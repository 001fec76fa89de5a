// SPDX-License-Identifier: GPL-3.0-or-later
// By how much a stage has bent its work-piece: by what its ends have turned against each other,
// beside what its tools have. What slips, rolls or tilts between them turns whole, and is not bent.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "machines/machine.h"
#include "pipeline/json.h"

namespace swage {

class BendWatch {
  public:
    // As the stage begins. Looks only where tools go round against each other by less than a turn,
    // and neither a grip nor a blade has a hand in it.
    BendWatch(const Machine& machine, const Drive& start, const Aggregate& work_piece);

    // After each leg.
    void look(int frame, const Drive& now, const Aggregate& work_piece);

    // With the most that its tools and its ends turned, and the ends at last, in degrees. As the
    // stage ends.
    void add_to(Json& record, const Aggregate& work_piece) const;
    // Empty: it is bent by half as much as its tools turned, or they have not.
    std::string warning(const Aggregate& work_piece) const;

    template <typename Io>
    void visit(Io& io) {  // what looking changes
        io(tools_, ends_, asked_, held_, frame_);
    }

  private:
    struct Ends {  // particles, and where they were
        std::vector<std::size_t> particle;
        std::vector<Vec3> place;
    };
    bool is_parted(const Aggregate& work_piece) const;

    std::array<Quat, 2> tool_start_{};
    std::array<std::size_t, 2> tool_{};  // the one that goes farther, against the other
    std::array<Ends, 2> end_;
    Vec3 axis_ = Vec3::Zero();  // in the world; zero: it does not look
    std::size_t particles_ = 0;
    bool was_parted_ = false;
    double tools_ = 0, ends_ = 0;  // turned by now [rad]
    double asked_ = 0, held_ = 0;  // the most
    int frame_ = 0;                // of the most that was held
};

// Of a stage's record: "bend: bent by ...". Empty: its tools do not bend.
std::string bend_text(const Json& stage);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// How each body moved in a stage, frame by frame: the table of curves/<stage>-bodies.csv.
#pragma once

#include <string>
#include <vector>

#include "pipeline/work_piece.h"
#include "sim/advance.h"

namespace swage {

// Along the world's axes.
struct BodyMotion {
    Vec3 centre;            // of mass [m]
    Vec3 velocity;          // of that [m/s]
    Vec3 angular_momentum;  // about it [kg m2/s]
    Vec3 spin;              // of the rigid body with this angular momentum and inertia [rad/s]
};
BodyMotion motion_of(const Aggregate& matter);

class BodyTable {
  public:
    // The first row is the start of the stage. What contacts hold there the first add() tells.
    BodyTable(int first_frame, const std::vector<WorkPiece>& bodies, const FrameReport& start);
    void add(int frame, const std::vector<WorkPiece>& bodies, const FrameReport& report);

    // Comma separated, a row for each frame and body; the first line names each column and its
    // unit.
    std::string csv_text() const;

    template <typename Io>
    void visit(Io& io) {
        io(row_);
    }

  private:
    struct Row {
        using IsPlain = Row;

        int frame;
        double time;
        std::size_t body;
        BodyMotion motion;
        Books books;
    };
    std::vector<std::string> name_;
    std::vector<Row> row_;
};

}  // namespace swage

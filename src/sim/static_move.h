// SPDX-License-Identifier: GPL-3.0-or-later
// What a solver of equilibria knows of one move, and what a try at its end has come to.
#pragma once

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/drive_motion.h"

namespace swage {

struct StaticMove {
    const Drive &from, &to;
    int depth;  // how often the drive's own move has been halved
    // Positions: before the move; and where the drag pulls back to, those at first.
    Vec3Array start, rest{};
    double elastic = 0, booked = 0;  // before it, where that is asked for [J]
    DriveMotion motion{};
    bool released = false;    // a load grows less, or a tool draws back
    bool let_go = false;      // nothing moves, but what was cut or lost its grips
    CellHistories history{};  // before it, where what has flowed was changed since
    double seated = 0;        // the farthest that any piece was seated before the try [m]
};

struct Relaxation {
    bool converged = false;
    int iterations = 0;
    double residual = 0;
    bool falls = false;    // it, or a piece of it
    bool buckled = false;  // an equilibrium on the way was unstable
};

}  // namespace swage

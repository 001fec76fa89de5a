// SPDX-License-Identifier: GPL-3.0-or-later
// What a solver reports of one move of the drive.
#pragma once

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "matter/drive.h"
#include "sim/contact_sums.h"
#include "sim/part_sum.h"
#include "sim/step_counts.h"

namespace swage {

// What a body holds at one time [J].
struct Stored {
    using IsPlain = Stored;
    double kinetic = 0, elastic = 0;
    double contact = 0;  // in the springs of contacts and grips

    double sum() const { return kinetic + elastic + contact; }
};

// What one body went through in a move.
struct BodyOutcome {
    Stored before, after;
    double plastic_work = 0;        // [J]
    double fracture_work = 0;       // [J]
    double friction_work = 0;       // [J]
    double set_free = 0;            // that cracks, cuts and grips that are gone let go of at a
                                    // standing drive [J]; quasi-static only
    int broken = 0;                 // connections
    double damped_work = 0;         // [J]; in motion only
    double drag_work = 0;           // [J]; in motion only
    bool drag_bounded = false;      // was more than a step can follow
    std::vector<double> work;       // by tool, then grip [J]
    std::vector<char> touched;      // likewise: at the end of any step; in motion only
    std::vector<double> load_work;  // by load, then gravity [J]
    std::vector<PartSum> part;      // at the end, by tool, then grip
    ContactSums by_contact;         // with other bodies and itself

    BodyOutcome(const Apparatus& apparatus, std::size_t loads)
        : work(apparatus.tool.size() + apparatus.grip.size(), 0.0),
          touched(work.size(), 0),
          load_work(loads, 0.0) {}

    // On the body by tools, grips, loads and gravity [J].
    double done() const {
        return std::accumulate(work.begin(), work.end(), 0.0) +
               std::accumulate(load_work.begin(), load_work.end(), 0.0);
    }
    double lost() const {  // [J]
        return plastic_work + fracture_work + friction_work + damped_work + drag_work +
               by_contact.damped + by_contact.friction;
    }
    // Fracture that gives energy is no account of it. `booked_late`: what of it is not booked yet,
    // less what was booked of earlier steps [J].
    double lost_since(const BodyOutcome& then, double booked_late = 0) const {  // [J]
        const double fracture = fracture_work - then.fracture_work + booked_late;
        return lost() - then.lost() + booked_late + std::max(0.0, -fracture);
    }
};

// Why a move was given up, and where the matter has got to.
struct MoveEnd {
    Error why;
    Drive at;
};

struct MoveOutcome : StepCounts {
    std::vector<BodyOutcome> body;
    int asleep = 0;               // bodies at rest at the end; in motion only
    int inside_out = 0;           // cells at once that shorter steps did not keep from it
    int afloat = 0, hanging = 0;  // pieces that would fall, or swing about a hinge, from now on
    int let_be = 0;               // points of it that meet the work-piece no more, from now on
    double left_over = 0;  // of forces, at any rest from now on, where it is more than before [N]
    double rounded = 0;    // the same where loads are small beside what rounded places leave [N]
    bool buckled = false;  // an equilibrium on the way was unstable, and left
    std::vector<std::string> lost;     // tools that the work-piece has slipped away from
    std::vector<std::string> pierced;  // tools that points of it have gone through
    std::optional<LimitStop> stop;     // the move ended there, for a limit
    std::optional<MoveEnd> given_up;   // or there, for want of any way on

    // Where it ended on its way to there.
    const Drive& end(const Drive& to) const {
        return stop ? stop->at : given_up ? given_up->at : to;
    }
};

// Work [J] that each tool and grip did while its pose went from one to another under these loads
// before and after: the trapezoid rule on force and torque of the pose's origin.
void add_work(const Drive& from, const Drive& to, const std::vector<PartSum>& before,
              const std::vector<PartSum>& after, std::vector<double>& work);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage did, for run.json.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "machines/machine.h"
#include "pipeline/body_volumes.h"
#include "pipeline/curves.h"
#include "pipeline/json_name.h"
#include "pipeline/probes.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"
#include "sim/advance.h"

namespace swage {

// Over all frames of a stage.
struct StageTotals : StepCounts {
    using IsPlain = StageTotals;

    long severed = 0, broken = 0;
    double penetration = 0;  // [m]
    double stored = 0;       // at the end of any frame, the most [J]
    bool touched = false;    // by a tool: quasi-static at the end of a leg, in motion of any step
    double entered = 0;      // spacing of what blades went into and severed nothing of; 0: nothing
    std::size_t passed = 0;  // connections that their motion took past a blade, uncut
    std::size_t passed_again = 0;  // likewise, at rest too, past one that had been through
    double remainder = 0;          // of the books, by now [J]
    double snapped = 0;            // the most by which one frame made it more [J]
    int snapped_in = 0;            // that frame

    void add(int number, const FrameReport& report, std::size_t tools) {
        count(report);
        const double more = report.remainder - std::exchange(remainder, report.remainder);
        if (more > snapped) snapped = more, snapped_in = number;
        severed += report.severed;
        broken += report.broken;
        stored = std::max(stored, report.kinetic + report.elastic + report.contact);
        for (std::size_t n = 0; n < report.load.size(); ++n) {
            penetration = std::max(penetration, report.load[n].penetration);
            touched = touched || (n < tools && report.load[n].touched);
        }
    }
};

// Where it got to.
struct StageEnd {
    const StageSpec& stage;
    const Machine& machine;
    std::vector<WorkPiece>& bodies;
    const StageTotals& totals;
    const FrameReport& first;  // as it began; `contact` is not known
    const FrameReport& last;
    int first_frame, last_frame;
    std::size_t legs;
    std::size_t connections_before;
    const std::vector<BodyVolume>& volumes_before;
    const std::vector<double>& overlaps_before;  // of each body with others (overlaps_of())
    const std::vector<char>& told_deep;          // of each: as it began (start_deep())
    std::vector<ProbePlace> probes;
};

std::size_t particle_count(const std::vector<WorkPiece>& bodies);
std::size_t connection_count(const std::vector<WorkPiece>& bodies);
int piece_count(const std::vector<WorkPiece>& bodies);

// `overlap`: the deepest of a body with itself [m].
Json stage_record(const StageEnd& end, const StageCurves& curves, double overlap,
                  const std::vector<std::string>& warnings);

}  // namespace swage

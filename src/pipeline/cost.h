// SPDX-License-Identifier: GPL-3.0-or-later
// What a run will need, before any of it is spent.
#pragma once

#include <string>
#include <vector>

#include "mold/mold.h"
#include "pipeline/counted_matter.h"
#include "pipeline/json.h"
#include "pipeline/machine_place.h"
#include "pipeline/run_options.h"
#include "pipeline/start_warnings.h"
#include "pipeline/step_note.h"
#include "pipeline/time_cost.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

struct BodyCost {
    double spacing = 0;    // [m]
    double cells = 0;      // that hold matter
    double across = 0;     // the thinnest side of its box, in cells: 4.2, where it lies in 5 layers
    double thickness = 0;  // of it, or of its thin parts, in cells: about
    double most_across = 0;  // that its cell_limit allows

    // Most of it is far thinner than its box.
    bool has_thin_parts() const { return thickness < across; }
    // Of the thinnest side, the number of whole ones that are nearest; 0: they are whole.
    int whole_layers() const;
    double outermost_fill() const;  // of those that are not
};

struct RunCost {
    MoldEstimate mold;  // sums over all bodies; spacing and cell_count are the work-piece's
    std::vector<BodyCost> body;
    bool counted = false;             // the mold was made as it is, so its numbers are no estimate
    double tool_give = 0;             // what the softest tool gives way by, in cells; 0: no tools
    int frames = 0;                   // stills, the start included
    CostRange steps;                  // relaxation iterations and steps of motion
    CostRange seconds;                // of simulation, skins, files and drawing
    std::string hangs_on;             // what makes that more or less; empty: nothing much
    double memory_bytes = 0;          // at the peak, about
    double most_memory_bytes = 0;     // the same where all that may break goes to rubble
    double undrawn_memory_bytes = 0;  // about, without pictures
    std::string less_memory;          // what to change for less: "a larger [mold] spacing"
    double disk_bytes = 0;            // of the run directory, when it holds the most, about
    double least_disk_bytes = 0;      // without what it keeps to go on from
    std::vector<std::string> note;    // of the first machine at the work-piece; of steps
    std::vector<MachinePlace> place;  // of each stage; none where the mold was not made
    // `mold` and `bodies` only where the mold was made; `bodies` tells of what the first machine's
    // tools are in, too.
    StartWarnings warning;

    const BodyCost& work_piece() const { return body.front(); }
};

int frame_count(const SceneSpec& scene);

// From sizes alone, at once. Throws as refuse_too_many_cells().
RunCost estimate_cost(const SceneSpec& scene, const std::vector<InputMesh>& input,
                      const RunOptions& options);

inline constexpr double kCountedCells = 300'000;

// The same with molds made for real, and the first machine set up at it, which finds the mistakes
// that only show there. Of more than about `most` cells coarser ones are made in their stead
// (pipeline/counted_matter.h). Throws what these throw.
RunCost count_cost(const SceneSpec& scene, const std::vector<InputMesh>& input,
                   const RunOptions& options, double most = kCountedCells);

Json cost_json(const RunCost& cost);

// Throws Error(resources) when the run would need more memory, disk or time than there is, with
// both numbers and what to change; does nothing when the user insists.
void refuse_excess(const RunCost& cost, const RunOptions& options);

}  // namespace swage

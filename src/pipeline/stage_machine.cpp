// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_machine.h"

#include "base/error.h"
#include "machines/parameters.h"

namespace swage {

namespace {

constexpr double kLegSlack = 0.05;  // spacings

[[noreturn]] void fail_at(const std::string& place, const Error& error) {
    throw Error(error.code(), place.empty() ? error.what() : place + ": " + error.what());
}

}  // namespace

Machine stage_machine(const StageSpec& stage, const Aggregate& work_piece,
                      const std::vector<Material>& beside) {
    try {
        return build_machine(stage.machine, stage.parameter,
                             place_work_frame(work_piece, stage.axis, stage.up), work_piece,
                             beside);
    } catch (const ParameterError& error) {
        const auto given = stage.parameter_place.find(error.parameter());
        fail_at(given != stage.parameter_place.end() ? given->second : stage.place, error);
    } catch (const Error& error) {
        if (error.code() != ExitCode::scene) throw;
        fail_at(stage.place, error);
    }
}

Legs stage_legs(const Machine& machine, int frames, const Aggregate& work_piece) {
    return legs_of(machine, frames, kLegSlack * work_piece.lattice.spacing);
}

}  // namespace swage

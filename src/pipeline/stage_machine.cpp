// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_machine.h"

#include "base/error.h"
#include "machines/parameters.h"

namespace swage {

namespace {

constexpr double kLegSlack = 0.05;  // spacings

std::string told_at(const std::string& place, const Error& error) {
    return place.empty() ? error.what() : place + ": " + error.what();
}

std::string told(const StageSpec& stage, const ParameterError& error) {
    const auto given = stage.parameter_place.find(error.parameter());
    return told_at(given != stage.parameter_place.end() ? given->second : stage.place, error);
}

Machine machine_at(const StageSpec& stage, const Aggregate& work_piece,
                   const std::vector<Material>& beside) {
    return build_machine(stage.machine, stage.parameter,
                         place_work_frame(work_piece, stage.axis, stage.up), work_piece, beside);
}

}  // namespace

Machine stage_machine(const StageSpec& stage, const Aggregate& work_piece,
                      const std::vector<Material>& beside) {
    try {
        return machine_at(stage, work_piece, beside);
    } catch (const ParameterError& error) {
        throw Error(error.code(), told(stage, error));
    } catch (const Error& error) {
        if (error.code() != ExitCode::scene) throw;
        throw Error(error.code(), told_at(stage.place, error));
    }
}

std::vector<std::string> foreseen_mistakes(const SceneSpec& scene, const Aggregate& work_piece,
                                           const std::vector<Material>& beside) {
    std::vector<std::string> mistakes;
    for (std::size_t n = 1; n < scene.stage.size(); ++n) {
        try {
            machine_at(scene.stage[n], work_piece, beside);
        } catch (const ParameterError& error) {
            mistakes.push_back(told(scene.stage[n], error) +
                               " (by the work-piece as it is at first)");
        } catch (const Error&) {
            // Whether it finds what to hold or to touch, the work-piece of then will show.
        }
    }
    return mistakes;
}

Legs stage_legs(const Machine& machine, int frames, const Aggregate& work_piece) {
    return legs_of(machine, frames, kLegSlack * work_piece.lattice.spacing);
}

}  // namespace swage

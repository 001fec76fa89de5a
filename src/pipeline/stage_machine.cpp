// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_machine.h"

#include "base/error.h"
#include "machines/parameters.h"

namespace swage {

namespace {

constexpr double kLegSlack = 0.05;  // spacings

// A machine file does not say which stage it is that asks for it.
std::string in_stage(const std::string& sentence, const StageSpec& stage) {
    return fmt::format("{} (stage \"{}\")", sentence, stage.name);
}

// Tells which stage a sentence foresees.
std::string end_of_foreseen(const StageSpec& stage) {
    return fmt::format(" (stage \"{}\", for the work-piece before the first stage)", stage.name);
}

std::vector<Mistake> placed(const StageSpec& stage, const ParameterError& error) {
    std::vector<Mistake> mistakes;
    for (const auto& [parameter, sentence, place] : error.mistakes()) {
        if (!place.file.empty()) {
            mistakes.push_back(mistake_at(place, in_stage(sentence, stage), ExitCode::scene));
            continue;
        }
        const auto given = stage.parameter_place.find(parameter);
        mistakes.push_back(mistake_at(
            given != stage.parameter_place.end() ? given->second : stage.place, sentence));
    }
    return mistakes;
}

// What a machine says of its own is told where its file has it, else where the stage names it.
template <typename Act>
auto at_stage(const StageSpec& stage, const Act& act) {
    try {
        return act();
    } catch (const ParameterError& error) {
        throw SceneError(placed(stage, error));
    } catch (const PlacedError& error) {
        if (error.place().file.empty()) {
            throw SceneError({mistake_at(stage.place, error.what(), error.code())});
        }
        throw SceneError({mistake_at(error.place(), in_stage(error.what(), stage), error.code())});
    } catch (const Error& error) {
        if (error.code() != ExitCode::scene) throw;
        throw SceneError({mistake_at(stage.place, error.what())});
    }
}

}  // namespace

WorkFrame stage_frame(const StageSpec& stage, const Aggregate& work_piece, const Box& skin) {
    return place_work_frame(work_piece, stage.axis, stage.up, stage.machine.upright, skin);
}

Machine stage_machine(const StageSpec& stage, const Aggregate& work_piece,
                      const std::vector<Material>& beside, const Box& skin, double coarser) {
    return at_stage(stage, [&] {
        return build_machine(stage.machine, stage.parameter, stage_frame(stage, work_piece, skin),
                             work_piece, beside, stage.duration, coarser);
    });
}

std::vector<std::string> foreseen_mistakes(const SceneSpec& scene, const Aggregate& work_piece,
                                           const Box& skin, const std::vector<Material>& beside,
                                           double coarser) {
    std::vector<std::string> mistakes;
    for (std::size_t n = 1; n < scene.stage.size(); ++n) {
        const StageSpec& stage = scene.stage[n];
        try {
            stage_machine(stage, work_piece, beside, skin, coarser);
        } catch (const SceneError& error) {
            for (const Mistake& mistake : error.mistakes()) {
                std::string text = mistake_text(mistake);
                const std::string known = in_stage("", stage);
                if (text.ends_with(known)) text.resize(text.size() - known.size());
                mistakes.push_back(text + end_of_foreseen(stage));
            }
        } catch (const Error&) {
            // Another work-piece may have what this one wants for.
        }
    }
    return mistakes;
}

void forget_foreseen(std::vector<std::string>& warnings, const StageSpec& stage) {
    std::erase_if(warnings, [end = end_of_foreseen(stage)](const std::string& one) {
        return one.ends_with(end);
    });
}

Legs stage_legs(const StageSpec& stage, const Machine& machine, int frames, double spacing,
                double begin) {
    return at_stage(stage, [&] {
        return legs_of(machine, frames, kLegSlack * spacing, in_motion(stage.sim.solver), begin);
    });
}

std::vector<Drive> stage_drives(const StageSpec& stage, const Machine& machine,
                                const std::vector<Leg>& legs, int steps) {
    return at_stage(stage, [&] { return drives_of(machine, legs, steps, stage.duration); });
}

}  // namespace swage

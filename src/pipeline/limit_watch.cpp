// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/limit_watch.h"

#include "base/log.h"
#include "base/units.h"
#include "pipeline/json.h"

namespace swage {

namespace {

std::string amount_text(double amount, bool of_torque) {
    return of_torque ? "a torque of " + quantity_text(amount, Quantity::torque)
                     : quantity_text(amount, Quantity::force);
}

const char* unit_of(bool of_torque) { return of_torque ? "torque_N_m" : "force_N"; }

}  // namespace

std::vector<std::string> limit_texts(const MachineSpec& machine) {
    std::vector<std::string> texts;
    for (const LimitSpec& limit : machine.limit) {
        texts.push_back(fmt::format("the machine stops when {} bears {}", limit.part,
                                    amount_text(limit.most, limit.of_torque)));
    }
    return texts;
}

Json limits_json(const MachineSpec& machine) {
    Json json = Json::array();
    for (const LimitSpec& limit : machine.limit) {
        json.push_back({{"part", limit.part}, {unit_of(limit.of_torque), limit.most}});
    }
    return json;
}

LimitWatch::LimitWatch(const StageSpec& stage, const Machine& machine)
    : stage_(stage), machine_(machine), most_(machine.apparatus.limit.size()) {}

void LimitWatch::look(int frame, const FrameReport& report, bool within) {
    if (stop_) return;
    for (std::size_t l = 0; l < most_.size(); ++l) {
        const LoadLimit& limit = machine_.apparatus.limit[l];
        const ToolLoad& load = report.load[limit.part];
        const double borne = limit.borne(load.force, load.torque, load.pose);
        if (borne > most_[l].borne) most_[l] = {borne, frame, within};
    }
    if (!report.stop) return;
    stop_ = report.stop;
    frame_ = frame;
    const LimitSpec& limit = spec();
    if (is_met()) {
        log_info("{}: {} reached {} at {:.3g} % of the stage, in frame {}, and stops there",
                 stage_.name, limit.part, amount_text(limit.most, limit.of_torque),
                 100 * machine_.stop, frame);
    }
}

const LimitSpec& LimitWatch::spec() const { return machine_.spec.limit[stop_->limit]; }

bool LimitWatch::is_met() const { return stop_->beyond == 0 && stop_->borne <= spec().most; }

std::vector<std::string> LimitWatch::warnings(bool whole) const {
    std::vector<std::string> lines;
    const auto amount = [](double value, const LimitSpec& limit) {
        return amount_text(value, limit.of_torque);
    };
    if (stop_ && !is_met()) {
        const LimitSpec& limit = spec();
        const std::string most = amount(limit.most, limit), borne = amount(stop_->borne, limit);
        lines.push_back(
            stop_->beyond > 0
                ? fmt::format(
                      "{}: {} stops at {:.3g} % of the stage, in frame {}: it bears {} there and "
                      "{} at the smallest advance, which is beyond its limit of {}",
                      stage_.name, limit.part, 100 * machine_.stop, frame_, borne,
                      amount(stop_->beyond, limit), most)
                : fmt::format("{}: {} bears {} where it is, in frame {}, beyond its limit of {}: "
                              "the machine stops at {:.3g} % of the stage",
                              stage_.name, limit.part, borne, frame_, most, 100 * machine_.stop));
    }
    for (std::size_t l = 0; whole && !stop_ && l < most_.size(); ++l) {
        const LimitSpec& limit = machine_.spec.limit[l];
        lines.push_back(
            fmt::format("{}: {} never reached its limit of {}: {}", stage_.name, limit.part,
                        amount(limit.most, limit),
                        most_[l].borne > 0
                            ? fmt::format("the most that it bore was {}, {} frame {}",
                                          amount(most_[l].borne, limit),
                                          most_[l].within ? "on the way to" : "in", most_[l].frame)
                            : "it bore nothing"));
    }
    return lines;
}

void LimitWatch::add_to(Json& record) const {
    if (most_.empty()) return;
    record["limits"] = limits_json(machine_.spec);
    record["stopped_at"] = nullptr;
    if (!stop_) return;
    const LimitSpec& limit = spec();
    Json& at = record["stopped_at"];
    at = {{"part", limit.part},
          {unit_of(limit.of_torque), stop_->borne},
          {"share", machine_.stop},
          {"time_s", stop_->at.time},
          {"frame", frame_}};
    if (stop_->beyond > 0) at[std::string("next_") + unit_of(limit.of_torque)] = stop_->beyond;
}

}  // namespace swage

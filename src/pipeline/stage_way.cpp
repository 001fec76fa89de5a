// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_way.h"

#include <algorithm>
#include <cmath>

namespace swage {

namespace {

// What a blade sweeps as it turns lies between its poses in steps at most this long.
constexpr int kBladeSteps = 64;  // of a stage, at least

int blade_steps(const std::vector<Leg>& legs) {
    double longest = 0;
    for (const Leg& leg : legs) longest = std::max(longest, leg.end - leg.begin);
    return static_cast<int>(std::ceil(kBladeSteps * longest * (1 - 1e-9)));
}

}  // namespace

StageWay::StageWay(const StageSpec& stage, Machine& machine, const Aggregate& work_piece)
    : stage_(stage), machine_(machine), work_piece_(work_piece) {
    set_out(0);
    lost_ = legs_.lost;
}

void StageWay::set_out(double begin) {
    legs_ = stage_legs(stage_, machine_, stage_.frames, work_piece_.lattice.spacing, begin);
    leg_ = 0;
    if (!machine_.apparatus.blade.empty()) steps_ = std::max(1, blade_steps(legs_.leg));
    way_ = legs_.leg.empty() ? std::vector<Drive>()
                             : stage_drives(stage_, machine_, legs_.leg, steps_);
    ahead_ = way_;
}

bool StageWay::goes_on_in(int frame) const {
    return leg_ < legs_.leg.size() && legs_.leg[leg_].frame == frame - 1;
}

DriveAt StageWay::between() const {
    if (machine_.apparatus.limit.empty() || machine_.stop < 1) return {};
    return
        [this](double time) { return drive_at(machine_, time / stage_.duration, stage_.duration); };
}

void StageWay::go_on() {
    ahead_ = ahead_.subspan(static_cast<std::size_t>(steps_));
    ++leg_;
    ++gone_;
}

void StageWay::stop(const Drive& here) {
    const bool part_way = here.time > now().time;
    gone_ += part_way ? 1 : 0;
    before_ = gone_;
    has_stopped_ = true;
    machine_.stop = here.time / stage_.duration;
    const Drive stopped = here;
    set_out(machine_.stop);
    if (way_.empty()) {
        way_ = {stopped};
        ahead_ = way_;
    } else {
        way_.front() = stopped;
    }
}

}  // namespace swage

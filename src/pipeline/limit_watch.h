// SPDX-License-Identifier: GPL-3.0-or-later
// What became of a stage's limits: which was reached and when, or how near it was come to.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "machines/machine.h"
#include "pipeline/json_name.h"
#include "scene/spec.h"
#include "sim/advance.h"

namespace swage {

// "the machine comes no farther once plate bears 20 kN", for each limit.
std::vector<std::string> limit_texts(const MachineSpec& machine);
Json limits_json(const MachineSpec& machine);

class LimitWatch {
  public:
    // Both must outlive it.
    LimitWatch(const StageSpec& stage, const Machine& machine);

    // After each leg, with the machine as it then is. Tells in the log where a limit was reached.
    // `within`: the frame goes on.
    void look(int frame, const FrameReport& report, bool within = false);

    // `whole`: the stage was gone through.
    std::vector<std::string> warnings(bool whole) const;
    // `limits` and `stopped_at`, where there are any limits.
    void add_to(Json& record) const;

    template <typename Io>
    void visit(Io& io) {
        io(most_, stop_, frame_);
    }

  private:
    struct Most {
        using IsPlain = Most;

        double borne = 0;
        int frame = 0, within = 0;  // that, and no row of the curves has it
    };
    const LimitSpec& spec() const;  // of the limit that was reached
    bool is_met() const;            // neither jumped over nor gone beyond from the start

    const StageSpec& stage_;
    const Machine& machine_;
    std::vector<Most> most_;  // of each limit, at the end of any leg
    std::optional<LimitStop> stop_;
    int frame_ = 0;  // that it was in
};

}  // namespace swage

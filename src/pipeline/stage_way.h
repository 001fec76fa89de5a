// SPDX-License-Identifier: GPL-3.0-or-later
// The way of a stage's machine, leg by leg; and, once a limit is reached, what is left of it.
#pragma once

#include <span>
#include <vector>

#include "pipeline/stage_machine.h"

namespace swage {

class StageWay {
  public:
    // All must outlive it. Throws as stage_legs().
    StageWay(const StageSpec& stage, Machine& machine, const Aggregate& work_piece);

    // Whether the next leg belongs to the n-th frame, from 1.
    bool goes_on_in(int frame) const;
    const Drive& now() const { return ahead_.front(); }
    const Drive& next() const { return ahead_[static_cast<std::size_t>(steps_)]; }
    std::span<const Drive> ahead() const { return ahead_; }  // of all legs, from now on
    std::span<const Drive> leg_ahead() const {
        return ahead_.first(static_cast<std::size_t>(steps_) + 1);
    }
    int steps() const { return steps_; }  // of each leg
    // Where the machine is between now and next, if it is asked to look for a limit there; else
    // nothing, and the way is straight.
    DriveAt between() const;

    void go_on();  // a leg is gone
    // The machine has come only so far, and is told when: what is left of its way begins here.
    void stop(const Drive& here);

    std::size_t gone() const { return gone_; }  // legs
    std::size_t legs() const { return before_ + legs_.leg.size(); }
    int lost() const { return lost_; }  // frames, as Legs::lost

    template <typename Io>
    void visit(Io& io) {  // what has changed since it began
        io(leg_, before_, gone_, has_stopped_);
        if (has_stopped_) io(machine_.stop, legs_.leg, steps_, way_);
        if constexpr (Io::kReads) {
            ahead_ = std::span<const Drive>(way_).subspan(leg_ * static_cast<std::size_t>(steps_));
        }
    }

  private:
    void set_out(double begin);

    const StageSpec& stage_;
    Machine& machine_;
    const Aggregate& work_piece_;
    Legs legs_;
    int steps_ = 1, lost_ = 0;
    std::vector<Drive> way_;
    std::span<const Drive> ahead_;
    std::size_t leg_ = 0, before_ = 0, gone_ = 0;  // before_: legs gone when it stopped
    bool has_stopped_ = false;
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The cuts of a stage: which blade's is settled in which body, each once that blade reaches it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "machines/machine.h"
#include "pipeline/stage_record.h"
#include "pipeline/stage_way.h"
#include "pipeline/warning_book.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"
#include "sim/advance.h"

namespace swage {

class StageCuts {
  public:
    // All must outlive it.
    StageCuts(const StageSpec& stage, const Machine& machine, const StageWay& way,
              std::vector<WorkPiece>& bodies, StageTotals& totals, WarningBook& warnings);

    bool any_blade() const { return !machine_.apparatus.blade.empty(); }
    bool is_cut(std::size_t body) const;
    // Of each body: the blades that have cut it, came out and go once more as they first did on the
    // leg ahead; on their way back they are no blades.
    std::vector<std::vector<char>> coming_again() const;

    // As a leg begins: once a blade is about to reach a body its whole cut is settled, as the body
    // lies then; in its matter and, along the same path, in its skin. `last`: how the leg before
    // ended.
    void plan(Simulation& simulation, const FrameReport& last, int number);
    // The machine has come to stop. Blades go on as they would have gone, in other legs.
    void plan_anew(Simulation& simulation, const FrameReport& last, int number);

    template <typename Io>
    void visit(Io& io) {
        io(settled_, through_, first_way_);
    }

  private:
    using Blades = std::vector<char>;
    // Of a body and a blade: whether its cut is settled, and by that none.
    static constexpr char kCut = 1, kGrazed = 2;

    Blades marked(std::size_t body, char as) const;
    Vec3 way_ahead(std::size_t blade) const;  // on the next leg
    Blades reaching(const Simulation& simulation, std::size_t body, const Blades& of,
                    std::span<const Drive> leg) const;
    std::vector<Drive> way_met(std::size_t body, std::span<const Drive> way,
                               const FrameReport& last) const;
    void settle(Simulation& simulation, std::size_t body, const Blades& blades,
                const FrameReport& last, int number);
    void look_for_blades_out(std::size_t body, std::span<const Drive> leg);
    void look_for_blades(std::size_t body, std::span<const Drive> leg);

    const StageSpec& stage_;
    const Machine& machine_;
    const StageWay& way_;
    std::vector<WorkPiece>& bodies_;
    StageTotals& totals_;
    WarningBook& warnings_;
    std::vector<Blades> settled_, through_;     // of each body
    std::vector<std::vector<Vec3>> first_way_;  // likewise, on the leg on which it began to cut
};

}  // namespace swage

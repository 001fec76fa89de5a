// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/frame_account.h"

#include <fmt/format.h>

#include <vector>

#include "base/text.h"
#include "pipeline/rounded_text.h"

namespace swage {

std::string frame_account(const FrameReport& frame) {
    std::vector<std::string> part;
    const auto add = [&](long count, const char* one, const char* many, const char* what) {
        if (count == 0) return;
        part.push_back(counted(static_cast<std::size_t>(count), one, many) + what);
    };
    if (frame.increments > 0) {
        add(frame.iterations, "iteration", "iterations", "");
        add(frame.increments, "increment", "increments", "");
        add(frame.halvings, "increment", "increments", " halved");
        part.push_back(fmt::format("{:.1e} of the push left over", frame.residual));
    }
    if (frame.steps > 0) {
        add(frame.steps, "step", "steps", "");
        part.push_back("the shortest " + rounded_text(frame.shortest_step, Quantity::time, 2));
        add(frame.rejected, "step", "steps", " taken back");
        add(frame.rescued, "step", "steps", " by the implicit solver instead");
    }
    add(frame.asleep, "body", "bodies", " at rest");
    add(frame.severed, "connection", "connections", " cut");
    add(frame.broken, "connection", "connections", " broken");
    if (frame.pieces > static_cast<int>(frame.body.size()))
        add(frame.pieces, "piece", "pieces", "");
    return part.empty() ? "nothing to do" : joined(part, ", ");
}

}  // namespace swage

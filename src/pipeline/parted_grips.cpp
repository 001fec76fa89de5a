// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/parted_grips.h"

#include <algorithm>
#include <set>
#include <vector>

#include "base/text.h"
#include "base/text_error.h"
#include "sim/gripped_pieces.h"

namespace swage {

namespace {

constexpr int kLooks = 32;      // at a stage
constexpr double kSame = 1e-6;  // of the work-piece's size, that two grips move apart by

// How all that a grip holds would move by it.
std::vector<Pose> way_of(const Motion& motion) {
    std::vector<Pose> way;
    for (int n = 1; n <= kLooks; ++n) way.push_back(motion.at(double(n) / kLooks));
    return way;
}

bool differ(const std::vector<Pose>& a, const std::vector<Pose>& b, double size) {
    for (std::size_t n = 0; n < a.size(); ++n) {
        const double moved = (a[n].translation - b[n].translation).norm();
        if (moved > kSame * size || turn_between(a[n], b[n]).norm() > kSame) return true;
    }
    return false;
}

std::string share_text(double share) {
    return share < 0.01 ? "less than 1 %" : fmt::format("{:.0f} %", 100 * share);
}

std::string held_text(const std::set<int>& held, const std::vector<double>& share) {
    constexpr std::size_t kTold = 2;
    std::vector<std::string> told;
    double rest = 0;
    for (const int piece : held) {
        const double own = share[std::size_t(piece)];
        if (told.size() < kTold) {
            told.push_back(
                fmt::format("piece {}, with {} of the mass", piece + 1, share_text(own)));
        } else {
            rest += own;
        }
    }
    if (held.empty()) return "nothing";
    std::string text = joined(told, " and ");
    if (held.size() <= kTold) return text;
    return fmt::format("{} and {}, with {}", joined(told, ", "),
                       counted(held.size() - kTold, "other", "others"), share_text(rest));
}

}  // namespace

std::string parted_grips(const StageSpec& stage, const Machine& machine, const Aggregate& matter) {
    const std::vector<Grip>& grip = machine.apparatus.grip;
    if (grip.size() < 2 || !machine.apparatus.blade.empty()) return {};
    const double size = machine.frame.size.norm();
    std::vector<std::vector<Pose>> way;
    try {
        for (const Motion& motion : machine.grip_motion) way.push_back(way_of(motion));
    } catch (const PlacedError&) {  // drive_at() tells that
        return {};
    }
    const auto move_apart = [&](std::size_t g, std::size_t h) {
        return differ(way[g], way[h], size);
    };
    bool any = false;
    for (std::size_t g = 1; g < grip.size(); ++g) any = any || move_apart(0, g);
    if (!any) return {};

    const GrippedPieces gripped = find_gripped_pieces(matter, machine.apparatus);
    const int count = gripped.pieces.count;
    if (count < 2) return {};
    std::vector<std::set<int>> held;
    for (const std::vector<int>& at : gripped.at) {
        held.emplace_back(at.begin(), at.end());
        held.back().erase(GrippedPieces::kNone);
    }
    for (std::size_t g = 0; g < grip.size(); ++g) {
        for (std::size_t h = 0; h < g; ++h) {
            const bool share =
                std::ranges::any_of(held[g], [&](int piece) { return held[h].contains(piece); });
            if (share && move_apart(g, h)) return {};
        }
    }

    std::vector<double> share(std::size_t(count), 0);
    double all = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        share[std::size_t(gripped.pieces.particle_piece[p])] += matter.particle_mass[p];
        all += matter.particle_mass[p];
    }
    for (double& one : share) one /= all;
    std::vector<std::string> told;
    for (std::size_t g = 0; g < grip.size(); ++g) {
        told.push_back(fmt::format("{}: {}", grip[g].name, held_text(held[g], share)));
    }
    return fmt::format(
        "its grips hold separate pieces of the work-piece ({}): no matter joins these, so the "
        "grips move pieces and deform none{}",
        joined(told, "; "),
        stage.sim.self_contact || in_motion(stage.sim.solver)
            ? ". Pieces that touch push and rub on each other, which joins nothing"
            : "");
}

}  // namespace swage

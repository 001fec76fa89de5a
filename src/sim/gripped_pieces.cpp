// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/gripped_pieces.h"

#include "sim/torn_forces.h"

namespace swage {

GrippedPieces find_gripped_pieces(const Aggregate& matter, const Apparatus& apparatus) {
    constexpr int kNone = GrippedPieces::kNone, kSeveral = GrippedPieces::kSeveral;
    GrippedPieces found;
    found.pieces = find_pieces(matter);
    found.by.assign(std::size_t(found.pieces.count), kNone);
    found.firm.assign(found.by.size(), 0);
    for (std::size_t g = 0; g < apparatus.grip.size(); ++g) {
        const Grip& grip = apparatus.grip[g];
        const bool is_firm = grip.hold == Vec3::Ones();
        const int holder = is_firm ? int(g) : kSeveral;
        std::vector<int>& at = found.at.emplace_back();
        const std::vector<PointCarriage> beside = holders(grip, matter);
        for (std::size_t n = 0; n < grip.point.size(); ++n) {
            const auto p = static_cast<std::size_t>(grip.point[n]);
            const PointCarriage by =
                beside.empty() ? PointCarriage{matter.surface.row(p), matter.surface.place(p)}
                               : beside[n];
            const int piece = by.is_whole ? piece_of(by, found.pieces) : kNone;
            at.push_back(piece);
            if (piece == kNone) continue;
            found.firm[std::size_t(piece)] |= is_firm;
            int& held = found.by[std::size_t(piece)];
            held = held == kNone || held == holder ? holder : kSeveral;
        }
    }
    return found;
}

}  // namespace swage

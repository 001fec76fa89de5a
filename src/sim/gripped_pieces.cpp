// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/gripped_pieces.h"

#include <algorithm>
#include <cmath>

#include "sim/torn_forces.h"

namespace swage {

namespace {

// Of the particle that carries most of it, whose carriers hang together.
int piece_at(const Pieces& pieces, const SurfacePoints::Carriers& by) {
    const auto most = std::ranges::max_element(
        by.weight, [](double a, double b) { return std::abs(a) < std::abs(b); });
    return pieces.particle_piece[by.corner[std::size_t(most - by.weight.begin())]];
}

}  // namespace

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
            const int piece =
                beside.empty()
                    ? piece_at(found.pieces, matter.surface.carriers(std::size_t(grip.point[n])))
                : beside[n].is_whole ? piece_at(found.pieces, beside[n].carriers())
                                     : kNone;
            at.push_back(piece);
            if (piece == kNone) continue;
            found.firm[std::size_t(piece)] |= is_firm;
            int& by = found.by[std::size_t(piece)];
            by = by == kNone || by == holder ? holder : kSeveral;
        }
    }
    return found;
}

}  // namespace swage

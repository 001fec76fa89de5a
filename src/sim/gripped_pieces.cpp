// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/gripped_pieces.h"

#include <algorithm>
#include <cmath>

#include "matter/parted.h"

namespace swage {

namespace {

// Of the particle that carries most of the point: what is not torn hangs together.
int piece_at(const Aggregate& matter, const Pieces& pieces, std::size_t point) {
    if (is_torn(matter, point)) return GrippedPieces::kNone;
    const SurfacePoints::Carriers by = matter.surface.carriers(point);
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
        for (int point : grip.point) {
            const int piece = piece_at(matter, found.pieces, std::size_t(point));
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

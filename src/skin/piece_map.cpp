// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/piece_map.h"

#include <Eigen/QR>
#include <bit>

namespace swage {

Vec3 hold_between(const Vec3& reference, std::span<const BodyPlace> others) {
    const BodyPlace& first = others.front();
    Eigen::Matrix<double, 3, 2> way = Eigen::Matrix<double, 3, 2>::Zero(), change = way;
    for (std::size_t n = 1; n < others.size(); ++n) {
        way.col(n - 1) = others[n].reference - first.reference;
        change.col(n - 1) = others[n].hold - first.hold;
    }
    if (change.isZero(0)) return first.hold;
    const Eigen::Vector2d share =
        way.colPivHouseholderQr().solve(reference - first.reference).cwiseMax(0.0).cwiseMin(1.0);
    return first.hold + change * share;
}

BodyPlace PieceMap::beside(const Vec3& reference, std::span<const BodyPlace> others) const {
    BodyPlace place{reference, carrying_cell(matter_, reference), kAllCorners,
                    hold_between(reference, others)};
    if (!corners_hang_together(matter_, matter_.lattice.cell_corners(place.cell))) {
        for (const BodyPlace& other : others) {
            if (other.cell != place.cell) continue;
            place.side = other.side;
            return place;
        }
    }
    const int piece = piece_of(others.front());
    const auto side_in = [&](CellId cell, const Vec3i&) {
        return side_of_piece(cell, reference, piece);
    };
    CellSide best{place.cell, side_in(place.cell, {})};
    if (best.side == 0) best = nearest_side(matter_, place.cell, reference, side_in);
    if (best.cell < 0) return place;
    place.cell = best.cell;
    place.side = best.side;
    return place;
}

int PieceMap::piece_of(const BodyPlace& place) const {
    const auto [corner, carrier, followed] = carriage_of(matter_, place);
    const int heaviest = heaviest_corner(trilinear_weights(carrier.local), followed);
    return pieces_.particle_piece[corner[heaviest]];
}

bool PieceMap::follows(CellId cell, CornerMask group, int piece) const {
    const std::array<ParticleId, 8> corner = matter_.lattice.cell_corners(cell);
    return pieces_.particle_piece[corner[std::countr_zero(group)]] == piece;
}

CornerMask PieceMap::side_of_piece(CellId cell, const Vec3& reference, int piece) const {
    const std::array<ParticleId, 8> corner = matter_.lattice.cell_corners(cell);
    CornerMask own = 0;
    for (int c = 0; c < 8; ++c) own |= (pieces_.particle_piece[corner[c]] == piece) << c;
    if (own == 0) return 0;
    const CornerGroups groups = corner_groups(matter_, corner);
    if (groups[0] == kAllCorners) return kAllCorners;
    const Vec3 local = carrier_in(cell_box(matter_, cell), reference).local;
    const int heaviest = heaviest_corner(trilinear_weights(local), own);
    return heaviest < 0 ? 0 : groups[heaviest];
}

}  // namespace swage

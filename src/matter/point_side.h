// SPDX-License-Identifier: GPL-3.0-or-later
// Points of the true surface beside a cut or a crack, by what is left on their own side.
#pragma once

#include <array>
#include <vector>

#include "matter/cell_parts.h"

namespace swage {

// A cell and a place in it or beyond. Where that has no whole cell on its side some corners of its
// own carry it, by their shares.
struct PointCarriage {
    std::array<ParticleId, 4> row{};
    Vec3 place = Vec3::Zero();
    CornerMask corners = kAllCorners;
    bool is_whole = true;  // the cell

    SurfacePoints::Carriers carriers() const;
    Vec3 position(const Aggregate& matter) const;  // now [m]

    template <typename Io>
    void visit(Io& io) {
        io(row, place, corners, is_whole);
    }
};

// By a whole cell its own corners carry a point. Of one that is parted these would hold together
// what is not: a whole cell beside it does that hangs together with the corners on the point's
// side, by weights that keep force and moment. Where no blade has told sides, as of a crack, the
// new surface lies half-way.
PointCarriage carriage_on_side(const Aggregate& matter, std::size_t point);
// Of any point that a cell carried by itself, on the side of these corners.
PointCarriage carriage_on_side(const Aggregate& matter, const PointCarriage& own, CornerMask side);
// Of a point part of whose patch lies on this piece: by the corners that its cell has of that.
// Where it has none, as above.
PointCarriage carriage_on_piece(const Aggregate& matter, std::size_t point, const Pieces& pieces,
                                int piece);

// From now on a whole cell carries it.
inline void carry(SurfacePoints& points, std::size_t point, const PointCarriage& by) {
    points.set(point, by.row, by.place, points.area(point), points.normal(point));
}

// The same where matter is bent: the cell carries what lies at this place now [m], which a carriage
// as molded would shift by as much as that cell is bent unlike the one that carried it before. Not
// whole where the cell's shape does not tell, or only by far.
PointCarriage brought_to(const Vec3& at, const Aggregate& matter, PointCarriage by);

// The piece that carries a point. Its cell may have corners on others too, none of which weighs
// anything.
int piece_of(const PointCarriage& carriage, const Pieces& pieces);

// The corners of a point's cell on its side of a surface that parts that.
struct PointSide {
    using IsPlain = PointSide;
    int point;
    int corners;  // a bit each
};
// Those of points whose cells are parted by now, and takes them off the list.
void keep_sides(Aggregate& matter, std::vector<PointSide>& sides);

// By what carries it there, now [m].
Vec3 position_on_side(const Aggregate& matter, std::size_t point);
// As Aggregate has it; none where no whole cell tells it.
Mat3 gradient_on_side(const Aggregate& matter, std::size_t point);

}  // namespace swage

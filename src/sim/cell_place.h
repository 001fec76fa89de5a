// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point of space lies among a body's cells, each bent as its corners are.
#pragma once

#include <array>

#include "sim/contact_side.h"

namespace swage {

struct CellPlace {
    CellId cell;
    Vec3i site;
    std::array<int, 8> corner{};       // in the body's patch
    Vec3 place = Vec3::Constant(0.5);  // in the cell, 0 to 1
};

// A cell's corners: where the patch has them, or copies.
struct CellCorners {
    CellCorners(const ContactPatch& patch, const CellPlace& at) {
        for (int c = 0; c < 8; ++c) now[c] = &patch.motion(at.corner[c]);
    }
    std::array<const ContactPatch::Motion*, 8> now;
    std::array<ContactPatch::Motion, 8> copy;
};

// Of the cell's trilinear map at a place: dx / dplace, its columns g_i [m]; the rows of its inverse
// are r_i / volume.
struct CellGradient {
    Vec4 g[3], r[3];
    double volume;
};

// Whether x has been found by Newton's method from `place`, which goes on until that is so far
// beyond the cell; false too where the cell is inside out.
SWAGE_INLINE bool find_in_cell(const CellCorners& corner, Vec4 x, double spacing, double beyond,
                               Vec3& place, CellGradient& at) {
    Vec3 p = place;
    bool found = false;
    for (int n = 0; n < 12 && !found; ++n) {
        const double qx = p.x(), qy = 1 - p.y(), qz = 1 - p.z();
        const auto& c = corner.now;
        const Vec4 e0 = c[1]->place - c[0]->place, e1 = c[3]->place - c[2]->place,
                   e2 = c[5]->place - c[4]->place, e3 = c[7]->place - c[6]->place;
        const Vec4 a0 = c[0]->place + qx * e0, a1 = c[2]->place + qx * e1,
                   a2 = c[4]->place + qx * e2, a3 = c[6]->place + qx * e3;
        const Vec4 b0 = qy * a0 + p.y() * a1, b1 = qy * a2 + p.y() * a3;
        at.g[0] = qz * (qy * e0 + p.y() * e1) + p.z() * (qy * e2 + p.y() * e3);
        at.g[1] = qz * (a1 - a0) + p.z() * (a3 - a2);
        at.g[2] = b1 - b0;
        at.r[0] = cross(at.g[1], at.g[2]);
        at.r[1] = cross(at.g[2], at.g[0]);
        at.r[2] = cross(at.g[0], at.g[1]);
        at.volume = dot3(at.g[0], at.r[0]);
        if (!(at.volume > 1e-6 * spacing * spacing * spacing)) {
            place = p;
            at.volume = 0;
            return false;
        }
        const Vec4 left = x - (qz * b0 + p.z() * b1);
        Vec3 way = Vec3(dot3(at.r[0], left), dot3(at.r[1], left), dot3(at.r[2], left)) / at.volume;
        const double size = way.cwiseAbs().maxCoeff();
        if (size > 1) way /= size;
        p += way;
        found = size < 1e-8;
        // Far off: the cell there is a better place to go on from.
        if (n > 0 && ((p.array() < -beyond).any() || (p.array() > 1 + beyond).any())) break;
    }
    place = p;
    return found;
}

// From the cell in which x is not: on to one nearer to it, or whether the way ends there.
enum class Onward { goes, ends_found, ends_lost };
Onward walk_on(const ContactSide& onto, bool found, CellPlace& at, CellCorners& corner);

inline constexpr double kSlack = 1e-9;  // of places in cells

// Walks from the cell it was last in to the one that holds x, whose corners are then `corner`;
// false where there is none: `at` is then the last cell on the way. A little beyond the last cells
// it is still in them. Where it ends in another cell, `at.corner` is not yet of that.
SWAGE_INLINE bool find_place(const ContactSide& onto, Vec4 x, CellPlace& at, CellCorners& corner,
                             CellGradient& gradient) {
    for (int hop = 0; hop < 6; ++hop) {
        const bool found = find_in_cell(corner, x, onto.matter().lattice.spacing,
                                        onto.beyond(at.cell), at.place, gradient);
        if (gradient.volume == 0) return false;
        if ((at.place.array() >= -kSlack).all() && (at.place.array() <= 1 + kSlack).all()) {
            return found;
        }
        const Onward next = walk_on(onto, found, at, corner);
        if (next != Onward::goes) return next == Onward::ends_found;
    }
    return false;
}

}  // namespace swage

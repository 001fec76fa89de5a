// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_place.h"

namespace swage {

Onward walk_on(const ContactSide& onto, bool found, CellPlace& at, CellCorners& corner) {
    const Lattice& lattice = onto.matter().lattice;
    Vec3& p = at.place;
    const Vec3i out =
        Vec3i((p.array() > 1 + kSlack).cast<int>()) - Vec3i((p.array() < -kSlack).cast<int>());
    if (out.isZero()) return Onward::ends_lost;  // no number
    CellId next = -1;
    Vec3i step = out;
    // Onto a cell that is cut or broken, part of which is still this side's.
    bool opens = onto.is_thin();
    bool is_deep = false;  // what lies on is no rim
    const auto try_step = [&](const Vec3i& s) {
        const Vec3i site = at.site + s;
        const CellId cell = lattice.cell_at(site);
        const bool holds = onto.may_hold(cell);
        opens = opens || (cell >= 0 && !onto.is_whole(cell));
        is_deep = is_deep || (cell >= 0 && onto.is_whole(cell) && !holds);
        if (!holds) return false;
        next = cell;
        step = s;
        return true;
    };
    if (!try_step(out)) {
        const Vec3 excess = (p.array() - 0.5).abs() - 0.5;
        int most;
        excess.maxCoeff(&most);
        for (int d = 0; d < 3 && next < 0; ++d) {
            const int axis = (most + d) % 3;
            if (out[axis] != 0) try_step(Vec3i::Unit(axis) * out[axis]);
        }
    }
    if (next < 0) {
        const double more = opens ? onto.beyond(at.cell) : is_deep ? 0 : kSliver;
        const bool holds = found && (p.array() >= -more).all() && (p.array() <= 1 + more).all();
        return holds ? Onward::ends_found : Onward::ends_lost;
    }
    at.cell = next;
    at.site += step;
    const std::array<ParticleId, 8> particle = lattice.cell_corners(next);
    for (int c = 0; c < 8; ++c) {
        corner.copy[c] = onto.patch().motion_of(particle[c]);
        corner.now[c] = &corner.copy[c];
    }
    p -= step.cast<double>();
    const double beyond = onto.beyond(next);
    p = p.cwiseMax(-beyond).cwiseMin(1 + beyond);
    return Onward::goes;
}

}  // namespace swage

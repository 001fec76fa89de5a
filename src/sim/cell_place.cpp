// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_place.h"

namespace swage {

namespace {

// The cell's trilinear map.
struct CellMap {
    std::array<Vec3, 8> x;

    CellMap(const Vec3Array& position, const std::array<ParticleId, 8>& corner) {
        for (int c = 0; c < 8; ++c) x[c] = position.at(corner[c]);
    }
    Vec3 at(const Vec3& p, Mat3& gradient) const {
        const double qy = 1 - p.y(), qz = 1 - p.z();
        const Vec3 e0 = x[1] - x[0], e1 = x[3] - x[2], e2 = x[5] - x[4], e3 = x[7] - x[6];
        const Vec3 a0 = x[0] + p.x() * e0, a1 = x[2] + p.x() * e1, a2 = x[4] + p.x() * e2,
                   a3 = x[6] + p.x() * e3;
        const Vec3 b0 = qy * a0 + p.y() * a1, b1 = qy * a2 + p.y() * a3;
        gradient.col(0) = qz * (qy * e0 + p.y() * e1) + p.z() * (qy * e2 + p.y() * e3);
        gradient.col(1) = qz * (a1 - a0) + p.z() * (a3 - a2);
        gradient.col(2) = b1 - b0;
        return qz * b0 + p.z() * b1;
    }
};

}  // namespace

std::array<double, 8> trilinear_weights(const Vec3& p) {
    const double x[2] = {1 - p.x(), p.x()}, y[2] = {1 - p.y(), p.y()}, z[2] = {1 - p.z(), p.z()};
    std::array<double, 8> w;
    for (int c = 0; c < 8; ++c) w[c] = x[c & 1] * y[c >> 1 & 1] * z[c >> 2];
    return w;
}

bool find_place(const ContactSide& onto, const Vec3& x, CellPlace& at, Mat3& gradient) {
    constexpr double kSlack = 1e-9;
    const Vec3Array& position = onto.matter().particle_position;
    const double a = onto.matter().lattice.spacing;
    for (int hop = 0; hop < 6; ++hop) {
        const CellMap map(position, at.corner);
        Vec3& p = at.place;
        bool found = false;
        for (int n = 0; n < 12 && !found; ++n) {
            const Vec3 left = x - map.at(p, gradient);
            const double volume = gradient.determinant();
            if (!(volume > 1e-6 * a * a * a)) return false;
            Vec3 way = gradient.inverse() * left;
            const double size = way.cwiseAbs().maxCoeff();
            if (size > 1) way /= size;
            p += way;
            found = size < 1e-8;
            // Far off: the cell there is a better place to go on from.
            if (n > 0 && ((p.array() < -0.5).any() || (p.array() > 1.5).any())) break;
        }
        const Vec3i out =
            Vec3i((p.array() > 1 + kSlack).cast<int>()) - Vec3i((p.array() < -kSlack).cast<int>());
        if (out.isZero()) return found;
        CellId next = -1;
        Vec3i step = out;
        bool opens =
            false;  // onto a cell that is cut or broken, half of which is still this side's
        const auto try_step = [&](const Vec3i& s) {
            const Vec3i site = at.site + s;
            const CellId cell = onto.matter().lattice.cell_at(site.x(), site.y(), site.z());
            opens = opens || (cell >= 0 && !onto.is_whole(cell));
            if (!onto.may_hold(cell)) return false;
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
            return opens && found && (p.array() >= -0.5).all() && (p.array() <= 1.5).all();
        }
        at.cell = next;
        at.site += step;
        at.corner = onto.matter().lattice.cell_corners(next);
        p -= step.cast<double>();
        p = p.cwiseMax(-0.5).cwiseMin(1.5);
    }
    return false;
}

}  // namespace swage

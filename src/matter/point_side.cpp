// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/point_side.h"

#include <algorithm>
#include <limits>

#include "matter/cell_gradient.h"
#include "matter/parted.h"

namespace swage {

namespace {

constexpr double kLeast = 1e-3;  // a corner that weighs nothing is on a side too

std::array<ParticleId, 8> corners_of(const std::array<ParticleId, 4>& row) {
    std::array<ParticleId, 8> corner;
    for (int c = 0; c < 8; ++c) corner[c] = corner_particle(row, c);
    return corner;
}

// Of the corners that hang together those that weigh most on the point's side; where all of these
// have gone, most of all.
CornerMask own_corners(const Aggregate& matter, const std::array<ParticleId, 8>& corner,
                       const std::array<double, 8>& weight, CornerMask side) {
    const CornerGroups groups = corner_groups(matter, corner);
    for (const CornerMask on : {side, kAllCorners}) {
        CornerMask heaviest = 0;
        double most = 0;
        for (const CornerMask together : groups) {
            double sum = 0;
            for (int c = 0; c < 8; ++c) {
                if (together & on & 1 << c) sum += std::max(weight[c], 0.0) + kLeast;
            }
            if (sum > most) most = sum, heaviest = together;
        }
        if (heaviest != 0) return heaviest;
    }
    return kAllCorners;
}

// By how much a force on a place grows, at most, on the corners that carry it: what their weights'
// sizes sum to, 1 within the cell.
double growth(const Vec3& place) {
    const Vec3 beyond = (place - place.cwiseMax(0.0).cwiseMin(1.0)).cwiseAbs();
    return (Vec3::Ones() + 2 * beyond).prod();
}

bool any_of(const std::array<ParticleId, 8>& corner, const std::vector<ParticleId>& particles) {
    return std::ranges::any_of(
        corner, [&](ParticleId p) { return std::ranges::find(particles, p) != particles.end(); });
}

template <typename Visit>
void for_each_within(const Lattice& lattice, const Vec3i& site, int reach, const Visit& visit) {
    for (int k = -reach; k <= reach; ++k) {
        for (int j = -reach; j <= reach; ++j) {
            for (int i = -reach; i <= reach; ++i) {
                const CellId cell = lattice.cell_at(site + Vec3i(i, j, k));
                if (cell >= 0) visit(cell, Vec3i(i, j, k));
            }
        }
    }
}

// Those that hang together with them in the cells around the site, too.
std::vector<ParticleId> and_beside(const Aggregate& matter, const Vec3i& site,
                                   const std::vector<ParticleId>& particles) {
    std::vector<ParticleId> more = particles;
    for_each_within(matter.lattice, site, 1, [&](CellId cell, const Vec3i&) {
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        if (!any_of(corner, particles)) return;
        const CornerGroups groups = corner_groups(matter, corner);
        for (int c = 0; c < 8; ++c) {
            if (std::ranges::find(particles, corner[c]) == particles.end()) continue;
            for (int d = 0; d < 8; ++d) {
                if (groups[c] >> d & 1) more.push_back(corner[d]);
            }
        }
    });
    return more;
}

PointCarriage carriage_by(const Aggregate& matter, std::size_t point, CornerMask side) {
    const PointCarriage own{matter.surface.row(point), matter.surface.place(point)};
    return is_parted(matter, point) ? carriage_on_side(matter, own, side) : own;
}

}  // namespace

SurfacePoints::Carriers PointCarriage::carriers() const {
    SurfacePoints::Carriers by{corners_of(row), trilinear_weights(place)};
    if (corners == kAllCorners) return by;
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        by.weight[c] = corners >> c & 1 ? std::max(by.weight[c], 0.0) + kLeast : 0;
        sum += by.weight[c];
    }
    for (double& weight : by.weight) weight /= sum;
    return by;
}

Vec3 PointCarriage::position(const Aggregate& matter) const {
    const SurfacePoints::Carriers by = carriers();
    Vec3 x = Vec3::Zero();
    for (int c = 0; c < 8; ++c) x += by.weight[c] * matter.particle_position.at(by.corner[c]);
    return x;
}

// Of the whole cells that by which a force grows least, a firm one where there is any.
PointCarriage carriage_on_side(const Aggregate& matter, const PointCarriage& own, CornerMask side) {
    constexpr int kReach = 2;  // cells: a slanted cut leaves what it only grazes without one beside
    if (cell_is_whole(matter, own.row)) return own;
    const SurfacePoints::Carriers by = own.carriers();
    const CornerMask corners = own_corners(matter, by.corner, by.weight, side);
    std::vector<ParticleId> on_side;
    for (int c = 0; c < 8; ++c) {
        if (corners >> c & 1) on_side.push_back(by.corner[c]);
    }
    const Lattice& lattice = matter.lattice;
    const Vec3 low = matter.particle_reference.at(std::size_t(own.row[0])) - lattice.origin;
    const Vec3i home = (low / lattice.spacing).array().round().cast<int>();
    PointCarriage best{own.row, own.place, corners, false};
    double least = std::numeric_limits<double>::infinity();
    bool is_best_firm = false;
    for (int reach = 1; reach <= kReach && !best.is_whole; ++reach) {
        if (reach > 1) on_side = and_beside(matter, home, on_side);
        for_each_within(lattice, home, reach, [&](CellId cell, const Vec3i& step) {
            const std::array<ParticleId, 4> row = lattice.cell_row(cell);
            if (!any_of(corners_of(row), on_side) || !cell_is_whole(matter, row)) return;
            const Vec3 place = own.place - step.cast<double>();
            const double grown = growth(place);
            const bool is_firm = matter.cell_fill[std::size_t(cell)] >= kFirmFill;
            if (is_firm < is_best_firm || (is_firm == is_best_firm && grown >= least)) return;
            best = {row, place};
            least = grown;
            is_best_firm = is_firm;
        });
    }
    return best;
}

PointCarriage carriage_on_side(const Aggregate& matter, std::size_t point) {
    return carriage_by(matter, point, matter.surface.side(point));
}

PointCarriage brought_to(const Vec3& at, const Aggregate& matter, PointCarriage by) {
    constexpr int kTries = 20;
    constexpr double kExact = 1e-12, kFar = 1;  // [cells]
    const double a = matter.lattice.spacing;
    const Vec3 molded = by.place;
    for (int n = 0; n < kTries; ++n) {
        const Vec3 off = at - by.position(matter);
        if (off.norm() <= kExact * a) return by;
        const Mat3 along = a * cell_gradient(matter, corners_of(by.row), by.place);
        if (!(along.determinant() > 0)) break;
        by.place += along.inverse() * off;
        if (!((by.place - molded).cwiseAbs().maxCoeff() <= kFar)) break;
    }
    by.is_whole = false;
    return by;
}

PointCarriage carriage_on_piece(const Aggregate& matter, std::size_t point, const Pieces& pieces,
                                int piece) {
    const std::array<ParticleId, 8> corner = matter.surface.corner(point);
    CornerMask of_piece = 0;
    for (int c = 0; c < 8; ++c) {
        of_piece |= (pieces.particle_piece[std::size_t(corner[c])] == piece) << c;
    }
    const CornerMask side = matter.surface.side(point), both = side & of_piece;
    return carriage_by(matter, point, both != 0 ? both : of_piece != 0 ? of_piece : side);
}

int piece_of(const PointCarriage& carriage, const Pieces& pieces) {
    const SurfacePoints::Carriers by = carriage.carriers();
    const int corner = heaviest_corner(by.weight, carriage.corners);
    return pieces.particle_piece[std::size_t(by.corner[std::size_t(corner)])];
}

void keep_sides(Aggregate& matter, std::vector<PointSide>& sides) {
    std::erase_if(sides, [&](const PointSide& one) {
        const auto point = static_cast<std::size_t>(one.point);
        if (!is_parted(matter, point)) return false;
        matter.surface.set_side(point, static_cast<CornerMask>(one.corners));
        return true;
    });
}

Vec3 position_on_side(const Aggregate& matter, std::size_t point) {
    return is_parted(matter, point) ? carriage_on_side(matter, point).position(matter)
                                    : matter.surface_position(point);
}

Mat3 gradient_on_side(const Aggregate& matter, std::size_t point) {
    if (!is_parted(matter, point)) return matter.surface_gradient(point);
    const PointCarriage by = carriage_on_side(matter, point);
    if (!by.is_whole) return Mat3::Identity();
    return cell_gradient(matter, corners_of(by.row), by.place);
}

}  // namespace swage

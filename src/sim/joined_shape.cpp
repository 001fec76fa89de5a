// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/joined_shape.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "matter/particle_site.h"

namespace swage {

namespace {

constexpr double kFlat = 1e-6;  // of a product of shares that directions have

Mat3 cofactors_of(const Mat3& m) {
    Mat3 all;
    all << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
    return all;
}

}  // namespace

Mat3 joined_deformation(const Aggregate& matter, ParticleId lower, ParticleId upper) {
    std::vector<std::pair<ParticleId, ParticleId>> joined;  // some of them several times
    const Vec3i site = lattice_site(matter, lower).cwiseMin(lattice_site(matter, upper));
    matter.lattice.for_each_cell_around(site, [&](CellId cell, const Vec3i&) {
        const auto corners = matter.lattice.cell_corners(cell);
        for (const CellConnection& c : kCellConnection) {
            const ParticleId from = corners[std::size_t(c.corner)];
            if (!(matter.connection[c.direction].weight[from] > 0)) continue;
            joined.emplace_back(from, corners[std::size_t(upper_corner(c))]);
        }
    });
    std::vector<ParticleId> reached = {lower, upper};
    const auto is_reached = [&](ParticleId p) {
        return std::find(reached.begin(), reached.end(), p) != reached.end();
    };
    for (std::size_t before = 0; before != reached.size();) {
        before = reached.size();
        for (const auto& [from, to] : joined) {
            if (is_reached(from) == is_reached(to)) continue;
            reached.push_back(is_reached(from) ? to : from);
        }
    }
    Mat3 molded = Mat3::Zero(), mixed = Mat3::Zero();  // sums of products of the connections' ways
    Vec3 along = Vec3::Zero(), along_molded = Vec3::Zero();
    for (const auto& [from, to] : joined) {
        if (!is_reached(from)) continue;
        const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
        const Vec3 way_molded =
            (matter.particle_reference.at(b) - matter.particle_reference.at(a)) /
            matter.lattice.spacing;
        const Vec3 way = (matter.particle_position.at(b) - matter.particle_position.at(a)) /
                         matter.lattice.spacing;
        molded += way_molded * way_molded.transpose();
        mixed += way * way_molded.transpose();
        const double side = along_molded.dot(way_molded) < 0 ? -1 : 1;
        along += side * way;
        along_molded += side * way_molded;
    }
    const double size = molded.trace();
    const Mat3 cofactors = cofactors_of(molded);
    if (cofactors.trace() < kFlat * size * size) {  // a row
        return turn_onto(along_molded, along).toRotationMatrix();
    }
    if (molded.determinant() < kFlat * size * size * size) {  // a layer
        const Mat3 across = cofactors_of(mixed);
        molded += size * cofactors / cofactors.trace();
        mixed += size * across / std::max(across.norm(), kFlat * size * size);
    }
    return mixed * molded.inverse();
}

}  // namespace swage

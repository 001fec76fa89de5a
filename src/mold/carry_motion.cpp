// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/carry_motion.h"

#include <Eigen/LU>
#include <algorithm>

#include "mold/cells_there.h"

namespace swage {

namespace {

constexpr double kFlat = 1e-6;  // a cell crushed to less than this has no slopes

// How velocity changes over a cell: that which fits its corners best.
struct Flow {
    Vec3 middle = Vec3::Zero(), velocity = Vec3::Zero();
    Mat3 slope = Mat3::Zero();

    Vec3 at(const Vec3& place) const { return velocity + slope * (place - middle); }
};

Flow flow_of(const Aggregate& matter, CellId cell) {
    Flow flow;
    const auto corners = matter.lattice.cell_corners(cell);
    for (ParticleId p : corners) {
        flow.middle += matter.particle_position.at(p) / 8;
        flow.velocity += matter.particle_velocity.at(p) / 8;
    }
    Mat3 spread = Mat3::Zero(), together = Mat3::Zero();
    for (ParticleId p : corners) {
        const Vec3 arm = matter.particle_position.at(p) - flow.middle;
        spread += arm * arm.transpose();
        together += (matter.particle_velocity.at(p) - flow.velocity) * arm.transpose();
    }
    const double size = spread.trace() / 3;
    if (spread.determinant() > kFlat * size * size * size) {
        flow.slope = together * spread.inverse();
    }
    return flow;
}

Vec3 momentum_of(const Aggregate& matter) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        sum += matter.particle_mass[p] * matter.particle_velocity.at(p);
    }
    return sum;
}

Vec3 spin_about(const Vec3& centre, const Aggregate& matter) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        sum += matter.particle_mass[p] *
               (matter.particle_position.at(p) - centre).cross(matter.particle_velocity.at(p));
    }
    return sum;
}

}  // namespace

void carry_motion(const Aggregate& from, Aggregate& to) {
    const auto rests = [](const std::vector<double>& part) {
        return std::all_of(part.begin(), part.end(), [](double v) { return v == 0; });
    };
    const Vec3Array& old = from.particle_velocity;
    if (rests(old.x) && rests(old.y) && rests(old.z)) return;
    const std::size_t count = to.particle_count();
    std::vector<Vec3> place;
    for (std::size_t p = 0; p < count; ++p) place.push_back(to.particle_position.at(p));
    // Corners of cells that the body does not fill stick out of it by up to a spacing.
    const std::vector<CellId> like = cells_there(from, place, to.lattice.spacing);
    Vec3 centre = Vec3::Zero();
    double mass = 0;
    for (std::size_t p = 0; p < count; ++p) {
        to.particle_velocity.set(p, flow_of(from, like[p]).at(place[p]));
        mass += to.particle_mass[p];
        centre += to.particle_mass[p] * place[p];
    }
    centre /= mass;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t p = 0; p < count; ++p) {
        const Vec3 arm = place[p] - centre;
        inertia +=
            to.particle_mass[p] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    }
    const Vec3 push = (momentum_of(from) - momentum_of(to)) / mass;
    const Vec3 turn = inertia.inverse() * (spin_about(centre, from) - spin_about(centre, to));
    for (std::size_t p = 0; p < count; ++p) {
        to.particle_velocity.set(p,
                                 to.particle_velocity.at(p) + push + turn.cross(place[p] - centre));
    }
}

}  // namespace swage

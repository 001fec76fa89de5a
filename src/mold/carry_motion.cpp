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

// How a body moves as a whole: that motion which has its momentum and spin.
struct WholeMotion {
    double mass = 0;
    Vec3 centre = Vec3::Zero(), momentum = Vec3::Zero(), spin = Vec3::Zero();  // about the centre
    Mat3 by_spin = Mat3::Zero();  // how fast it turns, of its spin

    explicit WholeMotion(const Aggregate& matter) {
        const auto& part = matter.particle_mass;
        for (std::size_t p = 0; p < part.size(); ++p) {
            mass += part[p];
            centre += part[p] * matter.particle_position.at(p);
            momentum += part[p] * matter.particle_velocity.at(p);
        }
        centre /= mass;
        Mat3 inertia = Mat3::Zero();
        for (std::size_t p = 0; p < part.size(); ++p) {
            const Vec3 arm = matter.particle_position.at(p) - centre;
            inertia += part[p] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
            spin += part[p] * arm.cross(matter.particle_velocity.at(p));
        }
        by_spin = inertia.inverse();
    }
    Vec3 at(const Vec3& place) const {
        return momentum / mass + (by_spin * spin).cross(place - centre);
    }
    // Of the motion within the body [J].
    double energy_within(const Aggregate& matter) const {
        double sum = 0;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            const Vec3 way = matter.particle_velocity.at(p) - at(matter.particle_position.at(p));
            sum += 0.5 * matter.particle_mass[p] * way.squaredNorm();
        }
        return sum;
    }
};

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
    for (std::size_t p = 0; p < count; ++p) {
        to.particle_velocity.set(p, flow_of(from, like[p]).at(place[p]));
    }
    const WholeMotion was(from), found(to);
    WholeMotion is = found;
    is.momentum = was.momentum;
    is.spin = was.spin + (was.centre - found.centre).cross(was.momentum);
    // Shards that fly apart become one: there may be less motion within it, and never more.
    const double had = was.energy_within(from), has = found.energy_within(to);
    const double share = has > had ? std::sqrt(had / has) : 1;
    for (std::size_t p = 0; p < count; ++p) {
        const Vec3 within = to.particle_velocity.at(p) - found.at(place[p]);
        to.particle_velocity.set(p, is.at(place[p]) + share * within);
    }
}

}  // namespace swage

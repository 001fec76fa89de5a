// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/own_overlap.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "geometry/near_pairs.h"
#include "matter/touch_points.h"
#include "sim/body_contact.h"

namespace swage {

namespace {

// Of the way from a cell's middle to its farthest corner, where all that it holds lies, slivers
// beyond its faces with it. Cells that are not next to each other are farther apart until they have
// been stretched by a seventh.
constexpr double kRound = 1.5;

// Whether a point may lie in a cell that is not next to its own. Far quicker than contact itself,
// and bodies that have hardly been deformed end here.
bool may_overlap(const Aggregate& matter) {
    const TouchPoints touch(matter);
    if (touch.size() > touch.own()) return true;  // the faces of a crack are next to each other
    std::vector<Vec3> point;
    for (std::size_t p = 0; p < touch.size(); ++p) {
        point.push_back(touch.points().position(p, matter.particle_position));
    }
    std::vector<Box> box;
    std::vector<Vec3i> site;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            std::array<Vec3, 8> corner;
            for (int c = 0; c < 8; ++c) corner[c] = matter.particle_position.at(run.corner(n, c));
            const Vec3 middle =
                std::accumulate(corner.begin(), corner.end(), Vec3(Vec3::Zero())) / 8;
            double far = 0;
            for (const Vec3& at : corner) far = std::max(far, (at - middle).norm());
            const Vec3 reach = Vec3::Constant(kRound * far);
            box.push_back({middle - reach, middle + reach});
            site.emplace_back(run.i + n, run.j, run.k);
        }
    }
    const std::vector<NearPair> near = near_pairs(point, box);
    return std::any_of(near.begin(), near.end(), [&](const NearPair& pair) {
        const Box& of = box[pair.box];
        const double reach = 0.5 * (of.high.x() - of.low.x());
        return (touch.home()[pair.point] - site[pair.box]).cwiseAbs().maxCoeff() > 1 &&
               (point[pair.point] - 0.5 * (of.low + of.high)).norm() < reach;
    });
}

}  // namespace

double own_overlap(Aggregate& matter) {
    if (!may_overlap(matter)) return 0;
    SimSettings settings;
    settings.self_contact = true;
    const std::vector<char> awake = {0};
    BodyContact contact({&matter}, settings);
    contact.renew_all(awake);
    if (contact.candidates() == 0) return 0;
    Vec3Array force;
    force.resize(matter.particle_count());
    std::vector<ContactSums> sums;
    contact.add_forces({&force}, Vec3::Zero(), 0, awake, sums);
    return sums[0].penetration;
}

}  // namespace swage

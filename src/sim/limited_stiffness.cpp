// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/limited_stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/surface_forces.h"
#include "sim/surface_modulus.h"

namespace swage {

namespace {

constexpr double kFaces = 2;  // of a cell, as which at most a point counts on it

LimitedPoints on_rigid(const Aggregate& matter, const SurfacePoints& points, double of_layer,
                       Solver solver, double most) {
    const SurfaceLayer layer(matter, points, solver);
    LimitedPoints limited;
    for (std::size_t p = 0; p < points.size(); ++p) {
        limited.asked.push_back(layer.stiffness(points, p, of_layer));
    }
    limited.stiffest = stiffest_of_points(matter, points, limited.asked, most);
    return limited;
}

LimitedPoints one_way(const MeetingBody& from, const MeetingBody& onto, const SimSettings& settings,
                      double most) {
    const double scale = settings.stiffness_of_contacts();
    const auto asked = [&](const MeetingBody& one, const MeetingBody& other) {
        const double spacing = other.matter.lattice.spacing;
        return stiffness_on_body(one.matter, one.touch.points(),
                                 surface_modulus(other.matter, settings.solver) / spacing, spacing,
                                 scale, settings.solver);
    };
    LimitedPoints limited;
    limited.asked = asked(from, onto);
    limited.stiffest = stiffest_of_points(from.matter, from.touch.points(), limited.asked, most);
    const double share = share_borne(onto.matter, onto.touch.points(), asked(onto, from), most);
    for (std::size_t p = 0; p < limited.asked.size(); ++p) {
        limited.stiffest[p] = stiffest_on_body(limited.stiffest[p], share, limited.asked[p]);
    }
    return limited;
}

}  // namespace

double area_on(double spacing, const SurfacePoints& points, std::size_t point) {
    return std::min(points.area(point), kFaces * spacing * spacing);
}

std::vector<double> stiffness_on_body(const Aggregate& from, const SurfacePoints& points,
                                      double give, double spacing, double contact_stiffness,
                                      Solver solver) {
    const SurfaceLayer layer(from, points, solver);
    std::vector<double> stiffness;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const double one = layer.modulus(p) / from.lattice.spacing;
        const double area = area_on(spacing, points, p);
        stiffness.push_back(contact_stiffness * one * give / (one + give) * area);
    }
    return stiffness;
}

double share_borne(const Aggregate& matter, const SurfacePoints& points,
                   const std::vector<double>& stiffness, double most) {
    std::vector<Vec3> carried(matter.particle_count(), Vec3::Zero());
    for (std::size_t p = 0; p < points.size(); ++p) {
        const SurfacePoints::Carriers by = points.carriers(p);
        for (int c = 0; c < 8; ++c) {
            carried[by.corner[c]] +=
                std::sqrt(stiffness[p]) * std::abs(by.weight[c]) * points.normal(p);
        }
    }
    LimitedPoints limited;
    limited.asked = stiffness;
    for (std::size_t p = 0; p < points.size(); ++p) {
        const SurfacePoints::Carriers by = points.carriers(p);
        const Vec3 normal = points.normal(p);
        double row = 0;  // over the root of the point's own stiffness
        for (int c = 0; c < 8; ++c) {
            const double along = std::max(0.0, normal.dot(carried[by.corner[c]]));
            row += std::abs(by.weight[c]) * along / matter.particle_mass[by.corner[c]];
        }
        limited.stiffest.push_back(row > 0 ? std::sqrt(stiffness[p]) * most / row
                                           : std::numeric_limits<double>::infinity());
    }
    return limited.share();
}

void LimitedPoints::add(const LimitedPoints& others) {
    asked.insert(asked.end(), others.asked.begin(), others.asked.end());
    stiffest.insert(stiffest.end(), others.stiffest.begin(), others.stiffest.end());
}

double LimitedPoints::share(double shorter) const {
    double all = 0, left = 0;
    for (std::size_t p = 0; p < asked.size(); ++p) {
        all += asked[p];
        left += std::min(asked[p], stiffest[p] * shorter * shorter);
    }
    return all > 0 ? left / all : 1;
}

LimitedPoints points_at_tools(const Aggregate& matter, const SimSettings& settings, double step) {
    return on_rigid(matter, TouchPoints(matter).points(), settings.stiffness_of_contacts(),
                    settings.solver, kTouchShare / (step * step));
}

LimitedPoints points_in_grips(const Aggregate& matter, const SimSettings& settings, double step) {
    return on_rigid(matter, matter.surface, settings.grip_stiffness, settings.solver,
                    kGripShare / (step * step));
}

LimitedPoints points_between(const MeetingBody& one, const MeetingBody& other,
                             const SimSettings& settings, double step) {
    const double most = kMeetShare / (step * step);
    LimitedPoints both = one_way(one, other, settings, most);
    both.add(one_way(other, one, settings, most));
    return both;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff contacts and grips are asked to be, and what explicit steps leave of that.
#pragma once

#include <algorithm>
#include <vector>

#include "matter/aggregate.h"
#include "matter/touch_points.h"
#include "sim/settings.h"

namespace swage {

// Of the surface that a point stands for, what counts on a body [m2]: it pushes one cell there,
// which larger cells' points would drive in alone. `spacing`: of the body [m].
double area_on(double spacing, const SurfacePoints& points, std::size_t point);

// Asked of each point of a body on another, by one way alone (sim/body_contact.h) [N/m]. Of the
// other, `give`: its surface_modulus() over its spacing [Pa/m].
std::vector<double> stiffness_on_body(const Aggregate& from, const SurfacePoints& points,
                                      double give, double spacing, double contact_stiffness,
                                      Solver solver);

// What steps leave each of these at the most [N/m]: its carriers follow it (stiffest_of_points()),
// and so does `onto`, whose own points would be asked as much: which of its corners will be pressed
// on is not known, so it is what its whole surface has in the mean,
//
//     k_p <= s stiffness_p,   s = sum_q least(k_q, most_q) / sum_q k_q,
//
// q its points. They are pressed from one side at a time, and so most_q is that of springs across
// the surface alone: in the Gram matrix of stiffest_of_points() each pair counts by n_q . n_r.
// NOTE: place by place it would be less on edges than on faces, and what slides from one to the
// other would have its springs softened under load. With the first bound alone a stiff, heavy body
// pressed a light one harder than steps can follow, and a third of the light one's energy came
// from nowhere.
// Here `share` is s, by share_borne() of the other body; 1: it bears all.
inline double stiffest_on_body(double of_points, double share, double stiffness) {
    return share < 1 ? std::min(of_points, share * stiffness) : of_points;
}
double share_borne(const Aggregate& matter, const SurfacePoints& points,
                   const std::vector<double>& stiffness, double most);

// Points that are pressed alike.
struct LimitedPoints {
    std::vector<double> asked, stiffest;  // of each [N/m]; the second in steps of some length

    void add(const LimitedPoints& others);
    // What all of them have together of what they are asked, in steps shorter by this factor.
    double share(double shorter = 1) const;
};

// A body, and with what it meets others.
struct MeetingBody {
    MeetingBody(const Aggregate& body) : matter(body), touch(body, false) {}
    const Aggregate& matter;
    TouchPoints touch;
};

// Of a body's whole surface as it is now, in steps of this length [s]: under tools that say nothing
// of their own; in grips; and where it meets another and that meets it.
LimitedPoints points_at_tools(const Aggregate& matter, const SimSettings& settings, double step);
LimitedPoints points_in_grips(const Aggregate& matter, const SimSettings& settings, double step);
LimitedPoints points_between(const MeetingBody& one, const MeetingBody& other,
                             const SimSettings& settings, double step);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The test stand: a body between grips and loads, brought to rest far more exactly than a run
// needs, and what is measured of it.
#pragma once

#include <memory>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "sim/advance.h"

namespace swage {

// A bar along x, centred on the origin, that whole cells fill: sides 1, Young's modulus 1.
Aggregate unit_bar(double length, int across, Material material);
// A block along the axes, centred on the origin, that whole cells fill.
Aggregate block_of(const Vec3& size, double spacing, const Material& material);
// Any mesh with cells of 1 / across.
Aggregate unit_mold(const TriMesh& mesh, int across, const Material& material);
TriMesh bar_mesh(double length, double side);
Material unit_material(double poisson_ratio = 0.25);
TriMesh turned(TriMesh mesh, const Quat& rotation);

// Surface points of the flat end face that looks along `outward` (a unit vector).
std::vector<int> end_face(const Aggregate& matter, const Vec3& outward);
double area_of(const Aggregate& matter, const std::vector<int>& points);
Vec3 mean_position(const Aggregate& matter, const std::vector<int>& points);
Vec3 mean_move(const Aggregate& matter, const std::vector<int>& points);  // since molding

// Of what no grip and no load moves; tools stand where they are.
Drive at_time(double time, const std::vector<Pose>& world_from_tool = {});

class Stand {
  public:
    // Tolerance: of the forces at rest, over the largest push.
    explicit Stand(Aggregate body, double tolerance = 1e-6, const Vec3& gravity = Vec3::Zero());

    Aggregate matter;
    Apparatus apparatus;
    Drive drive;  // now

    // Holds points by a frame at their middle, along those of the world's axes that are 1; returns
    // its number.
    int grip(const std::vector<int>& points, const Vec3& hold = Vec3::Ones());
    // Dead forces, an even share by area of this one in all; returns the load's number.
    int load(const std::vector<int>& points, const Vec3& force);
    // A pressure that follows the surface; `closed`: all of a closed one.
    int press(const std::vector<int>& points, double pressure, bool closed = false);

    // Puts the particles where a coarser body of the same shape has its matter: a first guess.
    void start_from(const Aggregate& coarse);
    // Goes on to another drive.
    FrameReport move(const Drive& to);
    // Repeats the present drive until nothing moves on. Matter that cannot yield jumps ahead on
    // the way; what can would remember.
    FrameReport settle();

  private:
    SimSettings settings_;
    std::unique_ptr<Simulation> simulation_;
};

// The slice of surface within `half` of s along an axis at molding: its mean place and turn.
struct Slice {
    double place;  // along the axis
    double angle;  // [rad] about `about`
};
Slice slice_of(const Aggregate& matter, const Vec3& along, double s, double half,
               const Vec3& about);
// Turn per length about `about` between slices at -s and s.
double turn_rate(const Aggregate& matter, const Vec3& along, double s, double half,
                 const Vec3& about);
// Of a bar along x that is bent about y.
double middle_curvature(const Aggregate& bar);

// Deformation gradient that fits the slice's surface best. Particles of partly filled cells lie
// outside the body and tell less of it.
Mat3 mean_gradient(const Aggregate& matter, const Vec3& along, double s, double half);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// A blade severs the connections that its edge sweeps through (S2.15).
#pragma once

#include <array>
#include <deque>
#include <span>
#include <vector>

#include "geometry/trimesh.h"
#include "matter/aggregate.h"
#include "matter/drive.h"
#include "matter/point_side.h"

namespace swage {

struct SeverEvent {
    using IsPlain = SeverEvent;
    int direction;     // of the connection, into kForward
    ParticleId lower;  // its ends
    ParticleId upper;
    float weight;  // share of the section that it had
    int blade = 0;
    bool met = false;    // a blade has been beside it since it was planned
    float share = 0.5f;  // of the way from the lower end, at which the blade crosses it
    std::array<float, 3> normal = {0, 0, 0};  // of the path there, at molding (CutPoint)
};

// The surface that the blade's edge sweeps between two poses, as triangles in the world. Neighbours
// share their vertices bit for bit.
std::vector<std::array<Vec3, 3>> swept_triangles(const Blade& blade, const Pose& from,
                                                 const Pose& to);
// That of all blades on their way from drive to drive.
std::vector<std::array<Vec3, 3>> swept_triangles(const Apparatus& apparatus,
                                                 std::span<const Drive> way);

// The same as a mesh, without what a blade at rest sweeps.
TriMesh swept_mesh(const std::vector<std::array<Vec3, 3>>& swept);

// Whether the surface crosses what lies between two points of matter of this spacing.
bool crosses(const std::vector<std::array<Vec3, 3>>& swept, const Vec3& from, const Vec3& to,
             double spacing);

// The unsevered connections that the surface crosses, in the order of the lattice.
std::vector<SeverEvent> crossed_connections(const Aggregate& matter,
                                            const std::vector<std::array<Vec3, 3>>& swept);

// Of several blades that cross a connection on this way the first by number is its blade, whichever
// comes first: one beside it that finds nothing else parts nothing. Those that are planned at
// different times are named apart (sim/cut_plan.h).
void name_blades(std::span<SeverEvent> events, const Aggregate& matter, const Apparatus& apparatus,
                 std::span<const Drive> way);

// Of events to come, by leg: those whose middle is within `reach` [m] of the surface are met,
// whichever blade they were planned for.
void mark_met(std::deque<std::vector<SeverEvent>>& plan, const Aggregate& matter,
              const std::vector<std::array<Vec3, 3>>& swept, double reach);

// The matter keeps where its blades went.
void sever(Aggregate& matter, std::span<const SeverEvent> events);

// Of the surface's points in and beside cells that these events part the sides on which that leaves
// them.
std::vector<PointSide> sides_of(const Aggregate& matter, std::span<const SeverEvent> events,
                                const std::vector<std::array<Vec3, 3>>& swept);

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Small closed meshes for tests and benchmarks, made in place.
#pragma once

#include <functional>

#include "geometry/box_mesh.h"
#include "geometry/edges.h"

namespace swage::test {

using swage::box_mesh;

// Every edge has two triangles, in opposite directions.
bool is_closed(const TriMesh& mesh);

// 20 * 4^divisions triangles.
TriMesh sphere_mesh(double radius, int divisions);

// A closed surface over two angles that both come round, `across` running counter-clockwise
// seen along `along`.
TriMesh ring_mesh(int along, int across, const std::function<Vec3(double, double)>& at);

TriMesh torus_mesh(double ring, double tube, int along, int across);

// A trefoil of bumpy tube, 2 * along * across triangles, about 3 wide.
TriMesh knot_mesh(int along, int across);

TriMesh moved(TriMesh mesh, const Pose& pose);
TriMesh turned_inside_out(TriMesh mesh);
TriMesh together(const TriMesh& a, const TriMesh& b);

}  // namespace swage::test

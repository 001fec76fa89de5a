// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/blade_entry.h"

#include "geometry/triangle_tree.h"
#include "matter/cell_middle.h"
#include "sim/sever.h"

namespace swage {

bool enters_matter(const std::vector<std::array<Vec3, 3>>& swept, const Aggregate& matter) {
    constexpr float kWhole = 0.99f;  // of a cell
    const TriMesh mesh = swept_mesh(swept);
    if (mesh.triangle.empty()) return false;
    const double reach = 0.5 * matter.lattice.spacing;
    const Box near = box_of(mesh.position).widened(reach);
    const TriangleTree tree(mesh);
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.cell_fill[c] < kWhole) continue;
        const Vec3 middle = cell_middle(matter, static_cast<CellId>(c));
        if (near.contains(middle) && tree.distance(middle) <= reach) return true;
    }
    return false;
}

bool passes_beside(const std::vector<std::array<Vec3, 3>>& swept, const Aggregate& matter) {
    const TriMesh mesh = swept_mesh(swept);
    if (mesh.triangle.empty()) return false;
    const double reach = matter.lattice.spacing;
    const Box near = box_of(mesh.position).widened(reach);
    const TriangleTree tree(mesh);
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const Vec3 at = matter.particle_position.at(p);
        if (near.contains(at) && tree.distance(at) <= reach) return false;
    }
    return true;
}

}  // namespace swage

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

}  // namespace swage

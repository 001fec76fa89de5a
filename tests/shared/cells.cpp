// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/cells.h"

namespace swage::test {

Aggregate make_cells(const Vec3& low, const Vec3i& count, double a, const Material& material,
                     const std::function<bool(const Vec3i&)>& is_wanted) {
    const auto is_cell = [&](const Vec3i& at) {
        return (at.array() >= 0).all() && (at.array() < count.array()).all() && is_wanted(at);
    };
    std::vector<Vec3i> cells;
    for (int n = 0; n < count.prod(); ++n) {
        const Vec3i at(n % count.x(), n / count.x() % count.y(), n / count.x() / count.y());
        if (is_cell(at)) cells.push_back(at);
    }
    Aggregate m =
        make_matter(low, a, count, cells, std::vector<float>(cells.size(), 1.0f), material);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (int face = 0; face < 6; ++face) {
            const int axis = face >> 1, end = face & 1;
            const Vec3 out = (end ? 1 : -1) * Vec3::Unit(axis);
            if (is_cell(cells[c] + out.cast<int>())) continue;
            for (int q = 0; q < 4; ++q) {
                Vec3 at = end * Vec3::Unit(axis);
                at[(axis + 1) % 3] = q & 1 ? 0.75 : 0.25;
                at[(axis + 2) % 3] = q & 2 ? 0.75 : 0.25;
                m.surface.add(m.lattice.cell_row(static_cast<CellId>(c)), at, a * a / 4, out);
            }
        }
    }
    return m;
}

}  // namespace swage::test

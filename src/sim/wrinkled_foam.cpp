// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/wrinkled_foam.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "matter/cell_gradient.h"
#include "sim/elasticity_of.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kPressed = 0.5;  // the smallest stretch that is no matter
constexpr float kSliver = 0.5f;   // of a cell: less is crushed long before the rest

}  // namespace

bool foam_wrinkles(const Aggregate& matter) {
    std::vector<char> is_foam;  // each material
    for (std::size_t m = 0; m < matter.material_count(); ++m) {
        is_foam.push_back(elasticity_of(matter, m) == Elasticity::storakers);
    }
    if (std::ranges::count(is_foam, 1) == 0) return false;
    const std::vector<char> pressed =
        of_each_chunk(matter.cell_fill.size(), [&](std::size_t begin, std::size_t end) -> char {
            for (std::size_t n = begin; n < end; ++n) {
                const auto c = static_cast<CellId>(n);
                if (matter.cell_fill[n] < kSliver || !is_foam[matter.material_number(c)]) continue;
                const Mat3 f =
                    cell_gradient(matter, matter.lattice.cell_corners(c), Vec3::Constant(0.5));
                Eigen::SelfAdjointEigenSolver<Mat3> stretch;
                stretch.computeDirect(f.transpose() * f, Eigen::EigenvaluesOnly);
                if (stretch.eigenvalues()[0] < kPressed * kPressed) return 1;
            }
            return 0;
        });
    return std::ranges::count(pressed, 1) > 0;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_overlap.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/units.h"
#include "geometry/near_pairs.h"
#include "matter/cell_middle.h"

namespace swage {

namespace {

// Middles of cells that lie on each other are half of both cells apart; these are nearer.
constexpr double kNearer = 0.45;
constexpr float kSolid = 0.5f;  // share of a cell, that its middle is in the body

std::vector<Vec3> solid_middles(const Aggregate& matter) {
    std::vector<Vec3> middles;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.cell_fill[c] < kSolid) continue;
        middles.push_back(cell_middle(matter, static_cast<CellId>(c)));
    }
    return middles;
}

}  // namespace

std::vector<std::string> start_overlaps(const std::vector<NamedMatter>& bodies) {
    std::vector<std::vector<Vec3>> middle;
    for (const NamedMatter& body : bodies) middle.push_back(solid_middles(*body.matter));
    std::vector<std::string> told;
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = a + 1; b < bodies.size(); ++b) {
            const double side_a = bodies[a].matter->lattice.spacing,
                         side_b = bodies[b].matter->lattice.spacing;
            const double reach = kNearer * (side_a + side_b);
            std::vector<Box> box;
            for (const Vec3& m : middle[b]) {
                box.push_back({m - Vec3::Constant(reach), m + Vec3::Constant(reach)});
            }
            std::vector<char> shared(middle[a].size(), 0);
            for (const auto& [point, other] : near_pairs(middle[a], box)) {
                const Vec3 way = middle[a][static_cast<std::size_t>(point)] -
                                 middle[b][static_cast<std::size_t>(other)];
                if (way.norm() < reach) shared[static_cast<std::size_t>(point)] = 1;
            }
            const auto cells = std::count(shared.begin(), shared.end(), 1);
            if (cells == 0) continue;
            told.push_back(fmt::format(
                "\"{}\" and \"{}\" lie in each other at the start, by about {} cells of {}: they "
                "will burst apart; put them further apart with `at`",
                bodies[a].name, bodies[b].name, cells, quantity_text(side_a, Quantity::length)));
        }
    }
    return told;
}

}  // namespace swage

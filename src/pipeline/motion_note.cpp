// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/motion_note.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace swage {

namespace {

constexpr double kLittle = 0.01;  // of what is held as strain

}  // namespace

MotionLeft motion_of(const std::vector<WorkPiece>& bodies) {
    MotionLeft left;
    double fastest = 0;
    for (const WorkPiece& body : bodies) {
        const Aggregate& matter = body.matter;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            const double square = matter.particle_velocity.at(p).squaredNorm();
            left.energy += 0.5 * matter.particle_mass[p] * square;
            fastest = std::max(fastest, square);
        }
        const double slowly = matter.lattice.spacing;  // in a second
        left.is_little += 0.5 * matter.mass() * slowly * slowly;
    }
    left.speed = std::sqrt(fastest);
    return left;
}

std::string motion_note(const MotionLeft& left, double elastic) {
    if (left.energy <= std::max(left.is_little, kLittle * elastic)) return {};
    return fmt::format(
        "it begins in motion, at up to {}, which equilibria do not have: {:.3g} J of kinetic "
        "energy are left out; let the stage before last until it is at rest, or use solver = "
        "\"explicit\"",
        quantity_text(left.speed, Quantity::speed), left.energy);
}

}  // namespace swage

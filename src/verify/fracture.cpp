// SPDX-License-Identifier: GPL-3.0-or-later
// Cracks. All but the closed one run through slices one cell thick, free on both sides (plane
// stress), with a spacing of 1.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "verify/case.h"
#include "verify/crack_strip.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kTolerance = 1e-3;
constexpr double kStep = 0.02;  // by which the energy release rate grows from frame to frame

// Moves both grips apart until the tip has passed `goal`; returns the opening half a step before.
double open_until(Stand& stand, const Vec3& along, const Vec3& across, double goal,
                  const std::function<double(double)>& opening_at, double share, Tip& tip) {
    constexpr double kGiveUp = 4;
    const Drive rest = stand.drive;
    for (; share < kGiveUp; share += kStep) {
        Drive to = stand.drive;
        for (int side : {-1, 1}) {
            to.world_from_grip[side > 0].translation = rest.world_from_grip[side > 0].translation +
                                                       0.5 * side * opening_at(share) * across;
        }
        stand.move(to);
        tip = tip_of(stand.matter, along, across);
        if (tip.ahead > goal) return share - 0.5 * kStep;
    }
    return share;
}

// A strip whose clamped edges part: far ahead of the crack the energy in each length is known, and
// far behind there is none, whatever the crack is like.
void strip(bool brief, Values& values) {
    constexpr double kHeld = 3;  // spacings that a clamp holds of each side
    struct Level {
        double reach, half;  // half of the free height
        double straight;     // bound along the axis
    };
    for (const auto& [reach, half, straight] : {Level{8, 16, 0.15}, Level{16, 26, 0.05}}) {
        if (brief && reach > 8) break;
        for (double degrees : {0.0, 22.5, 45.0}) {
            if (brief && degrees > 0) break;
            const double angle = degrees * kPi / 180;
            const Vec3 along(std::cos(angle), std::sin(angle), 0);
            const Vec3 across(-along.y(), along.x(), 0);
            const Material material = breaking(reach);
            Stand stand(slice(5 * half, 2 * (half + kHeld), angle, material), kTolerance);
            const double end = -0.8 * half;
            notch(stand.matter, along, across, end);
            for (int side : {-1, 1}) {
                stand.grip(clamped(stand.matter, across, side, half));
            }
            const auto opening = [&](double share) { return strip_opening(share, half, material); };
            Tip tip;
            const double asked =
                open_until(stand, along, across, end + 0.7 * half, opening, 0.8, tip);
            const std::string at = fmt::format(", {:g} deg, l / a = {:g}", degrees, reach);
            Value toughness = relative("G / G_c" + at, 0, 1, asked, degrees > 0 ? 0.15 : straight);
            // Across the axes a crack may ask less.
            if (degrees > 0) toughness.error = std::max(0.0, asked - 1);
            values.add(toughness);
            const double grown = tip_of(stand.matter, along, across, end + 0.7 * half).off;
            values.add(absolute("off its line [cells]" + at, 0, 0, grown, 1));
            // Once it has grown so far it may run on to the strip's end.
            values.add(absolute("off all along [cells]" + at, 0, 0, tip.off,
                                std::numeric_limits<double>::infinity()));
        }
    }
}

// The farthest broken diagonal of the faces that look along z.
double slid_as_far_as(const Aggregate& m) {
    double ahead = -1e3;
    for (const Span& span : m.lattice.span) {
        const std::vector<float>& damage = m.connection[span.direction].damage;
        const auto& way = kForward[span.direction];
        if (damage.empty() || way[0] == 0 || way[1] == 0) continue;
        for (int n = 0; n < span.count; ++n) {
            if (damage[span.lower + n] < 1) continue;
            const Vec3 middle = 0.5 * (m.particle_reference.at(span.lower + n) +
                                       m.particle_reference.at(span.upper + n));
            ahead = std::max(ahead, middle.x());
        }
    }
    return ahead;
}

// A strip of which one layer of cells breaks, whose clamped edges slide by each other, or part
// while they do.
void weak_layer(bool brief, Values& values) {
    constexpr double kHeld = 3;
    // A crack that runs before the bound is missed as well where the bound is begun with.
    const double first = brief ? 0.85 : 0.5;
    struct Level {
        double reach, half, bound;
    };
    for (const auto& [reach, half, bound] :
         {Level{8, brief ? 12.5 : 16.5, 0.15}, Level{16, 26.5, 0.05}}) {
        if (brief && reach > 8) break;
        for (double degrees : {90.0, 45.0}) {
            if (brief && degrees < 90) break;
            const double angle = degrees * kPi / 180;
            const Vec3 way(std::sin(angle), std::cos(angle), 0);
            Aggregate body = slice(5 * half, 2 * (half + kHeld), 0, unit_material(kCrackNu));
            const Material weak = breaking(reach);
            body.inset.push_back(weak);
            const int middle = body.lattice.cell_count.y() / 2;
            for (std::size_t c = 0; c < body.cell_fill.size(); ++c) {
                const Vec3i site = body.lattice.cell_site(static_cast<CellId>(c));
                body.cell_material.push_back(site.y() == middle);
            }
            Stand stand(std::move(body), kTolerance);
            const double end = -0.8 * half;
            notch(stand.matter, Vec3::UnitX(), Vec3::UnitY(), end);
            for (int side : {-1, 1}) {
                stand.grip(clamped(stand.matter, Vec3::UnitY(), side, half));
            }
            // Far ahead: E / (1 - nu^2) parted^2 / (4 half) + E / (2 (1 + nu)) slid^2 / (4 half).
            const double each = (way.y() * way.y() / (1 - kCrackNu * kCrackNu) +
                                 way.x() * way.x() / (2 * (1 + kCrackNu))) /
                                (4 * half);
            const Drive rest = stand.drive;
            double share = first;
            for (; share < 4; share += kStep) {
                Drive to = stand.drive;
                for (int side : {-1, 1}) {
                    to.world_from_grip[side > 0].translation =
                        rest.world_from_grip[side > 0].translation +
                        0.5 * side * std::sqrt(share * weak.toughness / each) * way;
                }
                stand.move(to);
                if (slid_as_far_as(stand.matter) > end + 0.7 * half) break;
            }
            const std::string at = fmt::format(", {:g} deg, l / a = {:g}", degrees, reach);
            values.add(
                relative("G / G_c" + at, 0, 1, share - 0.5 * kStep, degrees < 90 ? 0.25 : bound));
        }
    }
}

// Two arms with grooves between them, drawn apart at their ends.
void cantilevers(bool, Values& values) {
    constexpr double kGroove = 0.15;  // of the thickness that is left
    constexpr double kCrack = 3;      // arms long
    std::vector<std::pair<int, double>> opened;
    for (int halves : {9, 17, 33}) {
        const double arm = 0.5 * halves;
        // One material: l_c is 0.7 arms.
        const Material material = breaking(0.7 * arm);
        const double length = 8 * arm, end = -0.5 * length + kCrack * arm;
        Stand stand(slice(length, halves, 0, material), kTolerance);
        Aggregate& m = stand.matter;
        for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
            if (m.lattice.cell_site(static_cast<CellId>(c)).y() == halves / 2) {
                m.cell_fill[c] = kGroove;
            }
        }
        notch(m, Vec3::UnitX(), Vec3::UnitY(), end);
        for (int side : {-1, 1}) {
            // One row of points, so that the end may turn.
            std::vector<int> points = end_face(m, side * Vec3::UnitY());
            double first = 0;
            for (int p : points) first = std::min(first, m.surface_reference(p).x());
            std::erase_if(points, [&](int p) { return m.surface_reference(p).x() > first + 0.1; });
            stand.grip(points);
        }
        // Slender beams: G = 3 E h^3 opening^2 / (16 a^4).
        const double toughness = kGroove * material.toughness, crack = kCrack * arm;
        const double slender =
            std::sqrt(16 * toughness * std::pow(crack, 4) / (3 * arm * arm * arm));
        Tip tip;
        const double share = open_until(
            stand, Vec3::UnitX(), Vec3::UnitY(), end + 0.5 * arm,
            [&](double s) { return slender * s; }, 1.3, tip);
        opened.emplace_back(halves / 2, share);
        values.add(absolute("off its line [cells]", halves / 2, 0, tip.off, 1));
    }
    const auto [finest, finest_share] = opened.back();
    opened.pop_back();
    for (const auto& [across, share] : opened) {
        values.add(relative("opening / finest run's", across, 1, share / finest_share, 0.12));
    }
    // Two thirds of an arm is how much longer it seems for turning at its root; what grooves and
    // softening ahead of the tip add is not in it.
    values.add(told("opening / slender beams'", finest, std::pow((kCrack + 0.5 + 0.67) / kCrack, 2),
                    finest_share));
}

// Breaks every connection across x = 0.
void break_through(Aggregate& m) {
    for (ConnectionArrays& all : m.connection) all.damage.assign(all.weight.size(), 0.0f);
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const double low = m.particle_reference.at(span.lower + n).x();
            const double high = m.particle_reference.at(span.upper + n).x();
            if ((low < 1e-3) == (high < 1e-3)) continue;
            m.connection[span.direction].weight.set(span.lower + n, 0);
            m.connection[span.direction].damage[span.lower + n] = 1;
        }
    }
}

void closed_crack(bool, Values& values) {
    constexpr int kAcross = 4;
    constexpr double kPress = 1e-5, kSlide = 1e-5;
    double force[2][2];
    for (int broken : {0, 1}) {
        Stand stand(unit_bar(2, kAcross, breaking(8.0 / kAcross)), 1e-6);
        if (broken) break_through(stand.matter);
        for (int side : {-1, 1}) stand.grip(end_face(stand.matter, side * Vec3::UnitX()));
        Drive to = stand.drive;
        to.world_from_grip[1].translation.x() -= kPress;
        force[broken][0] = stand.move(to).load[1].force.x();
        to.world_from_grip[1].translation.y() += kSlide;
        force[broken][1] = stand.move(to).load[1].force.y();
    }
    values.add(relative("pressed / whole", kAcross, 1, force[1][0] / force[0][0], 0.2));
    values.add(as_share("slid / whole", kAcross, 0, force[1][1] / force[0][1], 0.01));
}

}  // namespace

void add_fracture_cases(std::vector<Case>& cases) {
    cases.push_back({"crack", "a crack runs through a strip with clamped edges",
                     "energy balance (Rice 1968)", 0, false, strip});
    cases.push_back({"weak-layer", "a crack slides along a weak layer, or opens it as well",
                     "energy balance (Rice 1968)", 0, true, weak_layer});
    cases.push_back({"double-cantilever", "a crack between two arms drawn apart", "own finest run",
                     0, false, cantilevers});
    cases.push_back(
        {"closed-crack", "a broken bar, pressed and slid", "contact", 0, true, closed_crack});
}

}  // namespace swage

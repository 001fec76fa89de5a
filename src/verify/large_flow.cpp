// SPDX-License-Identifier: GPL-3.0-or-later
// Matter that flows far: pressed, drawn and shot at a wall.
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/make_shape.h"
#include "laws/flow_forms.h"
#include "mold/mold.h"
#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kYield = 0.002;  // over E

// A cube whose ends are held along x alone, so that it stays a block: a bar of section V / length
// and a stress of yield + H ln(length), but for what is elastic.
void far_flow(bool brief, Values& values) {
    struct Way {
        const char* what;
        double length, hardening;
    };
    constexpr int kFrames = 40;
    for (int across : {2, 4}) {
        if (brief && across > 2) break;
        // Drawn without hardening it would neck.
        for (const auto& [what, length, hardening] :
             {Way{"pressed to a quarter", 0.25, 0}, Way{"drawn to twice", 2, 5 * kYield}}) {
            Material material = unit_material(0.3);
            material.yield_stress = kYield;
            material.hardening = hardening;
            Stand stand(block_of({1, 1, 1}, 1.0 / across, material), 1e-5);
            for (int side : {-1, 1}) {
                stand.grip(end_face(stand.matter, side * Vec3::UnitX()), Vec3::UnitX());
            }
            const Drive start = stand.drive;
            const double strain = std::log(length);
            for (int frame = 1; frame <= kFrames; ++frame) {
                Drive to = stand.drive;
                const double grown = std::exp(strain * frame / kFrames) - 1;
                for (int side : {0, 1}) {
                    to.world_from_grip[side].translation =
                        start.world_from_grip[side].translation + Vec3((side - 0.5) * grown, 0, 0);
                }
                stand.move(to);
            }
            const double flowed =
                (std::abs(strain) - kYield) / (1 + hardening / material.young_modulus);
            const double stress = kYield + hardening * flowed;
            const double force = std::abs(stand.settle().load[1].force.x());
            values.add(
                relative(std::string("force, ") + what, across, stress / length, force, 0.002));
        }
    }
}

// A cube of metal that hardens as K (e0 + e)^n, its ends held along x alone, in log strains: the
// force is stress exp(-strain), strain that of plastic flow and stress / E. It is greatest where
// the stress rises as much as it is, at a strain of about n - e0. The work of flow is the integral.
void power_law(bool brief, Values& values) {
    constexpr int kFrames = 50;
    constexpr double kStrongest = 0.004, kStart = 0.01, kPower = 0.2, kFarthest = 0.25;
    const SwiftForm form{kStrongest, kStart, kPower};
    const auto strain_at = [&](double flowed) { return flowed + form(flowed); };  // E is 1
    const auto force_at = [&](double flowed) {
        return form(flowed) * std::exp(-strain_at(flowed));
    };
    // Where a function of the flow, which changes its sign once, does.
    const auto found = [](const auto& above) {
        double low = 0, high = 1;
        while (high - low > 1e-12) (above(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
        return low;
    };
    const double strongest = found([&](double flowed) {
        const double rise = kPower * form(flowed) / (kStart + flowed);
        return rise / (1 + rise) < form(flowed);
    });
    const double last = found([&](double flowed) { return strain_at(flowed) > kFarthest; });
    for (int across : {2, 4}) {
        if (brief && across > 2) break;
        Material material = unit_material(0.3);
        material.flow_along(points_of(form));
        Stand stand(block_of({1, 1, 1}, 1.0 / across, material), 1e-5);
        for (int side : {-1, 1}) {
            stand.grip(end_face(stand.matter, side * Vec3::UnitX()), Vec3::UnitX());
        }
        const Drive start = stand.drive;
        std::array<double, kFrames + 1> force{};
        FrameReport r;
        for (int frame = 1; frame <= kFrames; ++frame) {
            Drive to = stand.drive;
            const double grown = std::expm1(kFarthest * frame / kFrames);
            for (int side : {0, 1}) {
                to.world_from_grip[side].translation =
                    start.world_from_grip[side].translation + Vec3((side - 0.5) * grown, 0, 0);
            }
            r = stand.move(to);
            force[frame] = std::abs(r.load[1].force.x());
        }
        // By the parabola through the largest and those beside it.
        const auto at = std::max_element(force.begin() + 2, force.end() - 1);
        const double bend = at[1] - 2 * at[0] + at[-1], lean = 0.5 * (at[1] - at[-1]);
        const double strain = kFarthest / kFrames * (at - force.begin() - lean / bend);
        values.add(relative("greatest force", across, force_at(strongest),
                            at[0] - 0.5 * lean * lean / bend, 1e-4));
        values.add(
            relative("strain at the greatest force", across, strain_at(strongest), strain, 2e-3));
        values.add(relative("force at the end", across, force_at(last), force[kFrames], 1e-4));
        const double rise = kPower + 1;
        const double work =
            kStrongest / rise * (std::pow(kStart + last, rise) - std::pow(kStart, rise));
        values.add(relative("work of flow", across, work, r.plastic, 2e-4));
    }
}

// A bar of stress yield + H strain bears most at the strain (H - yield) / H, where its section
// shrinks as fast as it hardens: H exp(yield / H - 1) of its first section. From there on it necks.
void necking(bool brief, Values& values) {
    constexpr double kHardening = 1.5 * kYield, kLongest = 1.6;
    constexpr int kFrames = 60;
    const double most = kHardening * std::exp(kYield / kHardening - 1);
    for (int across : {4, 8}) {
        if (brief && across > 4) break;
        Material material = unit_material(0.3);
        material.yield_stress = kYield;
        material.hardening = kHardening;
        Stand stand(block_of({6, 1, 1}, 1.0 / across, material), 1e-4);
        for (int side : {-1, 1}) stand.grip(end_face(stand.matter, side * Vec3::UnitX()));
        const Drive start = stand.drive;
        double largest = 0, last = 0;
        for (int frame = 1; frame <= kFrames; ++frame) {
            Drive to = stand.drive;
            const double grown = 6 * (std::exp(std::log(kLongest) * frame / kFrames) - 1);
            for (int side : {0, 1}) {
                to.world_from_grip[side].translation =
                    start.world_from_grip[side].translation + Vec3((side - 0.5) * grown, 0, 0);
            }
            last = std::abs(stand.move(to).load[1].force.x());
            largest = std::max(largest, last);
        }
        values.add(relative("largest force", across, most, largest, 0.01));
        values.add(at_least("lost of it at 1.6 times the length", across, 0.1, 1 - last / largest));
    }
}

// The bar of copper that is shot at a rigid wall in the literature: 32.4 x 6.4 mm at 227 m/s, as it
// is after 80 us. Length and radius of the foot are given as 21.26 to 21.66 and 6.97 to 7.24 mm;
// the finest, adaptive meshes (Camacho & Ortiz) have 21.42 to 21.44 and 7.21 to 7.24.
void taylor_bar(bool brief, Values& values) {
    constexpr double kLength = 0.0324, kRadius = 0.0032, kSpeed = 227, kTime = 80e-6;
    Material copper;
    copper.young_modulus = 117e9;
    copper.poisson_ratio = 0.35;
    copper.density = 8930;
    copper.yield_stress = 400e6;
    copper.hardening = 100e6;
    copper.damping_ratio = 0;
    for (int across : {6, 8, 12}) {
        if (brief && across > 6) break;
        MoldSettings mold_settings;
        mold_settings.spacing = 2 * kRadius / across;
        TriMesh rod =
            make_shape("rod", {{"length", kLength}, {"diameter", 2 * kRadius}, {"division", 60}})
                .mesh;
        Aggregate bar = mold(rod, copper, mold_settings);
        bar.particle_velocity.x.assign(bar.particle_count(), -kSpeed);
        Apparatus wall;
        wall.name = "wall";
        wall.tool.push_back({"wall", BoxShape{Vec3::Constant(0.1), 0}, 0});
        SimSettings settings;
        settings.solver = Solver::explicit_steps;
        const std::vector<Pose> there{{Quat::Identity(), {-0.05 - 0.5 * kLength, 0, 0}}};
        Simulation simulation(bar, wall, settings);
        const double given = 0.5 * bar.mass() * kSpeed * kSpeed;
        const FrameReport r = simulation.advance(at_time(0, there), at_time(kTime, there));
        double low = 0, high = 0;
        std::array<double, 16> foot{};  // by direction
        for (std::size_t p = 0; p < bar.surface.size(); ++p) {
            const Vec3 x = bar.surface_position(p);
            low = std::min(low, x.x()), high = std::max(high, x.x());
            const double turn = std::atan2(x.z(), x.y()) / (2 * kPi) + 0.5;
            double& most = foot[static_cast<std::size_t>(foot.size() * turn) % foot.size()];
            most = std::max(most, std::hypot(x.y(), x.z()));
        }
        double radius = 0;
        for (double one : foot) radius += one / double(foot.size());
        values.add(relative("length [mm]", across, 21.43, 1e3 * (high - low), 0.01));
        values.add(relative("radius of the foot [mm]", across, 7.225, 1e3 * radius, 0.02));
        values.add(
            as_share("energy left over, share", across, 0, std::abs(r.remainder) / given, 2e-3));
    }
}

}  // namespace

void add_large_flow_cases(std::vector<Case>& cases) {
    cases.push_back({"far-flow", "a block pressed to a quarter and drawn to twice its length",
                     "stress times section", 0, true, far_flow});
    cases.push_back({"power-law", "a block of metal that hardens by a power, drawn past its most",
                     "Swift 1952; Considere 1885", 0, true, power_law});
    cases.push_back({"necking", "a bar drawn until it necks", "Considere 1885", 0, true, necking});
    cases.push_back({"taylor-bar", "a copper rod hits a rigid wall at 227 m/s",
                     "Kamoulakos 1990; Zhu & Cescotto 1995; Camacho & Ortiz 1997", 0, true,
                     taylor_bar});
}

}  // namespace swage

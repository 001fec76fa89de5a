// SPDX-License-Identifier: GPL-3.0-or-later
// Bars of two materials, one a hundred times as stiff, whose boundary runs through cells.
#include <cmath>
#include <limits>
#include <memory>

#include "geometry/box_mesh.h"
#include "mold/mold.h"
#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kStiff = 100;
constexpr double kFractions[] = {0.25, 0.5, 0.75, 0.9};  // of the cell that the boundary crosses

Aggregate layered(const Vec3& size, int across, const Vec3& low, const Vec3& high, double nu) {
    Material stiff = unit_material(nu);
    stiff.young_modulus = kStiff;
    MoldSettings settings;
    settings.spacing = 1.0 / across;
    return mold(box_mesh(-0.5 * size, 0.5 * size), unit_material(nu), settings,
                {{box_mesh(low, high), stiff}});
}

std::string at_fraction(const char* what, double fraction) {
    return std::string(what) + " (boundary at " + std::to_string(fraction).substr(0, 4) +
           " of a cell)";
}

// Layers along the bar, the stiff one above y. The end faces are pulled with the stress of a
// uniform strain or bend, patch by patch; what the middle does is compared with what the forces
// that were really applied ask of plane sections.
void layers_along(bool brief, Values& values) {
    constexpr double kLength = 6, kStrain = 1e-4;
    for (int across : brief ? std::vector{4} : std::vector{4, 8}) {
        const double a = 1.0 / across;
        for (double fraction : kFractions) {
            const double y = -0.5 + (across / 2 + fraction) * a;
            const double low = y + 0.5, high = 0.5 - y;
            const double stretched = low + kStiff * high;
            const double coupled = 0.5 * ((y * y - 0.25) + kStiff * (0.25 - y * y));
            const double bent = (y * y * y + 0.125 + kStiff * (0.125 - y * y * y)) / 3;
            for (bool bends : {false, true}) {
                Stand stand(layered({kLength, 1, 1}, across, {-0.5 * kLength, y, -0.5},
                                    {0.5 * kLength, 0.5, 0.5}, 0.25));
                double force = 0, moment = 0;
                for (double side : {-1.0, 1.0}) {
                    Load load;
                    load.name = side < 0 ? "left" : "right";
                    load.point = end_face(stand.matter, side * Vec3::UnitX());
                    force = moment = 0;
                    for (int p : load.point) {
                        const double at = stand.matter.surface_reference(p).y();
                        // The patch is half a cell high.
                        const double soft = std::clamp((y - at) / (0.5 * a) + 0.5, 0.0, 1.0);
                        const double modulus = soft + kStiff * (1 - soft);
                        const double pull =
                            stand.matter.surface.area(p) * modulus * kStrain * (bends ? at : 1.0);
                        load.force.push_back(side * pull * Vec3::UnitX());
                        force += pull, moment += pull * at;
                    }
                    stand.apparatus.load.push_back(load);
                    stand.drive.load_strength.push_back(1);
                }
                stand.settle();
                // force = A e + B k, moment = B e + D k
                const double det = stretched * bent - coupled * coupled;
                const double strain = (bent * force - coupled * moment) / det;
                const double bend = (stretched * moment - coupled * force) / det;
                if (bends) {
                    const double rate =
                        -turn_rate(stand.matter, Vec3::UnitX(), 1, 0.25 * a, Vec3::UnitZ());
                    values.add(relative(at_fraction("bending", fraction), across, bend, rate,
                                        across == 8 ? 0.01 : 0.02));
                } else {
                    const Mat3 f = mean_gradient(stand.matter, Vec3::UnitX(), 0, 1);
                    values.add(relative(at_fraction("stretch", fraction), across, strain,
                                        f(0, 0) - 1, across == 8 ? 0.01 : 0.02));
                }
            }
        }
    }
}

// Layers across the bar: a stiff one in the middle, of four cells less what the boundaries leave.
void layers_across(bool brief, Values& values) {
    constexpr double kLength = 4, kPull = 1e-4;
    for (int across : brief ? std::vector{4} : std::vector{4, 8}) {
        const double a = 1.0 / across;
        for (double fraction : kFractions) {
            const double left = -0.5 - fraction * a, right = 0.5 + (1 - fraction) * a;
            Stand stand(layered({kLength, 1, 1}, across, {left, -0.5, -0.5}, {right, 0.5, 0.5}, 0));
            for (double side : {-1.0, 1.0}) {
                stand.load(end_face(stand.matter, side * Vec3::UnitX()),
                           side * kPull * Vec3::UnitX());
            }
            stand.settle();
            const double longer =
                mean_move(stand.matter, end_face(stand.matter, Vec3::UnitX())).x() -
                mean_move(stand.matter, end_face(stand.matter, -Vec3::UnitX())).x();
            const double stiff = right - left;
            values.add(relative(at_fraction("in series", fraction), across,
                                kPull * (kLength - stiff + stiff / kStiff), longer, 0.01));
        }
    }
}

// What a material bears when it is sheared by g, and how far it goes under t; linear hardening.
struct Sheared {
    double modulus, yields, hardening;  // mu; yield stress in shear; of t over plastic shear [Pa]

    explicit Sheared(const Material& m)
        : modulus(m.young_modulus / (2 + 2 * m.poisson_ratio)),
          yields(m.yield_stress / std::sqrt(3.0)),
          hardening(m.hardening / 3) {}
    double flow_at(double t) const { return t > yields ? (t - yields) / hardening : 0; }
    double strain_at(double t) const { return t / modulus + flow_at(t); }
    double stress_at(double g) const {
        const double t = modulus * g;
        return t < yields ? t : (g + yields / hardening) / (1 / modulus + 1 / hardening);
    }
};

// A block of two layers, the stiff one above y or z = at; sheared in x and y.
struct ShearedBlock {
    struct Yields {
        const char* flows;
        double soft, stiff;  // [Pa]
    };
    Material soft = unit_material(0.25), stiff = soft;
    double low;  // share of the soft layer
    std::unique_ptr<Stand> stand;

    ShearedBlock(int across, double fraction, int axis, const Yields& yields) {
        const double a = 1.0 / across, at = -0.5 + (across / 2 + fraction) * a;
        low = at + 0.5;
        stiff.young_modulus = kStiff;
        soft.yield_stress = yields.soft, stiff.yield_stress = yields.stiff;
        soft.hardening = 0.2, stiff.hardening = 5;
        MoldSettings settings;
        settings.spacing = a;
        const Vec3 half = Vec3::Constant(0.5);
        Vec3 from = -half;
        from[axis] = at;
        stand = std::make_unique<Stand>(
            mold(box_mesh(-half, half), soft, settings, {{box_mesh(from, half), stiff}}));
    }
    std::vector<int> face(int axis, double side) const {
        return end_face(stand->matter, side * Vec3::Unit(axis));
    }
    double shear() const {
        double sum = 0;
        for (int axis : {0, 1}) {
            for (double side : {-1.0, 1.0}) {
                sum += side * mean_move(stand->matter, face(axis, side))[1 - axis];
            }
        }
        return sum;
    }
};
constexpr double kNever = std::numeric_limits<double>::infinity();

// Layers in series bear the same: dead loads on four faces, and taken off again.
void yield_in_series(int across, double fraction, const ShearedBlock::Yields& yields,
                     Values& values) {
    constexpr double kStress = 1.2e-3;
    ShearedBlock block(across, fraction, 1, yields);
    Stand& stand = *block.stand;
    for (int axis : {0, 1}) {
        for (double side : {-1.0, 1.0}) {
            stand.load(block.face(axis, side), side * kStress * Vec3::Unit(1 - axis));
        }
    }
    // It would turn over, so that all of it is pulled.
    stand.grip(block.face(2, -1), Vec3::UnitZ());
    stand.grip(block.face(2, 1), Vec3::UnitZ());
    const auto go_to = [&](double strength) {
        Drive to = stand.drive;
        to.time += 1;
        for (double& one : to.load_strength) one = strength;
        stand.move(to);
    };
    for (double& one : stand.drive.load_strength) one = 0;
    for (double strength : {0.25, 0.5, 0.75, 1.0}) go_to(strength);
    stand.settle();
    const Sheared s(block.soft), h(block.stiff);
    const double low = block.low, g = low * s.strain_at(kStress) + (1 - low) * h.strain_at(kStress);
    const std::string what = std::string("in series, ") + yields.flows;
    values.add(relative(at_fraction((what + ": shear").c_str(), fraction), across, g, block.shear(),
                        0.002));
    for (double strength : {0.5, 0.0}) go_to(strength);
    stand.settle();
    const double left = low * s.flow_at(kStress) + (1 - low) * h.flow_at(kStress);
    values.add(as_share(at_fraction((what + ": share left of it").c_str(), fraction), across,
                        left / g, block.shear() / g, 0.002));
}

// Layers side by side go as far: four faces are led, and half of the way back.
void yield_side_by_side(int across, double fraction, const ShearedBlock::Yields& yields,
                        Values& values) {
    constexpr double kShear = 4e-3;
    ShearedBlock block(across, fraction, 2, yields);
    Stand& stand = *block.stand;
    for (double side : {-1.0, 1.0}) stand.grip(block.face(1, side));
    for (double side : {-1.0, 1.0}) stand.grip(block.face(0, side));
    const Drive start = stand.drive;
    FrameReport report;
    const auto go_to = [&](double g) {
        Drive to = start;
        to.time = stand.drive.time + 1;
        to.world_from_grip[0].translation.x() -= 0.5 * g;
        to.world_from_grip[1].translation.x() += 0.5 * g;
        for (int n : {2, 3}) {
            to.world_from_grip[n].rotation = Quat(Eigen::AngleAxisd(-g, Vec3::UnitZ()));
        }
        report = stand.move(to);
    };
    // Of all forces on the faces, sum of (f_x r_y + f_y r_x) / 2: edges belong to two faces.
    const auto mean_stress = [&] {
        double sum = 0;
        for (int n = 0; n < 4; ++n) {
            const double arm = n % 2 ? 0.5 : -0.5, lever = n < 2 ? 1 : -1;
            sum += 0.5 *
                   (report.load[n].force[n < 2 ? 0 : 1] * arm + lever * report.load[n].torque.z());
        }
        return sum;
    };
    for (double share : {0.25, 0.5, 0.75, 1.0}) go_to(share * kShear);
    report = stand.settle();
    const Sheared s(block.soft), h(block.stiff);
    const double low = block.low, g = block.shear();
    const auto mean = [&](double soft, double stiff) { return low * soft + (1 - low) * stiff; };
    const double stress = mean(s.stress_at(g), h.stress_at(g));
    const std::string what = std::string("side by side, ") + yields.flows;
    values.add(relative(at_fraction((what + ": stress").c_str(), fraction), across, stress,
                        mean_stress(), 0.002));
    for (double share : {0.75, 0.5}) go_to(share * kShear);
    report = stand.settle();
    const double back = g - block.shear();
    values.add(as_share(at_fraction((what + ": share left half-way back").c_str(), fraction),
                        across, 1 - mean(s.modulus, h.modulus) * back / stress,
                        mean_stress() / stress, 0.002));
}

void layers_yield(bool brief, Values& values) {
    for (int across : brief ? std::vector{4} : std::vector{4, 8}) {
        for (double fraction : brief ? std::vector{0.5} : std::vector{0.25, 0.5, 0.9}) {
            yield_in_series(across, fraction, {"the soft one flows", 1e-3, kNever}, values);
            yield_in_series(across, fraction, {"both flow", 1e-3, 1.5e-3}, values);
            yield_side_by_side(across, fraction, {"the soft one flows", 1e-3, kNever}, values);
            yield_side_by_side(across, fraction, {"the stiff one flows", kNever, 0.1}, values);
            yield_side_by_side(across, fraction, {"both flow", 1e-3, 0.1}, values);
        }
    }
}

// A core that does not break in a shell that does, pulled by both ends: they carry together until
// the shell has cracked across and let go of the core, which carries alone from then on, stiffer or
// softer than the shell was.
void layers_crack(bool brief, Values& values) {
    constexpr double kLength = 3, kOnset = 1e-3, kHalf = 0.25, kFar = 0.05;
    const double core_section = 4 * kHalf * kHalf;
    for (int across : brief ? std::vector{4} : std::vector{4, 8}) {
        for (double modulus : {10.0, 0.1}) {
            Material shell = unit_material(0), core = shell;
            shell.strength = kOnset;
            shell.toughness = 8.0 / across * kOnset * kOnset;  // its softening reaches eight cells
            core.young_modulus = modulus;
            MoldSettings settings;
            settings.spacing = 1.0 / across;
            const Vec3 half(0.5 * kLength, 0.5, 0.5), inner(0.5 * kLength, kHalf, kHalf);
            Stand stand(
                mold(box_mesh(-half, half), shell, settings, {{box_mesh(-inner, inner), core}}),
                1e-4);
            for (double side : {-1.0, 1.0}) {
                stand.grip(end_face(stand.matter, side * Vec3::UnitX()));
            }
            const Drive start = stand.drive;
            const auto pull_at = [&](double strain) {
                Drive to = start;
                to.time = stand.drive.time + 1;
                to.world_from_grip[1].translation.x() += strain * kLength;
                return stand.move(to).load[1].force.x();
            };
            // Between the ends as they are: grips give way a little. Hencky's law, nu = 0.
            const auto bears = [&](double both) {
                const auto x = [&](double side) {
                    return mean_position(stand.matter, end_face(stand.matter, side * Vec3::UnitX()))
                        .x();
                };
                const double stretch = (x(1) - x(-1)) / kLength;
                return both * std::log(stretch) / stretch;
            };
            const std::string what = modulus > 1 ? "stiff core" : "soft core";
            const double whole = pull_at(0.5 * kOnset);
            values.add(relative(what + ": both", across,
                                bears(1 - core_section + modulus * core_section), whole, 1e-4));
            double alone = 0;
            for (double strain : {1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, kFar / kOnset}) {
                alone = pull_at(strain * kOnset);
            }
            values.add(relative(what + ": alone", across, bears(modulus * core_section), alone,
                                across == 4 ? 0.002 : 0.001));
        }
    }
}

// The lowest swing along a free bar of two materials end to end, of lengths l and wave speeds c:
// E_1 k_1 tan(k_1 l_1) + E_2 k_2 tan(k_2 l_2) = 0, k = w / c; the shape has cos(k x) from each end.
struct SeriesSwing {
    struct Part {
        double length, modulus, density;
        double number(double w) const { return w * std::sqrt(density / modulus); }
    } left, right;
    double frequency = 0;

    double missed(double w) const {
        const double p = left.number(w), q = right.number(w);
        return left.modulus * p * std::sin(p * left.length) * std::cos(q * right.length) +
               right.modulus * q * std::sin(q * right.length) * std::cos(p * left.length);
    }
    void find() {
        double high = 1e-3;
        while (missed(high) > 0) high *= 1.001;
        double low = high / 1.001;
        for (int n = 0; n < 60; ++n) {
            const double w = 0.5 * (low + high);
            (missed(w) > 0 ? low : high) = w;
        }
        frequency = low;
    }
    double at(double x) const {  // from the left end
        const double p = left.number(frequency), q = right.number(frequency);
        if (x <= left.length) return std::cos(p * x) * std::cos(q * right.length);
        return std::cos(q * (left.length + right.length - x)) * std::cos(p * left.length);
    }
};

void layers_swing(bool brief, Values& values) {
    constexpr double kLength = 4, kSpeed = 1e-4, kDense = 8;
    const int periods = brief ? 2 : 20;
    for (int along : brief ? std::vector{16} : std::vector{16, 32}) {
        const double a = kLength / along;
        for (double fraction : kFractions) {
            const double boundary = (along / 2 + fraction) * a;
            SeriesSwing swing{{boundary, 1, 1}, {kLength - boundary, kStiff, kDense}};
            swing.find();
            Material soft = unit_material(0), stiff = soft;
            soft.density = 1, stiff.density = kDense, stiff.young_modulus = kStiff;
            soft.damping_ratio = stiff.damping_ratio = 0;
            MoldSettings settings;
            settings.spacing = a;
            const Vec3 size(kLength, a, a);
            Aggregate bar = mold(box_mesh(Vec3::Zero(), size), soft, settings,
                                 {{box_mesh({boundary, 0, 0}, size), stiff}});
            for (std::size_t p = 0; p < bar.particle_count(); ++p) {
                bar.particle_velocity.x[p] = kSpeed * swing.at(bar.particle_reference.at(p).x());
            }
            const Apparatus nothing;
            SimSettings steps;
            steps.solver = Solver::explicit_steps;
            Simulation simulation(bar, nothing, steps);
            const double period = 2 * kPi / swing.frequency, frame = period / 8;
            double turns = 0, last = 0, energy = 0, drift = 0;
            for (int n = 1; n <= 8 * periods; ++n) {
                Drive from, to;
                from.time = (n - 1) * frame, to.time = n * frame;
                const FrameReport report = simulation.advance(from, to);
                const double held = report.kinetic + report.elastic;
                if (n == 1) energy = held;
                drift = std::max(drift, std::abs(held / energy - 1));
                double place = 0, speed = 0;
                for (std::size_t p = 0; p < bar.particle_count(); ++p) {
                    const Vec3 at = bar.particle_reference.at(p);
                    const double s = bar.particle_mass[p] * swing.at(at.x());
                    place += s * (bar.particle_position.x[p] - at.x());
                    speed += s * bar.particle_velocity.x[p];
                }
                const double now = std::atan2(swing.frequency * place, speed) / (2 * kPi);
                turns += std::remainder(now - last, 1);
                last = now;
            }
            values.add(relative(at_fraction("period", fraction), along, period,
                                8 * periods * frame / turns, along == 16 ? 0.003 : 0.001));
            values.add(as_share("most that the energy is off, share", along, 0, drift, 1e-3));
        }
    }
}

}  // namespace

void add_two_material_cases(std::vector<Case>& cases) {
    cases.push_back({"layers-along", "two materials, 1 : 100, side by side: stretched and bent",
                     "plane sections", 0, false, layers_along});
    cases.push_back({"layers-across", "two materials, 1 : 100, in series: stretched", "Hooke", 0,
                     true, layers_across});
    cases.push_back({"layers-yield", "two materials, 1 : 100, sheared past yield and let go",
                     "linear hardening", 0, true, layers_yield});
    cases.push_back({"layers-crack", "a shell that cracks around a core that does not, pulled",
                     "Hooke", 0, true, layers_crack});
    cases.push_back({"layers-swing", "two materials, 1 : 100, in series: a free bar swings",
                     "wave equation", 0, true, layers_swing});
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Cracks that run by themselves, in explicit steps: a strip of free height 2 h between clamps, with
// a notch, is opened until its crack stands just short of going on, then within eight waves' way
// across it to a share of G_c in its energy far ahead. Where the clamps open like a wedge that
// share falls along the way.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "verify/case.h"
#include "verify/crack_strip.h"

namespace swage {

namespace {

constexpr double kHalf = 16, kLength = 8 * kHalf, kHeld = 3;
constexpr double kNotch = -0.5 * kLength + kHalf;  // its end
constexpr double kStill = 0.8;                     // share of G_c at which the motion begins
constexpr int kRise = 8;                           // frames in which the clamps part on
constexpr double kFrame = 0.5 * kHalf;             // [s]; the speed of sound in a bar is 1
constexpr int kFew = 8;                            // frames that a speed is measured over, 37 cells
constexpr double kDamping = 0.02;

// Rayleigh's speed over that of shear, within 0.5 % (Viktorov 1967).
double rayleigh_speed() {
    return (0.87 + 1.12 * kCrackNu) / (1 + kCrackNu) * std::sqrt(0.5 / (1 + kCrackNu));
}

struct Ran {
    double tip = 0, fastest = 0;  // place; over Rayleigh's speed, on the way of a few cells
    int most_rows = 0;            // broken one above the other, at any place along
    double taken = 0;             // by fracture, over G_c and the tip's way
    double remainder = 0;         // over all that was put in
};

// Of the cracks that start at the notch; at high loads others do at the clamps' corners.
struct Grown {
    double tip = kNotch;
    int most_rows = 0;
};
Grown grown(const Aggregate& m) {
    Grown grown;
    std::vector<int> rows(static_cast<std::size_t>(m.lattice.cell_count.x()) + 1, 0);
    constexpr int kUpright = 1;  // direction of edges along y
    const std::vector<float>& damage = m.connection[kUpright].damage;
    for (const Span& span : m.lattice.span) {
        if (span.direction != kUpright || damage.empty()) continue;
        for (int n = 0; n < span.count; ++n) {
            const Vec3 x = m.particle_reference.at(span.lower + n);
            if (damage[span.lower + n] < 1 || std::abs(x.y()) > 0.5 * kHalf) continue;
            grown.tip = std::max(grown.tip, x.x());
            if (x.z() > 0) continue;
            ++rows[static_cast<std::size_t>(std::lround(x.x() - m.lattice.origin.x()))];
        }
    }
    grown.most_rows = *std::max_element(rows.begin(), rows.end());
    return grown;
}

// `wedge`: share of the opening that is lost from the left end to the right.
Ran run_crack(double share, double reach, double wedge) {
    const Material material = [&] {
        Material m = breaking(reach);
        m.damping_ratio = kDamping;
        return m;
    }();
    Stand stand(slice(kLength, 2 * (kHalf + kHeld), 0, material), 1e-3);
    notch(stand.matter, Vec3::UnitX(), Vec3::UnitY(), kNotch);
    for (int side : {-1, 1}) {
        stand.grip(clamped(stand.matter, Vec3::UnitY(), side, kHalf));
    }
    const Drive rest = stand.drive;
    const auto opened = [&](double opening, double time) {
        Drive drive = rest;
        drive.time = time;
        for (int side : {-1, 1}) {
            Pose& pose = drive.world_from_grip[side > 0];
            const Pose about{
                Quat(Eigen::AngleAxisd(-0.5 * side * opening * wedge / kLength, Vec3::UnitZ())),
                Vec3::Zero()};
            const Vec3 left(-0.5 * kLength, pose.translation.y(), 0);
            pose.translation = left + about.rotation * (pose.translation - left) +
                               0.5 * side * opening * Vec3::UnitY();
            pose.rotation = about.rotation * pose.rotation;
        }
        return drive;
    };
    const double still = strip_opening(kStill, kHalf, material);
    const double most = strip_opening(share, kHalf, material);
    stand.move(opened(still, 0));
    stand.settle();

    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.step_safety = 0.5;
    Simulation simulation(stand.matter, stand.apparatus, settings);
    Ran ran;
    ran.tip = kNotch;
    std::vector<double> tips{kNotch};
    FrameReport report;
    double put_in = 0;
    constexpr int kFrames = 70;
    for (int n = 0; n < kFrames && ran.tip < 0.5 * kLength - kHalf; ++n) {
        const auto at = [&](int frame) {
            const double part = std::min(1.0, double(frame) / kRise);
            return opened(still + part * (most - still), frame * kFrame);
        };
        report = simulation.advance(at(n), at(n + 1));
        const double ahead = grown(stand.matter).tip;
        tips.push_back(ran.tip = ahead);
        if (n >= kFew) {
            const double way = tips[n + 1] - tips[n + 1 - kFew];
            ran.fastest = std::max(ran.fastest, way / (kFew * kFrame) / rayleigh_speed());
        }
        put_in = std::max(put_in, report.kinetic + report.elastic + report.contact +
                                      report.fracture + report.damped);
    }
    ran.most_rows = grown(stand.matter).most_rows;
    ran.taken = report.fracture / (material.toughness * (ran.tip - kNotch));
    ran.remainder = report.remainder / put_in;
    return ran;
}

void fast_crack(bool brief, Values& values) {
    for (double reach : {4.0, 8.0}) {
        const std::string at = fmt::format(", l / a = {:g}", reach);
        // The share falls to 1 where the opening has fallen to 1 / sqrt(2).
        constexpr double kShare = 2, kWedge = 0.6;
        const Ran ran = run_crack(kShare, reach, kWedge);
        const double even = -0.5 * kLength + kLength * (1 - 1 / std::sqrt(kShare)) / kWedge;
        values.add(relative("energy taken / G_c" + at, 0, 1, ran.taken, 0.1));
        values.add(absolute("arrest beyond balance / h" + at, 0, 0, (ran.tip - even) / kHalf, 1.5));
        values.add(as_share("remainder / all energy" + at, 0, 0, ran.remainder, 0.01));
        if (brief) return;
    }
    const Ran slow = run_crack(1.3, 8, 0), fast = run_crack(3, 4, 0);
    values.add(absolute("rows broken at 1.3 G_c", 0, 1, slow.most_rows, 0.5));
    Value speed = told("speed at 3 G_c / Rayleigh's", 0, 1, fast.fastest);
    speed.error = std::max(0.0, fast.fastest - 1);
    speed.bound = 0.01;
    values.add(speed);
    Value branches = absolute("rows broken at 3 G_c, at least", 0, 2, fast.most_rows, 0.5);
    branches.error = std::max(0, 2 - fast.most_rows);
    values.add(branches);
}

}  // namespace

void add_fast_fracture_cases(std::vector<Case>& cases) {
    cases.push_back({"fast-crack", "cracks that run, branch and stop by themselves",
                     "energy balance (Freund 1990)", 0, false, fast_crack});
}

}  // namespace swage

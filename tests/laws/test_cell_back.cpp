// SPDX-License-Identifier: GPL-3.0-or-later
#include "laws/back_growth.h"
#include "laws/cell_forces.h"
#include "laws/flow_forms.h"
#include "laws/isotropic_part.h"
#include "tests/catch.h"
#include "tests/laws/shaken_cube.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kBack = 0.04, kOver = 0.02;  // X_s, 1 / gamma

CellModuli law_of(double yield_stress, double hardening, const std::vector<FlowPoint>& curve = {}) {
    CellModuli law = cell_moduli(7.0, 0.3, kSpacing, yield_stress, hardening, curve);
    law.back_stress = kBack;
    law.back_rate = 1 / kOver;
    law.sliver_strength = 0.2;
    return law;
}

struct Cell {
    double fill = 1;
    Triple<double> at{0, 0, 0};
    CellHistory<double> history{};
    BackStrain<double> back{};
};
struct State {
    CornerSums<double> sums;
    Columns<double> gradient, elastic;
    CellStrain<double> strain;
    BackFlowed<double> flowed;
};
State state_of(const CellModuli& law, const Cell& cell, const Corners& x) {
    State s;
    s.sums = sums_of(x);
    s.gradient = centroid_gradient(s.sums, cell.at, kSpacing);
    s.elastic = s.gradient * taken_back(cell.history);
    s.strain = cell_strain(s.elastic);
    s.flowed = flow_with_back(law, cell.history, cell.back, s.strain.log,
                              pulled_back(s.elastic, s.sums), cell.fill);
    return s;
}
// Of the increment: elastic energy after the return, and what the flow takes.
double taken(const CellModuli& law, const Cell& cell, const BackFlowed<double>& r) {
    return kVolume * cell.fill *
           (r.d_alpha * (mean_flow_stress(law, cell.history.alpha, r.d_alpha) + r.more) +
            r.alone.took);
}
double energy(const CellModuli& law, const Cell& cell, const Corners& x) {
    const State s = state_of(law, cell, x);
    const BackFlowed<double>& r = s.flowed;
    const Symmetric<double> e = r.kept * r.distortion + r.lent * cell.back.strain;
    const CellModes<double> q = r.kept_modes * r.modes + r.lent * cell.back.modes;
    const double size = cell_size(s.strain).log;
    return kVolume * cell.fill * (law.shear * contract(e, e) + 0.5 * law.bulk * size * size) +
           0.5 * mode_fill(cell.fill) * product(mode_stress(law, taken_back(cell.history), q), q) +
           taken(law, cell, r);
}
Corners force(const CellModuli& law, const Cell& cell, const Corners& x) {
    const CellConstants constants(law);
    const CornerSums<double> r = cell_forces<CellKind::kinematic, true, true>(
        constants, sums_of(x), CellShare<double>{cell.fill, cell.at}, cell.history, 1, nullptr,
        &cell.back);
    return forces_of(r);
}
void commit(const CellModuli& law, Cell& cell, const Corners& x) {
    const State s = state_of(law, cell, x);
    if (!(s.flowed.d_alpha > 0)) return;
    const BackGrown<double> grown =
        flowed_on(cell.history, cell.back, s.flowed, s.gradient, s.sums);
    cell.history = grown.history, cell.back = grown.back;
}

// One that has flowed this way and that, partly filled, and bent, drawn or pressed on the way.
Cell worked_cell(Draw& draw, const CellModuli& law, double far, bool is_sliver = false) {
    Cell c;
    c.fill = is_sliver ? draw(0.005, 0.06) : draw(0.1, 1);
    c.at = {draw(-0.8, 0.8), draw(-0.8, 0.8), draw(-0.8, 0.8)};
    for (int n = 0; n < 4; ++n) commit(law, c, draw.turn() * draw.shaken(far));
    return c;
}

Corners drawn(double strain) {
    const double thin = std::exp(-0.5 * strain);
    return Vec3(std::exp(strain), thin, thin).asDiagonal() * cube();
}
// True stress along the way over that across.
double tension(const CellModuli& law, const Cell& cell, const Corners& x) {
    const Corners f = force(law, cell, x);
    return -(f.row(0).dot(x.row(0)) - f.row(1).dot(x.row(1))) / kVolume;
}

}  // namespace

TEST_CASE("what fades is told to the last digits, however small, and its slopes are its own") {
    for (double x : {0.0, 1e-12, 1e-5, 0.1, 0.499999, 0.5, 0.7, 3.0, 40.0, 1e4}) {
        const Fading<double> f = fading(x);
        const double mean = x > 0 ? -std::expm1(-x) / x : 1;
        CHECK(f.left == Approx(std::exp(-std::min(x, 600.0))).epsilon(1e-14));
        CHECK(f.mean == Approx(mean).epsilon(1e-14));
        const double bend = x < 1e-4 ? 0.5 - x / 3 : (mean - std::exp(-x)) / x;
        CHECK(f.bend == Approx(bend).epsilon(1e-8));
    }
}

TEST_CASE("forces of a cell with a back stress are minus the gradient of its increment's energy") {
    Draw draw;
    const CellModuli linear = law_of(0.05, 0.3),
                     curved = law_of(0, 0, {{0, 0.05}, {0.03, 0.1}, {0.2, 0.12}});
    int flowed = 0, turned = 0, alone = 0;
    for (int n = 0; n < 60; ++n) {
        const CellModuli& law = n % 2 ? linear : curved;
        const double far = n < 30 ? 0.02 : 0.1;
        const Cell cell = worked_cell(draw, law, far, n % 10 == 9);
        const Corners x = draw.turn() * draw.shaken(far);
        const State s = state_of(law, cell, x);
        flowed += s.flowed.d_alpha > 0;
        alone += s.flowed.alone.d_alpha > 0;
        // How much the flow's way is another than that of the back stress.
        const double both = contract(s.flowed.distortion, cell.back.strain);
        turned += both * both < 0.8 * contract(s.flowed.distortion, s.flowed.distortion) *
                                    contract(cell.back.strain, cell.back.strain);
        const Corners f = force(law, cell, x);
        check_forces([&](const Corners& moved) { return energy(law, cell, moved); }, x, f);
        const Mat3 turn = draw.turn();
        CHECK((force(law, cell, turn * x) - turn * f).norm() < 1e-11 * f.norm());
    }
    CHECK(flowed > 40);
    CHECK(turned > 30);
    CHECK(alone > 2);
}

TEST_CASE("pulled and pressed again and again a cell bears what the law says, in any steps") {
    constexpr double kYield = 0.05, kRise = 0.3;
    const CellModuli law = law_of(kYield, kRise);
    const double firm = 3 * law.shear;
    for (int steps : {1, 7}) {
        Cell cell;
        // Along one line: plastic strain, gathered and as it is; the back stress.
        double gathered = 0, flowed = 0, shift = 0, from = 0;
        for (double to : {0.03, -0.02, -0.021, 0.06, 0.05}) {
            // Up to where it yields the stress goes with the strain.
            const int side = to > from ? 1 : -1;
            const auto radius = [&](double p) {
                return kYield + kRise * p - kBack * (1 - std::exp(-p / kOver));
            };
            const double onset = flowed + (shift + side * radius(gathered)) / firm;
            const bool yields = side * (onset - from) > 0 && side * (to - onset) > 0;
            if (yields) {
                CHECK(state_of(law, cell, drawn(onset - side * 1e-5)).flowed.d_alpha == 0);
                CHECK(state_of(law, cell, drawn(onset + side * 1e-5)).flowed.d_alpha > 0);
            }
            const double start = yields ? onset : from;
            for (int n = 1; n <= steps; ++n) {
                const double strain = start + (to - start) * n / steps;
                // The increment that leaves the stress on the surface, by halves.
                double low = 0, high = 1;
                const auto after = [&](double d) {
                    return side * kBack + (shift - side * kBack) * std::exp(-d / kOver);
                };
                while (high - low > 1e-15) {
                    const double d = 0.5 * (low + high);
                    const double stress = firm * (strain - flowed - side * d);
                    (side * (stress - after(d)) > radius(gathered + d) ? low : high) = d;
                }
                const Corners x = drawn(strain);
                CHECK(tension(law, cell, x) ==
                      Approx(firm * (strain - flowed - side * low)).margin(2e-6 * kYield));
                shift = after(low), flowed += side * low, gathered += low;
                commit(law, cell, x);
                CHECK(cell.history.alpha == Approx(gathered).margin(1e-7));
                CHECK(std::sqrt(6.0) * law.shear *
                          std::sqrt(contract(cell.back.strain, cell.back.strain)) ==
                      Approx(std::abs(shift)).margin(1e-5 * kBack));
            }
            from = to;
        }
    }
}

TEST_CASE("a pull that goes on bears the curve, whatever the back stress is") {
    const std::vector<FlowPoint> curve = {{0, 0.05}, {0.02, 0.08}, {0.1, 0.1}};
    CellModuli plain = law_of(0, 0, curve);
    const CellModuli law = plain;
    plain.back_stress = 0;
    Cell cell, other;
    for (double strain : {0.005, 0.02, 0.021, 0.09, 0.2}) {
        const Corners x = drawn(strain);
        CHECK(tension(law, cell, x) == Approx(tension(plain, other, x)).epsilon(1e-7));
        commit(law, cell, x);
        commit(plain, other, x);
    }
}

TEST_CASE("what hardens by its back stress alone goes round one loop, as high as theory says") {
    // sigma_0 + X_s (1 - exp(-p / p_s)) as the curve leaves sigma_0 for the other part.
    constexpr double kYield = 0.05, kFarthest = 0.04;
    const CellModuli law =
        law_of(0, 0, points_of(VoceForm{.s0 = kYield, .Q = kBack, .b = 1 / kOver}));
    Cell cell;
    double last = 0, work = 0;
    const auto go = [&](double to) {
        const double start = last;
        for (int n = 1; n <= 20; ++n) {
            last = start + (to - start) * n / 20;
            work += taken(law, cell, state_of(law, cell, drawn(last)).flowed) / kVolume;
            commit(law, cell, drawn(last));
        }
        return tension(law, cell, drawn(last));
    };
    go(kFarthest);
    for (int n = 0; n < 10; ++n) go(n % 2 ? kFarthest : -kFarthest);
    const double low = go(-kFarthest), gathered = cell.history.alpha;
    work = 0;
    const double high = go(kFarthest);
    const double range = cell.history.alpha - gathered;  // plastic, of half a loop
    CHECK(range == Approx(2 * (kFarthest - high / (3 * law.shear))).epsilon(1e-5));
    CHECK(high == Approx(kYield + kBack * std::tanh(range / (2 * kOver))).epsilon(2e-4));
    CHECK(low == Approx(-high).epsilon(2e-4));
    // What the half loop takes: the back stress stands at the end as it stood, of other sign.
    const double shift = kBack * std::tanh(range / (2 * kOver));
    CHECK(work == Approx(kYield * range + kBack * range - 2 * shift * kOver).epsilon(1e-3));
}

TEST_CASE("after the return a cell with a back stress stands where that says, wherever it goes") {
    Draw draw;
    const CellModuli law = law_of(0.05, 0.3);
    for (int n = 0; n < 40; ++n) {
        // Uniform: what bends across changes its stiffness with the shape.
        Cell cell;
        const auto gradient = [&](double by) {
            return Mat3(Mat3::Identity() + by * Mat3::NullaryExpr([&] { return draw(-1, 1); }));
        };
        for (int k = 0; k < 3; ++k) commit(law, cell, draw.turn() * gradient(0.05) * cube());
        const Corners x = draw.turn() * gradient(n < 20 ? 0.005 : 0.05) * cube();
        const State s = state_of(law, cell, x);
        const double d = s.flowed.d_alpha;
        if (!(d > 0)) continue;
        Cell after = cell;
        commit(law, after, x);
        const State now = state_of(law, after, x);
        const Symmetric<double> expected =
            s.flowed.kept * s.flowed.distortion + s.flowed.lent * cell.back.strain;
        const auto size = [](const Symmetric<double>& e) { return std::sqrt(contract(e, e)); };
        // But for a rotation that all of it shares.
        CHECK(size(deviator(now.strain.log)) == Approx(size(expected)).epsilon(1e-5));
        CHECK(contract(now.flowed.distortion, after.back.strain) ==
              Approx(contract(expected, s.flowed.gained * s.flowed.distortion +
                                            s.flowed.held * cell.back.strain))
                  .margin(1e-5 * size(expected) * size(after.back.strain)));
        // What is left beyond the surface is of second order.
        const double x_over = d * law.back_rate;
        CHECK(now.flowed.d_alpha < 0.05 * x_over * d + 1e-9);
        CHECK(std::sqrt(6.0) * law.shear * size(after.back.strain) < kBack);
        const Corners f = force(law, cell, x);
        CHECK((force(law, after, x) - f).norm() < (0.02 * x_over + 1e-3) * f.norm());
    }
}

TEST_CASE("where the flow turns, many steps come to one end, and few come near it") {
    // Drawn, then sheared: the direction turns all the way.
    const CellModuli law = law_of(0.05, 0.3);
    std::vector<double> bears;
    for (int steps : {2, 4, 8, 256}) {
        Cell cell;
        commit(law, cell, drawn(0.03));
        Corners x;
        for (int n = 1; n <= steps; ++n) {
            Mat3 shear = Mat3::Identity();
            shear(0, 1) = 0.06 * n / steps;
            x = shear * drawn(0.03);
            if (n < steps) commit(law, cell, x);
        }
        const Corners f = force(law, cell, x);
        bears.push_back(-f.row(0).dot(x.row(1)) / kVolume);
    }
    CHECK(std::abs(bears[0] - bears[3]) < 0.1 * bears[3]);
    CHECK(std::abs(bears[2] - bears[3]) < 0.35 * std::abs(bears[0] - bears[3]));
    CHECK(std::abs(bears[2] - bears[3]) < 0.02 * bears[3]);
}

TEST_CASE("what a back stress leaves to the growing part is least where it is told to be") {
    for (const auto& [hardening, curve] : {std::pair(0.0, false), std::pair(0.7, false),
                                           std::pair(5.0, false), std::pair(0.0, true)}) {
        const std::vector<FlowPoint> points = {{0, 0.05}, {0.01, 0.06}, {0.04, 0.065}, {1, 0.3}};
        const std::vector<FlowPoint> given = curve ? points : std::vector<FlowPoint>{};
        const FlowPoint least = least_isotropic(0.05, hardening, given, kBack, kOver);
        double lowest = 1;
        const FlowCurve lines = flow_curve(points, 1);
        for (int n = 0; n <= 200'000; ++n) {
            const double p = n * 1e-5;
            const double all = curve ? mean_flow_stress(lines, p, 0) : 0.05 + hardening * p;
            lowest = std::min(lowest, all - kBack * (1 - std::exp(-p / kOver)));
        }
        CHECK(least.stress == Approx(lowest).epsilon(1e-6));
    }
}

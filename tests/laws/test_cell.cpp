// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>

#include "laws/cell_growth.h"
#include "laws/cell_rest.h"
#include "tests/catch.h"
#include "tests/laws/shaken_cube.h"

using namespace swage;
using namespace swage::test;

namespace {

const CellModuli kLaw = cell_moduli(7.0, 0.3, kSpacing);
// As steep at first as the matter is stiff, then level, then rising again.
const std::vector<FlowPoint> kCurve = {{0, 0.02},   {0.005, 0.05}, {0.02, 0.05},
                                       {0.05, 0.1}, {0.2, 0.13},   {1, 0.2}};
double stress_on_curve(double alpha) {
    for (std::size_t n = 1; n < kCurve.size(); ++n) {
        const auto& [from, low] = kCurve[n - 1];
        const auto& [to, high] = kCurve[n];
        if (alpha < to) return low + (high - low) * (alpha - from) / (to - from);
    }
    return kCurve.back().stress;
}

struct Cell {
    double fill = 1;
    Triple<double> at{0, 0, 0};
    CellHistory<double> history{};
    bool rubber = false;
};

struct State {
    CornerSums<double> sums;
    Columns<double> gradient, elastic;  // F, F_e
    CellStrain<double> strain;
    CellModes<double> modes;
};
State state_of(const Cell& cell, const Corners& x) {
    State s;
    s.sums = sums_of(x);
    s.gradient = centroid_gradient(s.sums, cell.at, kLaw.spacing);
    s.elastic = s.gradient * taken_back(cell.history);
    s.strain = cell_strain(s.elastic);
    s.modes = pulled_back(s.elastic, s.sums);
    return s;
}
CellFlowed<double> flow_of(const CellModuli& law, const Cell& cell, const State& s) {
    return flow_cell(law, cell.history, s.strain.log, s.modes, cell.fill);
}

// Of the increment: elastic energy after the return, and what the flow takes.
double energy(const CellModuli& law, const Cell& cell, const Corners& x) {
    const State s = state_of(cell, x);
    const double fill3 = mode_fill(cell.fill);
    if (cell.rubber) {
        return kVolume * cell.fill * rubber_energy(law, s.gradient) +
               0.5 * fill3 * product(mode_stress(law, s.modes), s.modes);
    }
    const CellFlowed<double> r = flow_of(law, cell, s);
    const double size = cell_size(s.strain).log;
    const double w = r.kept * r.kept, of_modes = r.kept_modes * r.kept_modes;
    const double stored =
        kVolume * cell.fill *
            (law.shear * w * contract(r.distortion, r.distortion) + 0.5 * law.bulk * size * size) +
        0.5 * fill3 * of_modes * product(r.mode_stress, r.modes);
    const double flowed =
        r.d_alpha * mean_flow_stress(law, cell.history.alpha, r.d_alpha) + r.alone.took;
    return stored + kVolume * cell.fill * flowed;
}

Corners force(const CellModuli& law, const Cell& cell, const Corners& x) {
    const State s = state_of(cell, x);
    const double fill3 = mode_fill(cell.fill);
    const double scale = kVolume * cell.fill;
    if (cell.rubber) {
        const Columns<double> p = rubber_stress(law, s.gradient);
        return forces_of(sum_forces(s.sums, s.gradient, taken_back(CellHistory<double>{}),
                                    Columns<double>{scale * p.x, scale * p.y, scale * p.z},
                                    fill3 * mode_stress(law, s.modes), cell.at, law.spacing));
    }
    const CellFlowed<double> r = flow_of(law, cell, s);
    const Symmetric<double> a = taken_back(cell.history);
    return forces_of(sum_forces(s.sums, s.elastic, a,
                                s.elastic * (scale * cell_stress(law, s.strain, r.kept)) * a,
                                (fill3 * r.kept_modes) * r.mode_stress, cell.at, law.spacing));
}

// Drawn to exp(far) times its length at the most, with a volume of one.
Symmetric<double> random_stretch(Draw& draw, double far) {
    const double x = far * draw(-1, 1), y = far * draw(-1, 1) / 2;
    const Mat3 axes = draw.turn();
    const Mat3 a =
        axes * Vec3(std::exp(-x), std::exp(-y), std::exp(x + y)).asDiagonal() * axes.transpose() -
        Mat3::Identity();
    return {a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(1, 2), a(2, 0)};
}
Mat3 matrix_of(const Symmetric<double>& s) {
    Mat3 m;
    m << s.xx, s.xy, s.zx, s.xy, s.yy, s.yz, s.zx, s.yz, s.zz;
    return m;
}

Cell random_cell(Draw& draw) {
    Cell c;
    c.fill = draw(0.1, 1);
    c.at = {draw(-0.8, 0.8), draw(-0.8, 0.8), draw(-0.8, 0.8)};
    return c;
}

}  // namespace

TEST_CASE("forces of a cell are minus the gradient of its energy, flowing or not, rubber or not") {
    Draw draw;
    CellModuli yielding = kLaw, elastic = kLaw, curved = kLaw;
    yielding.yield_stress = 0.05;
    yielding.hardening = 0.3;
    curved.curve = flow_curve(kCurve, kLaw.shear);
    yielding.sliver_strength = curved.sliver_strength = 1.2;
    elastic.yield_stress = 1e100;
    int flowed = 0, alone = 0;
    for (int n = 0; n < 80; ++n) {
        Cell cell = random_cell(draw);
        cell.rubber = n % 3 == 2;
        if (n >= 60) cell.fill = draw(0.005, 0.06);
        const CellModuli& law = n % 3 != 1 ? elastic : n % 6 == 1 ? yielding : curved;
        if (n % 3 == 1) {
            cell.history.alpha = draw(0, 0.1);
            cell.history.stretch = random_stretch(draw, n % 2 ? 0.03 : 1.5);
            cell.history.modes.xy.x = 0.02 * kSpacing;
        }
        const Mat3 flowed_so_far = matrix_of(taken_back(cell.history)).inverse();
        Corners x = draw.turn() * flowed_so_far * draw.shaken(0.1);
        const State s = state_of(cell, x);
        flowed += n % 3 == 1 && flow_of(law, cell, s).d_alpha > 0;
        alone += n % 3 == 1 && flow_of(law, cell, s).alone.d_alpha > 0;
        check_forces([&](const Corners& moved) { return energy(law, cell, moved); }, x,
                     force(law, cell, x));
    }
    CHECK(flowed > 10);
    CHECK(alone > 3);
}

TEST_CASE("bending of a sliver flows at the yield stress by itself, whatever its mean does") {
    CellModuli law = kLaw;
    law.yield_stress = 0.05, law.hardening = 0, law.sliver_strength = 1.5;
    const auto stress_of_modes = [&](const Cell& cell, const State& s) {
        const CellModes<double> q = s.modes - cell.history.modes;
        const double twice = product(mode_stress(law, taken_back(cell.history), q), q);
        return std::sqrt(3 * law.shear * mode_share(cell.fill) * twice / kVolume);
    };
    for (double fill : {0.01, 0.05}) {
        Cell cell;
        cell.fill = fill;
        double before = 0;
        for (const auto& [drawn, bent] : {std::pair{0.0, 0.02}, {0.3, 0.02}, {0.3, 2.0}}) {
            Corners x =
                Vec3(std::exp(drawn), std::exp(-drawn / 2), std::exp(-drawn / 2)).asDiagonal() *
                cube();
            for (int c = 0; c < 8; ++c)
                x(0, c) += bent * kSpacing * ((c & 1) - 0.5) * ((c >> 1 & 1) - 0.5);
            const State s = state_of(cell, x);
            const CellFlowed<double> r = flow_of(law, cell, s);
            CHECK((r.alone.d_alpha > 0) == (bent > 1));
            CHECK((r.d_alpha > 1e-3) == (drawn > before));
            cell.history = flowed_on(cell.history, r, s.gradient, s.sums);
            before = drawn;
            const double stress = stress_of_modes(cell, state_of(cell, x));
            INFO(fill << " " << drawn << " " << bent);
            if (bent > 1) CHECK(stress == Approx(1.5 * law.yield_stress).epsilon(0.02));
            if (bent < 1) CHECK(stress > 0);
        }
    }
}

TEST_CASE("a turned cell is pushed as the cell is, turned") {
    Draw draw;
    CellModuli law = kLaw;
    law.yield_stress = 0.1;
    for (int n = 0; n < 20; ++n) {
        Cell cell = random_cell(draw);
        cell.rubber = n % 2;
        const Corners x = draw.shaken(0.1);
        const Mat3 turn = draw.turn();
        const Corners f = force(law, cell, x), turned = force(law, cell, turn * x);
        CHECK((turned - turn * f).norm() < 1e-12 * f.norm());
        CHECK(force(law, cell, turn * cube()).norm() < 1e-13 * kLaw.bulk * kSpacing * kSpacing);
    }
}

TEST_CASE(
    "a small uniform strain gives Hooke's stress for any Poisson's ratio, whatever the fill") {
    Draw draw;
    for (double ratio : {0.0, 0.25, 0.4, 0.49}) {
        CellModuli law = cell_moduli(7.0, ratio, kSpacing, 1e100);
        const Cell cell = random_cell(draw);
        Mat3 strain = Mat3::Zero();
        strain.diagonal() = Vec3(1e-6, -ratio * 1e-6, -ratio * 1e-6);  // uniaxial stress
        Corners x = cube();
        x = (Mat3::Identity() + strain) * x;
        CHECK(energy(law, cell, x) ==
              Approx(cell.fill * kVolume * 0.5 * 7.0 * 1e-12).epsilon(1e-5));
        // Virtual work of a sideways strain: no stress there.
        Corners wider = x;
        wider.row(1) *= 1 + 1e-6;
        CHECK((force(law, cell, x).array() * (wider - x).array()).sum() /
                  (cell.fill * kVolume * 7.0 * 1e-12) ==
              Approx(0).margin(1e-4));
    }
}

TEST_CASE("the logarithmic strain is the logarithm's, and its stress does the strain's work") {
    Draw draw;
    for (int n = 0; n < 20; ++n) {
        const Vec3 stretch(std::exp(draw(-.2, .2)), std::exp(draw(-.2, .2)),
                           std::exp(draw(-.2, .2)));
        const Mat3 axes = draw.turn();
        const Mat3 f = draw.turn() * axes * stretch.asDiagonal() * axes.transpose();
        const auto column = [&](int c) { return Triple<double>{f(0, c), f(1, c), f(2, c)}; };
        const Symmetric<double> e =
            cell_strain(Columns<double>{column(0), column(1), column(2)}).log;
        Mat3 got;
        got << e.xx, e.xy, e.zx, e.xy, e.yy, e.yz, e.zx, e.yz, e.zz;
        const Mat3 expected = axes * Vec3(stretch.array().log()).asDiagonal() * axes.transpose();
        CHECK((got - expected).norm() < 5e-6);
    }
}

TEST_CASE("a cell's volume is told by its volume alone, however far it is drawn") {
    Draw draw;
    for (int n = 0; n < 40; ++n) {
        const double j = std::exp(draw(-.2, .2)), x = std::exp(draw(-2, 2)),
                     y = std::exp(draw(-1, 1));
        const Mat3 f = draw.turn() * Vec3(x, y, j / (x * y)).asDiagonal() * draw.turn();
        const auto column = [&](int c) { return Triple<double>{f(0, c), f(1, c), f(2, c)}; };
        const CellStrain<double> e = cell_strain(Columns<double>{column(0), column(1), column(2)});
        CHECK(cell_size(e).log == Approx(std::log(j)).margin(5e-6));
        // 2 dJ/dC = J C^-1, where J is 1.
        const Symmetric<double> s = evaluate(e, cell_size(e).slope);
        Mat3 slope;
        slope << s.xx, s.xy, s.zx, s.xy, s.yy, s.yz, s.zx, s.yz, s.zz;
        CHECK((slope * (f.transpose() * f) - Mat3::Identity()).norm() < 2e-4);
    }
}

TEST_CASE("after the return the cell stands on its yield surface and pushes as it did") {
    Draw draw;
    CellModuli law = kLaw;
    law.yield_stress = 0.05;
    law.hardening = 0.4;
    for (int n = 0; n < 40; ++n) {
        Cell cell = random_cell(draw);
        cell.history.stretch = random_stretch(draw, n % 2 ? 0.1 : 1);
        const bool bends = n >= 20;
        const Mat3 drawn = Mat3::Identity() + 0.05 * Mat3::NullaryExpr([&] { return draw(-1, 1); });
        const Corners x = matrix_of(taken_back(cell.history)).inverse() *
                          (bends ? draw.shaken(0.07) : Corners(drawn * cube()));
        const State s = state_of(cell, x);
        const CellFlowed<double> r = flow_of(law, cell, s);
        REQUIRE(r.d_alpha > 0);
        Cell after = cell;
        after.history = flowed_on(cell.history, r, s.gradient, s.sums);
        CHECK(matrix_of(taken_back(after.history)).determinant() == Approx(1).epsilon(1e-12));
        const State now = state_of(after, x);
        const double kept = r.kept * std::sqrt(contract(r.distortion, r.distortion));
        const Symmetric<double> e = deviator(now.strain.log);
        CHECK(std::sqrt(contract(e, e)) == Approx(kept).epsilon(bends ? 2e-3 : 1e-5));
        CHECK(cell_size(now.strain).log == Approx(cell_size(s.strain).log).margin(1e-6));
        const CellFlowed<double> again = flow_of(law, after, now);
        // What bends across changes its stiffness with the shape.
        CHECK(again.d_alpha < (bends ? 0.02 : 1e-5) * r.d_alpha);
        const Corners before = force(law, cell, x);
        CHECK((force(law, after, x) - before).norm() < (bends ? 0.2 : 1e-4) * before.norm());
    }
}

TEST_CASE("however far it has flowed matter bears what its hardening says") {
    CellModuli law = kLaw;
    law.yield_stress = 0.01;
    for (const auto& [hardening, curve] :
         {std::pair(0.0, false), std::pair(0.02, false), std::pair(0.0, true)}) {
        law.hardening = hardening;
        law.curve = flow_curve(curve ? kCurve : std::vector<FlowPoint>{}, kLaw.shear);
        // Pressed to e^-3 of its height, and sheared by 6 heights.
        for (bool sheared : {false, true}) {
            Cell cell;
            const int steps = 400;
            for (int n = 1; n <= steps; ++n) {
                const double t = double(n) / steps;
                Mat3 f = Mat3::Identity();
                if (sheared) {
                    f(0, 1) = 6 * t;
                } else {
                    f.diagonal() = Vec3(std::exp(-3 * t), std::exp(1.5 * t), std::exp(1.5 * t));
                }
                const State s = state_of(cell, f * cube());
                const CellFlowed<double> r = flow_of(law, cell, s);
                const Mat3 elastic =
                    (Mat3() << s.elastic.x.x, s.elastic.y.x, s.elastic.z.x, s.elastic.x.y,
                     s.elastic.y.y, s.elastic.z.y, s.elastic.x.z, s.elastic.y.z, s.elastic.z.z)
                        .finished();
                const Mat3 stress =
                    elastic * matrix_of(cell_stress(law, s.strain, r.kept)) * elastic.transpose();
                const double alpha = cell.history.alpha + r.d_alpha;
                const double limit =
                    curve ? stress_on_curve(alpha) : law.yield_stress + hardening * alpha;
                const double bears =
                    sheared ? std::sqrt(3) * stress(0, 1) : stress(1, 1) - stress(0, 0);
                INFO(sheared << " " << n);
                if (t > 0.1) CHECK(bears == Approx(limit).epsilon(sheared ? 2e-3 : 1e-5));
                cell.history = flowed_on(cell.history, r, s.gradient, s.sums);
            }
            CHECK(cell.history.alpha == Approx(sheared ? 6 / std::sqrt(3) : 3).epsilon(2e-2));
        }
    }
}

TEST_CASE("one step over many points of a flow curve ends where many small ones do") {
    CellModuli law = kLaw;
    law.curve = flow_curve(kCurve, kLaw.shear);
    const auto drawn = [](double strain) {
        const double thin = std::exp(-0.5 * strain);
        return Corners(Vec3(std::exp(strain), thin, thin).asDiagonal() * cube());
    };
    Cell one, many;
    double work = 0;
    constexpr int kSteps = 1000;
    constexpr double kStrain = 0.08;
    const auto flow_on = [&](Cell& cell, double strain) {
        const State s = state_of(cell, drawn(strain));
        const CellFlowed<double> r = flow_of(law, cell, s);
        const double took = r.d_alpha * mean_flow_stress(law, cell.history.alpha, r.d_alpha);
        cell.history = flowed_on(cell.history, r, s.gradient, s.sums);
        return took;
    };
    for (int n = 1; n <= kSteps; ++n) work += flow_on(many, kStrain * n / kSteps);
    CHECK(flow_on(one, kStrain) == Approx(work).epsilon(1e-7));
    CHECK(one.history.alpha > kCurve[3].strain);
    CHECK(one.history.alpha == Approx(many.history.alpha).epsilon(1e-7));
    const Corners f = force(law, one, drawn(kStrain)), g = force(law, many, drawn(kStrain));
    CHECK((f - g).norm() < 1e-6 * f.norm());
}

TEST_CASE("what was drawn bends as the longer brick that it is") {
    // Of one volume: 2 x 1 x 1/2. The strain of a mode is its amplitude over the edge.
    const Symmetric<double> a = {0.5, 1, 2, 0, 0, 0};
    const auto energy_of = [&](const CellModes<double>& q) {
        return product(mode_stress(kLaw, a, q), q) / 2;
    };
    CellModes<double> q{};
    q.xy.x = 0.02;
    CHECK(energy_of(q) == Approx((kLaw.edge + kLaw.diagonal) / 2 * 0.01 * 0.01));
    q = {};
    q.zx.z = 0.02;
    CHECK(energy_of(q) == Approx((kLaw.edge + kLaw.diagonal) / 2 * 0.04 * 0.04));
    // Sheared along y by a slope of the thin way, and twisted about x.
    q = {};
    q.xy.z = 0.02;
    CHECK(energy_of(q) == Approx(kLaw.diagonal / 2 * (0.02 * 0.02 + 0.01 * 0.01)));
    // A turned brick is one.
    Draw draw;
    for (int n = 0; n < 10; ++n) {
        q = {{draw(-1, 1), draw(-1, 1), draw(-1, 1)},
             {draw(-1, 1), draw(-1, 1), draw(-1, 1)},
             {draw(-1, 1), draw(-1, 1), draw(-1, 1)},
             {draw(-1, 1), draw(-1, 1), draw(-1, 1)}};
        const Symmetric<double> turned = {a.zz, a.xx, a.yy, 0, 0, 0};  // x to y to z to x
        const auto next = [](const Triple<double>& v) { return Triple<double>{v.z, v.x, v.y}; };
        const CellModes<double> with = {next(q.zx), next(q.xy), next(q.yz), next(q.xyz)};
        CHECK(product(mode_stress(kLaw, turned, with), with) / 2 == Approx(energy_of(q)));
        const Symmetric<double> one = {1, 1, 1, 0, 0, 0};
        CHECK(product(mode_stress(kLaw, one, q), q) ==
              Approx(product(mode_stress(kLaw, q), q)).epsilon(1e-12));
    }
}

TEST_CASE("the numbers of a history come one by one in the order in which they are kept") {
    CellHistory<double> history;
    for_each_number(history, [](int n, double& number) { number = 1.0 + n; });
    CHECK(history.stretch.xx == 1);
    CHECK(history.stretch.zx == 6);
    CHECK(history.modes.xy.x == 7);
    CHECK(history.modes.xyz.z == 18);
    CHECK(history.alpha == 19);
    int count = 0;
    for_each_number(std::as_const(history), [&](int n, const double& number) {
        CHECK(n == count++);
        CHECK(number == count);
    });
    CHECK(count == 19);
}

TEST_CASE("laid out as its rest shape says a cell that has flowed carries nothing") {
    Draw draw;
    for (int n = 0; n < 60; ++n) {
        Cell cell = random_cell(draw);
        if (n % 2) cell.fill = 1, cell.at = {0, 0, 0};
        // Up to a stretch of 1.8, bent and twisted by a third of a spacing.
        const double far = n < 20 ? 0.01 : n < 40 ? 0.1 : 0.3;
        cell.history.stretch = random_stretch(draw, 2 * far);
        for (Triple<double>* q : {&cell.history.modes.xy, &cell.history.modes.yz,
                                  &cell.history.modes.zx, &cell.history.modes.xyz}) {
            *q = {far * draw(-1, 1), far * draw(-1, 1), far * draw(-1, 1)};
        }
        const CellRest<double> rest = cell_rest(cell.history, cell.at, kSpacing);
        const Mat3 stretch =
            Eigen::SelfAdjointEigenSolver<Mat3>(matrix_of(rest.metric)).operatorSqrt();
        Corners x;
        for (int q = 0; q < 8; ++q) {
            x.col(q) = stretch * Vec3(rest.corner[q].x, rest.corner[q].y, rest.corner[q].z);
        }
        for (int q = 1; q < 8; ++q) {
            CHECK((x.col(q) - x.col(0)).squaredNorm() ==
                  Approx(rest_square(rest, 0, q)).epsilon(1e-12));
        }
        // Against the force that as much strain would make.
        const double about = kLaw.shear * kSpacing * kSpacing * cell.fill;
        CHECK(force(kLaw, cell, draw.turn() * x).norm() < 1e-12 * about);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "base/math.h"
#include "laws/cell.h"
#include "laws/cell_rest.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.3;
const CellModuli kLaw = cell_moduli(7.0, 0.3, kSpacing);

using Corners = Eigen::Matrix<double, 3, 8>;

Corners cube() {
    Corners x;
    for (int c = 0; c < 8; ++c) x.col(c) = kSpacing * Vec3(c & 1, c >> 1 & 1, c >> 2);
    return x;
}

CornerSums<double> sums_of(const Corners& x) {
    CornerSums<double> c;
    double v[8];
    for (int q = 0; q < 8; ++q) v[q] = x(0, q);
    sum_corners(v, c.x.x, c.y.x, c.z.x, c.xy.x, c.yz.x, c.zx.x, c.xyz.x);
    for (int q = 0; q < 8; ++q) v[q] = x(1, q);
    sum_corners(v, c.x.y, c.y.y, c.z.y, c.xy.y, c.yz.y, c.zx.y, c.xyz.y);
    for (int q = 0; q < 8; ++q) v[q] = x(2, q);
    sum_corners(v, c.x.z, c.y.z, c.z.z, c.xy.z, c.yz.z, c.zx.z, c.xyz.z);
    return c;
}

Corners forces_of(const CornerSums<double>& r) {
    Corners f;
    double v[8];
    spread_corners(r.x.x, r.y.x, r.z.x, r.xy.x, r.yz.x, r.zx.x, r.xyz.x, v);
    for (int q = 0; q < 8; ++q) f(0, q) = v[q];
    spread_corners(r.x.y, r.y.y, r.z.y, r.xy.y, r.yz.y, r.zx.y, r.xyz.y, v);
    for (int q = 0; q < 8; ++q) f(1, q) = v[q];
    spread_corners(r.x.z, r.y.z, r.z.z, r.xy.z, r.yz.z, r.zx.z, r.xyz.z, v);
    for (int q = 0; q < 8; ++q) f(2, q) = v[q];
    return f;
}

struct Cell {
    double fill = 1;
    Triple<double> at{0, 0, 0};
    CellHistory<double> history{};
    bool rubber = false;
};

struct State {
    CornerSums<double> sums;
    Columns<double> gradient;
    CellModes<double> modes;
};
State state_of(const Cell& cell, const Corners& x) {
    State s;
    s.sums = sums_of(x);
    s.gradient = centroid_gradient(s.sums, cell.at, kLaw.spacing);
    s.modes = {transposed_times(s.gradient, s.sums.xy), transposed_times(s.gradient, s.sums.yz),
               transposed_times(s.gradient, s.sums.zx), transposed_times(s.gradient, s.sums.xyz)};
    return s;
}

const double kVolume = kSpacing * kSpacing * kSpacing;

// Of the increment: elastic energy after the return, and what the flow takes.
double energy(const CellModuli& law, const Cell& cell, const Corners& x) {
    const State s = state_of(cell, x);
    const double fill3 = cell.fill * cell.fill * cell.fill;
    if (cell.rubber) {
        return kVolume * cell.fill * rubber_energy(law, s.gradient) +
               0.5 * fill3 * product(mode_stress(law, s.modes), s.modes);
    }
    const CellStrain<double> strain = cell_strain(s.gradient);
    const CellFlowed<double> r = flow_cell(law, cell.history, strain.log, s.modes, cell.fill);
    const double size = cell_size(strain).log;
    const double w = r.kept * r.kept;
    const double stored =
        kVolume * cell.fill *
            (law.shear * w * contract(r.distortion, r.distortion) + 0.5 * law.bulk * size * size) +
        0.5 * fill3 * w * product(mode_stress(law, r.modes), r.modes);
    const double flowed =
        r.d_alpha * (law.yield_stress + law.hardening * (cell.history.alpha + 0.5 * r.d_alpha));
    return stored + kVolume * cell.fill * flowed;
}

Corners force(const CellModuli& law, const Cell& cell, const Corners& x) {
    const State s = state_of(cell, x);
    const double fill3 = cell.fill * cell.fill * cell.fill;
    const double scale = kVolume * cell.fill;
    if (cell.rubber) {
        const Columns<double> p = rubber_stress(law, s.gradient);
        return forces_of(sum_forces(s.sums, s.gradient,
                                    Columns<double>{scale * p.x, scale * p.y, scale * p.z},
                                    fill3 * mode_stress(law, s.modes), cell.at, law.spacing));
    }
    const CellStrain<double> strain = cell_strain(s.gradient);
    const CellFlowed<double> r = flow_cell(law, cell.history, strain.log, s.modes, cell.fill);
    const CellSize<double> size = cell_size(strain);
    const Symmetric<double> stress =
        material_stress(strain, (2 * law.shear * r.kept) * r.distortion) +
        evaluate(strain, law.bulk * size.log * size.slope);
    return forces_of(sum_forces(s.sums, s.gradient, s.gradient * (scale * stress),
                                (fill3 * r.kept) * mode_stress(law, r.modes), cell.at,
                                law.spacing));
}

class Draw {
  public:
    double operator()(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    Corners shaken(double by) {
        Corners x = cube();
        for (double& v : x.reshaped()) v += by * kSpacing * (*this)(-1, 1);
        return x;
    }
    Mat3 turn() {
        const Vec3 axis((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
        return Eigen::AngleAxisd((*this)(-3, 3), axis.normalized()).toRotationMatrix();
    }

  private:
    std::mt19937 engine_{7};
};

Cell random_cell(Draw& draw) {
    Cell c;
    c.fill = draw(0.1, 1);
    c.at = {draw(-0.8, 0.8), draw(-0.8, 0.8), draw(-0.8, 0.8)};
    return c;
}

}  // namespace

TEST_CASE("forces of a cell are minus the gradient of its energy, flowing or not, rubber or not") {
    Draw draw;
    CellModuli yielding = kLaw, elastic = kLaw;
    yielding.yield_stress = 0.05;
    yielding.hardening = 0.3;
    elastic.yield_stress = 1e100;
    int flowed = 0;
    for (int n = 0; n < 60; ++n) {
        Cell cell = random_cell(draw);
        cell.rubber = n % 3 == 2;
        const CellModuli& law = n % 3 == 1 ? yielding : elastic;
        if (n % 3 == 1) {
            cell.history.alpha = draw(0, 0.1);
            cell.history.strain = {0.01, -0.02, 0.01, draw(-.02, .02), draw(-.02, .02), 0.01};
            cell.history.modes.xy.x = 0.02 * kSpacing;
        }
        Corners x = draw.turn() * draw.shaken(0.1);
        const State s = state_of(cell, x);
        flowed +=
            n % 3 == 1 &&
            flow_cell(law, cell.history, cell_strain(s.gradient).log, s.modes, cell.fill).d_alpha >
                0;
        const Corners f = force(law, cell, x);
        Corners slope;
        const double h = 1e-4 * kSpacing;
        for (int i = 0; i < 24; ++i) {
            const auto at = [&](double by) {
                Corners moved = x;
                moved.reshaped()[i] += by;
                return energy(law, cell, moved);
            };
            slope.reshaped()[i] = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
        }
        CHECK((f + slope).norm() < 1e-8 * f.norm());
        // Neither does it push or turn itself.
        CHECK(f.rowwise().sum().norm() < 1e-13 * f.norm());
        Vec3 torque = Vec3::Zero();
        for (int c = 0; c < 8; ++c) torque += Vec3(x.col(c)).cross(Vec3(f.col(c)));
        CHECK(torque.norm() < 1e-12 * f.norm() * kSpacing);
    }
    CHECK(flowed > 10);
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

TEST_CASE("after the return the cell stands on its yield surface, its volume untouched") {
    Draw draw;
    CellModuli law = kLaw;
    law.yield_stress = 0.05;
    law.hardening = 0.4;
    for (int n = 0; n < 20; ++n) {
        Cell cell = random_cell(draw);
        const State s = state_of(cell, draw.shaken(0.15));
        const CellFlowed<double> r =
            flow_cell(law, cell.history, cell_strain(s.gradient).log, s.modes, cell.fill);
        REQUIRE(r.d_alpha > 0);
        CellHistory<double> after = cell.history;
        after.strain = after.strain + (1 - r.kept) * r.distortion;
        after.modes = (1 - r.kept) * r.modes;
        after.alpha += r.d_alpha;
        CHECK(trace(after.strain) == Approx(0).margin(1e-14));
        const CellFlowed<double> again =
            flow_cell(law, after, cell_strain(s.gradient).log, s.modes, cell.fill);
        CHECK(again.d_alpha < 1e-12);
        CHECK(again.kept == Approx(1));
    }
}

TEST_CASE("laid out as its rest shape says a cell that has flowed carries nothing") {
    Draw draw;
    for (int n = 0; n < 60; ++n) {
        Cell cell = random_cell(draw);
        if (n % 2) cell.fill = 1, cell.at = {0, 0, 0};
        // Up to a stretch of 1.5, bent and twisted by a third of a spacing.
        const double far = n < 20 ? 0.01 : n < 40 ? 0.1 : 0.3;
        const double xx = far * draw(-1, 1), yy = far * draw(-1, 1) / 2;
        cell.history.strain = {
            xx, yy, -xx - yy, far * draw(-1, 1) / 2, far * draw(-1, 1) / 2, far * draw(-1, 1) / 2};
        for (Triple<double>* q : {&cell.history.modes.xy, &cell.history.modes.yz,
                                  &cell.history.modes.zx, &cell.history.modes.xyz}) {
            *q = {far * draw(-1, 1), far * draw(-1, 1), far * draw(-1, 1)};
        }
        const auto laid_out = [&](const CellRest<double>& rest) {
            const Symmetric<double>& c = rest.metric;
            Mat3 metric;
            metric << c.xx, c.xy, c.zx, c.xy, c.yy, c.yz, c.zx, c.yz, c.zz;
            const Mat3 stretch = Eigen::SelfAdjointEigenSolver<Mat3>(metric).operatorSqrt();
            Corners x;
            for (int q = 0; q < 8; ++q) {
                x.col(q) = stretch * Vec3(rest.corner[q].x, rest.corner[q].y, rest.corner[q].z);
            }
            for (int q = 1; q < 8; ++q) {
                CHECK((x.col(q) - x.col(0)).squaredNorm() ==
                      Approx(rest_square(rest, 0, q)).epsilon(1e-12));
            }
            return Corners(draw.turn() * x);
        };
        // Against the force that as much strain would make.
        const double about = kLaw.shear * kSpacing * kSpacing * cell.fill;
        const CellHistory<double>& history = cell.history;
        const Corners exact = laid_out(cell_rest<3>(history, cell.at, kSpacing));
        CHECK(force(kLaw, cell, exact).norm() < 1e-9 * about);
        const Corners rough = laid_out(cell_rest<0>(history, cell.at, kSpacing));
        CHECK(force(kLaw, cell, rough).norm() < 3 * std::pow(far, 7) * about + 1e-12 * about);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include "laws/cell_growth.h"
#include "laws/laminate.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kSpacing = 0.1;

struct Cell {
    double at[3][8];
    CellModuli law[2];
    CellKind kind[2];
    double fill[2];
    Triple<double> place[2], normal;
    CellHistory<double> history[2]{};

    void phases(Phase<double> (&m)[2]) const {
        for (int p = 0; p < 2; ++p) {
            m[p] = {&law[p], kind[p], fill[p], place[p], history[p]};
        }
    }
    CornerSums<double> sums() const { return sum_corners(at); }
    Laminate<double> solved() const {
        Phase<double> m[2];
        phases(m);
        Laminate<double> r;
        laminate(sums(), m, normal, kSpacing, r);
        return r;
    }
    // What the increment from the history takes, elastic and plastic together.
    double energy() const {
        Phase<double> m[2];
        phases(m);
        const Laminate<double> r = solved();
        double share[2], sum = 0;
        jump_shares(m, share);
        const double volume = kSpacing * kSpacing * kSpacing;
        for (int p = 0; p < 2; ++p) {
            const PhaseState<double>& s = r.phase[p];
            const Columns<double> f = jumped(s.gradient, normal, share[p] * r.jump);
            const CellModes<double> q = s.modes - history[p].modes;
            const Symmetric<double> a = taken_back(history[p]);
            const double modes = 0.5 * mode_fill(fill[p]) * product(mode_stress(law[p], a, q), q);
            sum += volume * fill[p] * layer_guard(m[p], f, s.gradient).energy + modes;
            const CellStrain<double> e = cell_strain(f * a);
            sum += volume * fill[p] * mean_energy(kind[p], law[p], f, e);
            if (kind[p] != CellKind::yielding) continue;
            const CellFlowed<double> flowed =
                flow_cell(law[p], history[p], e.log, s.modes, fill[p]);
            sum -= volume * fill[p] *
                   (saved_by_flow(law[p], history[p].alpha, flowed) +
                    saved_by_flow(law[p], flowed.alone));
        }
        return sum;
    }
};

// From the yield stress, over points that small strains pass.
std::vector<FlowPoint> curve_from(double yields, double modulus) {
    std::vector<FlowPoint> point;
    for (double strain : {0.0, 2e-4, 1e-3, 3e-3, 0.01, 0.03}) {
        point.push_back({strain, yields + 0.02 * modulus * std::sqrt(1e-3 * strain)});
    }
    return point;
}

// Strained by about `strain`, with flow behind it; yielding at 1e-3.
Cell random_cell(std::mt19937& engine, double strain, double ratio, bool hardens) {
    std::uniform_real_distribution<double> draw(-1, 1);
    Cell cell;
    for (int p = 0; p < 2; ++p) {
        const double e = p == 0 ? 1.0 : ratio;
        const double yields = e * 1e-3 * (1.5 + draw(engine));
        cell.law[p] = cell_moduli(e, 0.3, kSpacing, yields, hardens ? 0.02 * e : 0);
        cell.kind[p] = p == 0 || draw(engine) > 0 ? CellKind::yielding : CellKind::elastic;
    }
    cell.fill[0] = 0.5 + 0.45 * draw(engine);
    cell.fill[1] = 1 - cell.fill[0];
    const Triple<double> n = {draw(engine), draw(engine), draw(engine)};
    cell.normal = (1 / std::sqrt(dot(n, n))) * n;
    for (int p = 0; p < 2; ++p) {
        cell.place[p] = ((p == 0 ? -1 : 1) * (1 - cell.fill[p])) * cell.normal;
    }
    double turn[3][3], angle = 3 * draw(engine);
    const Triple<double> axis = cell.normal;  // any
    const double w[3] = {axis.x, axis.y, axis.z}, c = std::cos(angle), s = std::sin(angle);
    const double skew[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            turn[i][j] = (i == j ? c : 0) + s * skew[i][j] + (1 - c) * w[i] * w[j];
        }
    }
    for (int corner = 0; corner < 8; ++corner) {
        double x[3];
        for (int i = 0; i < 3; ++i) {
            x[i] = kSpacing * ((corner >> i & 1) - 0.5 + 0.3 * strain * draw(engine));
        }
        x[0] *= 1 + strain;
        x[1] += strain * x[2];
        for (int i = 0; i < 3; ++i) {
            cell.at[i][corner] = turn[i][0] * x[0] + turn[i][1] * x[1] + turn[i][2] * x[2];
        }
    }
    return cell;
}

void flow(Cell& cell) {
    const Laminate<double> r = cell.solved();
    for (int p = 0; p < 2; ++p) {
        const CellFlowed<double>& s = r.phase[p].flowed;
        if (cell.kind[p] != CellKind::yielding || !(s.d_alpha > 0)) continue;
        cell.history[p] = flowed_on(cell.history[p], s, r.phase[p].gradient, cell.sums());
    }
}

double traction_left(const Cell& cell, const Laminate<double>& r) {
    const Triple<double> one = r.phase[0].stress * cell.normal,
                         other = r.phase[1].stress * cell.normal, left = one - other;
    return std::sqrt(dot(left, left) / (dot(one, one) + dot(other, other)));
}

}  // namespace

TEST_CASE("both sides of a boundary carry one traction, whatever flows") {
    std::mt19937 engine(5);
    int tried = 0, missed = 0, most = 0;
    long rounds = 0;
    for (bool hardens : {true, false}) {
        for (double ratio : {1.0, 10.0, 1000.0}) {
            for (double strain : {1e-4, 2e-3, 0.02, 0.05}) {
                if (strain > 0.02 && !hardens) continue;
                for (int n = 0; n < 60; ++n) {
                    Cell cell = random_cell(engine, strain, ratio, hardens);
                    for (int step = 0; step < 3; ++step) {
                        const Laminate<double> r = cell.solved();
                        ++tried;
                        rounds += r.rounds;
                        most = std::max(most, r.rounds);
                        missed += !(traction_left(cell, r) < 1e-6);
                        flow(cell);
                        for (auto& row : cell.at) {
                            for (double& x : row) {
                                x += 0.3 * strain * kSpacing *
                                     std::uniform_real_distribution<double>(-1, 1)(engine);
                            }
                        }
                    }
                }
            }
        }
    }
    INFO(tried << " tried, rounds in the mean " << double(rounds) / tried << ", at most " << most);
    CHECK(missed == 0);
    CHECK(double(rounds) / tried < 8);
}

TEST_CASE(
    "a cell of two materials pushes by the slope of its increment's energy, as flow sets in") {
    std::mt19937 engine(7);
    for (const auto& [hardens, curved] :
         {std::pair(true, false), std::pair(false, false), std::pair(true, true)}) {
        for (double strain : {1e-3, 5e-3, 0.03}) {
            for (int n = 0; n < 20; ++n) {
                Cell cell = random_cell(engine, strain, 30, hardens);
                for (CellModuli& law : cell.law) {
                    if (!curved) continue;
                    law.curve =
                        flow_curve(curve_from(law.yield_stress, 2.6 * law.shear), law.shear);
                }
                if (n % 5 == 4) cell.kind[1] = CellKind::rubber;
                if (n % 2) flow(cell);
                Phase<double> m[2];
                cell.phases(m);
                const Laminate<double> r = cell.solved();
                const CornerSums<double> f = laminate_forces(cell.sums(), m, r, kSpacing);
                double force[3][8], largest = 0;
                spread_corners(f, force);
                for (const auto& row : force) {
                    for (double v : row) largest = std::max(largest, std::abs(v));
                }
                const double h = 1e-5 * strain * kSpacing;
                for (int corner = 0; corner < 8; corner += 3) {
                    for (int i = 0; i < 3; ++i) {
                        Cell moved = cell;
                        moved.at[i][corner] += h;
                        const double up = moved.energy();
                        moved.at[i][corner] -= 2 * h;
                        const double slope = (up - moved.energy()) / (2 * h);
                        CHECK(std::abs(force[i][corner] + slope) < 1e-4 * largest);
                    }
                }
            }
        }
    }
}

TEST_CASE(
    "a soft layer of a cell bears ever more, however far it is crushed, and never turns over") {
    for (CellKind kind :
         {CellKind::elastic, CellKind::yielding, CellKind::rubber, CellKind::foam}) {
        for (double ratio : {2.0, 100.0, 1e4}) {
            for (double fill : {0.02, 0.16, 0.5}) {
                Cell cell{};
                cell.law[0] = cell_moduli(1, 0.3, kSpacing, 1e100);
                cell.law[1] = cell_moduli(ratio, 0.3, kSpacing, 1e100);
                cell.kind[0] = kind, cell.kind[1] = CellKind::elastic;
                cell.fill[0] = fill, cell.fill[1] = 1 - fill;
                cell.normal = {1, 0, 0};
                cell.place[0] = (fill - 1) * cell.normal, cell.place[1] = fill * cell.normal;
                double before = 0;
                for (double size = 1; size > 0.5; size -= 0.005) {
                    INFO(int(kind) << ", 1 : " << ratio << ", share " << fill << ", to " << size);
                    for (int corner = 0; corner < 8; ++corner) {
                        for (int i = 0; i < 3; ++i) {
                            cell.at[i][corner] = kSpacing * ((corner >> i & 1) - 0.5);
                        }
                        cell.at[0][corner] *= size;
                        cell.at[1][corner] += 0.2 * cell.at[0][corner];
                    }
                    const Laminate<double> r = cell.solved();
                    CHECK(traction_left(cell, r) < 1e-6);
                    const Columns<double>& f = r.phase[0].gradient;
                    const Triple<double> x = f.x + (1 - fill) * r.jump;
                    CHECK(dot(x, cross(f.y, f.z)) > (ratio > 1000 ? -0.4 : 0));
                    const double push = -r.phase[0].stress.x.x;
                    CHECK(push > before);
                    before = push;
                }
            }
        }
    }
}

TEST_CASE("crushed cells of two materials push by the slope of their energy, inside out too") {
    std::mt19937 engine(9);
    std::uniform_real_distribution<double> draw(0, 1);
    int crushed = 0, inverted = 0;
    for (int n = 0; n < 60; ++n) {
        Cell cell = random_cell(engine, 0.05, n % 2 ? 100 : 3, true);
        cell.kind[0] = n % 3 == 0 ? CellKind::rubber : CellKind::elastic;
        cell.kind[1] = CellKind::elastic;
        const double size = n % 10 == 9 ? -0.3 : 0.3 + 0.6 * draw(engine);
        for (int corner = 0; corner < 8; ++corner) cell.at[n % 3][corner] *= size;
        Phase<double> m[2];
        cell.phases(m);
        const Laminate<double> r = cell.solved();
        INFO("round " << n);
        REQUIRE(r.wrong < r.right);
        double share[2], volume[2];
        jump_shares(m, share);
        for (int p = 0; p < 2; ++p) {
            const Columns<double> f = jumped(r.phase[p].gradient, cell.normal, share[p] * r.jump);
            volume[p] = dot(f.x, cross(f.y, f.z));
        }
        crushed += std::min(volume[0], volume[1]) < 0.5, inverted += volume[0] < 0;
        const Columns<double> inverse = inverse_of(jump_slope(m, cell.normal, r));
        const auto force_of = [&](const Cell& at, double(&force)[3][8]) {
            spread_corners(laminate_forces(at.sums(), m, at.solved(), kSpacing), force);
        };
        double force[3][8], largest = 0;
        force_of(cell, force);
        for (const auto& row : force) {
            for (double v : row) largest = std::max(largest, std::abs(v));
        }
        const double h = 1e-6 * kSpacing;
        for (int corner = 0; corner < 8; corner += 3) {
            for (int i = 0; i < 3; ++i) {
                Cell to[2] = {cell, cell};
                double pushed[2][3][8], way[3][8]{}, slope[3][8], stiffest = 0, off = 0;
                for (int side : {0, 1}) {
                    to[side].at[i][corner] += side == 0 ? -h : h;
                    force_of(to[side], pushed[side]);
                }
                const double work = (to[1].energy() - to[0].energy()) / (2 * h);
                CHECK(std::abs(force[i][corner] + work) < 1e-4 * largest);
                way[i][corner] = 1;
                spread_corners(laminate_slope(cell.sums(), sum_corners(way), m, cell.normal,
                                              kSpacing, r.jump, inverse, 1),
                               slope);
                for (int k = 0; k < 24; ++k) {
                    const double found =
                        (pushed[1][k / 8][k % 8] - pushed[0][k / 8][k % 8]) / (2 * h);
                    stiffest = std::max(stiffest, std::abs(found));
                    off = std::max(off, std::abs(found - slope[k / 8][k % 8]));
                }
                CHECK(off < 1e-4 * stiffest);
            }
        }
    }
    CHECK(crushed > 20);
    CHECK(inverted > 3);
}

TEST_CASE("layers in series and side by side past yield are as their materials alone") {
    // Sheared by g, so that layers in series share the stress t and those beside it the strain:
    // t = mu g elastic, and beyond yield g = t / mu + (sqrt(3) t - sigma) sqrt(3) / H.
    const double fill = 0.3, g = 6e-3;
    const auto stress = [](const CellModuli& m, double strain) {
        const double elastic = m.shear * strain;
        if (std::sqrt(3.0) * elastic < m.yield_stress) return elastic;
        return (strain + std::sqrt(3.0) * m.yield_stress / m.hardening) /
               (1 / m.shear + 3 / m.hardening);
    };
    const auto strain = [](const CellModuli& m, double t) {
        return t / m.shear +
               std::max(0.0, std::sqrt(3.0) * t - m.yield_stress) * std::sqrt(3.0) / m.hardening;
    };
    for (bool series : {true, false}) {
        Cell cell{};
        cell.law[0] = cell_moduli(1, 0.3, kSpacing, 1e-3, 0.1);
        cell.law[1] = cell_moduli(10, 0.2, kSpacing, 1.5e-3, 0.2);
        cell.kind[0] = cell.kind[1] = CellKind::yielding;
        cell.fill[0] = fill, cell.fill[1] = 1 - fill;
        cell.normal = series ? Triple<double>{0, 1, 0} : Triple<double>{0, 0, 1};
        cell.place[0] = (fill - 1) * cell.normal, cell.place[1] = fill * cell.normal;
        for (int corner = 0; corner < 8; ++corner) {
            double x[3];
            for (int i = 0; i < 3; ++i) x[i] = kSpacing * ((corner >> i & 1) - 0.5);
            x[0] += g * x[1];
            for (int i = 0; i < 3; ++i) cell.at[i][corner] = x[i];
        }
        const Laminate<double> r = cell.solved();
        for (int p = 0; p < 2; ++p) {
            const double t = r.phase[p].stress.y.x;
            CAPTURE(series, p, t);
            if (!series) CHECK(t == Approx(stress(cell.law[p], g)).epsilon(1e-3));
        }
        if (!series) continue;
        const double t = r.phase[0].stress.y.x;
        CHECK(r.phase[1].stress.y.x == Approx(t).epsilon(1e-6));
        CHECK(fill * strain(cell.law[0], t) + (1 - fill) * strain(cell.law[1], t) ==
              Approx(g).epsilon(1e-3));
        CHECK(r.phase[0].flowed.d_alpha > 0);
        CHECK(r.phase[1].flowed.d_alpha > 0);
    }
}

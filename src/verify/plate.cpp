// SPDX-License-Identifier: GPL-3.0-or-later
// NAFEMS LE10: a quarter of a thick plate between two ellipses, under pressure. The rest of it is
// stood in for by smooth planes.
#include <cmath>
#include <limits>

#include "geometry/polygon.h"
#include "geometry/trimesh.h"
#include "mold/mold.h"
#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

constexpr double kThick = 0.6, kYoung = 210e9, kNu = 0.3, kPressure = 1e6;
const Vec3 kInner(2, 1, 0), kOuter(3.25, 2.75, 0);  // half axes [m]

// z from 0 to kThick; the mesh's sides are chords of the ellipses.
TriMesh quarter_plate() {
    constexpr int kSides = 96;
    TriMesh mesh;
    for (int n = 0; n <= kSides; ++n) {
        const double turn = 0.5 * kPi * n / kSides;
        const Vec3 way(n < kSides ? std::cos(turn) : 0, n > 0 ? std::sin(turn) : 0, 0);
        for (const double z : {0.0, kThick}) {
            for (const Vec3& axes : {kInner, kOuter}) {
                mesh.position.push_back(axes.cwiseProduct(way) + Vec3(0, 0, z));
            }
        }
    }
    const auto quad = [&](int a, int b, int c, int d) {
        for (const Corners& half : halves({a, b, c, d})) mesh.triangle.push_back(half);
    };
    // Of each section: inner below 0, outer below 1, inner above 2, outer above 3.
    for (int n = 0; n < kSides; ++n) {
        const int a = 4 * n, b = a + 4;
        quad(a, b, b + 1, a + 1);          // below
        quad(a + 2, a + 3, b + 3, b + 2);  // above
        quad(a, a + 2, b + 2, b);          // inner
        quad(a + 1, b + 1, b + 3, a + 3);  // outer
    }
    quad(0, 1, 3, 2);
    const int last = 4 * kSides;
    quad(last, last + 2, last + 3, last + 1);
    return mesh;
}

// What a quantity is at a place on the upper face: a plane fitted to it over points near by.
template <typename Quantity>
double at_place(const Aggregate& matter, const std::vector<int>& points, const Vec3& place,
                const Quantity& quantity) {
    const double reach = 4 * matter.lattice.spacing;
    Mat3 square = Mat3::Zero();
    Vec3 mixed = Vec3::Zero();
    for (int p : points) {
        const Vec3 way = matter.surface_reference(p) - place;
        if (way.norm() > reach) continue;
        const Vec3 terms(1, way.x(), way.y());
        square += matter.surface.area(p) * terms * terms.transpose();
        mixed += matter.surface.area(p) * quantity(p) * terms;
    }
    return square.ldlt().solve(mixed)[0];
}

void thick_plate(bool, Values& values) {
    constexpr double kTold = std::numeric_limits<double>::infinity();
    Material material;
    material.young_modulus = kYoung;
    material.poisson_ratio = kNu;
    for (const auto& [across, bound] : {std::pair(6, kTold), std::pair(12, 0.05)}) {
        MoldSettings settings;
        settings.spacing = kThick / across;
        Stand stand(mold(quarter_plate(), material, settings), 1e-4);
        const SurfacePoints& surface = stand.matter.surface;
        const auto points_on = [&](const auto& condition) {
            std::vector<int> points;
            for (std::size_t p = 0; p < surface.size(); ++p) {
                if (condition(stand.matter.surface_reference(p), surface.normal(p))) {
                    points.push_back(static_cast<int>(p));
                }
            }
            return points;
        };
        const auto is_outer = [](const Vec3& x, const Vec3& n) {
            return std::abs(n.z()) < 0.5 && n.x() * x.x() + n.y() * x.y() > 0.5;
        };
        stand.grip(
            points_on([](const Vec3& x, const Vec3& n) { return n.x() < -0.99 && x.x() < 1e-6; }),
            Vec3::UnitX());
        stand.grip(
            points_on([](const Vec3& x, const Vec3& n) { return n.y() < -0.99 && x.y() < 1e-6; }),
            Vec3::UnitY());
        stand.grip(points_on(is_outer), Vec3(1, 1, 0));
        stand.grip(points_on([&](const Vec3& x, const Vec3& n) {
                       return is_outer(x, n) &&
                              std::abs(x.z() - 0.5 * kThick) < 0.3 * *settings.spacing;
                   }),
                   Vec3::UnitZ());
        const std::vector<int> top =
            points_on([](const Vec3&, const Vec3& n) { return n.z() > 0.99; });
        stand.press(top, kPressure);
        stand.settle();

        const auto move = [&](int axis) {
            return [&, axis](int p) {
                return (stand.matter.surface_position(p) - stand.matter.surface_reference(p))[axis];
            };
        };
        const auto stress_yy = [&](int p) {
            const Mat3 f = stand.matter.surface_gradient(p);
            const Mat3 strain = 0.5 * (f + f.transpose()) - Mat3::Identity();
            return kYoung / (1 + kNu) * (strain(1, 1) + kNu / (1 - 2 * kNu) * strain.trace()) / 1e6;
        };
        const Vec3 a(0, kInner.y(), kThick), d(kInner.x(), 0, kThick);
        values.add(relative("u_z at A [m]", across, -2.005e-4,
                            at_place(stand.matter, top, a, move(2)), bound));
        values.add(
            told("u_y at A [m]", across, -4.176e-5, at_place(stand.matter, top, a, move(1))));
        values.add(
            told("u_z at D [m]", across, -1.007e-4, at_place(stand.matter, top, d, move(2))));
        values.add(
            told("u_x at D [m]", across, -2.750e-5, at_place(stand.matter, top, d, move(0))));
        values.add(
            told("sigma_yy at D [MPa]", across, -5.38, at_place(stand.matter, top, d, stress_yy)));
    }
}

}  // namespace

void add_plate_cases(std::vector<Case>& cases) {
    cases.push_back({"thick-plate", "a thick elliptic plate under pressure, a quarter of it",
                     "NAFEMS LE10; CalculiX C3D20R 8x12x4", 0, false, thick_plate});
}

}  // namespace swage

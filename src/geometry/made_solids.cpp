// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of regular rows of quads: bar, sheet, sphere, rod, tube.
// Source: the disc's rows are P. Shirley's and K. Chiu's concentric map, 1997.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/portable_math.h"
#include "geometry/made_shapes.h"
#include "geometry/polygon.h"

namespace swage {

namespace {

void add_quad(TriMesh& mesh, std::array<int, 4> q) {
    // The shorter diagonal; the same one for equal lengths, so that rows look alike.
    const auto gap = [&](int a, int b) {
        return (mesh.position[q[a]] - mesh.position[q[b]]).norm();
    };
    if (gap(1, 3) < (1 - 1e-9) * gap(0, 2)) q = {q[1], q[2], q[3], q[0]};
    const int polygon = mesh.triangle_polygon.empty() ? 0 : mesh.triangle_polygon.back() + 1;
    for (const Corners& half : halves(q)) mesh.triangle.push_back(half);
    mesh.triangle_polygon.insert(mesh.triangle_polygon.end(), 2, polygon);
}

std::vector<double> even_ticks(double low, double high, int count) {
    std::vector<double> ticks;
    for (int i = 0; i <= count; ++i) ticks.push_back(low + (high - low) * i / count);
    return ticks;
}

int divisions(double length, double edge) {
    return std::max(1, static_cast<int>(std::lround(length / edge)));
}

// A box with round edges: the flat part in even steps of about `edge`, each half of an edge's
// quarter circle in steps of equal angle.
TriMesh rounded_box(const Vec3& size, double rounding, double edge, double rounding_edge) {
    const Vec3 half = 0.5 * size;
    const Vec3 flat = (half.array() - rounding).max(0.0);
    const int steps = rounding > 0 ? divisions(rounding * kPi / 4, rounding_edge) : 0;
    std::array<std::vector<double>, 3> ticks;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double>& t = ticks[axis];
        t = {0};
        if (flat[axis] > 0)
            t = even_ticks(-flat[axis], flat[axis], divisions(2 * flat[axis], edge));
        for (int i = 1; i <= steps; ++i) {
            const double out = rounding * portable::tan(kPi / 4 * i / steps);
            t.insert(t.begin(), -flat[axis] - out);
            t.push_back(flat[axis] + out);
        }
    }
    return box_surface(ticks, [&](const Vec3& p) -> Vec3 {
        const Vec3 inner = p.cwiseMax(-flat).cwiseMin(flat);
        if (rounding == 0) return p;
        return inner + rounding * (p - inner).normalized();
    });
}

// Cylindrical coordinates: u along the length, v around or, on the ends, across.
void wrap_uv(TriMesh& mesh, double length, double radius, double inner_radius) {
    const double around = 2 * kPi * radius;
    const double scale = 1 / std::max(length, around);
    for (const Corners& t : mesh.triangle) {
        std::array<Vec3, 3> p = {mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]};
        const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
        const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
        const double angle = portable::atan2(middle.z(), middle.y());
        Corners uv;
        for (int k = 0; k < 3; ++k) {
            Vec2 at;
            if (std::abs(normal.x()) > 0.9) {
                at = Vec2(0.5 * length + (normal.x() > 0 ? 1 : -1) * p[k].y(), p[k].z());
            } else {
                // The corner's angle without a jump at the seam.
                const double off =
                    std::remainder(portable::atan2(p[k].z(), p[k].y()) - angle, 2 * kPi);
                const bool outer = middle.tail<2>().norm() > 0.5 * (radius + inner_radius);
                const double r = outer ? radius : inner_radius;
                at = Vec2(p[k].x() + 0.5 * length, (angle + off + kPi) * r);
            }
            uv[k] = static_cast<int>(mesh.uv.size());
            mesh.uv.push_back(scale * at);
        }
        mesh.triangle_uv.push_back(uv);
    }
}

}  // namespace

TriMesh box_surface(const std::array<std::vector<double>, 3>& ticks,
                    const std::function<Vec3(const Vec3&)>& map) {
    TriMesh mesh;
    const Vec3i last(static_cast<int>(ticks[0].size()) - 1, static_cast<int>(ticks[1].size()) - 1,
                     static_cast<int>(ticks[2].size()) - 1);
    std::map<std::array<int, 3>, int> id;
    const auto position = [&](const Vec3i& at) {
        const auto [entry, is_new] =
            id.try_emplace({at.x(), at.y(), at.z()}, static_cast<int>(mesh.position.size()));
        if (is_new)
            mesh.position.push_back(
                map(Vec3(ticks[0][at.x()], ticks[1][at.y()], ticks[2][at.z()])));
        return entry->second;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true}) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (int j = 0; j < last[v]; ++j)
                for (int i = 0; i < last[u]; ++i) {
                    const auto corner = [&](int di, int dj) {
                        Vec3i at;
                        at[axis] = high ? last[axis] : 0;
                        at[u] = i + di;
                        at[v] = j + dj;
                        return position(at);
                    };
                    const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1);
                    const int d = corner(0, 1);
                    if (high)
                        add_quad(mesh, {a, b, c, d});
                    else
                        add_quad(mesh, {a, d, c, b});
                }
        }
    return mesh;
}

TriMesh ring_surface(int around, int along, const std::function<Vec3(int, int)>& position) {
    TriMesh mesh;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < along; ++j) mesh.position.push_back(position(i, j));
    const auto id = [&](int i, int j) { return i % around * along + j % along; };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < along; ++j)
            add_quad(mesh, {id(i, j), id(i, j + 1), id(i + 1, j + 1), id(i + 1, j)});
    return mesh;
}

TriMesh make_bar(const ShapeValues& values) {
    const Vec3 size(values.at("length"), values.at("height"), values.at("width"));
    const double rounding = values.at("rounding");
    if (2 * rounding > size.minCoeff())
        fail(ExitCode::command_line,
             "bar: a rounding of {} m is more than half the thinnest side, {} m", rounding,
             0.5 * size.minCoeff());
    const double edge = size.x() / values.at("division");
    return rounded_box(size, rounding, edge, 0.4 * edge);
}

TriMesh make_sheet(const ShapeValues& values) {
    const Vec3 size(values.at("length"), values.at("thickness"), values.at("width"));
    return rounded_box(size, 0, size.x() / values.at("division"), 0);
}

TriMesh make_sphere(const ShapeValues& values) {
    const double diameter = values.at("diameter");
    const double edge = diameter / values.at("division");
    const auto ball = [&](double across) {
        return rounded_box(Vec3::Constant(across), 0.5 * across, edge, edge);
    };
    TriMesh mesh = ball(diameter);
    const double wall = values.at("wall");
    if (wall == 0) return mesh;
    if (wall >= 0.5 * diameter)
        fail(ExitCode::command_line, "sphere: a wall of {} m leaves no hollow in a radius of {} m",
             wall, 0.5 * diameter);
    const TriMesh hollow = ball(diameter - 2 * wall);
    const int first = static_cast<int>(mesh.position.size());
    mesh.position.insert(mesh.position.end(), hollow.position.begin(), hollow.position.end());
    for (const auto& [a, b, c] : hollow.triangle)
        mesh.triangle.push_back({first + a, first + c, first + b});
    return mesh;
}

TriMesh make_rod(const ShapeValues& values) {
    const double length = values.at("length"), radius = 0.5 * values.at("diameter");
    const double edge = length / values.at("division");
    const auto across = even_ticks(-1, 1, 2 * divisions(0.25 * kPi * radius, edge));
    TriMesh mesh = box_surface(
        {even_ticks(-0.5 * length, 0.5 * length, divisions(length, edge)), across, across},
        [&](const Vec3& p) -> Vec3 {
            const double y = p.y(), z = p.z();
            const double ring = std::max(std::abs(y), std::abs(z));
            if (ring == 0) return p;
            const double angle = std::abs(y) >= std::abs(z)
                                     ? (y > 0 ? 0 : kPi) + kPi / 4 * z / y
                                     : (z > 0 ? 0.5 : 1.5) * kPi - kPi / 4 * y / z;
            return {p.x(), radius * ring * portable::cos(angle),
                    radius * ring * portable::sin(angle)};
        });
    wrap_uv(mesh, length, radius, 0);
    return mesh;
}

TriMesh make_tube(const ShapeValues& values) {
    const double length = values.at("length"), radius = 0.5 * values.at("diameter");
    const double wall = values.at("wall");
    if (wall >= radius)
        fail(ExitCode::command_line, "tube: a wall of {} m leaves no bore in a radius of {} m",
             wall, radius);
    const double edge = length / values.at("division");
    const int along = divisions(length, edge), across = divisions(wall, edge);
    // Once around the wall's section: out along the length, in, back along the bore, out.
    std::vector<Vec2> section;
    const auto side = [&](Vec2 from, Vec2 to, int count) {
        for (int i = 0; i < count; ++i) section.push_back(from + (to - from) * i / count);
    };
    const double x = 0.5 * length, inner = radius - wall;
    side({-x, radius}, {x, radius}, along);
    side({x, radius}, {x, inner}, across);
    side({x, inner}, {-x, inner}, along);
    side({-x, inner}, {-x, radius}, across);
    const int around = 4 * std::max(3, divisions(0.5 * kPi * radius, edge));
    TriMesh mesh = ring_surface(around, static_cast<int>(section.size()), [&](int i, int j) {
        const double angle = 2 * kPi * i / around;
        const Vec2 at = section[j];
        return Vec3(at.x(), at.y() * portable::cos(angle), -at.y() * portable::sin(angle));
    });
    wrap_uv(mesh, length, radius, inner);
    return mesh;
}

}  // namespace swage

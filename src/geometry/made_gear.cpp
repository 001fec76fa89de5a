// SPDX-License-Identifier: GPL-3.0-or-later
// A spur gear with involute flanks (D. Dudley, "Handbook of practical gear design", 1994: pressure
// angle 20 degrees, addendum one module, dedendum 1.25), a hub, a thinner web and a rim.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/portable_math.h"
#include "geometry/made_shapes.h"
#include "geometry/remesh.h"

namespace swage {

namespace {

struct Teeth {
    int count;
    double tip_radius;
    double module() const { return 2 * tip_radius / (count + 2); }
    double pitch_radius() const { return tip_radius - module(); }
    double root_radius() const { return pitch_radius() - 1.25 * module(); }
};

double involute(double tangent) { return tangent - portable::atan(tangent); }

// Half the angle that a tooth fills at a radius. Below the base circle the flank would go straight
// in; it leans out instead, as a fillet does, to a share of the gap at the root.
double half_tooth_angle(const Teeth& teeth, double radius) {
    const double pressure = 20 * kPi / 180;
    const double base = teeth.pitch_radius() * portable::cos(pressure);
    const double at_pitch = kPi / (2 * teeth.count) + involute(portable::tan(pressure));
    const double ratio = std::max(1.0, radius / base);
    const double flank = at_pitch - involute(std::sqrt(ratio * ratio - 1));
    const double start = std::min(base, teeth.pitch_radius());
    if (radius >= start) return flank;
    const double depth = (start - radius) / (start - teeth.root_radius());
    const double gap = kPi / teeth.count - flank;
    return flank + 0.30 * gap * depth * depth + 0.05 * gap * depth;
}

// Points of one tooth, from the middle of a gap to just before the middle of the next.
std::vector<Vec2> tooth_outline(const Teeth& teeth, double edge) {
    const double root = teeth.root_radius(), tip = teeth.tip_radius;
    const auto steps = [&](double length) {
        return std::max(1, static_cast<int>(std::lround(length / edge)));
    };
    const double pitch_angle = 2 * kPi / teeth.count;
    const double root_half = 0.5 * pitch_angle - half_tooth_angle(teeth, root);
    const double tip_half = half_tooth_angle(teeth, tip);
    const int gap = steps(root_half * root), flank = std::max(3, steps(tip - root));
    const int land = steps(2 * tip_half * tip);
    std::vector<Vec2> polar;  // angle from the tooth's middle, radius
    for (int i = 0; i < gap; ++i)
        polar.emplace_back(-0.5 * pitch_angle + root_half * i / gap, root);
    for (int i = 0; i < flank; ++i) {
        const double r = root + (tip - root) * i / flank;
        polar.emplace_back(-half_tooth_angle(teeth, r), r);
    }
    for (int i = 0; i < land; ++i) polar.emplace_back(-tip_half + 2 * tip_half * i / land, tip);
    for (int i = flank; i > 0; --i) {
        const double r = root + (tip - root) * i / flank;
        polar.emplace_back(half_tooth_angle(teeth, r), r);
    }
    for (int i = 0; i < gap; ++i)
        polar.emplace_back(0.5 * pitch_angle - root_half * (1 - double(i) / gap), root);
    return polar;
}

// A closed row of points around the axis.
struct Row {
    std::vector<Vec2> polar;  // angle (ascending, less than a turn in all) and radius
    double height = 0;
    bool wall = false;  // the strip to the next row is curved
};

int count_around(double radius, double edge) {
    return 4 * std::max(3, static_cast<int>(std::lround(0.5 * kPi * radius / edge)));
}

Row circle(double start, double radius, double height, int count, bool wall) {
    Row row;
    for (int i = 0; i < count; ++i) row.polar.emplace_back(start + 2 * kPi * i / count, radius);
    row.height = height;
    row.wall = wall;
    return row;
}

// Strips of triangles from each row to the next and from the last to the first, going on along
// whichever row is behind.
TriMesh lace(const std::vector<Row>& rows, std::vector<bool>& keep) {
    TriMesh mesh;
    std::vector<int> first;
    for (const Row& row : rows) {
        first.push_back(static_cast<int>(mesh.position.size()));
        for (const Vec2& p : row.polar)
            mesh.position.emplace_back(p.y() * portable::sin(p.x()), row.height,
                                       p.y() * portable::cos(p.x()));
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const std::size_t s = (r + 1) % rows.size();
        const std::vector<Vec2>&a = rows[r].polar, &b = rows[s].polar;
        const auto angle = [](const std::vector<Vec2>& row, std::size_t i) {
            return row[i % row.size()].x() + (i < row.size() ? 0 : 2 * kPi);
        };
        const auto id = [&](std::size_t row, std::size_t i) {
            return first[row] + static_cast<int>(i % rows[row].polar.size());
        };
        std::size_t i = 0, j = 0;
        while (i < a.size() || j < b.size()) {
            const bool along_a =
                j == b.size() || (i < a.size() && angle(a, i + 1) <= angle(b, j + 1));
            mesh.triangle.push_back({id(r, i), id(s, j), along_a ? id(r, i + 1) : id(s, j + 1)});
            ++(along_a ? i : j);
            keep.push_back(rows[r].wall);
        }
    }
    return mesh;
}

}  // namespace

TriMesh make_gear(const ShapeValues& values) {
    const Teeth teeth{static_cast<int>(values.at("teeth")), 0.5 * values.at("diameter")};
    const double bore = 0.5 * values.at("bore"), half = 0.5 * values.at("width");
    const double edge = 2 * teeth.tip_radius / values.at("division");
    const double rim = teeth.root_radius() - 0.6 * teeth.module();
    const double hub = bore + 0.30 * (rim - bore), web_end = bore + 0.80 * (rim - bore);
    if (rim < 1.3 * bore)
        fail(ExitCode::command_line, "gear: a bore of {} m leaves no rim under {} teeth on {} m",
             2 * bore, teeth.count, 2 * teeth.tip_radius);
    if (half_tooth_angle(teeth, teeth.tip_radius) <= 0)
        fail(ExitCode::command_line, "gear: {} teeth would be pointed", teeth.count);

    const std::vector<Vec2> tooth = tooth_outline(teeth, edge);
    std::vector<Vec2> outline;  // angle, radius
    for (int i = 0; i < teeth.count; ++i)
        for (const Vec2& p : tooth) outline.emplace_back(p.x() + 2 * kPi * i / teeth.count, p.y());

    // Rows of points around the axis, once around the section: up the bore, out over the upper
    // side, down the teeth, in below. What lies flat is remeshed; walls and slopes stay.
    std::vector<Row> rows;
    const double start = outline.front().x();
    // The web is half as thick as the gear, unless its slopes would leave no room between them.
    const double step = std::min(0.25 * half, 0.3 * (web_end - hub)), web = half - 2 * step;
    const int high = std::max(1, static_cast<int>(std::lround(2 * half / edge)));
    const int bore_count = count_around(bore, edge), hub_count = count_around(hub, edge);
    const int web_count = count_around(web_end, edge);
    for (int i = 0; i <= high; ++i)
        rows.push_back(circle(start, bore, -half + 2 * half * i / high, bore_count, i < high));
    const auto upper_side = [&](double sign) {
        std::vector<Row> side = {circle(start, hub, sign * half, hub_count, true),
                                 circle(start, hub + step, sign * web, hub_count, false),
                                 circle(start, web_end - step, sign * web, web_count, true),
                                 circle(start, web_end, sign * half, web_count, false)};
        Row below;  // under each point of the outline, so that the first triangles do not fold
        below.height = sign * half;
        for (const Vec2& p : outline) below.polar.emplace_back(p.x(), rim);
        side.push_back(below);
        return side;
    };
    for (const Row& row : upper_side(1)) rows.push_back(row);
    for (int i = 0; i <= high; ++i) rows.push_back({outline, half - 2 * half * i / high, i < high});
    const std::vector<Row> lower = upper_side(-1);
    for (std::size_t i = lower.size(); i-- > 0;) {
        rows.push_back(lower[i]);
        rows.back().wall = i > 0 && lower[i - 1].wall;
    }

    RemeshSettings settings;
    TriMesh mesh = lace(rows, settings.keep);
    settings.edge_length = [&](const Vec3&) { return edge; };
    settings.project = [](const Vec3& p) { return p; };
    return remesh(mesh, settings);
}

}  // namespace swage

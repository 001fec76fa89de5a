// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/tool_clash.h"

#include <algorithm>

#include "base/units.h"
#include "geometry/shape.h"

namespace swage {

namespace {

constexpr int kLooks = 64;              // at a motion, at the most
constexpr double kEdgeStep = 0.005;     // share of the tool's size
constexpr std::size_t kPoints = 20000;  // of a tool, about

struct Body {
    const Shape* shape;
    Box box;
    std::vector<Vec3> point;  // of its surface
};

// Vertices of the drawn surface, and points along its edges: where two bodies meet, an edge of one
// goes into the other.
Body body_of(const Shape& shape) {
    Body body{&shape, bounds_of(shape), {}};
    const TriMesh mesh = surface_of(shape);
    body.point = mesh.position;
    const double step = kEdgeStep * body.box.size().norm();
    for (const Corners& corner : mesh.triangle) {
        for (int c = 0; c < 3; ++c) {
            const int a = corner[c], b = corner[(c + 1) % 3];
            if (a > b) continue;  // its neighbour has it too
            const Vec3 from = mesh.position[std::size_t(a)], to = mesh.position[std::size_t(b)];
            const int parts = static_cast<int>((to - from).norm() / step) + 1;
            for (int n = 1; n < parts; ++n) {
                body.point.push_back(from + double(n) / parts * (to - from));
            }
        }
    }
    const std::size_t every = body.point.size() / kPoints + 1;
    std::size_t kept = 0;
    for (std::size_t n = 0; n < body.point.size(); n += every) body.point[kept++] = body.point[n];
    body.point.resize(kept);
    return body;
}

// Of the points of one in the other [m]; 0: none is.
double depth_in(const Body& of, const Body& in, const Pose& in_from_of) {
    const Vec3 middle = in.box.center(), half = 0.5 * in.box.size();
    const Vec3 between = in_from_of * of.box.center() - middle;
    if (between.norm() > half.norm() + 0.5 * of.box.size().norm()) return 0;
    const Mat3 turn = in_from_of.rotation.toRotationMatrix();  // for many points
    double deepest = 0;
    for (const Vec3& point : of.point) {
        const Vec3 at = turn * point + in_from_of.translation;
        if (((at - middle).cwiseAbs().array() > half.array()).any()) continue;
        deepest = std::max(deepest, -distance_to(*in.shape, at).value);
    }
    return deepest;
}

struct Clash {
    double at_start = 0, most = 0;  // depth [m]
    double t = 0;                   // when it is most
};

Clash clash_of(const Body& a, const Body& b, const std::vector<Pose>& work_from_a,
               const std::vector<Pose>& work_from_b) {
    Clash clash;
    const std::size_t last = work_from_a.size() - 1;
    for (std::size_t n = 0; n <= last; n += std::max<std::size_t>(1, last / kLooks)) {
        const Pose a_from_b = work_from_a[n].inverse() * work_from_b[n];
        const double depth = std::max(depth_in(b, a, a_from_b), depth_in(a, b, a_from_b.inverse()));
        if (n == 0) clash.at_start = depth;
        if (depth > clash.most) clash.most = depth, clash.t = double(n) / double(last);
    }
    return clash;
}

}  // namespace

std::vector<std::string> tool_clashes(const Machine& machine,
                                      const std::vector<std::vector<Pose>>& way, double slack) {
    std::vector<std::string> notes;
    const std::vector<Tool>& tool = machine.apparatus.tool;
    std::vector<Body> body;
    std::vector<std::vector<Pose>> work_from_tool = way;
    for (std::size_t n = 0; n < tool.size() && tool.size() > 1; ++n) {
        body.push_back(body_of(tool[n].shape));
        for (Pose& pose : work_from_tool[n]) pose = pose * machine.work_from_tool[n];
    }
    for (std::size_t a = 0; a < body.size(); ++a) {
        for (std::size_t b = a + 1; b < body.size(); ++b) {
            if (way[a].empty() || way[b].empty()) continue;
            const std::vector<ToolSpec>& spec = machine.spec.tool;
            if (spec[a].motion.stands() && spec[b].motion.stands()) continue;
            const Clash clash = clash_of(body[a], body[b], work_from_tool[a], work_from_tool[b]);
            if (clash.most - clash.at_start <= slack) continue;
            notes.push_back(fmt::format(
                "tools {} and {} overlap by {} at t = {:.3g}{}: matter caught between them has no "
                "room, and their forces mean nothing",
                tool[a].name, tool[b].name, quantity_text(clash.most, Quantity::length), clash.t,
                clash.at_start > slack
                    ? fmt::format(", {} of it from the start",
                                  quantity_text(clash.at_start, Quantity::length))
                    : ""));
        }
    }
    return notes;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Tool shapes as triangles. Each face of a shape has smooth groups of its own, so that flat faces
// are shaded flat and round ones round.
#include <algorithm>
#include <map>

#include "base/portable_math.h"
#include "geometry/polygon.h"
#include "geometry/shape.h"

namespace swage {

namespace {

constexpr int kAroundCylinder = 128;
constexpr int kAroundRim = 4;        // steps of the rim's bevel
constexpr int kAroundRounding = 12;  // the same of a rim that is round
constexpr double kRimShare = 0.03;   // of the radius: a rim that catches light; contact has none
constexpr int kAroundEdge = 6;       // steps of a quarter turn around a box's edge, halved
constexpr int kAroundSphere = 24;    // the same for a sphere

// Welds positions, and gives a smooth group to each pair of position and face.
class Surface {
  public:
    int position(const Vec3& p) {
        const std::array<double, 3> key = {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
        const auto [found, is_new] = id_.try_emplace(key, static_cast<int>(mesh_.position.size()));
        if (is_new) mesh_.position.push_back(p);
        return found->second;
    }
    void triangle(int face, const Corners& corners) {
        if (has_repeated_corner(corners)) return;
        mesh_.triangle.push_back(corners);
        mesh_.triangle_smooth.emplace_back();
        for (int c = 0; c < 3; ++c) {
            const auto [found, is_new] =
                group_.try_emplace({face, corners[c]}, mesh_.smooth_group_count);
            mesh_.smooth_group_count += is_new;
            mesh_.triangle_smooth.back()[c] = found->second;
        }
    }
    void quad(int face, int a, int b, int c, int d) {
        for (const Corners& half : halves({a, b, c, d})) triangle(face, half);
    }
    TriMesh take() { return std::move(mesh_); }

  private:
    TriMesh mesh_;
    std::map<std::array<double, 3>, int> id_;
    std::map<std::pair<int, int>, int> group_;
};

TriMesh surface(const CylinderShape& cylinder) {
    const bool is_round = cylinder.rounding > 0, is_bored = cylinder.hole > 0;
    const double half_wall = 0.5 * (is_bored ? cylinder.radius - cylinder.hole : cylinder.radius);
    const double rim = is_round ? std::min({cylinder.rounding, is_bored ? half_wall : 2 * half_wall,
                                            0.5 * cylinder.length})
                                : kRimShare * std::min(2 * half_wall, 0.5 * cylinder.length);
    const int around_rim = is_round ? kAroundRounding : kAroundRim;
    // The outline: radius, height, face that ends here. From the low end's centre to the high
    // end's; of a bored one from the low end of the hole round to there again.
    struct Ring {
        double radius, height;
        int face;
    };
    std::vector<Ring> outline;
    // Outer rims by 1, those of the hole by -1.
    const auto add_rim = [&](double radius, double way, bool is_high, int face) {
        for (int n = 0; n <= around_rim; ++n) {
            const int step =
                is_high == (way > 0) ? n : around_rim - n;  // from side to end, or back
            const double angle = 0.5 * kPi * step / around_rim;
            const double height = 0.5 * cylinder.length - rim * (1 - portable::sin(angle));
            outline.push_back({radius - way * rim * (1 - portable::cos(angle)),
                               is_high ? height : -height, n == 0 ? face : face + 1});
        }
    };
    if (!is_bored) outline.push_back({0, -0.5 * cylinder.length, 0});
    add_rim(cylinder.radius, 1, false, 0);
    add_rim(cylinder.radius, 1, true, 2);
    if (is_bored) {
        add_rim(cylinder.hole, -1, true, 4);
        add_rim(cylinder.hole, -1, false, 6);
        outline.push_back(outline.front());
        outline.back().face = 8;
    } else {
        outline.push_back({0, 0.5 * cylinder.length, 4});
    }

    Surface surface;
    const auto point = [&](const Ring& ring, int n) {
        const double angle = 2 * kPi * (n % kAroundCylinder) / kAroundCylinder;
        return surface.position(
            {ring.radius * portable::cos(angle), ring.radius * portable::sin(angle), ring.height});
    };
    for (std::size_t r = 1; r < outline.size(); ++r) {
        for (int n = 0; n < kAroundCylinder; ++n) {
            surface.quad(outline[r].face, point(outline[r - 1], n), point(outline[r - 1], n + 1),
                         point(outline[r], n + 1), point(outline[r], n));
        }
    }
    return surface.take();
}

// Six sides of a cube, cut into squares of equal angle and blown up to a ball of radius `rounding`;
// the ball's eight parts are then moved apart to the corners of the core.
TriMesh rounded_box(const Vec3& core, double rounding, int steps) {
    Surface surface;
    // Along each of a side's two directions: -45 ... 0 degrees at the low end of the core, 0 ... 45
    // at its high end.
    struct Line {
        double slope;  // tan of the angle
        double end;    // -1 or 1
    };
    std::vector<Line> line;
    for (int n = -steps; n <= 0; ++n) line.push_back({portable::tan(0.25 * kPi * n / steps), -1});
    for (int n = 0; n <= steps; ++n) line.push_back({portable::tan(0.25 * kPi * n / steps), 1});
    line.front().slope = -1;  // to the bit, where sides meet
    line.back().slope = 1;

    const int kRound = 0;
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double way = side % 2 == 0 ? 1 : -1;
        const auto point = [&](std::size_t a, std::size_t b) {
            Vec3 direction, corner;
            direction[axis] = way;
            direction[u] = line[a].slope;
            direction[v] = line[b].slope;
            corner[axis] = way * 0.5 * core[axis];
            corner[u] = line[a].end * 0.5 * core[u];
            corner[v] = line[b].end * 0.5 * core[v];
            // Squares in one order whatever the side, for equal bits where sides meet.
            const double x = direction.x() * direction.x(), y = direction.y() * direction.y(),
                         z = direction.z() * direction.z();
            return surface.position(corner + direction * (rounding / std::sqrt(x + y + z)));
        };
        const std::size_t middle = static_cast<std::size_t>(steps);
        for (std::size_t a = 0; a + 1 < line.size(); ++a) {
            for (std::size_t b = 0; b + 1 < line.size(); ++b) {
                const bool flat = a == middle && b == middle;
                const int face = flat && core[u] > 0 && core[v] > 0 ? 1 + side : kRound;
                const int p = point(a, b), q = point(a + 1, b), r = point(a + 1, b + 1),
                          s = point(a, b + 1);
                if (way > 0) {
                    surface.quad(face, p, q, r, s);
                } else {
                    surface.quad(face, p, s, r, q);
                }
            }
        }
    }
    return surface.take();
}

TriMesh surface(const BoxShape& box) {
    const double rounding = std::clamp(box.rounding, 0.0, 0.5 * box.size.minCoeff());
    return rounded_box(box.size - Vec3::Constant(2 * rounding), rounding, kAroundEdge);
}
TriMesh surface(const SphereShape& sphere) {
    return rounded_box(Vec3::Zero(), sphere.radius, kAroundSphere);
}
TriMesh surface(const MeshShape& mesh) { return *mesh.mesh; }

}  // namespace

TriMesh surface_of(const Shape& shape) {
    return std::visit([](const auto& one) { return surface(one); }, shape);
}

}  // namespace swage

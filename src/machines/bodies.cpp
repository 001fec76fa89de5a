// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/bodies.h"

#include <algorithm>

#include "base/portable_math.h"
#include "geometry/shape.h"

namespace swage {

namespace {

constexpr int kNutSides = 6;
constexpr int kRodSides = 24;
constexpr double kSmooth = 0.87;  // the cosine of the turn from which an edge has a corner

void append(TriMesh& mesh, const TriMesh& part, const Pose& mesh_from_part) {
    const int positions = static_cast<int>(mesh.position.size());
    const int groups = mesh.smooth_group_count;
    for (const Vec3& p : part.position) mesh.position.push_back(mesh_from_part * p);
    for (const auto& [a, b, c] : part.triangle) {
        mesh.triangle.push_back({a + positions, b + positions, c + positions});
    }
    for (const auto& [a, b, c] : part.triangle_smooth) {
        mesh.triangle_smooth.push_back({a + groups, b + groups, c + groups});
    }
    mesh.smooth_group_count += part.smooth_group_count;
}

void append_flat(TriMesh& mesh, const std::vector<int>& polygon) {
    const int groups = mesh.smooth_group_count;
    const int corners = static_cast<int>(polygon.size());
    for (int c = 1; c + 1 < corners; ++c) {
        mesh.triangle.push_back({polygon[0], polygon[c], polygon[c + 1]});
        mesh.triangle_smooth.push_back({groups, groups + c, groups + c + 1});
    }
    mesh.smooth_group_count += corners;
}

// A bar along y, its middle at `centre`: a rod with many sides, a nut with six.
void append_prism(TriMesh& mesh, int sides, double radius, double length, const Vec3& centre) {
    const int first = static_cast<int>(mesh.position.size());
    std::vector<int> low, high;
    for (int n = 0; n < sides; ++n) {
        const double turn = 2 * kPi * n / sides;
        const Vec3 out = radius * Vec3(portable::cos(turn), 0, -portable::sin(turn));
        mesh.position.push_back(centre + out - Vec3(0, 0.5 * length, 0));
        mesh.position.push_back(centre + out + Vec3(0, 0.5 * length, 0));
        low.insert(low.begin(), first + 2 * n);
        high.push_back(first + 2 * n + 1);
    }
    append_flat(mesh, low);
    append_flat(mesh, high);
    const bool round = sides > kNutSides;
    const int groups = mesh.smooth_group_count;
    if (round) mesh.smooth_group_count += 2 * sides;
    for (int n = 0; n < sides; ++n) {
        const int a = 2 * n, b = 2 * ((n + 1) % sides);
        const std::vector<int> side = {first + a, first + b, first + b + 1, first + a + 1};
        if (!round) {
            append_flat(mesh, side);
            continue;
        }
        mesh.triangle.push_back({side[0], side[1], side[2]});
        mesh.triangle.push_back({side[0], side[2], side[3]});
        mesh.triangle_smooth.push_back({groups + a, groups + b, groups + b + 1});
        mesh.triangle_smooth.push_back({groups + a, groups + b + 1, groups + a + 1});
    }
}

Vec3 across(const Vec3& direction) {
    int axis = 0;
    direction.cwiseAbs().minCoeff(&axis);
    return direction.cross(Vec3::Unit(axis)).normalized();
}

}  // namespace

TriMesh clamp_around(const Box& held, double clearance) {
    const Vec3 size = held.size().cwiseMax(1e-3 * held.size().maxCoeff());
    const double plate =
        std::max(0.3 * std::sqrt(size.y() * size.z()), 0.05 * std::max(size.y(), size.z()));
    const double bolt = 0.28 * plate;  // its radius
    const double span = size.z() + 2 * clearance + 6 * bolt;
    const double rounding = 0.12 * std::min(plate, size.x());
    const TriMesh plate_mesh = surface_of(BoxShape{{size.x(), plate, span}, rounding});

    TriMesh clamp;
    const double off = 0.5 * size.y() + clearance + 0.5 * plate;
    for (const double side : {-1.0, 1.0}) {
        append(clamp, plate_mesh, {Quat::Identity(), held.center() + Vec3(0, side * off, 0)});
    }
    const double reach = 2 * off + plate;
    const bool two_abreast = size.x() > 10 * bolt;
    for (const double side : {-1.0, 1.0}) {
        for (const double place : two_abreast ? std::vector{-0.28, 0.28} : std::vector{0.0}) {
            const Vec3 foot =
                held.center() +
                Vec3(place * size.x(), 0, side * (0.5 * size.z() + clearance + 1.5 * bolt));
            append_prism(clamp, kRodSides, bolt, reach + 0.9 * plate, foot);
            for (const double end : {-1.0, 1.0}) {
                append_prism(clamp, kNutSides, 1.7 * bolt, 0.3 * plate,
                             foot + Vec3(0, end * (0.5 * reach + 0.15 * plate), 0));
            }
        }
    }
    return clamp;
}

TriMesh blade_behind(const std::vector<Vec3>& edge, const Vec3& back, double height,
                     double thickness) {
    const bool is_closed = edge.front() == edge.back();
    const int count = static_cast<int>(edge.size()) - is_closed;
    const Vec3 along = is_closed ? Vec3::Zero() : Vec3((edge.back() - edge.front()).normalized());
    Vec3 up = back - back.dot(along) * along;
    up = up.norm() > 1e-9 * back.norm() ? up.normalized() : across(along);
    const Vec3 side = up.cross(along);
    // Where the edge bends, the plate does.
    const auto at = [&](int n) -> const Vec3& {
        return edge[is_closed ? (n + count) % count : std::clamp(n, 0, count - 1)];
    };
    const auto side_at = [&](int n) -> Vec3 {
        const Vec3 own = up.cross(at(n + 1) - at(n - 1));
        return count > 2 && own.norm() > 0 ? own.normalized() : side;
    };

    // The plate's section, from the edge around, seen against `along`: (side, up).
    const double ground = std::min(4 * thickness, 0.4 * height);
    const std::vector<Vec2> section = {{0, 0},
                                       {0.5 * thickness, ground},
                                       {0.5 * thickness, height},
                                       {-0.5 * thickness, height},
                                       {-0.5 * thickness, ground}};
    const int corners = static_cast<int>(section.size());
    TriMesh body;
    for (int n = 0; n < count; ++n) {
        const Vec3 own = side_at(n);
        for (const Vec2& s : section) {
            body.position.push_back(edge[n] + s.x() * own + s.y() * up);
        }
    }
    // A corner of a face shares its normal with the one before it along the edge, where that does
    // not turn sharply: two groups a corner of each row, one a face of the section.
    const auto group_of = [&](int n, int c, bool is_next, bool is_far) {
        const Vec3 before = at(n) - at(n - 1), after = at(n + 1) - at(n);
        const bool is_sharp = before.dot(after) < kSmooth * before.norm() * after.norm();
        const int own = ((n % count) * corners + c) * 2 + is_next;
        return own + (is_sharp && is_far ? 2 * count * corners : 0);
    };
    body.smooth_group_count = 4 * count * corners;
    const int faces = is_closed ? count : count - 1;
    for (int n = 0; n < faces; ++n) {
        const int row = n * corners, beyond = (n + 1) % count * corners;
        for (int c = 0; c < corners; ++c) {
            const int next = (c + 1) % corners;
            body.triangle.push_back({row + c, row + next, beyond + next});
            body.triangle.push_back({row + c, beyond + next, beyond + c});
            const int a = group_of(n, c, false, false), b = group_of(n, c, true, false);
            const int d = group_of(n + 1, c, true, true), e = group_of(n + 1, c, false, true);
            body.triangle_smooth.push_back({a, b, d});
            body.triangle_smooth.push_back({a, d, e});
        }
    }
    if (is_closed) return body;
    const int last = (count - 1) * corners;
    append_flat(body, {0, 4, 3, 2, 1});
    append_flat(body, {last, last + 1, last + 2, last + 3, last + 4});

    Mat3 axes;
    axes << side, up, along;
    const double width = (edge.back() - edge.front()).norm();
    const Vec3 spine(5 * thickness, 0.14 * height, width + 2 * thickness);
    append(body, surface_of(BoxShape{spine, 0.8 * thickness}),
           {Quat(axes), 0.5 * (edge.front() + edge.back()) + height * up});
    return body;
}

}  // namespace swage

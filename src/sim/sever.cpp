// SPDX-License-Identifier: GPL-3.0-or-later
// A segment crosses a triangle when its ends lie on opposite sides of the triangle's plane and
// the three edges see it on one side. All side tests are half-open (zero counts as positive) and
// an edge shared by two triangles is tested in one order, so a segment through a shared edge or
// corner crosses exactly one of them. The blade is shifted by a millionth of a spacing along no
// special direction, because planes through lattice sites are the rule, not the exception: without
// either, cuts leave uncut threads.
#include "sim/sever.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/box.h"
#include "geometry/triangle_tree.h"
#include "matter/particle_site.h"
#include "sim/joined_shape.h"

namespace swage {

namespace {

using Triangle = std::array<Vec3, 3>;

double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
}

bool before(const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// On which side of the directed segment the edge p -> q passes; exactly opposite for q -> p.
bool edge_side(const Vec3& from, const Vec3& to, const Vec3& p, const Vec3& q) {
    return before(p, q) ? volume6(from, to, p, q) >= 0 : !(volume6(from, to, q, p) >= 0);
}

bool crosses_triangle(const Vec3& from, const Vec3& to, const Triangle& t) {
    const bool from_side = volume6(t[0], t[1], t[2], from) >= 0;
    const bool to_side = volume6(t[0], t[1], t[2], to) >= 0;
    if (from_side == to_side) return false;
    const bool s = edge_side(from, to, t[0], t[1]);
    return s == edge_side(from, to, t[1], t[2]) && s == edge_side(from, to, t[2], t[0]);
}

constexpr double kLargestTurn = 0.02;  // [rad] of the blade in one swept strip

}  // namespace

std::vector<Triangle> swept_triangles(const Blade& blade, const Pose& from, const Pose& to) {
    const double turn = turn_between(from, to).norm();
    const int strips = std::max(1, static_cast<int>(std::ceil(turn / kLargestTurn)));
    std::vector<Triangle> triangles;
    Pose low = from;
    for (int n = 1; n <= strips; ++n) {
        const Pose high = n == strips ? to : between(from, to, double(n) / strips);
        for (std::size_t e = 0; e + 1 < blade.edge.size(); ++e) {
            const Vec3 p0 = low * blade.edge[e], q0 = low * blade.edge[e + 1];
            const Vec3 p1 = high * blade.edge[e], q1 = high * blade.edge[e + 1];
            triangles.push_back({p0, p1, q1});
            triangles.push_back({p0, q1, q0});
        }
        low = high;
    }
    return triangles;
}

std::vector<Triangle> swept_triangles(const Apparatus& apparatus, std::span<const Drive> way) {
    std::vector<Triangle> all;
    for (std::size_t n = 0; n + 1 < way.size(); ++n) {
        for (std::size_t b = 0; b < apparatus.blade.size(); ++b) {
            const std::vector<Triangle> part = swept_triangles(
                apparatus.blade[b], way[n].world_from_blade[b], way[n + 1].world_from_blade[b]);
            all.insert(all.end(), part.begin(), part.end());
        }
    }
    return all;
}

TriMesh swept_mesh(const std::vector<Triangle>& swept) {
    TriMesh mesh;
    for (const Triangle& corner : swept) {
        if ((corner[1] - corner[0]).cross(corner[2] - corner[0]).isZero(0)) continue;
        const int first = static_cast<int>(mesh.position.size());
        mesh.position.insert(mesh.position.end(), corner.begin(), corner.end());
        mesh.triangle.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

namespace {

Vec3 shift_of(double spacing) { return spacing * Vec3(1.3e-6, 1.7e-6, 0.9e-6); }

class SweptSurface {
  public:
    SweptSurface(const std::vector<Triangle>& swept, double spacing) {
        const Vec3 shift = shift_of(spacing);
        for (Triangle t : swept) {
            Box box;
            for (Vec3& corner : t) box.grow(corner += shift);
            // A blade that rests sweeps nothing.
            if ((t[1] - t[0]).cross(t[2] - t[0]).norm() == 0) continue;
            triangle_.push_back(t);
            box_.push_back(box);
            all_.grow(box);
        }
    }

    bool is_empty() const { return triangle_.empty(); }
    // Null where none crosses.
    const Triangle* crossing(const Vec3& from, const Vec3& to) const {
        const Box own = {from.cwiseMin(to), from.cwiseMax(to)};
        if (!own.overlaps(all_)) return nullptr;
        for (std::size_t t = 0; t < triangle_.size(); ++t) {
            if (own.overlaps(box_[t]) && crosses_triangle(from, to, triangle_[t])) {
                return &triangle_[t];
            }
        }
        return nullptr;
    }
    bool crosses(const Vec3& from, const Vec3& to) const { return crossing(from, to) != nullptr; }

  private:
    std::vector<Triangle> triangle_;
    std::vector<Box> box_;
    Box all_;
};

}  // namespace

bool crosses(const std::vector<Triangle>& swept, const Vec3& from, const Vec3& to, double spacing) {
    return SweptSurface(swept, spacing).crosses(from, to);
}

namespace {

// Mean deformation of a whole cell that the connection lies in; where there is none, as what is
// still joined there tells.
Mat3 deformation_at(const Aggregate& matter, const SeverEvent& event) {
    const Vec3i a = lattice_site(matter, event.lower), b = lattice_site(matter, event.upper);
    for (int back = 0; back < 8; ++back) {
        const Vec3i step = corner_step(back);
        if ((step.array() * (a - b).array() != 0).any()) continue;
        const CellId cell = matter.lattice.cell_at(a.cwiseMin(b) - step);
        if (cell < 0 || !cell_is_whole(matter, matter.lattice.cell_row(cell))) continue;
        Mat3 sum = Mat3::Zero();
        const auto corners = matter.lattice.cell_corners(cell);
        for (int c = 0; c < 8; ++c) {
            const Vec3 from_middle = corner_step(c).cast<double>() - Vec3::Constant(0.5);
            sum += matter.particle_position.at(corners[c]) * from_middle.transpose();
        }
        return sum / (2 * matter.lattice.spacing);
    }
    return joined_deformation(matter, event.lower, event.upper);
}

// By the blade where it is, not as it is shifted.
void note_crossing(const Aggregate& matter, const Triangle& shifted, const Vec3& from,
                   const Vec3& to, SeverEvent& event) {
    Triangle t = shifted;
    for (Vec3& corner : t) corner -= shift_of(matter.lattice.spacing);
    const double before = volume6(t[0], t[1], t[2], from), after = volume6(t[0], t[1], t[2], to);
    event.share = static_cast<float>(std::clamp(before / (before - after), 0.0, 1.0));
    const Vec3 path = (t[1] - t[0]).cross(t[2] - t[0]);
    const Vec3 normal = (deformation_at(matter, event).transpose() * path).normalized();
    for (int d = 0; d < 3; ++d) event.normal[std::size_t(d)] = static_cast<float>(normal[d]);
}

}  // namespace

std::vector<SeverEvent> crossed_connections(const Aggregate& matter,
                                            const std::vector<Triangle>& swept) {
    const SweptSurface surface(swept, matter.lattice.spacing);
    std::vector<SeverEvent> events;
    if (surface.is_empty()) return events;
    for (const Span& span : matter.lattice.span) {
        const SparseArray<float>& weight = matter.connection[span.direction].weight;
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n;
            if (weight[lower] <= 0) continue;
            const Vec3 from = matter.particle_position.at(lower);
            const Vec3 to = matter.particle_position.at(span.upper + n);
            const Triangle* blade = surface.crossing(from, to);
            if (blade == nullptr) continue;
            events.push_back({span.direction, lower, span.upper + n, weight[lower]});
            note_crossing(matter, *blade, from, to, events.back());
        }
    }
    return events;
}

void name_blades(std::span<SeverEvent> events, const Aggregate& matter, const Apparatus& apparatus,
                 std::span<const Drive> way) {
    std::vector<char> is_named(events.size(), 0);
    for (std::size_t b = 0; b < apparatus.blade.size() && apparatus.blade.size() > 1; ++b) {
        std::vector<Triangle> swept;
        for (std::size_t n = 0; n + 1 < way.size(); ++n) {
            const std::vector<Triangle> part = swept_triangles(
                apparatus.blade[b], way[n].world_from_blade[b], way[n + 1].world_from_blade[b]);
            swept.insert(swept.end(), part.begin(), part.end());
        }
        const SweptSurface surface(swept, matter.lattice.spacing);
        for (std::size_t e = 0; e < events.size(); ++e) {
            if (is_named[e] || !surface.crosses(matter.particle_position.at(events[e].lower),
                                                matter.particle_position.at(events[e].upper))) {
                continue;
            }
            is_named[e] = 1;
            events[e].blade = static_cast<int>(b);
        }
    }
}

void mark_met(std::deque<std::vector<SeverEvent>>& plan, const Aggregate& matter,
              const std::vector<Triangle>& swept, double reach) {
    const TriMesh mesh = swept_mesh(swept);
    if (mesh.triangle.empty()) return;
    const Box near = box_of(mesh.position).widened(reach);
    const TriangleTree tree(mesh);
    for (std::vector<SeverEvent>& events : plan) {
        for (SeverEvent& e : events) {
            if (e.met) continue;
            const Vec3 middle =
                0.5 * (matter.particle_position.at(e.lower) + matter.particle_position.at(e.upper));
            e.met = near.contains(middle) && tree.distance(middle) <= reach;
        }
    }
}

void sever(Aggregate& matter, std::span<const SeverEvent> events) {
    for (const SeverEvent& e : events) {
        matter.connection[e.direction].weight.set(e.lower, 0);
        if (e.normal == SeverEvent().normal) continue;
        const Vec3i a = lattice_site(matter, e.lower), b = lattice_site(matter, e.upper);
        const Vec3 normal(e.normal[0], e.normal[1], e.normal[2]);
        matter.cut.push_back(cut_point(a, b, e.share, normal));
    }
}

std::vector<PointSide> sides_of(const Aggregate& matter, std::span<const SeverEvent> events,
                                const std::vector<Triangle>& swept) {
    std::vector<PointSide> sides;
    if (events.empty()) return sides;
    const SweptSurface surface(swept, matter.lattice.spacing);
    std::vector<char> is_end(matter.particle_count(), 0);
    for (const SeverEvent& e : events)
        is_end[std::size_t(e.lower)] = is_end[std::size_t(e.upper)] = 1;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        if (matter.surface.is_loose(p)) continue;
        const std::array<ParticleId, 8> corner = matter.surface.corner(p);
        if (std::ranges::none_of(corner, [&](ParticleId c) { return is_end[std::size_t(c)]; }))
            continue;
        const Vec3 at = position_on_side(matter, p);
        int corners = matter.surface.side(p);
        for (int c = 0; c < 8; ++c) {
            if (surface.crosses(at, matter.particle_position.at(corner[c]))) corners &= ~(1 << c);
        }
        sides.push_back({static_cast<int>(p), corners});
    }
    return sides;
}

}  // namespace swage

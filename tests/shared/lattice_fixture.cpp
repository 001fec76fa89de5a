// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/shared/lattice_fixture.h"

#include "matter/particle_site.h"
#include "matter/point_side.h"

namespace swage::test {

Vec3 gradient_of(const Distance& distance, const Vec3& at, double reach) {
    Vec3 g;
    for (int d = 0; d < 3; ++d) {
        g[d] = distance(at + reach * Vec3::Unit(d)) - distance(at - reach * Vec3::Unit(d));
    }
    return g.normalized();
}

Aggregate make_shape(const Distance& distance, const Vec3& low, const Vec3i& count, double a) {
    constexpr int kSamples = 8;
    std::vector<Vec3i> cells;
    std::vector<float> fill;
    for (int k = 0; k < count.z(); ++k) {
        for (int j = 0; j < count.y(); ++j) {
            for (int i = 0; i < count.x(); ++i) {
                const Vec3 corner = low + a * Vec3(i, j, k);
                const double middle = distance(corner + Vec3::Constant(a / 2));
                int inside = 0;
                for (int s = 0; s < kSamples * kSamples * kSamples; ++s) {
                    const Vec3 at(s % kSamples, s / kSamples % kSamples, s / kSamples / kSamples);
                    if (std::abs(middle) > a) {
                        inside += middle < 0;
                    } else {
                        inside += distance(corner + a / kSamples * (at + Vec3::Constant(.5))) < 0;
                    }
                }
                if (inside == 0) continue;
                cells.emplace_back(i, j, k);
                fill.push_back(static_cast<float>(inside) / (kSamples * kSamples * kSamples));
            }
        }
    }
    Aggregate m = make_matter(low, a, count, cells, fill);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (int s = 0; s < 8; ++s) {
            const Vec3 half(s & 1, s >> 1 & 1, s >> 2);
            const Vec3 corner = low + a * (cells[c].cast<double>() + 0.5 * half);
            Vec3 at = corner + Vec3::Constant(a / 4), normal;
            const double depth = distance(at);
            if (std::abs(depth) > a / 2) continue;
            for (int n = 0; n < 4; ++n) {
                normal = gradient_of(distance, at, 1e-5 * a);
                at -= distance(at) * normal;
            }
            // A surface on the bins' common face belongs to the one inside.
            const double slack = depth < 0 ? 1e-6 : -1e-6;
            const Vec3 xi = (at - corner) / (a / 2);
            if ((xi.array() < -slack).any() || (xi.array() > 1 + slack).any()) continue;
            const Vec3 local = (at - low) / a - cells[c].cast<double>();
            m.surface.add(m.lattice.cell_row(static_cast<CellId>(c)), local, a * a / 4, normal);
        }
    }
    return m;
}

void sever_plane(Aggregate& m, const Vec3& point, const Vec3& normal,
                 const std::function<bool(const Vec3&)>& where) {
    const Vec3 on_plane = point + m.lattice.spacing * Vec3(1.3e-6, 1.7e-6, 0.9e-6);
    std::vector<PointSide> sides;
    for (std::size_t p = 0; p < m.surface.size() && !where; ++p) {
        const bool above = normal.dot(position_on_side(m, p) - on_plane) >= 0;
        int corners = m.surface.side(p);
        for (int c = 0; c < 8; ++c) {
            const Vec3 x = m.particle_position.at(m.surface.corner(p)[c]);
            if ((normal.dot(x - on_plane) >= 0) != above) corners &= ~(1 << c);
        }
        sides.push_back({int(p), corners});
    }
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const Vec3 a = m.particle_position.at(span.lower + n);
            const Vec3 b = m.particle_position.at(span.upper + n);
            const bool crosses = (normal.dot(a - on_plane) >= 0) != (normal.dot(b - on_plane) >= 0);
            if (!crosses || (where && !where(0.5 * (a + b)))) continue;
            m.connection[span.direction].weight.set(span.lower + n, 0);
            const double share = std::clamp(normal.dot(point - a) / normal.dot(b - a), 0.0, 1.0);
            m.cut.push_back(cut_point(lattice_site(m, span.lower + n),
                                      lattice_site(m, span.upper + n), float(share), normal));
        }
    }
    keep_sides(m, sides);
}

void sever_along(Aggregate& m, const Distance& distance) {
    const double a = m.lattice.spacing;
    const Vec3 shift = a * Vec3(1.3e-6, 1.7e-6, 0.9e-6);
    const auto is_above = [&](const Vec3& x) { return distance(x - shift) >= 0; };
    std::vector<PointSide> sides;
    for (std::size_t p = 0; p < m.surface.size(); ++p) {
        const bool above = is_above(m.surface.reference(p, m.particle_reference));
        int corners = m.surface.side(p);
        for (int c = 0; c < 8; ++c) {
            const Vec3 x = m.particle_reference.at(m.surface.corner(p)[c]);
            if (is_above(x) != above) corners &= ~(1 << c);
        }
        sides.push_back({int(p), corners});
    }
    const auto in_floats = [](const Vec3& v) {
        return std::array<float, 3>{float(v.x()), float(v.y()), float(v.z())};
    };
    for (const Span& span : m.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            Vec3 low = m.particle_reference.at(span.lower + n),
                 high = m.particle_reference.at(span.upper + n);
            const bool above = is_above(low);
            if (above == is_above(high)) continue;
            m.connection[span.direction].weight.set(span.lower + n, 0);
            for (int halved = 0; halved < 40; ++halved) {
                const Vec3 middle = 0.5 * (low + high);
                (is_above(middle) == above ? low : high) = middle;
            }
            m.cut.push_back({in_floats((low - shift - m.lattice.origin) / a),
                             in_floats(gradient_of(distance, low - shift, 1e-4 * a))});
        }
    }
    keep_sides(m, sides);
}

void deform(Aggregate& m, const std::function<Vec3(const Vec3&)>& map) {
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        m.particle_position.set(p, map(m.particle_reference.at(p)));
    }
}

}  // namespace swage::test

// SPDX-License-Identifier: GPL-3.0-or-later
// Points of a body's true surface, each carried by a cell: x = sum N_c x_c, N_c being the trilinear
// weights of its place in the cell. What touches and is gripped is these, never particles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "matter/lattice.h"

namespace swage {

// A cell filled less than this does not carry surface where a fuller one lies within reach: pressed
// hard, the far corners of a sliver, which hardly anything holds, are driven through the body, all
// the more when the material yields.
inline constexpr float kFirmFill = 0.4f;

// Trilinear weights of a place in a cell, by corner.
[[gnu::always_inline]] inline std::array<double, 8> trilinear_weights(const Vec3& p) {
    const double qx = 1 - p.x(), qy = 1 - p.y(), qz = 1 - p.z();
    const double ll = qy * qz, hl = p.y() * qz, lh = qy * p.z(), hh = p.y() * p.z();
    return {qx * ll, p.x() * ll, qx * hl, p.x() * hl, qx * lh, p.x() * lh, qx * hh, p.x() * hh};
}

class SurfacePoints {
  public:
    // The particles that carry a point and their weights, which sum to one.
    struct Carriers {
        std::array<ParticleId, 8> corner;
        std::array<double, 8> weight;
    };

    std::size_t size() const { return row_.size(); }
    void resize(std::size_t count);
    // A point of the cell with these low row ends (CellRun::row). `place`: in the cell, each 0 to 1
    // or a little outside; `area`: of the surface that it stands for [m2]; `normal`: unit, outward.
    // Both at molding.
    void set(std::size_t point, const std::array<ParticleId, 4>& row, const Vec3& place,
             double area, const Vec3& normal);
    void add(std::array<ParticleId, 4> row, const Vec3& place, double area, const Vec3& normal);
    // A point that a particle is by itself.
    void add_loose(ParticleId particle, double area, const Vec3& normal);
    bool is_loose(std::size_t point) const { return row_[point][1] == kLoose; }
    void move(std::size_t point, const Vec3& place, double area);

    const std::array<ParticleId, 4>& row(std::size_t point) const { return row_[point]; }
    std::array<ParticleId, 8> corner(std::size_t point) const {
        const std::array<ParticleId, 4>& r = row_[point];
        if (r[1] == kLoose) return {r[0], r[0], r[0], r[0], r[0], r[0], r[0], r[0]};
        return {r[0], r[0] + 1, r[1], r[1] + 1, r[2], r[2] + 1, r[3], r[3] + 1};
    }
    Vec3 place(std::size_t point) const { return in_doubles(place_[point]); }
    double area(std::size_t point) const { return area_[point]; }
    Vec3 normal(std::size_t point) const { return in_doubles(normal_[point]); }
    // Corners of its cell, a bit each, that blades have left on the point's side of their paths.
    std::uint8_t side(std::size_t point) const { return side_.empty() ? 0xff : side_[point]; }
    void set_side(std::size_t point, std::uint8_t corners);
    Carriers carriers(std::size_t point) const {
        return {corner(point), trilinear_weights(place(point))};
    }
    // Where the point was at molding [m].
    Vec3 reference(std::size_t point, const ReferencePlaces& particles) const {
        return particles.in_cell(static_cast<std::size_t>(row_[point][0]), place(point));
    }
    // Where it is now [m].
    Vec3 position(std::size_t point, const Vec3Array& particles) const {
        const Carriers by = carriers(point);
        double x = 0, y = 0, z = 0;
        for (int c = 0; c < 8; ++c) {
            const auto n = static_cast<std::size_t>(by.corner[c]);
            x += by.weight[c] * particles.x[n];
            y += by.weight[c] * particles.y[n];
            z += by.weight[c] * particles.z[n];
        }
        return {x, y, z};
    }
    std::size_t bytes() const;
    bool operator==(const SurfacePoints&) const = default;

    template <typename Io>
    void visit(Io& io) {  // as SparseArray has it
        auto& [row, place, normal, area, side] = *this;
        io(row, place, normal, area, side);
    }

  private:
    static Vec3 in_doubles(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

    static constexpr ParticleId kLoose = -1;  // in row[1]: row[0] is the particle

    std::vector<std::array<ParticleId, 4>> row_;
    std::vector<Eigen::Vector3f> place_, normal_;
    std::vector<double> area_;
    std::vector<std::uint8_t> side_;  // empty: no blade has come by
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/surface_points.h"

namespace swage {

void SurfacePoints::resize(std::size_t count) {
    row_.resize(count);
    place_.resize(count);
    area_.resize(count);
    normal_.resize(count);
    if (!side_.empty()) side_.resize(count, 0xff);
}

void SurfacePoints::set(std::size_t point, const std::array<ParticleId, 4>& row, const Vec3& place,
                        double area, const Vec3& normal) {
    row_[point] = row;
    normal_[point] = normal.cast<float>();
    move(point, place, area);
}

void SurfacePoints::add(std::array<ParticleId, 4> row, const Vec3& place, double area,
                        const Vec3& normal) {
    resize(size() + 1);
    set(size() - 1, row, place, area, normal);
}

void SurfacePoints::add_loose(ParticleId particle, double area, const Vec3& normal) {
    add({particle, kLoose, kLoose, kLoose}, Vec3::Zero(), area, normal);
}

void SurfacePoints::move(std::size_t point, const Vec3& place, double area) {
    place_[point] = place.cast<float>();
    area_[point] = area;
}

void SurfacePoints::set_side(std::size_t point, std::uint8_t corners) {
    if (side_.empty()) side_.resize(size(), 0xff);
    side_[point] = corners;
}

std::size_t SurfacePoints::bytes() const {
    return row_.capacity() * sizeof(row_[0]) + place_.capacity() * sizeof(place_[0]) +
           normal_.capacity() * sizeof(normal_[0]) + area_.capacity() * sizeof(double) +
           side_.capacity();
}

}  // namespace swage

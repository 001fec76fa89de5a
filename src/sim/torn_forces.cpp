// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/torn_forces.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "matter/parted.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;
constexpr double kNear = 2;  // spacings, as molded

// Of the load's points those that are parted by the cells on their side.
std::vector<PointCarriage> on_sides(const Load& load, const Aggregate& matter,
                                    const std::vector<char>& is_parted) {
    std::vector<PointCarriage> bearer(load.point.size());
    parallel_each(bearer.size(), kChunk, [&](std::size_t n) {
        const auto p = static_cast<std::size_t>(load.point[n]);
        bearer[n] = is_parted[n] ? carriage_on_side(matter, p)
                                 : PointCarriage{matter.surface.row(p), matter.surface.place(p)};
    });
    return bearer;
}

bool is_left_over(const PointCarriage& carriage) { return !carriage.is_whole; }

void go_to_patches_near(const Load& load, const Aggregate& matter, const std::vector<char>& torn,
                        std::vector<PointCarriage>& bearer) {
    if (std::ranges::none_of(bearer, is_left_over)) return;
    const std::vector<int> piece = find_pieces(matter).particle_piece;
    const auto place = [&](std::size_t n) {
        return matter.surface_reference(std::size_t(load.point[n]));
    };
    for (std::size_t n = 0; n < bearer.size(); ++n) {
        if (!is_left_over(bearer[n])) continue;
        const int corner = std::countr_zero(bearer[n].corners);
        const int on = piece[std::size_t(corner_particle(bearer[n].row, corner))];
        const Vec3 at = place(n);
        double nearest = kNear * matter.lattice.spacing;
        for (std::size_t m = 0; m < bearer.size(); ++m) {
            if (torn[m] || piece[std::size_t(bearer[m].row[0])] != on) continue;
            const double far = (place(m) - at).norm();
            if (far < nearest) nearest = far, bearer[n] = bearer[m];
        }
    }
}

}  // namespace

std::vector<PointCarriage> bearers(const Load& load, const Aggregate& matter) {
    std::vector<char> torn(load.point.size());
    parallel_each(torn.size(), kChunk,
                  [&](std::size_t n) { torn[n] = is_torn(matter, std::size_t(load.point[n])); });
    if (std::ranges::find(torn, 1) == torn.end()) return {};
    std::vector<PointCarriage> bearer = on_sides(load, matter, torn);
    go_to_patches_near(load, matter, torn, bearer);
    return bearer;
}

std::vector<PointCarriage> pressed_bearers(const Load& load, const Aggregate& matter,
                                           const std::vector<char>& is_parted) {
    std::vector<char> parted;
    for (int p : load.point) parted.push_back(is_parted[std::size_t(p)]);
    if (std::ranges::find(parted, 1) == parted.end()) return {};
    return on_sides(load, matter, parted);
}

}  // namespace swage

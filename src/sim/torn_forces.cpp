// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/torn_forces.h"

#include <algorithm>

#include "base/parallel.h"
#include "matter/carriage_of_held.h"
#include "matter/parted.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;
constexpr double kNear = 2;      // spacings, as molded
constexpr double kHalf = 0.501;  // of a patch, and what rounding adds

// NOTE: a box that ends at a cut may leave less than half of a patch, whose middle then lies beyond
// both: that part is on the side of the patches next to it. Calls act(n, pieces, piece) for each,
// with theirs.
template <typename Act>
void for_each_rest(const SurfacePart& part, const Aggregate& matter,
                   const std::vector<char>& is_parted, const std::vector<PointCarriage>& bearer,
                   const Act& act) {
    if (part.share.empty()) return;
    const auto is_little = [&](std::size_t n) { return part.share_of(n) < kHalf; };
    Pieces pieces;
    for (std::size_t n = 0; n < bearer.size(); ++n) {
        if (!is_parted[n] || !is_little(n)) continue;
        const Vec3 at = matter.surface_reference(std::size_t(part.point[n]));
        double nearest = matter.lattice.spacing;
        std::size_t next = n;
        for (std::size_t m = 0; m < bearer.size(); ++m) {
            if (is_little(m)) continue;
            const double far = (matter.surface_reference(std::size_t(part.point[m])) - at).norm();
            if (far < nearest) nearest = far, next = m;
        }
        if (next == n) continue;
        if (pieces.count == 0) pieces = find_pieces(matter);
        act(n, pieces, piece_of(bearer[next], pieces));
    }
}

// Of the points those that are parted by the cells on their side.
std::vector<PointCarriage> on_sides(const SurfacePart& part, const Aggregate& matter,
                                    const std::vector<char>& is_parted) {
    std::vector<PointCarriage> bearer(part.point.size());
    parallel_each(bearer.size(), kChunk, [&](std::size_t n) {
        const auto p = static_cast<std::size_t>(part.point[n]);
        bearer[n] = is_parted[n] ? carriage_on_side(matter, p)
                                 : PointCarriage{matter.surface.row(p), matter.surface.place(p)};
    });
    return bearer;
}

std::vector<PointCarriage> on_sides_of_load(const Load& load, const Aggregate& matter,
                                            const std::vector<char>& is_parted) {
    std::vector<PointCarriage> bearer = on_sides(load, matter, is_parted);
    for_each_rest(
        load, matter, is_parted, bearer, [&](std::size_t n, const Pieces& pieces, int piece) {
            bearer[n] = carriage_on_piece(matter, std::size_t(load.point[n]), pieces, piece);
        });
    return bearer;
}

// Which of the points are; empty: none.
std::vector<char> find_torn(const SurfacePart& part, const Aggregate& matter) {
    std::vector<char> torn(part.point.size());
    parallel_each(torn.size(), kChunk,
                  [&](std::size_t n) { torn[n] = is_torn(matter, std::size_t(part.point[n])); });
    if (std::ranges::find(torn, 1) == torn.end()) torn.clear();
    return torn;
}

bool is_left_over(const PointCarriage& carriage) { return !carriage.is_whole; }

void go_to_patches_near(const Load& load, const Aggregate& matter, const std::vector<char>& torn,
                        std::vector<PointCarriage>& bearer) {
    if (std::ranges::none_of(bearer, is_left_over)) return;
    const Pieces pieces = find_pieces(matter);
    const auto place = [&](std::size_t n) {
        return matter.surface_reference(std::size_t(load.point[n]));
    };
    for (std::size_t n = 0; n < bearer.size(); ++n) {
        if (!is_left_over(bearer[n])) continue;
        const int on = piece_of(bearer[n], pieces);
        const Vec3 at = place(n);
        double nearest = kNear * matter.lattice.spacing;
        for (std::size_t m = 0; m < bearer.size(); ++m) {
            const double far = torn[m] ? nearest : (place(m) - at).norm();
            if (far >= nearest || piece_of(bearer[m], pieces) != on) continue;
            nearest = far, bearer[n] = bearer[m];
        }
    }
}

}  // namespace

std::vector<PointCarriage> bearers(const Load& load, const Aggregate& matter) {
    const std::vector<char> torn = find_torn(load, matter);
    if (torn.empty()) return {};
    std::vector<PointCarriage> bearer = on_sides_of_load(load, matter, torn);
    go_to_patches_near(load, matter, torn, bearer);
    return bearer;
}

std::vector<PointCarriage> pressed_bearers(const Load& load, const Aggregate& matter,
                                           const std::vector<char>& is_parted) {
    std::vector<char> parted;
    for (int p : load.point) parted.push_back(is_parted[std::size_t(p)]);
    if (std::ranges::find(parted, 1) == parted.end()) return {};
    return on_sides_of_load(load, matter, parted);
}

std::vector<PointCarriage> holders(const Grip& grip, const Aggregate& matter) {
    const std::vector<char> torn = find_torn(grip, matter);
    if (torn.empty()) return {};
    std::vector<PointCarriage> holder(torn.size());
    parallel_each(torn.size(), kChunk, [&](std::size_t n) {
        holder[n] = carriage_of_held(matter, std::size_t(grip.point[n]));
    });
    for_each_rest(grip, matter, torn, holder, [&](std::size_t n, const Pieces& pieces, int piece) {
        if (piece_of(holder[n], pieces) != piece) holder[n].is_whole = false;
    });
    return holder;
}

}  // namespace swage

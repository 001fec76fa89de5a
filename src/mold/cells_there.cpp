// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/cells_there.h"

#include "geometry/box.h"
#include "geometry/near_pairs.h"
#include "matter/cell_middle.h"

namespace swage {

namespace {

constexpr CellId kNone = -1;

// Where a body's cells are.
class CellPlaces {
  public:
    explicit CellPlaces(const Aggregate& body) {
        for (std::size_t c = 0; c < body.cell_fill.size(); ++c) {
            Box around;
            for (ParticleId p : body.lattice.cell_corners(static_cast<CellId>(c))) {
                around.grow(body.particle_position.at(p));
            }
            box_.push_back(around);
            middle_.push_back(cell_middle(body, static_cast<CellId>(c)));
        }
    }

    // For those places that have none yet.
    template <typename Suits>
    void find_near(const std::vector<Vec3>& place, double wider, const Suits& suits,
                   std::vector<CellId>& there) const {
        std::vector<std::size_t> missing;
        std::vector<Vec3> at;
        for (std::size_t n = 0; n < place.size(); ++n) {
            if (there[n] != kNone) continue;
            missing.push_back(n);
            at.push_back(place[n]);
        }
        if (missing.empty()) return;
        std::vector<Box> box;
        for (const Box& one : box_) box.push_back(one.widened(wider));
        for (const auto& [point, other] : near_pairs(at, box)) {
            const std::size_t n = missing[static_cast<std::size_t>(point)];
            offer(static_cast<CellId>(other), place[n], n, suits, there[n]);
        }
    }
    template <typename Suits>
    void find_anywhere(const std::vector<Vec3>& place, const Suits& suits,
                       std::vector<CellId>& there) const {
        for (std::size_t n = 0; n < place.size(); ++n) {
            if (there[n] != kNone) continue;
            for (std::size_t c = 0; c < middle_.size(); ++c) {
                offer(static_cast<CellId>(c), place[n], n, suits, there[n]);
            }
        }
    }

  private:
    double far(const Vec3& place, CellId cell) const {
        return (place - middle_[static_cast<std::size_t>(cell)]).squaredNorm();
    }
    template <typename Suits>
    void offer(CellId cell, const Vec3& place, std::size_t n, const Suits& suits,
               CellId& there) const {
        if (!suits(n, cell)) return;
        if (there == kNone || far(place, cell) < far(place, there)) there = cell;
    }

    std::vector<Box> box_;
    std::vector<Vec3> middle_;
};

}  // namespace

std::vector<CellId> cells_there(const Aggregate& body, const std::vector<Vec3>& place,
                                double wider) {
    const auto any = [](std::size_t, CellId) { return true; };
    std::vector<CellId> there(place.size(), kNone);
    const CellPlaces cells(body);
    cells.find_near(place, wider, any, there);
    cells.find_anywhere(place, any, there);
    return there;
}

std::vector<CellId> suited_cells_there(
    const Aggregate& body, const std::vector<Vec3>& place,
    const std::function<bool(std::size_t place, CellId cell)>& suits) {
    std::vector<CellId> there(place.size(), kNone);
    const CellPlaces cells(body);
    cells.find_near(place, 0, suits, there);
    cells.find_near(place, body.lattice.spacing, suits, there);
    cells.find_anywhere(place, suits, there);
    return there;
}

}  // namespace swage

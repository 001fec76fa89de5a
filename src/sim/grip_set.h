// SPDX-License-Identifier: GPL-3.0-or-later
// Grips: points of a body's true surface, each held by a spring to its place in a frame that moves.
// Forces act on the particles that carry a point, with the point's own weights, so that force and
// moment are kept exactly. A point whose carriers hang together no more is held by what carries it
// on its side of the cut or crack (sim/torn_forces.h), or let go.
//
// Of a patch that a grip's edge cuts a share s is held, its spring by s^2 softer: what the edge
// leaves free bends and stretches as one that ends there, to a tenth of a cell. By s alone it would
// be up to a quarter of a cell too short, for what holds the cell at the edge grows with the area
// held and with how far that reaches into the cell.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/held_point.h"
#include "sim/part_sum.h"
#include "sim/settings.h"
#include "sim/surface_modulus.h"

namespace swage {

class GripSet {
  public:
    // `body`: the matter's number among the bodies, by which grips name it. The apparatus must
    // outlive it.
    GripSet(const Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings,
            int body);

    // A blade or a crack has parted cells: points that it has torn are held by others or no more.
    void connections_changed(const Aggregate& matter);
    void masses_changed() { limit_is_old_ = true; }  // as MovingContacts has it

    // Explicit steps of this length [s] must stay stable, so there is a stiffness that no point
    // exceeds (stiffest_of_points()).
    void limit_stiffness(const Aggregate& matter, double step);

    // Adds to `stiffness` what grips add to each particle [N/m].
    void add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const;

    void add_held_points(const Aggregate& matter, const Drive& now,
                         std::vector<HeldPoint>& held) const;

    void add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force) const;
    // Sums by grip, for grip g at sums[first + g].
    void add_loads(const Aggregate& matter, const Drive& now, std::size_t first,
                   std::vector<PartSum>& sums) const;

    // In the springs [J].
    double stored_energy(const Aggregate& matter, const Drive& now) const;

    // All three; returns the energy.
    double add_all(const Aggregate& matter, const Drive& now, Vec3Array& force, std::size_t first,
                   std::vector<PartSum>& sums) const;

    // The farthest that any point's place moves [m].
    double travel(const Drive& from, const Drive& to) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        bool beside = beside_ != nullptr;
        io(limit_, limit_step_, torn_, beside);
        SurfacePoints now = beside_ ? *beside_ : SurfacePoints{};
        if (beside) io(now);
        if constexpr (Io::kReads) {
            beside_ = beside ? std::make_shared<const SurfacePoints>(std::move(now)) : nullptr;
        }
    }

  private:
    // Calls act(g, point, position, force, stiffness) for each point in a grip.
    template <typename Act>
    void for_each_point(const Aggregate& matter, const Drive& now, const Act& act) const;

    // Calls act(g, grip) for each grip on this body.
    template <typename Act>
    void for_each_grip(const Act& act) const {
        for (std::size_t g = 0; g < apparatus_->grip.size(); ++g) {
            if (apparatus_->grip[g].body == body_) act(g, apparatus_->grip[g]);
        }
    }
    // Calls act(n, point, stiffness) for each point that a grip holds.
    template <typename Act>
    void for_each_held(const Aggregate& matter, const Grip& grip, const Act& act) const {
        for (std::size_t n = 0; n < grip.point.size(); ++n) {
            const int point = grip.point[n];
            if (!is_torn(point)) act(n, point, stiffness(matter, grip, n));
        }
    }
    bool is_torn(int point) const { return !torn_.empty() && torn_[std::size_t(point)]; }
    // By what they are held.
    const SurfacePoints& points(const Aggregate& matter) const {
        return beside_ ? *beside_ : matter.surface;
    }
    template <typename Carriage>
    void carry_points(const Aggregate& matter, const Carriage& carriage);
    void find_limits(const Aggregate& matter);
    double stiffness(const Aggregate& matter, int point) const;  // of a whole patch [N/m]
    // Of the grip's n-th point [N/m].
    double stiffness(const Aggregate& matter, const Grip& grip, std::size_t n) const;

    const Apparatus* apparatus_;
    int body_;
    double of_layer_;  // so many times as stiff is a grip
    SurfaceLayer layer_;
    // By point of the surface; empty: none.
    std::vector<double> limit_;  // [N/m]
    double limit_step_ = 0;      // [s]
    bool limit_is_old_ = false;  // until connections_changed()
    std::vector<char> torn_;     // and let go
    // The body's, with those that other cells hold than as molded; null: none.
    std::shared_ptr<const SurfacePoints> beside_;
};

}  // namespace swage

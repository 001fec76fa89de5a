// SPDX-License-Identifier: GPL-3.0-or-later
// A body as contact with other bodies, and with itself, sees it: the points of its surface
// (matter/touch_points.h), the cells that they may meet, and which of them belong together.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "matter/aggregate.h"
#include "matter/touch_points.h"
#include "sim/contact_patch.h"
#include "sim/cut_surface.h"
#include "sim/point_stiffness.h"
#include "sim/rest_surface.h"

namespace swage {

class ContactSide {
  public:
    // `itself`: whether it may meet itself. The body must outlive it. `molded`: as another has it
    // that is_shared(); null: it is found.
    ContactSide(Aggregate& matter, bool itself, std::shared_ptr<const RestSurface> molded);
    // Of a piece without a whole cell (sim/thin_piece.h): where blades have ended it, beside its
    // surface as molded.
    ContactSide(Aggregate& matter, std::shared_ptr<const RestSurface> molded,
                std::shared_ptr<const CutSurface> ends);

    // A blade or a crack has changed which cells are whole. Points keep their numbers.
    void connections_changed();
    // These particles meet nothing by themselves, others do.
    void leave_out(const std::vector<ParticleId>& particles);

    Aggregate& matter() const { return *matter_; }
    const std::shared_ptr<const RestSurface>& molded() const { return molded_; }
    const SurfacePoints& points() const { return touch_.points(); }
    // The body's own; those of new surface come after them.
    std::size_t own_points() const { return touch_.own(); }
    bool meets(int point) const { return touch_.meets(point); }
    const std::vector<int>& meeting() const { return meeting_; }  // points, in their order
    // Of matter/touch_points.h.
    const Vec3i& home(int point) const { return touch_.home()[std::size_t(point)]; }
    bool is_loose(int point) const { return touch_.is_loose(point); }
    Vec3 position(int point) const {
        return points().position(std::size_t(point), matter_->particle_position);
    }
    double give(Solver solver);  // OtherSide::give
    std::shared_ptr<const PointStiffness> stiffness_on(const OtherSide& other, Solver solver);
    // Of all ways that this side is part of.
    ContactPatch& patch() { return patch_; }
    const ContactPatch& patch() const { return patch_; }
    // How far outside of a cell new surface may lie, in cells; and of any.
    double beyond(CellId cell) const {
        return cut_ != nullptr ? cut_->beyond(cell) : CutSurface::kBeforeBreak;
    }
    double beyond() const {
        return matter_->cut.empty() && !is_thin() ? CutSurface::kBeforeBreak
                                                  : CutSurface::kBeforeCut;
    }
    bool is_thin() const { return ends_ != nullptr; }
    // Whether any surface is new.
    bool is_cut() const { return is_thin() || touch_.size() > touch_.own(); }
    // How deep a place of a cell lies below the surface as molded or, where matter is cut or
    // broken, below the new one, whichever is nearer. Before a new face it may lie outside.
    // `met`: the slope of that where a point that touches has met it, else zero. What has come in
    // on one side of a thin piece does not come out on the other.
    RestSurface::Depth depth(const Vec3i& site, CellId cell, const Vec3& place,
                             const Eigen::Vector3f& met = Eigen::Vector3f::Zero()) const {
        if (is_thin()) return thin_depth(site, cell, place, met.cast<double>());
        if (cut_ != nullptr) return least_depth(site, cell, place);
        const bool inside = (place.array() >= 0).all() && (place.array() <= 1).all();
        return inside ? molded_->at(cell, place) : molded_->at_sliver(cell, place);
    }
    // Cells less than a spacing deep, in their order.
    const std::vector<CellId>& rim() const { return rim_; }
    const std::vector<CellId>& whole_rim() const { return whole_rim_; }  // of these
    // A whole cell not deep inside, which a point may meet.
    bool may_hold(CellId cell) const {
        return cell >= 0 && touch_.whole()[cell] &&
               (molded_->is_rim(cell) || (cut_ != nullptr && cut_->is_rim(cell)));
    }
    bool is_whole(CellId cell) const { return touch_.whole()[cell] != 0; }
    // Particles of cells near the surface, and loose ones.
    const std::vector<ParticleId>& skin() const { return skin_; }

    // How much a point meets a place of its own body, from 0 to 1, and how that changes with the
    // place, both in cells. What in the shape at rest is near it and connected to it there it does
    // not meet, and from there on more and more: were it cut off at once, a point that slides
    // along a crease would lose or gain what it presses with.
    struct OwnShare {
        double value;
        Vec3 gradient;
    };
    OwnShare own_share(int point, const Vec3i& site, const Vec3& place) const;
    // Whether a point meets next to nothing in this cell and around it.
    bool is_own_place(int point, const Vec3i& site) const;
    // Whether the point is within four cells of this one on each axis, and connected to it within
    // these.
    bool is_neighbour(int point, const Vec3i& site) const;

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(patch_);
        visit_points(io);
    }
    // Of that the points, as they have come to be numbered.
    template <typename Io>
    void visit_points(Io& io) {
        io(touch_);
        if constexpr (Io::kReads) {
            forget_near();
            find_cells();
        }
    }

  private:
    std::optional<RestSurface::Depth> molded_depth(const Vec3i& site, CellId cell,
                                                   const Vec3& place) const;
    RestSurface::Depth thin_depth(const Vec3i& site, CellId cell, const Vec3& place,
                                  const Vec3& met) const;
    RestSurface::Depth least_depth(const Vec3i& site, CellId cell, const Vec3& place) const;
    void find_cells();
    void find_near();
    void forget_near();  // points are others, not only more
    void find_cracks();
    bool stands_in_crack(int point) const;
    Vec3 own_place(int point) const { return own_place_[point].cast<double>(); }

    Aggregate* matter_;
    std::optional<double> give_;
    // As the points are, that ways have.
    std::vector<std::shared_ptr<const PointStiffness>> stiffness_on_;
    ContactPatch patch_;
    bool itself_;
    TouchPoints touch_;
    std::shared_ptr<const RestSurface> molded_;
    std::shared_ptr<const CutSurface> ends_;  // null: no thin piece
    std::shared_ptr<const CutSurface> cut_;   // null where all is whole
    std::vector<CellId> rim_, whole_rim_;
    std::vector<int> meeting_;
    std::vector<ParticleId> skin_;
    // With itself: of each point its place at molding, from the lattice's origin, in cells.
    std::vector<Eigen::Vector3f> own_place_;
    // Of each point a set, -1: empty, a loose particle's; of each set a bit for each cell of the
    // box around its home.
    std::vector<int> near_set_;
    std::vector<std::array<std::uint64_t, 12>> near_;
    std::vector<Vec3i> set_home_;
    std::vector<char> near_whole_;  // TouchPoints::whole() that they were found with; empty: none
    // Of each point of new surface whether it looks into a crack that presses by itself while it is
    // shut (closes_as_crack()), and not into a cut.
    std::vector<char> is_crack_;
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a body with which it meets tools, other bodies and itself: those of its surface
// as molded, with its edges and corners, and where cells are no longer whole, cut or broken, a
// new surface: a point before each face of a whole cell that looks at one, which the whole cell
// carries. It lies where the blade went, or half a spacing out where a load broke the matter.
// What a blade has left of a cell on either side of its path is carried by a whole one of that
// side (matter/point_side.h). Else what a cell no longer whole carries meets nothing; particles
// that no whole cell has left meet by themselves.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "matter/aggregate.h"
#include "matter/cut_planes.h"
#include "matter/point_side.h"

namespace swage {

class TouchPoints {
  public:
    // `beside_cuts`: whether what blades have left of cells meets anything. NOTE: among bodies it
    // does not, from when each side held what came half-way through a cut cell, wherever in it the
    // blade went. Now that its path is known it could.
    explicit TouchPoints(const Aggregate& matter, bool beside_cuts = true);

    // A point and what carried it before.
    struct Carried {
        int point;
        PointCarriage by;

        template <typename Io>
        void visit(Io& io) {
            io(point, by);
        }
    };
    // A blade or a crack has changed which cells are whole, or a step back has made them so again.
    // Points keep their numbers; returns those that another cell carries from now on, in their
    // order.
    std::vector<Carried> connections_changed(const Aggregate& matter);

    // Of particles by themselves these meet nothing until the next change.
    void leave_out(const std::vector<ParticleId>& particles);

    const SurfacePoints& points() const { return points_; }
    std::size_t size() const { return points_.size(); }
    // The body's own; those of new surface come after them.
    std::size_t own() const { return own_; }
    bool meets(int point) const { return meets_[point] != 0; }
    // Of new surface those before faces of cells, 2 axis + side.
    const std::map<std::pair<CellId, int>, int>& faces() const { return face_; }
    // A particle by itself.
    bool is_loose(int point) const { return points_.is_loose(static_cast<std::size_t>(point)); }
    // The cell that the point lies in or just outside of; of new surface, that which carries it.
    // Loose particles have none.
    const std::vector<Vec3i>& home() const { return home_; }
    const std::vector<char>& whole() const { return whole_; }  // of each cell

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(points_, carrier_, home_, meets_, whole_, beside_, face_, loose_);
    }

  private:
    std::vector<Carried> carry_beside(const Aggregate& matter);
    struct FaceSite {  // one that looks at a cell no longer whole
        CellId cell;
        Vec3i site;
        int face;  // 2 axis + side
    };
    int face_point(const Aggregate& matter, const FaceSite& at);
    int loose_point(double spacing, ParticleId particle);
    void add_loose(const Aggregate& matter);

    bool beside_cuts_;
    SurfacePoints points_;
    std::vector<int> patch_of_edge_;  // of each point at an edge, that beside it
    std::size_t own_;
    std::vector<CellId> carrier_;  // of each point of its own; -1: no cell
    std::vector<Vec3i> home_;
    std::vector<char> meets_, whole_;
    std::vector<Carried> beside_;  // its own that a cell beside theirs carries: as molded, by point
    std::map<std::pair<CellId, int>, int> face_;  // the point before a face of a cell
    std::optional<CutPlanes> cuts_;               // while faces are looked at
    std::map<ParticleId, int> loose_;             // the point of a particle
};

}  // namespace swage

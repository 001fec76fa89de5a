// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a body with which it meets tools, other bodies and itself: those of its surface as
// molded, with its edges and corners, and where cells are no longer whole, cut or broken, a new
// surface half-way through them: a point before each face of a whole cell that looks at one, half a
// spacing out, which the whole cell carries. What a cell no longer whole carries meets nothing;
// particles that no whole cell has left meet by themselves.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

class TouchPoints {
  public:
    explicit TouchPoints(const Aggregate& matter);

    // A blade or a crack has changed which cells are whole, or a step back has made them so again.
    // Points keep their numbers.
    void connections_changed(const Aggregate& matter);

    const SurfacePoints& points() const { return points_; }
    std::size_t size() const { return points_.size(); }
    // The body's own; those of new surface come after them.
    std::size_t own() const { return own_; }
    bool meets(int point) const { return meets_[point] != 0; }
    // A particle by itself.
    bool is_loose(int point) const { return points_.is_loose(static_cast<std::size_t>(point)); }
    // The cell that the point lies in or just outside of; of new surface, that which carries it.
    // Loose particles have none.
    const std::vector<Vec3i>& home() const { return home_; }
    const std::vector<char>& whole() const { return whole_; }  // of each cell

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(points_, carrier_, home_, meets_, whole_, face_, loose_);
    }

  private:
    int face_point(const Lattice& lattice, CellId cell, const Vec3i& site, int face);
    int loose_point(double spacing, ParticleId particle);
    void add_loose(const Aggregate& matter);

    SurfacePoints points_;
    std::size_t own_;
    std::vector<CellId> carrier_;  // of each point of its own; -1: no cell
    std::vector<Vec3i> home_;
    std::vector<char> meets_, whole_;
    std::map<std::pair<CellId, int>, int> face_;  // the point before a face of a cell
    std::map<ParticleId, int> loose_;             // the point of a particle
};

}  // namespace swage

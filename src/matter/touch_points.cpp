// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/touch_points.h"

#include <algorithm>

#include "base/parallel.h"
#include "matter/edge_points.h"
#include "matter/open_faces.h"

namespace swage {

namespace {

constexpr std::size_t kPoints = 4096;  // a chunk

}  // namespace

TouchPoints::TouchPoints(const Aggregate& matter, bool beside_cuts)
    : beside_cuts_(beside_cuts), points_(matter.surface) {
    const Lattice& lattice = matter.lattice;
    patch_of_edge_ = add_edge_points(matter, points_);
    own_ = points_.size();
    const std::vector<CellId> by_low_corner = lattice.cells_by_low_corner();
    for (std::size_t p = 0; p < own_; ++p) {
        carrier_.push_back(points_.is_loose(p) ? -1 : by_low_corner[points_.row(p)[0]]);
        const Vec3 at = points_.reference(p, matter.particle_reference);
        const Vec3 inner = (at - lattice.origin) / lattice.spacing - 1e-3 * points_.normal(p);
        home_.push_back(inner.array().floor().cast<int>());
    }
    connections_changed(matter);
}

int TouchPoints::face_point(const Aggregate& matter, const FaceSite& at) {
    const auto [known, is_new] =
        face_.try_emplace({at.cell, at.face}, static_cast<int>(points_.size()));
    if (!is_new) return known->second;
    const Vec3 out = (at.face & 1 ? 1 : -1) * Vec3::Unit(at.face >> 1);
    const Vec3 middle = Vec3::Constant(0.5) + 0.5 * out;  // of the face, in the cell
    Vec3 place = middle + 0.5 * out, normal = out;
    double share = 1;
    if (const auto plane = cut_before(matter, *cuts_, at.site, at.face)) {
        // As many faces look out along an axis as the plane's area has that way, so that all areas
        // add up to that.
        normal = plane->normal * (plane->normal.dot(out) < 0 ? -1 : 1);
        share = normal.dot(out);
        const Vec3 way = plane->place - at.site.cast<double>() - middle;
        place = middle + way.dot(normal) * normal;
    }
    const double a = matter.lattice.spacing;
    points_.add(matter.lattice.cell_row(at.cell), place, share * a * a, normal);
    home_.push_back(at.site);
    return known->second;
}

int TouchPoints::loose_point(double spacing, ParticleId particle) {
    const auto [at, is_new] = loose_.try_emplace(particle, static_cast<int>(points_.size()));
    if (!is_new) return at->second;
    points_.add_loose(particle, spacing * spacing, Vec3::UnitY());  // it has none
    home_.push_back(Vec3i::Zero());                                 // nor this
    return at->second;
}

void TouchPoints::add_loose(const Aggregate& matter) {
    std::vector<char> held(matter.particle_count(), 0);
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            if (!whole_[run.first + n]) continue;
            for (ParticleId p : run.row) held[p + n] = held[p + n + 1] = 1;
        }
    }
    for (std::size_t p = 0; p < held.size(); ++p) {
        if (held[p]) continue;
        const auto point = static_cast<std::size_t>(
            loose_point(matter.lattice.spacing, static_cast<ParticleId>(p)));
        if (point == meets_.size()) meets_.push_back(0);
        meets_[point] = 1;
    }
}

void TouchPoints::leave_out(const std::vector<ParticleId>& particles) {
    for (ParticleId p : particles) {
        const auto point = loose_.find(p);
        if (point != loose_.end()) meets_[std::size_t(point->second)] = 0;
    }
}

// Of the body's own points those in parted cells that a blade has told the side of.
std::vector<TouchPoints::Carried> TouchPoints::carry_beside(const Aggregate& matter) {
    const std::size_t patches = matter.surface.size();
    const auto carriage = [&](std::size_t p) {
        return PointCarriage{points_.row(p), points_.place(p)};
    };
    const bool is_new = whole_.empty();  // else cells that were until now
    const auto was_let_go = [&](std::size_t p) {
        return carrier_[p] >= 0 && !is_new && !whole_[std::size_t(carrier_[p])];
    };
    std::vector<Carried> were;
    for (const auto& [point, molded] : beside_) {
        were.push_back({point, carriage(std::size_t(point))});
        carry(points_, std::size_t(point), molded);
    }
    const auto find = [&](std::size_t begin, std::size_t end, std::vector<Carried>& found) {
        for (std::size_t p = begin; p < end; ++p) {
            if (meets_[p]) continue;
            const CornerMask side =
                matter.surface.side(p < patches ? p : std::size_t(patch_of_edge_[p - patches]));
            if (side == kAllCorners) continue;
            const PointCarriage by = carriage_on_side(matter, carriage(p), side);
            if (by.is_whole) found.push_back({static_cast<int>(p), by});
        }
    };
    beside_.clear();
    std::vector<Carried> changed;
    auto was = were.begin();
    for (auto [point, by] : parallel_collect<Carried>(own_, kPoints, find)) {
        const auto p = static_cast<std::size_t>(point);
        const PointCarriage molded = carriage(p);
        while (was != were.end() && was->point < point) changed.push_back(*was++);
        const bool had = was != were.end() && was->point == point;
        const PointCarriage before = had ? was->by : molded;
        if (had && before.row == by.row) {
            by = before;
        } else if (!had && was_let_go(p)) {
            continue;
        } else if (!is_new) {
            by = brought_to(before.position(matter), matter, by);
        }
        if (!by.is_whole) continue;
        carry(points_, p, by);
        meets_[p] = 1;
        beside_.push_back({point, molded});
        if (before.row != by.row) changed.push_back({point, before});
        if (had) ++was;
    }
    changed.insert(changed.end(), was, were.end());
    return changed;
}

std::vector<TouchPoints::Carried> TouchPoints::connections_changed(const Aggregate& matter) {
    const Lattice& lattice = matter.lattice;
    std::vector<char> whole = whole_cells(matter);
    meets_.assign(points_.size(), 0);
    for (std::size_t p = 0; p < own_; ++p) meets_[p] = carrier_[p] < 0 || whole[carrier_[p]];
    std::vector<Carried> changed;
    if (beside_cuts_) changed = carry_beside(matter);
    whole_ = std::move(whole);
    if (std::find(whole_.begin(), whole_.end(), 0) == whole_.end()) return changed;
    cuts_.emplace(matter);
    for_each_open_face(lattice, whole_, [&](const CellRun& run, int n, int face) {
        const FaceSite at{run.first + n, Vec3i(run.i + n, run.j, run.k), face};
        const auto point = static_cast<std::size_t>(face_point(matter, at));
        if (point == meets_.size()) meets_.push_back(0);
        meets_[point] = 1;
    });
    cuts_.reset();
    add_loose(matter);
    return changed;
}

}  // namespace swage

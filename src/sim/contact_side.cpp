// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_side.h"

#include <algorithm>
#include <iterator>

#include "base/parallel.h"
#include "sim/edge_points.h"

namespace swage {

namespace {

constexpr int kNear = 4;  // cells to each side that a point's neighbourhood is sought in
constexpr int kBox = 2 * kNear + 1;
// Cells from a point at rest, within its neighbourhood: where it meets nothing, where it meets all,
// which is nearer than the neighbourhood ends, and where cells begin that it is sought in first.
constexpr double kNone = 2.5, kAll = 3.5, kSeed = 3.0;
constexpr double kClosed = 1.0, kApart = 1.5;  // the same of faces of one crack
constexpr std::size_t kSets = 64;              // a chunk

int bit_of(const Vec3i& at) {
    return (at.x() + kNear) + kBox * ((at.y() + kNear) + kBox * (at.z() + kNear));
}

bool in_box(const Vec3i& at) { return (at.array().abs() <= kNear).all(); }

}  // namespace

ContactSide::ContactSide(Aggregate& matter, bool itself)
    : matter_(&matter),
      patch_(matter),
      itself_(itself),
      own_(matter.surface),
      molded_(std::make_shared<const RestSurface>(matter.lattice, matter.surface)) {
    add_edge_points(matter.lattice, own_);
    connections_changed();
}

void ContactSide::connections_changed() {
    find_whole();
    find_points();
    rim_ = molded_->skin();
    if (points_.size() > own_points()) {
        cut_ = std::make_shared<const CutSurface>(matter_->lattice, whole_);
        std::vector<CellId> both;
        std::set_union(rim_.begin(), rim_.end(), cut_->skin().begin(), cut_->skin().end(),
                       std::back_inserter(both));
        rim_ = std::move(both);
    }
    std::vector<char> taken(matter_->particle_count(), 0);
    for (CellId cell : rim_) {
        for (ParticleId p : matter_->lattice.cell_corners(cell)) taken[p] = 1;
    }
    skin_.clear();
    for (std::size_t p = 0; p < taken.size(); ++p) {
        if (taken[p]) skin_.push_back(static_cast<ParticleId>(p));
    }
    if (itself_) find_near();
}

RestSurface::Depth ContactSide::least_depth(const Vec3i& site, CellId cell,
                                            const Vec3& place) const {
    CellId at = cell;
    Vec3 local = place;
    const Vec3i out =
        Vec3i((place.array() > 1).cast<int>()) - Vec3i((place.array() < 0).cast<int>());
    if (!out.isZero()) {
        const Vec3i next = site + out;
        const CellId beside = matter_->lattice.cell_at(next.x(), next.y(), next.z());
        if (beside >= 0 && molded_->is_rim(beside)) {
            at = beside;
            local -= out.cast<double>();
        }
        if (beside < 0 && molded_->is_rim(cell) && !cut_->is_rim(cell)) {
            return molded_->at_sliver(cell, place);
        }
    }
    if (!cut_->is_rim(cell)) return molded_->at(at, local);
    RestSurface::Depth face = cut_->at(cell, place);
    // The new surface is half a cell before the face at most, so that nothing that is held there
    // is let go at once.
    if (!out.isZero()) {
        const Vec3 beyond = place - place.cwiseMax(0.0).cwiseMin(1.0);
        const double far = beyond.norm();
        if (far - 0.5 > face.distance) face = {far - 0.5, beyond / far};
    }
    if (!molded_->is_rim(at)) return face;
    const RestSurface::Depth own = molded_->at(at, local);
    return own.distance > face.distance ? own : face;
}

void ContactSide::find_whole() {
    const Aggregate& matter = *matter_;
    whole_.assign(matter.cell_fill.size(), 0);
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            std::array<ParticleId, 4> row = run.row;
            for (ParticleId& p : row) p += n;
            whole_[run.first + n] = cell_is_whole(matter, row);
        }
    }
}

void ContactSide::find_points() {
    const Lattice& lattice = matter_->lattice;
    const double a = lattice.spacing;
    points_ = own_;
    home_.clear();
    meets_.assign(points_.size(), 1);
    for (std::size_t p = 0; p < points_.size(); ++p) {
        const Vec3 inner = (points_.reference_position[p] - lattice.origin) / a -
                           1e-3 * points_.reference_normal[p];
        home_.push_back(inner.array().floor().cast<int>());
    }
    if (std::find(whole_.begin(), whole_.end(), 0) == whole_.end()) return;
    std::vector<CellId> by_low_corner(matter_->particle_count(), -1);
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) by_low_corner[run.row[0] + n] = run.first + n;
    }
    for (std::size_t p = 0; p < points_.size(); ++p) {
        meets_[p] = whole_[by_low_corner[points_.corner[p][0]]];
    }
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const CellId cell = run.first + n;
            if (!whole_[cell]) continue;
            const Vec3i site(run.i + n, run.j, run.k);
            for (int face = 0; face < 6; ++face) {
                const int axis = face >> 1, side = face & 1;
                const Vec3i out = (side ? 1 : -1) * Vec3i::Unit(axis);
                const Vec3i next = site + out;
                const CellId other = lattice.cell_at(next.x(), next.y(), next.z());
                if (other < 0 || whole_[other]) continue;
                Vec3 place = Vec3::Constant(0.5);
                place[axis] += out[axis];
                std::array<float, 8> weight;
                for (int c = 0; c < 8; ++c) {
                    double w = 1;
                    for (int d = 0; d < 3; ++d) w *= c >> d & 1 ? place[d] : 1 - place[d];
                    weight[c] = static_cast<float>(w);
                }
                points_.corner.push_back(lattice.cell_corners(cell));
                points_.weight.push_back(weight);
                points_.area.push_back(a * a);
                points_.reference_position.push_back(lattice.origin +
                                                     a * (site.cast<double>() + place));
                points_.reference_normal.push_back(out.cast<double>());
                home_.push_back(site);
                meets_.push_back(1);
            }
        }
    }
}

// Floods from each home through whole cells, within its box.
void ContactSide::find_near() {
    const Lattice& lattice = matter_->lattice;
    near_set_.assign(home_.size(), -1);
    std::vector<Vec3i> home;  // of points that follow one another and share it
    for (std::size_t p = 0; p < home_.size(); ++p) {
        if (p == 0 || home_[p] != home_[p - 1]) home.push_back(home_[p]);
        near_set_[p] = static_cast<int>(home.size()) - 1;
    }
    near_.assign(home.size(), {});
    parallel_for((home.size() + kSets - 1) / kSets, [&](std::size_t chunk) {
        const std::size_t stop = std::min(home.size(), (chunk + 1) * kSets);
        std::vector<Vec3i> open;
        for (std::size_t s = chunk * kSets; s < stop; ++s) {
            auto& set = near_[s];
            const auto visit = [&](const Vec3i& at) {
                if (!in_box(at)) return false;
                const int bit = bit_of(at);
                if (set[bit / 64] >> (bit % 64) & 1) return true;
                const Vec3i site = home[s] + at;
                const CellId cell = lattice.cell_at(site.x(), site.y(), site.z());
                if (cell < 0 || !whole_[cell]) return false;
                set[bit / 64] |= std::uint64_t(1) << (bit % 64);
                open.push_back(at);
                return true;
            };
            // A sliver may be no cell: then its neighbours begin.
            if (!visit(Vec3i::Zero())) {
                for (int n = 0; n < 27; ++n) visit({n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1});
            }
            while (!open.empty()) {
                const Vec3i at = open.back();
                open.pop_back();
                for (int d = 0; d < 3; ++d) {
                    visit(at + Vec3i::Unit(d));
                    visit(at - Vec3i::Unit(d));
                }
            }
        }
    });
}

bool ContactSide::is_neighbour(int point, const Vec3i& site) const {
    const Vec3i at = site - home_[point];
    if (!in_box(at)) return false;
    const int bit = bit_of(at);
    return near_[near_set_[point]][bit / 64] >> (bit % 64) & 1;
}

bool ContactSide::is_own_place(int point, const Vec3i& site) const {
    const Vec3 middle = site.cast<double>() + Vec3::Constant(0.5);
    return (middle - own_place(point)).squaredNorm() < kSeed * kSeed && is_neighbour(point, site);
}

ContactSide::OwnShare ContactSide::own_share(int point, const Vec3i& site,
                                             const Vec3& place) const {
    const Vec3 way = site.cast<double>() + place - own_place(point);
    const double far = way.norm();
    const auto from = [&](double none, double all) -> OwnShare {
        const double t = std::clamp((far - none) / (all - none), 0.0, 1.0);
        return {t * t * (3 - 2 * t), 6 * t * (1 - t) / ((all - none) * std::max(far, 1e-9)) * way};
    };
    if (far < kAll && is_neighbour(point, site)) return from(kNone, kAll);
    // Faces of a crack that loads have broken, not yet apart: a closed crack is the fracture law's.
    const bool is_face = static_cast<std::size_t>(point) >= own_points();
    if (is_face && far < kApart && !matter_->connection[0].damage.empty()) {
        return from(kClosed, kApart);
    }
    return {1, Vec3::Zero()};
}

}  // namespace swage

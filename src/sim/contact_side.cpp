// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_side.h"

#include <algorithm>
#include <iterator>

#include "base/parallel.h"

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
      touch_(matter),
      molded_(std::make_shared<const RestSurface>(matter)) {
    find_cells();
}

void ContactSide::connections_changed() {
    touch_.connections_changed(*matter_);
    find_cells();
}

void ContactSide::find_cells() {
    rim_ = molded_->skin();
    if (touch_.size() > touch_.own()) {
        cut_ = std::make_shared<const CutSurface>(matter_->lattice, touch_.whole());
        std::vector<CellId> both;
        std::set_union(rim_.begin(), rim_.end(), cut_->skin().begin(), cut_->skin().end(),
                       std::back_inserter(both));
        rim_ = std::move(both);
    }
    std::vector<char> taken(matter_->particle_count(), 0);
    for (CellId cell : rim_) {
        for (ParticleId p : matter_->lattice.cell_corners(cell)) taken[p] = 1;
    }
    for (std::size_t p = touch_.own(); p < touch_.size(); ++p) {
        const int point = static_cast<int>(p);
        if (touch_.is_loose(point) && touch_.meets(point)) taken[points().corner(p)[0]] = 1;
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
        const CellId beside = matter_->lattice.cell_at(next);
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

// Floods from each home through whole cells, within its box.
void ContactSide::find_near() {
    const Lattice& lattice = matter_->lattice;
    const std::vector<Vec3i>& home_of = touch_.home();
    own_place_.resize(home_of.size());
    near_set_.assign(home_of.size(), -1);
    std::vector<Vec3i> home;  // of points that follow one another and share it
    for (std::size_t p = 0; p < home_of.size(); ++p) {
        if (!touch_.is_loose(static_cast<int>(p))) {
            if (home.empty() || home_of[p] != home.back()) home.push_back(home_of[p]);
            near_set_[p] = static_cast<int>(home.size()) - 1;
        }
        const Vec3 at = points().reference(p, matter_->particle_reference);
        own_place_[p] = ((at - lattice.origin) / lattice.spacing).cast<float>();
    }
    near_.assign(home.size(), {});
    parallel_chunks(home.size(), kSets, [&](std::size_t begin, std::size_t end) {
        std::vector<Vec3i> open;
        for (std::size_t s = begin; s < end; ++s) {
            auto& set = near_[s];
            const auto visit = [&](const Vec3i& at) {
                if (!in_box(at)) return false;
                const int bit = bit_of(at);
                if (set[bit / 64] >> (bit % 64) & 1) return true;
                const CellId cell = lattice.cell_at(home[s] + at);
                if (cell < 0 || !touch_.whole()[cell]) return false;
                set[bit / 64] |= std::uint64_t(1) << (bit % 64);
                open.push_back(at);
                return true;
            };
            // A sliver may be no cell: then its neighbours begin.
            if (!visit(Vec3i::Zero())) {
                for (int n = 0; n < 27; ++n) visit(neighbor_step(n));
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
    if (near_set_[point] < 0) return false;
    const Vec3i at = site - touch_.home()[point];
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
    const bool is_face = static_cast<std::size_t>(point) >= touch_.own();
    if (is_face && far < kApart && !matter_->connection[0].damage.empty()) {
        return from(kClosed, kApart);
    }
    return {1, Vec3::Zero()};
}

}  // namespace swage

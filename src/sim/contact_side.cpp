// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_side.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "matter/broken_cells.h"
#include "sim/surface_modulus.h"

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

// Which homes' boxes hold a cell that is whole and was not, or the other way: by bins of kBin
// cells.
class ChangedBins {
  public:
    ChangedBins(const Lattice& lattice, const std::vector<char>& were, const std::vector<char>& are)
        : cells_(lattice.cell_count), bins_(bin_of(cells_) + Vec3i::Ones()) {
        if (were.empty()) return;
        mark_.assign(std::size_t(bins_.prod()), 0);
        for (const CellRun& run : lattice.cell_run) {
            for (int n = 0; n < run.count; ++n) {
                const CellId cell = run.first + n;
                if (were[cell] != are[cell]) mark({run.i + n, run.j, run.k});
            }
        }
    }
    bool touch(const Vec3i& home) const { return mark_.empty() || mark_[index_of(bin_at(home))]; }

  private:
    static constexpr int kBin = kNear;
    static Vec3i bin_of(const Vec3i& site) { return site / kBin; }
    // A home may lie a little outside of the lattice's box: then what lies within reach of it does
    // of the nearest site inside too.
    Vec3i bin_at(const Vec3i& site) const {
        return bin_of(site.cwiseMax(0).cwiseMin(cells_ - Vec3i::Ones()));
    }
    std::size_t index_of(const Vec3i& bin) const {
        return std::size_t(bin.x()) +
               std::size_t(bins_.x()) *
                   (std::size_t(bin.y()) + std::size_t(bins_.y()) * std::size_t(bin.z()));
    }
    void mark(const Vec3i& site) {
        const Vec3i low = bin_at(site - Vec3i::Constant(kNear)),
                    high = bin_at(site + Vec3i::Constant(kNear));
        for (int k = low.z(); k <= high.z(); ++k) {
            for (int j = low.y(); j <= high.y(); ++j) {
                for (int i = low.x(); i <= high.x(); ++i) mark_[index_of({i, j, k})] = 1;
            }
        }
    }

    Vec3i cells_, bins_;
    std::vector<char> mark_;  // empty: all
};

// Floods from a home through whole cells, within its box: by rows along x.
void flood(const Lattice& lattice, const std::vector<char>& whole, const Vec3i& home,
           std::array<std::uint64_t, 12>& set) {
    constexpr int kRows = kBox * kBox;
    std::array<unsigned, kRows> open{}, reached{};
    for (int row = 0; row < kRows; ++row) {
        const int j = home.y() + row % kBox - kNear, k = home.z() + row / kBox - kNear,
                  low = home.x() - kNear;
        if (j < 0 || k < 0 || j >= lattice.cell_count.y() || k >= lattice.cell_count.z()) continue;
        for (const CellRun& run : lattice.cell_runs(j, k)) {
            const int end = std::min(run.i + run.count, low + kBox);
            for (int i = std::max(run.i, low); i < end; ++i) {
                open[row] |= unsigned(whole[run.first + i - run.i] != 0) << (i - low);
            }
        }
    }
    std::array<char, kRows> waits{};
    std::vector<int> next;
    const auto reach = [&](int row, unsigned cells) {
        const unsigned more = cells & open[row] & ~reached[row];
        if (more == 0) return;
        reached[row] |= more;
        if (!std::exchange(waits[row], 1)) next.push_back(row);
    };
    constexpr int kHome = kRows / 2;
    reach(kHome, 1u << kNear);
    // A sliver may be no cell: then its neighbours begin.
    for (int n = 0; n < 9 && (open[kHome] >> kNear & 1) == 0; ++n) {
        reach(kHome + n % 3 - 1 + kBox * (n / 3 - 1), 7u << (kNear - 1));
    }
    while (!next.empty()) {
        const int row = next.back();
        next.pop_back();
        waits[row] = 0;
        for (unsigned was = 0; was != reached[row];) {
            was = reached[row];
            reached[row] |= (was << 1 | was >> 1) & open[row];
        }
        const int j = row % kBox, k = row / kBox;
        if (j > 0) reach(row - 1, reached[row]);
        if (j < kBox - 1) reach(row + 1, reached[row]);
        if (k > 0) reach(row - kBox, reached[row]);
        if (k < kBox - 1) reach(row + kBox, reached[row]);
    }
    set.fill(0);
    for (int row = 0; row < kRows; ++row) {
        const int bit = row * kBox, word = bit / 64, at = bit % 64;
        set[word] |= std::uint64_t(reached[row]) << at;
        if (at > 64 - kBox) set[word + 1] |= std::uint64_t(reached[row]) >> (64 - at);
    }
}

}  // namespace

ContactSide::ContactSide(Aggregate& matter, bool itself, std::shared_ptr<const RestSurface> molded)
    : matter_(&matter),
      patch_(matter),
      itself_(itself),
      touch_(matter, false),
      molded_(molded ? std::move(molded) : std::make_shared<const RestSurface>(matter)) {
    find_cells();
}

ContactSide::ContactSide(Aggregate& matter, std::shared_ptr<const RestSurface> molded,
                         std::shared_ptr<const CutSurface> ends)
    : matter_(&matter),
      patch_(matter),
      itself_(false),
      touch_(matter, false),
      molded_(std::move(molded)),
      ends_(std::move(ends)) {
    find_cells();
}

void ContactSide::connections_changed() {
    touch_.connections_changed(*matter_);
    find_cells();
}

void ContactSide::leave_out(const std::vector<ParticleId>& particles) {
    touch_.leave_out(particles);
    find_cells();
}

double ContactSide::give(Solver solver) {
    if (!give_) give_ = surface_modulus(*matter_, solver) / matter_->lattice.spacing;
    return *give_;
}

std::shared_ptr<const PointStiffness> ContactSide::stiffness_on(const OtherSide& other,
                                                                Solver solver) {
    for (const auto& known : stiffness_on_) {
        if (known->on == other) return known;
    }
    std::erase_if(stiffness_on_, [](const auto& known) { return known.use_count() == 1; });
    return stiffness_on_.emplace_back(
        std::make_shared<const PointStiffness>(*matter_, points(), other, solver));
}

void ContactSide::find_cells() {
    stiffness_on_.clear();
    rim_ = molded_->skin();
    if (is_thin() || touch_.size() > touch_.own()) {
        cut_ = is_thin() ? ends_ : std::make_shared<const CutSurface>(*matter_, touch_.whole());
        std::vector<CellId> both;
        std::set_union(rim_.begin(), rim_.end(), cut_->skin().begin(), cut_->skin().end(),
                       std::back_inserter(both));
        rim_ = std::move(both);
    }
    whole_rim_.clear();
    std::copy_if(rim_.begin(), rim_.end(), std::back_inserter(whole_rim_),
                 [&](CellId cell) { return is_whole(cell); });
    meeting_.clear();
    for (int p = 0; p < static_cast<int>(touch_.size()); ++p) {
        if (touch_.meets(p)) meeting_.push_back(p);
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
    if (itself_) {
        find_near();
        find_cracks();
    }
}

// Of the surface as molded, where a place in or beside the cell is near it: by the cell that holds
// the place, which a blade may have crossed, or by the last before it where there is none.
std::optional<RestSurface::Depth> ContactSide::molded_depth(const Vec3i& site, CellId cell,
                                                            const Vec3& place) const {
    const Vec3 beyond = place - place.cwiseMax(0.0).cwiseMin(1.0);
    const Vec3i out = Vec3i((beyond.array() > 0).cast<int>() - (beyond.array() < 0).cast<int>());
    const CellId beside = out.isZero() ? cell : matter_->lattice.cell_at(site + out);
    if (beside >= 0) {
        if (molded_->is_rim(beside)) return molded_->at(beside, place - out.cast<double>());
        if (molded_->is_rim(cell)) return molded_->at(cell, place);
        return {};
    }
    CellId last = -1;
    Vec3 local = place;
    double least = std::numeric_limits<double>::infinity();
    for (int axes = 0; axes < 7; ++axes) {
        const Vec3i step = out.cwiseProduct(corner_step(axes));
        const CellId there = step.isZero() ? cell : matter_->lattice.cell_at(site + step);
        if (there < 0 || !molded_->is_rim(there)) continue;
        const Vec3 left = beyond.cwiseProduct((step - out).cast<double>());
        if (left.squaredNorm() >= least) continue;
        least = left.squaredNorm();
        last = there;
        local = place - step.cast<double>();
    }
    if (last < 0) return {};
    return is_thin() ? molded_->at(last, local) : molded_->at_sliver(last, local);
}

// It may lie beyond its cells, which reach half-way only.
RestSurface::Depth ContactSide::thin_depth(const Vec3i& site, CellId cell, const Vec3& place,
                                           const Vec3& met) const {
    RestSurface::Depth depth{-CutSurface::kBeforeCut, Vec3::Zero()};
    if (cut_->is_rim(cell)) depth = cut_->at(cell, place, met);
    const std::optional<RestSurface::Depth> own = molded_depth(site, cell, place);
    if (own && own->distance > depth.distance && !CutSurface::is_opposed(own->gradient, met)) {
        depth = *own;
    }
    const Vec3 out = place - place.cwiseMax(0.0).cwiseMin(1.0);
    const double far = out.norm();
    if (far > 0 && far - beyond(cell) > depth.distance) depth = {far - beyond(cell), out / far};
    return depth;
}

RestSurface::Depth ContactSide::least_depth(const Vec3i& site, CellId cell,
                                            const Vec3& place) const {
    const std::optional<RestSurface::Depth> own = molded_depth(site, cell, place);
    if (!cut_->is_rim(cell)) return *own;
    RestSurface::Depth face = cut_->at(cell, place);
    // The new surface is no farther before the face, so that nothing that is held there is let go
    // at once.
    const Vec3 out = place - place.cwiseMax(0.0).cwiseMin(1.0);
    const double far = out.norm();
    const double most = beyond(cell);
    if (far > 0 && most > CutSurface::kBeforeBreak && face.distance < -most) {
        const double left = 1 - far / most;  // of what is deeper, so that it does not jump there
        face = {left * face.distance, left * face.gradient - face.distance / (most * far) * out};
    } else if (far > 0 && far - most > face.distance) {
        face = {far - most, out / far};
    }
    return own && own->distance > face.distance ? *own : face;
}

// Only where cells have broken, or are whole again, is anything else connected than before: a break
// that asked all points anew took a third of the run in which a calf of plaster goes to pieces.
void ContactSide::find_near() {
    const Lattice& lattice = matter_->lattice;
    const std::vector<Vec3i>& home_of = touch_.home();
    const std::size_t were = set_home_.size();
    for (std::size_t p = own_place_.size(); p < home_of.size(); ++p) {
        const bool is_loose = touch_.is_loose(static_cast<int>(p));
        // Points that follow one another and share a home share its set.
        if (!is_loose && (set_home_.empty() || home_of[p] != set_home_.back())) {
            set_home_.push_back(home_of[p]);
        }
        near_set_.push_back(is_loose ? -1 : static_cast<int>(set_home_.size()) - 1);
        const Vec3 at = points().reference(p, matter_->particle_reference);
        own_place_.emplace_back(((at - lattice.origin) / lattice.spacing).cast<float>());
    }
    near_.resize(set_home_.size());
    const ChangedBins changed(lattice, near_whole_, touch_.whole());
    parallel_chunks(near_.size(), kSets, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            if (s < were && !changed.touch(set_home_[s])) continue;
            flood(lattice, touch_.whole(), set_home_[s], near_[s]);
        }
    });
    near_whole_ = touch_.whole();
}

void ContactSide::forget_near() {
    own_place_.clear();
    near_set_.clear();
    near_.clear();
    set_home_.clear();
    near_whole_.clear();
}

void ContactSide::find_cracks() {
    is_crack_.assign(touch_.size() - touch_.own(), 0);
    for (const auto& [at, point] : touch_.faces()) {
        const auto& [cell, face] = at;
        if (!touch_.meets(point)) continue;
        const Vec3i beyond =
            touch_.home()[std::size_t(point)] + (face & 1 ? 1 : -1) * Vec3i::Unit(face >> 1);
        const Lattice& lattice = matter_->lattice;
        is_crack_[std::size_t(point) - touch_.own()] =
            closes_as_crack(*matter_, lattice.cell_row(lattice.cell_at(beyond)), face >> 1);
    }
    for (std::size_t n = 0; n < is_crack_.size(); ++n) {
        const int point = static_cast<int>(touch_.own() + n);
        if (!touch_.is_loose(point) || !touch_.meets(point)) continue;
        is_crack_[n] = stands_in_crack(point);
    }
}

// A particle by itself: all cells that it is a corner of.
bool ContactSide::stands_in_crack(int point) const {
    const Lattice& lattice = matter_->lattice;
    const Vec3i site = own_place(point).array().round().cast<int>();
    for (int corner = 0; corner < 8; ++corner) {
        const CellId cell = lattice.cell_at(site - Vec3i(corner & 1, corner >> 1 & 1, corner >> 2));
        for (int axis = 0; axis < 3 && cell >= 0; ++axis) {
            if (!closes_as_crack(*matter_, lattice.cell_row(cell), axis)) return false;
        }
    }
    return true;
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
    if (is_face && far < kApart && is_crack_[std::size_t(point) - touch_.own()]) {
        return from(kClosed, kApart);
    }
    return {1, Vec3::Zero()};
}

}  // namespace swage

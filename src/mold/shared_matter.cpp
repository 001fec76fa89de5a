// SPDX-License-Identifier: GPL-3.0-or-later
// What a cell holds is taken to fill the box about its centroid that reaches to the nearest faces,
// as moments.cpp has it. Where the cell is now that box is laid out in blocks about as wide as a
// new cell, or half as wide where it fills its own in part. Each lies along the new lattice's axes,
// as wide along each as its own edges reach there together (so that of a turned one the second
// moments stay), and is shared out by what it has in common with the boxes of the new cells:
// exactly, where both lattices' axes are the same.
#include "mold/shared_matter.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/whole.h"
#include "geometry/box.h"
#include "matter/cell_parts.h"

namespace swage {

namespace {

constexpr double kFull = 0.99;      // of a cell's width: what it holds fills it
constexpr int kBlocksOfPart = 2;    // along a new cell, of what fills its own in part
constexpr int kMostBlocks = 64;     // along an axis of a cell: of one drawn out beyond all measure
constexpr double kThinnest = 1e-3;  // of boxes [cells]
constexpr double kTouches = 1e-9;   // what round-off makes of a face that boxes share [cells]
constexpr std::size_t kChunk = 256, kBatch = 64 * kChunk;  // parts

Vec3 size_about(const Vec3& centroid) {
    return (Vec3::Ones() - 2 * centroid.cwiseAbs()).cwiseMax(kThinnest);
}

// Where a cell's places are now; each -0.5 to 0.5.
class PresentCell {
  public:
    PresentCell(const Aggregate& matter, CellId cell) : spacing_(matter.lattice.spacing) {
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        for (int c = 0; c < 8; ++c) corner_[c] = matter.particle_position.at(corner[c]);
        whole_ = corners_hang_together(matter, corner);
        if (!whole_) group_ = corner_groups(matter, corner);
        for (int c = 0; c < 8; ++c) {
            for (int d = 0; d < 3; ++d) edges_.col(d) += (c >> d & 1 ? 0.25 : -0.25) * corner_[c];
        }
    }
    bool is_whole() const { return whole_; }
    Vec3 at(const Vec3& place) const {
        if (!whole_) return in_piece(place).middle;
        Vec3 sum = Vec3::Zero();
        for (int c = 0; c < 8; ++c) {
            double weight = 1;
            for (int d = 0; d < 3; ++d) weight *= c >> d & 1 ? 0.5 + place[d] : 0.5 - place[d];
            sum += weight * corner_[c];
        }
        return sum;
    }
    // Along its three axes there [m].
    Mat3 edges(const Vec3& place) const { return whole_ ? edges_ : in_piece(place).edges; }

  private:
    struct Piece {
        Vec3 middle;
        Mat3 edges;
    };
    // What is torn goes with the corners that hang together with its own, as if these were rigid.
    Piece in_piece(const Vec3& place) const {
        int own = 0;
        for (int d = 0; d < 3; ++d) own |= place[d] > 0 ? 1 << d : 0;
        const auto was = [](int c) -> Vec3 {
            return corner_step(c).cast<double>() - Vec3::Constant(0.5);
        };
        Vec3 now = Vec3::Zero(), before = Vec3::Zero();
        int count = 0;
        for (int c = 0; c < 8; ++c) {
            if (group_[own] >> c & 1) now += corner_[c], before += was(c), ++count;
        }
        now /= count, before /= count;
        Mat3 together = Mat3::Zero();
        for (int c = 0; c < 8; ++c) {
            if (group_[own] >> c & 1) {
                together += (corner_[c] - now) * (was(c) - before).transpose();
            }
        }
        const Mat3 turn = nearest_rotation(together / spacing_);
        return {now + spacing_ * (turn * (place - before)), spacing_ * turn};
    }

    double spacing_;
    std::array<Vec3, 8> corner_;
    bool whole_;
    CornerGroups group_{};
    Mat3 edges_ = Mat3::Zero();
};

// What is molded anew, part by part. Places are told in cells from the lattice's origin.
class NewMatter {
  public:
    NewMatter(const Aggregate& matter, const std::vector<MatterPart>& part)
        : lattice_(matter.lattice), part_(part), first_(matter.cell_fill.size() + 1, 0) {
        for (const MatterPart& one : part) ++first_[one.cell + 1];
        for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    }
    // -1: the site has none of that material.
    int find(const Vec3i& site, std::size_t material) const {
        const CellId cell = lattice_.cell_at(site);
        if (cell < 0) return -1;
        for (int n = first_[cell]; n < first_[cell + 1]; ++n) {
            if (part_[n].material == material) return n;
        }
        return -1;
    }
    // That of the cells around a place which is nearest to it; -1: there is none.
    int find_around(const Vec3& place, std::size_t material) const {
        const Vec3i site = site_of(place);
        int nearest = -1;
        double least = 0;
        for (int n = 0; n < 27; ++n) {
            const Vec3i at = site + neighbor_step(n);
            const int found = find(at, material);
            if (found < 0) continue;
            const double far = (middle(found, at) - place).squaredNorm();
            if (nearest < 0 || far < least) nearest = found, least = far;
        }
        return nearest;
    }
    // What of it lies in a box [m3].
    double within(int part, const Vec3i& site, const Box& box) const {
        const Vec3 size = size_about(part_[part].centroid), at = middle(part, site);
        double share = 1;
        for (int d = 0; d < 3; ++d) {
            const double both = std::min(box.high[d], at[d] + 0.5 * size[d]) -
                                std::max(box.low[d], at[d] - 0.5 * size[d]);
            if (!(both > kTouches)) return 0;
            share *= both / size[d];
        }
        return part_[part].volume * share;
    }
    Vec3 place(const Vec3& at) const { return (at - lattice_.origin) / lattice_.spacing; }
    Vec3i last_site() const { return lattice_.cell_count - Vec3i::Ones(); }
    static Vec3i site_of(const Vec3& place) {
        constexpr double kFar = 1e9;  // outside of any lattice
        const auto along = [&](int d) {
            return to_int(std::floor(std::clamp(place[d], -kFar, kFar)));
        };
        return {along(0), along(1), along(2)};
    }
    double spacing() const { return lattice_.spacing; }

  private:
    Vec3 middle(int part, const Vec3i& site) const {
        return site.cast<double>() + Vec3::Constant(0.5) + part_[part].centroid;
    }

    const Lattice& lattice_;
    const std::vector<MatterPart>& part_;
    std::vector<int> first_;  // of each cell; one more at the end
};

// Shares parts out, one after the other.
class Sharing {
  public:
    Sharing(const NewMatter& to, std::vector<SharedMatter>& shared) : to_(to), shared_(shared) {}

    void begin(int from, std::size_t material) {
        from_ = from, material_ = material, own_ = shared_.size();
    }

    void add_block(const Vec3& place, const Vec3& width, double volume) {
        const Box box{place - 0.5 * width, place + 0.5 * width};
        const Vec3i first = NewMatter::site_of(box.low).cwiseMax(0),
                    last = NewMatter::site_of(box.high).cwiseMin(to_.last_site());
        found_.clear();
        double all = 0;
        Vec3i at;
        for (at.z() = first.z(); at.z() <= last.z(); ++at.z()) {
            for (at.y() = first.y(); at.y() <= last.y(); ++at.y()) {
                for (at.x() = first.x(); at.x() <= last.x(); ++at.x()) {
                    const int to = to_.find(at, material_);
                    const double share = to < 0 ? 0 : to_.within(to, at, box);
                    if (share > 0) found_.push_back({from_, to, share}), all += share;
                }
            }
        }
        for (const SharedMatter& one : found_) add(one.to, volume * (one.volume / all));
        if (!found_.empty()) return;
        const int to = to_.find_around(place, material_);
        if (to >= 0) add(to, volume);
    }

  private:
    void add(int to, double volume) {
        for (std::size_t n = own_; n < shared_.size(); ++n) {
            if (shared_[n].to != to) continue;
            shared_[n].volume += volume;
            return;
        }
        shared_.push_back({from_, to, volume});
    }

    const NewMatter& to_;
    std::vector<SharedMatter>& shared_;
    int from_ = 0;
    std::size_t material_ = 0, own_ = 0;  // its own from here on
    std::vector<SharedMatter> found_;
};

void share_out(const Aggregate& from, const MatterPart& part, const NewMatter& to,
               Sharing& sharing) {
    const PresentCell cell(from, part.cell);
    const Vec3 size = size_about(part.centroid);
    const double along = size.minCoeff() < kFull ? kBlocksOfPart : 1;
    Vec3i blocks;
    for (int d = 0; d < 3; ++d) {
        // A torn one's corners go their own ways.
        const double wide = size[d] * cell.edges(part.centroid).col(d).norm() / to.spacing();
        blocks[d] =
            cell.is_whole() ? std::clamp(to_int(std::round(along * wide)), 1, kMostBlocks) : 2;
    }
    const Vec3 step = size.cwiseQuotient(blocks.cast<double>());
    const double volume = part.volume / blocks.prod();
    Vec3i n;
    for (n.z() = 0; n.z() < blocks.z(); ++n.z()) {
        for (n.y() = 0; n.y() < blocks.y(); ++n.y()) {
            for (n.x() = 0; n.x() < blocks.x(); ++n.x()) {
                const Vec3 at = part.centroid - 0.5 * size +
                                step.cwiseProduct(n.cast<double>() + Vec3::Constant(0.5));
                const Mat3 edges = cell.edges(at) / to.spacing();
                const Vec3 width = (edges * step.asDiagonal()).rowwise().norm().cwiseMax(kThinnest);
                sharing.add_block(to.place(cell.at(at)), width, volume);
            }
        }
    }
}

}  // namespace

std::vector<MatterPart> matter_parts(const Aggregate& matter) {
    std::vector<MatterPart> parts;
    parts.reserve(matter.cell_fill.size() + matter.mixed_cell.size());
    const double whole = matter.lattice.cell_volume();
    auto mixed = matter.mixed_cell.begin();
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        const auto cell = static_cast<CellId>(c);
        const double volume = whole * matter.cell_fill[c];
        if (mixed == matter.mixed_cell.end() || mixed->cell != cell) {
            parts.push_back({cell, matter.material_number(cell), -1, volume,
                             matter.cell_centroid[c].cast<double>()});
            continue;
        }
        const double sum = double(mixed->fill[0]) + mixed->fill[1];
        for (int m : {0, 1}) {
            parts.push_back({cell, mixed->material[m], m, volume * mixed->fill[m] / sum,
                             mixed->centroid[m].cast<double>()});
        }
        ++mixed;
    }
    return parts;
}

void for_each_shared(const Aggregate& from, const std::vector<MatterPart>& part,
                     const Aggregate& to, const std::vector<MatterPart>& new_part,
                     const std::function<void(const SharedMatter&)>& see) {
    const NewMatter anew(to, new_part);
    // By batches, or what is shared would take more room than the bodies.
    for (std::size_t first = 0; first < part.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, part.size() - first);
        const auto found = parallel_parts(count, kChunk, [&](std::size_t begin, std::size_t end) {
            std::vector<SharedMatter> shared;
            Sharing sharing(anew, shared);
            for (std::size_t n = first + begin; n < first + end; ++n) {
                sharing.begin(static_cast<int>(n), part[n].material);
                share_out(from, part[n], anew, sharing);
            }
            return shared;
        });
        for (const std::vector<SharedMatter>& chunk : found) {
            for (const SharedMatter& one : chunk) see(one);
        }
    }
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: simple points for 6-connected bodies in an 18-connected outside, G. Bertrand and
// G. Malandain, "A new characterization of three-dimensional simple points", 1994.
#include "skin/voxel_thinning.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include "base/parallel.h"
#include "geometry/disjoint_sets.h"
#include "skin/cut_faces.h"

namespace swage {

namespace {

constexpr int kMostPasses = 8;
constexpr std::size_t kChunk = 16;  // runs of cells
constexpr float kFull = 0.99f;
// Spacings. NOTE: were all those taken that lie more outside than inside, each step that they leave
// would make a fold of the surface drawn around them.
constexpr double kOutside = 0.35;

// A bit for each of the 27 voxels around one, numbered (x + 1) + 3 (y + 1) + 9 (z + 1); 13 is the
// middle.
using Around = std::uint32_t;
constexpr int kMiddle = 13;
constexpr Around kAll = (1u << 27) - 1;

constexpr int steps_between(int a, int b) {
    const auto along = [](int p, int q) { return p > q ? p - q : q - p; };
    const int x = along(a % 3, b % 3), y = along(a / 3 % 3, b / 3 % 3), z = along(a / 9, b / 9);
    return x > 1 || y > 1 || z > 1 ? 4 : x + y + z;
}

// For each voxel those that it meets: at a face, at a face or an edge.
constexpr std::array<Around, 27> meeting_at_most(int steps) {
    std::array<Around, 27> met{};
    for (int n = 0; n < 27; ++n) {
        for (int m = 0; m < 27; ++m) {
            if (m != n && steps_between(n, m) <= steps) met[n] |= 1u << m;
        }
    }
    return met;
}
constexpr std::array<Around, 27> kByFaces = meeting_at_most(1), kByEdges = meeting_at_most(2);

Around met_by(Around some, const std::array<Around, 27>& meets) {
    Around met = 0;
    for (; some != 0; some &= some - 1) met |= meets[std::countr_zero(some)];
    return met;
}

// Whether of what hangs together among `member`, as voxels meet, one part alone meets the middle.
bool one_part_meets(Around member, const std::array<Around, 27>& meets) {
    const Around near = member & meets[kMiddle];
    if (near == 0) return false;
    Around part = near & -near;
    for (Around fresh = part; fresh != 0;) {
        fresh = met_by(fresh, meets) & member & ~part;
        part |= fresh;
    }
    return (near & ~part) == 0;
}

// Whether the middle may go without changing the topology of body and outside. NOTE: the surface
// parts what meets at a corner only, inside and outside. Were the outside to hang together over
// corners, holes of a voxel would be made that have a surface of their own.
bool is_simple(Around body) {
    constexpr Around kCenter = 1u << kMiddle;
    constexpr Around kSides = kByFaces[kMiddle], kBesideEdges = kByEdges[kMiddle] & ~kSides;
    const Around others = body & ~kCenter;
    // What meets the middle's edges counts where it meets a voxel at one of its faces.
    const Around lone = others & kBesideEdges & ~met_by(others & kSides, kByFaces);
    return one_part_meets(others & ~lone, kByFaces) &&
           one_part_meets(kAll & ~body & ~kCenter, kByEdges);
}

class Thinning {
  public:
    Thinning(const Aggregate& matter, const SurfaceSamples& samples)
        : matter_(matter), kept_(matter.cell_fill.size(), kAllCorners) {
        if (!samples.empty()) find_outside(samples);
    }

    std::vector<CornerMask> run() {
        thin();
        takes_rims_ = std::any_of(shelf_.begin(), shelf_.end(), [](CornerMask m) { return m; });
        if (takes_rims_) thin();
        return std::move(kept_);
    }

  private:
    void thin() {
        bool any = true;
        for (int pass = 0; any && pass < kMostPasses; ++pass) {
            any = false;
            for (Candidate& candidate : candidate_) {
                if (candidate.gone || !may_go(candidate)) continue;
                kept_[candidate.cell] &= static_cast<CornerMask>(~(1 << candidate.corner));
                candidate.gone = any = true;
                if (candidate.is_cut && !takes_rims_) add(shelf_, candidate);
            }
        }
    }

    struct Candidate {
        double height;  // of its middle above the surface, in spacings
        CellId cell;
        int corner;
        // That the voxels around it lie in, a bit for each axis along which they leave its own: -1
        // where there is none.
        std::array<CellId, 8> beside;
        bool is_cut;  // a connection near it is severed
        bool gone = false;
    };

    // The farthest out first.
    void find_outside(const SurfaceSamples& samples) {
        const std::vector<CellRun>& runs = matter_.lattice.cell_run;
        const auto find = [&](std::size_t begin, std::size_t end, std::vector<Candidate>& found) {
            for (std::size_t r = begin; r < end; ++r) {
                for (int n = 0; n < runs[r].count; ++n) {
                    find_in_cell(samples, runs[r].first + n, {runs[r].i + n, runs[r].j, runs[r].k},
                                 found);
                }
            }
        };
        candidate_ = parallel_collect<Candidate>(runs.size(), kChunk, find);
        hollow_.assign(kept_.size(), 0);
        shelf_ = hollow_;
        for (const Candidate& candidate : candidate_) add(hollow_, candidate);
        std::stable_sort(
            candidate_.begin(), candidate_.end(),
            [](const Candidate& p, const Candidate& q) { return p.height > q.height; });
    }

    void find_in_cell(const SurfaceSamples& samples, CellId cell, const Vec3i& site,
                      std::vector<Candidate>& found) const {
        if (matter_.cell_fill[cell] >= kFull) return;
        const bool is_held = lies_by_full(site);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3i half = corner_step(corner);
            const std::array<CellId, 8> beside = cells_beside(site, half);
            const bool is_cut = !all_whole(beside);
            if (!is_held && !is_cut) continue;
            const Vec3 middle = (site.cast<double>() + 0.5 * half.cast<double>()).array() + 0.25;
            const double height =
                samples.height(matter_.lattice.origin + matter_.lattice.spacing * middle);
            const bool goes =
                height > kOutside || (is_cut && holds_nothing(samples, cell, corner, site));
            if (goes) found.push_back({height, cell, corner, beside, is_cut});
        }
    }

    std::array<CellId, 8> cells_beside(const Vec3i& site, const Vec3i& half) const {
        std::array<CellId, 8> beside;
        for (int n = 0; n < 8; ++n) {
            const Vec3i at = site + corner_step(n).cwiseProduct(2 * half - Vec3i::Ones());
            beside[n] = matter_.lattice.cell_at(at);
        }
        return beside;
    }

    // Of a voxel at a cut what lies between its particle and the cut, which may be more than the
    // voxel or less: whether all of that is outside. NOTE: a blade that misses the surface by less
    // than a cell leaves particles beyond it that hold nothing: a shelf of voxels, whose points,
    // drawn to the surface and to the cut, ran to where these are nearest, in splinters of several
    // cells.
    bool holds_nothing(const SurfaceSamples& samples, CellId cell, int corner,
                       const Vec3i& site) const {
        const Lattice& lattice = matter_.lattice;
        const Vec3i own = site + corner_step(corner);
        const std::optional<CutTarget> cut = cut_plane_near(matter_, own);
        if (!cut) return false;
        const std::array<ParticleId, 8> particle = lattice.cell_corners(cell);
        Vec3 reach;
        for (int d = 0; d < 3; ++d) {
            const bool severed = matter_.connection[d].weight[particle[corner & ~(1 << d)]] <= 0;
            reach[d] = (corner >> d & 1 ? -1 : 1) * (severed ? 1 : 0.5);
        }
        std::array<Vec3, 8> end;
        std::array<double, 8> over;  // the cut, on the particle's side
        for (int c = 0; c < 8; ++c) {
            end[c] = own.cast<double>() + corner_step(c).cast<double>().cwiseProduct(reach);
            over[c] = cut->normal.dot(end[c]) - cut->height;
        }
        const bool is_under = over[0] < 0;
        const auto is_outside = [&](const Vec3& at) {
            return samples.height(lattice.origin + lattice.spacing * at) > 0;
        };
        for (int c = 0; c < 8; ++c) {
            if ((over[c] < 0) == is_under && !is_outside(end[c])) return false;
            for (int d = 0; d < 3; ++d) {
                const int next = c | 1 << d;
                if (next == c || (over[c] < 0) == (over[next] < 0)) continue;
                const double share = over[c] / (over[c] - over[next]);
                if (!is_outside(end[c] + share * (end[next] - end[c]))) return false;
            }
        }
        return true;
    }

    // No blade ran near. NOTE: where matter broke the surface goes on as it was molded.
    bool all_whole(const std::array<CellId, 8>& cells) const {
        return std::all_of(cells.begin(), cells.end(), [&](CellId cell) {
            if (cell < 0) return true;
            const auto corner = matter_.lattice.cell_corners(cell);
            return std::ranges::none_of(kCellConnection, [&](const CellConnection& link) {
                const ConnectionArrays& all = matter_.connection[link.direction];
                const ParticleId lower = corner[link.corner];
                return all.weight[lower] <= 0 && (all.damage.empty() || all.damage[lower] < 1);
            });
        });
    }

    // NOTE: of parts thinner than cells nothing may be left to hold what is taken away.
    bool lies_by_full(const Vec3i& site) const {
        for (int n = 0; n < 27; ++n) {
            const CellId cell = matter_.lattice.cell_at(site + neighbor_step(n));
            if (cell >= 0 && matter_.cell_fill[cell] >= kFull) return true;
        }
        return false;
    }

    // A voxel around a candidate: its cell, or -1, and its corner there.
    struct Voxel {
        CellId cell = -1;
        int corner = 0;
    };
    static bool has(const std::vector<CornerMask>& mask, const Voxel& voxel) {
        return voxel.cell >= 0 && mask[voxel.cell] >> voxel.corner & 1;
    }
    static void add(std::vector<CornerMask>& mask, const Candidate& candidate) {
        mask[candidate.cell] |= static_cast<CornerMask>(1 << candidate.corner);
    }
    static Voxel voxel_around(const Candidate& candidate, int n) {
        int leaves = 0, bits = 0;
        for (int d = 0, rest = n; d < 3; ++d, rest /= 3) {
            // -1 to 2; in the cell 0 or 1
            const int at = (candidate.corner >> d & 1) + rest % 3 - 1;
            leaves |= (at < 0 || at > 1) << d;
            bits |= (at & 1) << d;
        }
        return {candidate.beside[leaves], bits};
    }

    // NOTE: voxels beside those that hold something are the rim of the cut, where uneven steps
    // would fold the faces drawn around them. They go only where a shelf beyond them has gone, for
    // they would be left as a thread.
    bool may_go(const Candidate& candidate) const {
        std::array<Voxel, 27> voxel;
        Around body = 0;
        for (int n = 0; n < 27; ++n) {
            voxel[n] = voxel_around(candidate, n);
            if (has(kept_, voxel[n])) body |= 1u << n;
        }
        if (candidate.is_cut) {
            if (!keep_own_side(voxel, body)) return false;
            bool at_rim = false, at_shelf = false;
            for (int n = 0; n < 27; ++n) {
                at_rim |= (body >> n & 1) && !has(hollow_, voxel[n]);
                at_shelf |= has(shelf_, voxel[n]);
            }
            if (at_rim && !(takes_rims_ && at_shelf)) return false;
        }
        return is_simple(body);
    }

    // Of the body around a candidate what hangs together with it there; false where a cut ends
    // within that, whose two sides are one.
    bool keep_own_side(const std::array<Voxel, 27>& voxel, Around& body) const {
        const auto joined = [&](int low, int axis, int high) {
            if (voxel[low].cell != voxel[high].cell) return true;  // the same particle
            const auto corner = matter_.lattice.cell_corners(voxel[low].cell);
            return matter_.connection[axis].weight[corner[voxel[low].corner]] > 0;
        };
        constexpr std::array<int, 3> kStep = {1, 3, 9};
        DisjointSets sets(27);
        const auto for_each_pair = [&](const auto& act) {
            for (int n = 0; n < 27; ++n) {
                for (int axis = 0; axis < 3; ++axis) {
                    const int next = n + kStep[axis];
                    if (n / kStep[axis] % 3 < 2 && (body >> n & 1) && (body >> next & 1)) {
                        act(n, next, joined(n, axis, next));
                    }
                }
            }
        };
        for_each_pair([&](int low, int high, bool is) {
            if (is) sets.unite(low, high);
        });
        bool ends = false;
        for_each_pair([&](int low, int high, bool is) {
            ends |=
                !is && sets.root(low) == sets.root(high) && sets.root(low) == sets.root(kMiddle);
        });
        for (int n = 0; n < 27; ++n) {
            if (sets.root(n) != sets.root(kMiddle)) body &= ~(1u << n);
        }
        return !ends;
    }

    const Aggregate& matter_;
    std::vector<CornerMask> kept_;
    std::vector<CornerMask> hollow_;  // all candidates
    std::vector<CornerMask> shelf_;   // those at cuts that went before rims did
    bool takes_rims_ = false;
    std::vector<Candidate> candidate_;
};

}  // namespace

std::vector<CornerMask> voxels_to_draw(const Aggregate& matter, const SurfaceSamples& samples) {
    return Thinning(matter, samples).run();
}

}  // namespace swage

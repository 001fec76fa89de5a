// SPDX-License-Identifier: GPL-3.0-or-later
// Volume of a cube below a plane: R. Scardovelli & S. Zaleski, Analytical relations connecting
// linear interfaces and volume fractions in rectangular grids, J. Comput. Phys. 164, 2000.
#include "matter/piece_shares.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "matter/cut_planes.h"

namespace swage {

namespace {

constexpr double kFlat = 1e-7;    // of a normal's sum, below which a component counts as that
constexpr double kNarrow = 1e-3;  // of a cell, that what it holds reaches along an axis at least
constexpr double kBarely = 1e-9;  // what a corner on a plane counts for

// What one material has of a cell.
struct Part {
    double mass;    // [kg]
    Vec3 centroid;  // in the cell, each -0.5 to 0.5
};

struct Parts {
    std::array<Part, 2> part{};
    int count = 0;
};

Parts parts_of(const Aggregate& matter, CellId cell) {
    const double volume = matter.lattice.cell_volume();
    const MixedCell* const mixed = matter.mixed_at(cell);
    if (mixed == nullptr) {
        return {{Part{volume * matter.material_of(cell).density * matter.cell_fill[cell],
                      matter.cell_centroid[cell].cast<double>()}},
                1};
    }
    Parts parts{{}, 2};
    for (int m : {0, 1}) {
        parts.part[m] = {volume * matter.material_at(mixed->material[m]).density * mixed->fill[m],
                         mixed->centroid[m].cast<double>()};
    }
    return parts;
}

// A cell between pieces, whose corners these are of: what lies on the same side of all paths
// belongs to the corners there, those farthest from them the more.
class SharedCell {
  public:
    // `middle`: of the cell, in cells from the lattice's origin.
    SharedCell(const CutPlanes& cuts, const Vec3& middle, const std::array<int, 8>& piece)
        : plane_(cuts.around(middle)), middle_(middle), piece_(piece) {
        for (int c = 0; c < 8; ++c) {
            weight_[c] = 1;
            for (std::size_t n = 0; n < plane_.size(); ++n) {
                const double high = plane_[n].height(middle + 0.5 * outward(c));
                side_[c] |= int(high >= 0) << n;
                weight_[c] = std::min(weight_[c], std::max(std::abs(high), kBarely));
            }
            counts_[side_[c]] += weight_[c];
        }
    }
    // Gives the corners' pieces what they have of the part, eighth by eighth: give(piece, mass,
    // where in the cell). It is taken to fill what is left symmetrically about its centroid, as
    // molding has it (mold/moments.cpp).
    template <typename Give>
    void share_out(const Part& part, const Give& give) const {
        const Vec3 width = (0.5 * Vec3::Ones() - part.centroid.cwiseAbs()).cwiseMax(kNarrow);
        for (int e = 0; e < 8; ++e) {
            const Vec3 place = part.centroid + 0.5 * width.cwiseProduct(outward(e));
            const std::array<double, kSides> share = shares(place, width);
            double all = 0;
            for (double s : share) all += s;
            for (int c = 0; c < 8; ++c) {
                const int s = side_[c];
                const double own = all > 0 ? share[s] / all * weight_[c] / counts_[s] : 0.125;
                give(piece_[c], own * part.mass / 8, place);
            }
        }
    }

  private:
    static constexpr int kSides = 8;  // of three planes

    static Vec3 outward(int corner) {
        return 2 * corner_step(corner).cast<double>() - Vec3::Ones();
    }
    // Of a box in the cell what lies on each side that has corners.
    std::array<double, kSides> shares(const Vec3& place, const Vec3& width) const {
        std::array<double, kSides> share;
        for (int s = 0; s < kSides; ++s) share[s] = counts_[s] > 0 ? 1 : 0;
        for (std::size_t n = 0; n < plane_.size(); ++n) {
            const Vec3 normal = plane_[n].slope(middle_ + place);
            const double below =
                share_of_cube(width.cwiseProduct(normal), -plane_[n].height(middle_ + place));
            for (int s = 0; s < kSides; ++s) share[s] *= s >> n & 1 ? 1 - below : below;
        }
        return share;
    }

    std::vector<CutPlane> plane_;
    const Vec3 middle_;
    const std::array<int, 8>& piece_;
    std::array<int, 8> side_{};  // as bits, of which planes above
    std::array<double, 8> weight_;
    std::array<double, kSides> counts_{};
};

}  // namespace

double share_of_cube(const Vec3& normal, double distance) {
    Vec3 m = normal.cwiseAbs();
    const double sum = m.sum();
    if (!(sum > 0)) return distance > 0 ? 1 : 0;
    std::sort(m.data(), m.data() + 3);
    m = (m / sum).cwiseMax(kFlat);
    m /= m.sum();
    const double at = std::clamp(distance / sum + 0.5, 0.0, 1.0), a = std::min(at, 1 - at);
    const double both = m[0] + m[1], all = 6 * m[0] * m[1] * m[2];
    const auto less = [&](int n) { return m[n] * m[n] * (m[n] - 3 * a); };
    double below;
    if (a < m[0]) {
        below = a * a * a / all;
    } else if (a < m[1]) {
        below = a * (a - m[0]) / (2 * m[1] * m[2]) + m[0] * m[0] / (6 * m[1] * m[2]);
    } else if (a >= both && both < m[2]) {
        below = (2 * a - both) / (2 * m[2]);
    } else if (a < m[2]) {
        below = (a * a * (3 * both - a) + less(0) + less(1)) / all;
    } else {
        below = (a * a * (3 - 2 * a) + less(0) + less(1) + less(2)) / all;
    }
    return at <= 0.5 ? below : 1 - below;
}

std::vector<PieceShare> shares_of_pieces(const Aggregate& matter, const Pieces& pieces) {
    std::vector<PieceShare> all(static_cast<std::size_t>(pieces.count));
    const CutPlanes cuts(matter);
    const double a = matter.lattice.spacing;
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            std::array<int, 8> piece;
            for (int c = 0; c < 8; ++c) piece[c] = pieces.particle_piece[run.corner(n, c)];
            const Parts parts = parts_of(matter, run.first + n);
            const Vec3 middle = Vec3(run.i + n, run.j, run.k) + Vec3::Constant(0.5);
            const auto give = [&](int to, double mass, const Vec3& at) {
                all[to].mass += mass;
                all[to].moment += mass * (matter.lattice.origin + a * (middle + at));
            };
            std::optional<SharedCell> shared;
            if (!std::ranges::all_of(piece, [&](int p) { return p == piece[0]; })) {
                shared.emplace(cuts, middle, piece);
            }
            for (int p = 0; p < parts.count; ++p) {
                const Part& part = parts.part[p];
                for (int to : piece) all[to].at_particles += part.mass / 8;
                if (shared) {
                    shared->share_out(part, give);
                } else {
                    give(piece[0], part.mass, part.centroid);
                }
            }
        }
    }
    return all;
}

}  // namespace swage

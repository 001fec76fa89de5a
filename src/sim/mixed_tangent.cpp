// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/mixed_tangent.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/mixed_batch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kCellsPerChunk = 64;

// Of so many of its cells, from this one on.
template <int kWidth>
SWAGE_INLINE void some_matrices(const MixedBatch& batch, double turning, int begin,
                                CellMatrix* matrix) {
    typedef LanesOf<kWidth> V;
    const MixedLanes<kWidth> cells(batch, begin);
    const auto& [c, phase, normal, jump] = cells;
    const double spacing = batch.matter.lattice.spacing;
    Laminate<V> found;
    laminate(c, phase, normal, spacing, found, jump);
    const Columns<V> inverse = inverse_of(jump_slope(phase, normal, found, turning));
    for (int column = 0; column < CellMatrix::kSize; ++column) {
        V alone[3][8]{};
        alone[column % 3][column / 3] += 1.0;
        const CornerSums<V> r = laminate_slope(c, sum_corners(alone), phase, normal, spacing,
                                               found.jump, inverse, turning);
        V force[3][8];
        spread_corners(r, force);
        for (int row = 0; row <= column; ++row) {
            const V& f = force[row % 3][row / 3];
            const auto place = static_cast<std::size_t>(CellMatrix::place(row, column));
            for (int l = 0; l < std::min(kWidth, batch.count() - begin); ++l) {
                matrix[begin + l].upper[place] = -f[l];
            }
        }
    }
}

}  // namespace

MixedTangent::MixedTangent(const Aggregate& matter, const std::vector<float>& carried)
    : batches_(matter, carried), push_(batches_.cell.size()) {
    for (int n : batches_.cell)
        site_.push_back(matter.lattice.cell_site(matter.mixed_cell[n].cell));
}

const std::vector<CellMatrix>& MixedTangent::matrices(const Aggregate& matter,
                                                      TangentKind kind) const {
    for (const Known& known : known_) {
        if (known.kind == kind) return known.matrix;
    }
    const std::vector<MaterialLaw> laws = material_laws(matter, kind.flow);
    known_.push_back({kind, std::vector<CellMatrix>(batches_.cell.size())});
    std::vector<CellMatrix>& matrix = known_.back().matrix;
    parallel_for(batches_.count(), [&](std::size_t b) {
        const MixedBatch batch = mixed_batch(matter, laws, batches_, b);
        CellMatrix* const to = &matrix[batches_.first[b]];
        by_width([&]<int kWidth>() __attribute__((always_inline)) {
            for (int begin = 0; begin < batch.count(); begin += kWidth) {
                some_matrices<kWidth>(batch, kind.geometric, begin, to);
            }
        });
    });
    return matrix;
}

void MixedTangent::add_product(const Aggregate& matter, TangentKind kind,
                               const Vec3Array& direction, Vec3Array& result) {
    if (empty()) return;
    const std::vector<CellMatrix>& matrix = matrices(matter, kind);
    parallel_each(batches_.cell.size(), kCellsPerChunk, [&](std::size_t n) {
        double way[24], sum[24] = {};
        for (int c = 0; c < 8; ++c) {
            const Vec3 v = direction.at(batches_.corner[n][c]);
            for (int i = 0; i < 3; ++i) way[3 * c + i] = v[i];
        }
        const double* own = matrix[n].upper.data();
        for (int column = 0; column < 24; ++column) {
            double mine = 0;
            for (int row = 0; row < column; ++row, ++own) {
                mine += *own * way[row];
                sum[row] += *own * way[column];
            }
            sum[column] += mine + *own++ * way[column];
        }
        std::copy_n(sum, 24, push_[n].begin());
    });
    for (std::size_t n = 0; n < batches_.cell.size(); ++n) {
        for (int c = 0; c < 8; ++c) {
            result.add(batches_.corner[n][c],
                       {push_[n][3 * c], push_[n][3 * c + 1], push_[n][3 * c + 2]});
        }
    }
}

}  // namespace swage

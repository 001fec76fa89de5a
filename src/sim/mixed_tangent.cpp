// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/mixed_tangent.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/mixed_batch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kCellsPerChunk = 64;

struct TangentBatch {
    const Aggregate* matter;
    const MixedCell* cell[kLanes];
    const std::array<ParticleId, 8>* corner[kLanes];
    const MaterialLaw* law[2];
    double turning;
    CellMatrix* to;
    int count;
};

// Of so many of its cells, from this one on.
template <int kWidth>
SWAGE_INLINE void some_matrices(const TangentBatch& b, int first) {
    typedef LanesOf<kWidth> V;
    V at[3][8]{};
    Phase<V> phase[2]{};
    Triple<V> normal{};
    for (int p = 0; p < 2; ++p) {
        phase[p].law = &b.law[p]->moduli, phase[p].kind = b.law[p]->kind;
    }
    for (int l = 0; l < kWidth; ++l) {
        const int n = std::min(first + l, b.count - 1);
        read_mixed(b.matter->particle_position, *b.cell[n], *b.corner[n], l, at, phase, normal);
    }
    const double spacing = b.matter->lattice.spacing;
    const CornerSums<V> c = sum_corners(at);
    Laminate<V> found;
    laminate(c, phase, normal, spacing, found);
    const Columns<V> inverse = inverse_of(jump_slope(phase, normal, found, b.turning));
    for (int column = 0; column < CellMatrix::kSize; ++column) {
        V alone[3][8]{};
        alone[column % 3][column / 3] += 1.0;
        const CornerSums<V> r = laminate_slope(c, sum_corners(alone), phase, normal, spacing,
                                               found.jump, inverse, b.turning);
        V force[3][8];
        spread_corners(r, force);
        for (int row = 0; row <= column; ++row) {
            const V& f = force[row % 3][row / 3];
            for (int l = 0; l < std::min(kWidth, b.count - first); ++l) {
                b.to[first + l].upper[static_cast<std::size_t>(CellMatrix::place(row, column))] =
                    -f[l];
            }
        }
    }
}

template <int kWidth>
SWAGE_INLINE void all_matrices(const TangentBatch& b) {
    for (int first = 0; first < b.count; first += kWidth) some_matrices<kWidth>(b, first);
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
        TangentBatch batch{};
        batch.matter = &matter;
        batch.turning = kind.geometric;
        batch.count = batches_.first[b + 1] - batches_.first[b];
        for (int n = 0; n < batch.count; ++n) {
            batch.cell[n] = &matter.mixed_cell[batches_.cell[batches_.first[b] + n]];
            batch.corner[n] = &batches_.corner[batches_.first[b] + n];
        }
        for (int p = 0; p < 2; ++p) batch.law[p] = &laws[batch.cell[0]->material[p]];
        batch.to = matrix.data() + batches_.first[b];
        by_width([&]<int kWidth>() __attribute__((always_inline)) { all_matrices<kWidth>(batch); });
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

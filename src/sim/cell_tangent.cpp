// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_tangent.h"

#include <algorithm>

#include "base/parallel.h"
#include "laws/cell_forces.h"
#include "laws/dual.h"
#include "sim/cell_history.h"
#include "sim/row_groups.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kThreadRuns = 8;  // rows of cells that a thread is worth waking for

// Where the arrays of a run begin.
struct RunView {
    CornerRows x{};
    int count = 0;  // cells of the run
    CellId first = 0;
    const char* whole = nullptr;  // of each batch of kLanes cells
    const float* fill = nullptr;  // these go on behind the last cell
    const float* at[3] = {};
    HistoryRows history;  // of all cells
};

// What there is to do for one run of cells, or eight cells of it.
struct Task {
    const CellConstants& constants;
    const RunView& run;
    double turning;
};

template <typename V>
SWAGE_INLINE Triple<V> minus_slope(const Triple<Dual<V>>& a) {
    return {-a.x.slope, -a.y.slope, -a.z.slope};
}

// Minus the change of the cells' forces on their corners' sums.
template <CellKind kKind, typename V>
SWAGE_INLINE CornerSums<V> minus_slopes(const Task& task, int begin, const CornerSums<V>& x,
                                        const CornerSums<V>& way) {
    const RunView& run = task.run;
    using N = Dual<V>;
    const CornerSums<N> c = pair(x, way);
    const CellId first = run.first + begin;
    const CornerSums<N> r = by_share(
        !run.whole[begin / kLanes], can_flow(kKind) && run.history.hardening() != nullptr,
        [&]<bool kPart, bool kFlowed>() __attribute__((always_inline)) {
            CellShare<N> share{};
            CellHistory<N> history{};
            BackStrain<N> back;
            if constexpr (kPart) {
                share.fill = constant(load<V>(run.fill + begin));
                share.at = {constant(load<V>(run.at[0] + begin)),
                            constant(load<V>(run.at[1] + begin)),
                            constant(load<V>(run.at[2] + begin))};
            }
            if constexpr (kFlowed) history = constant(load_history<V>(run.history, first));
            if constexpr (kFlowed && kKind == CellKind::kinematic) {
                back = constant(load_back<V>(run.history, first));
            }
            return cell_forces<kKind, kPart, kFlowed>(task.constants, c, share, history,
                                                      task.turning, nullptr, &back);
        });
    return {minus_slope(r.x),  minus_slope(r.y),  minus_slope(r.z),  minus_slope(r.xy),
            minus_slope(r.yz), minus_slope(r.zx), minus_slope(r.xyz)};
}

// It is long: one copy of a kind and a width serves all tasks.
template <CellKind kKind, typename V>
SWAGE_INLINE CornerSums<V> tangent_forces(const Task& task, int begin, const CornerSums<V>& x,
                                          const CornerSums<V>& way) {
    CornerSums<V> result;
    in_width<kWidthOf<V>>([&]() __attribute__((always_inline)) {
        result = minus_slopes<kKind>(task, begin, x, way);
    });
    return result;
}

struct ProductTask : Task {
    CornerRows direction;
    CornerForces result;
};
// Tangents in terms of their coarse cells' corners, upper triangles by columns.
struct MatrixTask : Task {
    int begin;
    // Places of their low and high side in their coarse cells, along each axis, 0 to 1.
    Lanes low[3], high[3];
    Lanes* matrix;
};
// Some of eight lanes.
template <typename V>
SWAGE_INLINE V part_of(const Lanes& all, int first) {
    return load<V>(reinterpret_cast<const double*>(&all) + first);
}
template <typename V>
SWAGE_INLINE void put_part(const V& part, Lanes& all, int first) {
    store(part, reinterpret_cast<double*>(&all) + first);
}

template <CellKind kKind, int kWidth>
SWAGE_INLINE void act(const ProductTask& task) {
    typedef LanesOf<kWidth> V;
    const RunView& run = task.run;
    ForceCarry<V> carry;
    for (int begin = 0; begin < run.count; begin += kWidth) {
        const int count = std::min(kWidth, run.count - begin);
        const CornerSums<V> x = gather<V>(run.x, begin, count);
        const CornerSums<V> way = gather<V>(task.direction, begin, count);
        add_forces(tangent_forces<kKind>(task, begin, x, way), task.result, begin, count, carry);
    }
    if (run.count % kWidth == 0) add_carried(task.result, run.count, carry);
}

// Calls see(first, begin, x) for the cells of a batch, as many at a time as the vectors hold.
template <int kWidth, typename See>
SWAGE_INLINE void for_parts(const RunView& run, int batch, const See& see) {
    for (int first = 0; first < std::min(kLanes, run.count - batch); first += kWidth) {
        const int begin = batch + first, count = std::min(kWidth, run.count - begin);
        see(first, begin, gather<LanesOf<kWidth>>(run.x, begin, count));
    }
}

// The forces on all corners for a direction along one axis, from the sums of how far each goes.
template <CellKind kKind, typename V>
SWAGE_INLINE void forces_along(const Task& task, int begin, const CornerSums<V>& x,
                               const V (&sum)[7], int axis, V (&force)[3][8]) {
    const V none{};
    const auto along = [&](const V& v) __attribute__((always_inline)) {
        return Triple<V>{axis == 0 ? v : none, axis == 1 ? v : none, axis == 2 ? v : none};
    };
    const CornerSums<V> direction{along(sum[0]), along(sum[1]), along(sum[2]), along(sum[3]),
                                  along(sum[4]), along(sum[5]), along(sum[6])};
    spread_corners(tangent_forces<kKind>(task, begin, x, direction), force);
}

template <CellKind kKind, int kWidth>
SWAGE_INLINE void act(const MatrixTask& task) {
    typedef LanesOf<kWidth> V;
    for_parts<kWidth>(
        task.run, task.begin,
        [&](int first, int begin, const CornerSums<V>& x) __attribute__((always_inline)) {
            V low[3], high[3];
            for (int d = 0; d < 3; ++d) {
                low[d] = part_of<V>(task.low[d], first), high[d] = part_of<V>(task.high[d], first);
            }
            for (int corner = 0; corner < 8; ++corner) {
                V follow[8], sum[7];  // how the cell's corners follow this coarse corner
                for (int c = 0; c < 8; ++c) {
                    follow[c] = 1.0 + V{};
                    for (int d = 0; d < 3; ++d) {
                        const V t = c >> d & 1 ? high[d] : low[d];
                        follow[c] *= corner >> d & 1 ? t : 1.0 - t;
                    }
                }
                sum_corners(follow, sum[0], sum[1], sum[2], sum[3], sum[4], sum[5], sum[6]);
                for (int axis = 0; axis < 3; ++axis) {
                    const int column = 3 * corner + axis;
                    V force[3][8];
                    forces_along<kKind>(task, begin, x, sum, axis, force);
                    for (int i = 0; i < 3; ++i) {
                        // Back to the coarse corners, axis by axis.
                        V(&f)[8] = force[i];
                        for (int d = 0; d < 3; ++d) {
                            for (int c = 0; c < 8; ++c) {
                                if (c >> d & 1) continue;
                                const V one = f[c], other = f[c | 1 << d];
                                f[c | 1 << d] = low[d] * one + high[d] * other;
                                f[c] = (1.0 - low[d]) * one + (1.0 - high[d]) * other;
                            }
                        }
                        for (int c = 0; c < 8; ++c) {
                            const int row = 3 * c + i;
                            if (row > column) continue;
                            put_part(f[c], task.matrix[CellMatrix::place(row, column)], first);
                        }
                    }
                }
            }
        });
}

template <typename T>
void do_task(CellKind kind, const T& task) {
    by_kind(kind, [&]<CellKind kKind>() {
        by_width([&]<int kWidth>() __attribute__((always_inline)) { act<kKind, kWidth>(task); });
    });
}

}  // namespace

CellTangent::CellTangent(const Aggregate& matter, const std::vector<float>& fill)
    : slab_(cell_slabs(matter)), pieces_(matter, slab_), mixed_(matter, fill), fill_(fill) {
    for (const MixedCell& cell : matter.mixed_cell) fill_[cell.cell] = 0;
    fill_.resize(fill.size() + kLanes);
    for (int i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < matter.cell_centroid.size(); ++c) {
            at_[i].push_back(2 * matter.cell_centroid[c][i]);
        }
        at_[i].resize(at_[i].size() + kLanes);
    }
    for (const CellRun& run : pieces_.all(matter)) {
        batch_.push_back(whole_.size());
        for (int begin = 0; begin < run.count; begin += kLanes) {
            whole_.push_back(is_whole_batch(matter, fill_, run, begin));
        }
    }
}

struct CellTangent::Law {
    CellConstants constants;
    CellKind kind;
};

std::vector<CellTangent::Law> CellTangent::laws_for(const Aggregate& matter, Flow flow) const {
    std::vector<Law> laws;
    const bool is_plain = flow == Flow::none && matter.cell_history.empty();
    for (const auto& [moduli, kind] : material_laws(matter, flow)) {
        const bool is_elastic = is_plain && kind == CellKind::yielding;
        laws.push_back({CellConstants(moduli), is_elastic ? CellKind::elastic : kind});
    }
    return laws;
}

namespace {

RunView view_of(const Aggregate& matter, const CellRun& run, const std::vector<float>& fill,
                const std::array<std::vector<float>, 3>& at, const char* whole) {
    RunView view{.history = HistoryRows(matter)};
    view.x = corner_rows(matter.particle_position, run);
    view.count = run.count;
    view.first = run.first;
    view.whole = whole;
    view.fill = fill.data() + run.first;
    for (int i = 0; i < 3; ++i) view.at[i] = at[i].data() + run.first;
    return view;
}

}  // namespace

void CellTangent::product(const Aggregate& matter, Kind kind, const Vec3Array& direction,
                          Vec3Array& result) {
    const std::vector<Law> laws = laws_for(matter, kind.flow);
    const std::vector<CellRun>& all = pieces_.all(matter);
    result.resize(matter.particle_count());
    parallel_for(slab_.size(), [&](std::size_t index) {
        RowSlab& slab = slab_[index];
        const ForceRows to = force_rows(slab, result);
        for (double* component : to.own) {
            std::fill(component + slab.begin, component + slab.end, 0.0);
        }
        for (std::size_t r = pieces_.first_of(index); r < pieces_.first_of(index + 1); ++r) {
            const CellRun& run = all[r];
            const Law& law = laws[matter.material_number(run.first)];
            const RunView view = view_of(matter, run, fill_, at_, whole_.data() + batch_[r]);
            do_task(law.kind, ProductTask{{law.constants, view, kind.geometric},
                                          corner_rows(direction, run),
                                          corner_forces(slab, to, run)});
        }
    });
    add_seams(slab_, result);
    mixed_.add_product(matter, kind, direction, result);
}

std::vector<Mat3> CellTangent::own_blocks(const Aggregate& matter, Kind kind) const {
    const std::vector<Law> laws = laws_for(matter, kind.flow);
    const std::vector<CellRun>& all = pieces_.all(matter);
    std::vector<Mat3> own(matter.particle_count(), Mat3::Zero());
    // Rows of cells share particles with the next ones only: every other row of every other plane
    // at a time.
    const Vec3i& size = matter.lattice.cell_count;
    const RowGroups rows(all, size, Vec3i::Ones());
    for (int turn = 0; turn < 4; ++turn) {
        const int j = turn & 1, k = turn >> 1, across = (size.y() - j + 1) / 2,
                  up = (size.z() - k + 1) / 2;
        parallel_for(std::size_t(across) * up, all.size() / kThreadRuns, [&](std::size_t n) {
            const int row = static_cast<int>(n);
            Lanes matrix[std::tuple_size_v<decltype(CellMatrix::upper)>];
            for (std::size_t r : rows.of(2 * (row % across) + j, 2 * (row / across) + k)) {
                const CellRun& run = all[r];
                const Law& law = laws[matter.material_number(run.first)];
                const RunView view = view_of(matter, run, fill_, at_, whole_.data() + batch_[r]);
                for (int done = 0; done < run.count; done += kLanes) {
                    MatrixTask task{{law.constants, view, kind.geometric}, done, {}, {}, matrix};
                    for (Lanes& high : task.high)
                        high += 1.0;  // the cells are their own coarse ones
                    do_task(law.kind, task);
                    for (int l = 0; l < kLanes && done + l < run.count; ++l) {
                        for (int c = 0; c < 8; ++c) {
                            Mat3& to = own[run.corner(done + l, c)];
                            for (int i = 0; i < 3; ++i) {
                                for (int j = 0; j < 3; ++j) {
                                    const int place = CellMatrix::place(3 * c + std::min(i, j),
                                                                        3 * c + std::max(i, j));
                                    to(i, j) += matrix[place][l];
                                }
                            }
                        }
                    }
                }
            }
        });
    }
    if (mixed_.empty()) return own;
    const std::vector<CellMatrix>& mixed = mixed_.matrices(matter, kind);
    for (std::size_t n = 0; n < mixed.size(); ++n) {
        for (int c = 0; c < 8; ++c) {
            Mat3& to = own[mixed_.corner(n)[c]];
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) to(i, j) += mixed[n](3 * c + i, 3 * c + j);
            }
        }
    }
    return own;
}

namespace {

// sum += of a cell at `low` of so many in its coarse cell, whose particles follow its corners.
void add_followed(const CellMatrix& own, const Vec3i& low, const Vec3i& ratio, CellMatrix& sum) {
    double follow[8][8];  // corner of the coarse cell, of the cell
    for (int q = 0; q < 8; ++q) {
        for (int c = 0; c < 8; ++c) {
            follow[q][c] = 1;
            for (int d = 0; d < 3; ++d) {
                const double t = double(low[d] + (c >> d & 1)) / ratio[d];
                follow[q][c] *= q >> d & 1 ? t : 1 - t;
            }
        }
    }
    constexpr int kSize = CellMatrix::kSize;
    double half[kSize][kSize];  // rows of the cell, columns of the coarse one
    for (int row = 0; row < kSize; ++row) {
        for (int column = 0; column < kSize; ++column) {
            double one = 0;
            for (int c = 0; c < 8; ++c) one += follow[column / 3][c] * own(row, 3 * c + column % 3);
            half[row][column] = one;
        }
    }
    for (int column = 0; column < kSize; ++column) {
        for (int row = 0; row <= column; ++row) {
            double one = 0;
            for (int c = 0; c < 8; ++c) one += follow[row / 3][c] * half[3 * c + row % 3][column];
            sum.upper[CellMatrix::place(row, column)] += one;
        }
    }
}

}  // namespace

std::vector<CellMatrix> CellTangent::coarse_cells(const Aggregate& matter, Kind kind,
                                                  const Lattice& coarse, const Vec3i& ratio) const {
    const std::vector<Law> laws = laws_for(matter, kind.flow);
    const std::vector<CellRun>& all = pieces_.all(matter);
    std::size_t count = 0;
    for (const CellRun& run : coarse.cell_run) count += run.count;
    std::vector<CellMatrix> sum(count);
    const RowGroups rows(all, coarse.cell_count, ratio);
    parallel_for(rows.count(), all.size() / kThreadRuns, [&](std::size_t row) {
        Lanes matrix[std::tuple_size_v<decltype(CellMatrix::upper)>];
        for (std::size_t r : rows.of(row)) {
            const CellRun& run = all[r];
            const Law& law = laws[matter.material_number(run.first)];
            const RunView view = view_of(matter, run, fill_, at_, whole_.data() + batch_[r]);
            const Vec3i site(run.i, run.j, run.k);
            for (int done = 0; done < run.count; done += kLanes) {
                MatrixTask task{{law.constants, view, kind.geometric}, done, {}, {}, matrix};
                CellId cell[kLanes];
                const int many = std::min(kLanes, run.count - done);
                for (int l = 0; l < kLanes; ++l) {
                    const Vec3i at = site + Vec3i(done + l, 0, 0);
                    for (int d = 0; d < 3; ++d) {
                        task.low[d][l] = double(at[d] % ratio[d]) / ratio[d];
                        task.high[d][l] = double(at[d] % ratio[d] + 1) / ratio[d];
                    }
                    if (l < many) cell[l] = coarse.cell_at(at.cwiseQuotient(ratio));
                }
                do_task(law.kind, task);
                for (int l = 0; l < many; ++l) {
                    auto& to = sum[cell[l]].upper;
                    for (std::size_t e = 0; e < to.size(); ++e) to[e] += matrix[e][l];
                }
            }
        }
    });
    if (mixed_.empty()) return sum;
    const std::vector<CellMatrix>& mixed = mixed_.matrices(matter, kind);
    for (std::size_t n = 0; n < mixed.size(); ++n) {
        const Vec3i site = mixed_.site(n), at = site.cwiseQuotient(ratio);
        add_followed(mixed[n], site - at.cwiseProduct(ratio), ratio, sum[coarse.cell_at(at)]);
    }
    return sum;
}

}  // namespace swage

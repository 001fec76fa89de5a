// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_tangent.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "laws/cell.h"
#include "laws/dual.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

using Number = Dual<Lanes>;

constexpr std::size_t kSlabCells = 4096;
constexpr int kStrains = 6, kModes = 12;

// Where the arrays of a run begin; null history: nothing has flowed.
struct RunView {
    const double* x[3][4];
    const float* fill;
    const float* at[3];
    const float* strain[kStrains];
    const float* modes[kModes];
    const float* alpha;
    int count;
};

SWAGE_INLINE Lanes load(const double* from, int count) {
    Lanes v{};
    if (count >= kLanes) {
        std::memcpy(&v, from, sizeof v);
    } else {
        for (int l = 0; l < count; ++l) v[l] = from[l];
    }
    return v;
}
SWAGE_INLINE Lanes load(const float* from, int count) {
    Lanes v{};
    if (from == nullptr) return v;
    for (int l = 0; l < kLanes && l < count; ++l) v[l] = from[l];
    return v;
}
SWAGE_INLINE Number constant(const Lanes& v) { return {v, Lanes{}}; }

// Corners' sums of one vector field.
SWAGE_INLINE void gather(const double* const (&row)[3][4], int at, int count,
                         CornerSums<Lanes>& c) {
    Lanes v[8];
    const auto of = [&](int i) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            v[2 * q] = load(row[i][q] + at, count);
            v[2 * q + 1] = load(row[i][q] + at + 1, count);
        }
    };
    of(0);
    sum_corners(v, c.x.x, c.y.x, c.z.x, c.xy.x, c.yz.x, c.zx.x, c.xyz.x);
    of(1);
    sum_corners(v, c.x.y, c.y.y, c.z.y, c.xy.y, c.yz.y, c.zx.y, c.xyz.y);
    of(2);
    sum_corners(v, c.x.z, c.y.z, c.z.z, c.xy.z, c.yz.z, c.zx.z, c.xyz.z);
}

SWAGE_INLINE Triple<Number> pair(const Triple<Lanes>& v, const Triple<Lanes>& s) {
    return {{v.x, s.x}, {v.y, s.y}, {v.z, s.z}};
}
SWAGE_INLINE CornerSums<Number> pair(const CornerSums<Lanes>& v, const CornerSums<Lanes>& s) {
    return {pair(v.x, s.x),   pair(v.y, s.y),   pair(v.z, s.z),    pair(v.xy, s.xy),
            pair(v.yz, s.yz), pair(v.zx, s.zx), pair(v.xyz, s.xyz)};
}
SWAGE_INLINE Triple<Lanes> slope(const Triple<Number>& a) {
    return {a.x.slope, a.y.slope, a.z.slope};
}
SWAGE_INLINE Triple<Number> scale_slope(const Triple<Number>& a, double s) {
    return {{a.x.value, s * a.x.slope}, {a.y.value, s * a.y.slope}, {a.z.value, s * a.z.slope}};
}

// Minus the change of the cell's forces on its corners' sums.
template <bool kYields, bool kRubber>
SWAGE_INLINE CornerSums<Lanes> tangent_forces(const CellModuli& law, const RunView& run, int done,
                                              double geometric, const CornerSums<Lanes>& position,
                                              const CornerSums<Lanes>& direction) {
    const int left = run.count - done;
    const Lanes fill_value = load(run.fill + done, left);
    const Number fill = constant(fill_value);
    const Triple<Number> at = {constant(load(run.at[0] + done, left)),
                               constant(load(run.at[1] + done, left)),
                               constant(load(run.at[2] + done, left))};
    CornerSums<Number> c = pair(position, direction);
    Columns<Number> f = centroid_gradient(c, at, law.spacing);
    const CellModes<Number> modes = {transposed_times(f, c.xy), transposed_times(f, c.yz),
                                     transposed_times(f, c.zx), transposed_times(f, c.xyz)};
    const double volume = law.spacing * law.spacing * law.spacing;
    Columns<Number> first;
    CellModes<Number> mode_force;
    const auto freeze_turn = [&]() __attribute__((always_inline)) {
        for (Triple<Number>* v :
             {&c.x, &c.y, &c.z, &c.xy, &c.yz, &c.zx, &c.xyz, &f.x, &f.y, &f.z}) {
            *v = scale_slope(*v, geometric);
        }
    };
    if constexpr (kRubber) {
        const Number scale = volume * fill;
        first = rubber_stress(law, f);
        first = {scale * first.x, scale * first.y, scale * first.z};
        mode_force = mode_fill(fill) * mode_stress(law, modes);
        freeze_turn();
    } else {
        const CellStrain<Number> strain = cell_strain(f);
        Number kept = constant(1.0 + 0.0 * fill_value), size = trace(strain.log);
        Symmetric<Number> distortion = deviator(strain.log);
        CellModes<Number> elastic = modes;
        if constexpr (kYields) {
            const auto history = [&](const float* from) __attribute__((always_inline)) {
                return constant(load(from == nullptr ? from : from + done, left));
            };
            const auto mode = [&](int m) __attribute__((always_inline)) {
                return Triple<Number>{history(run.modes[m]), history(run.modes[m + 1]),
                                      history(run.modes[m + 2])};
            };
            const CellHistory<Number> committed = {
                {history(run.strain[0]), history(run.strain[1]), history(run.strain[2]),
                 history(run.strain[3]), history(run.strain[4]), history(run.strain[5])},
                {mode(0), mode(3), mode(6), mode(9)},
                history(run.alpha)};
            const CellFlowed<Number> r = flow_cell(law, committed, strain.log, modes, fill);
            kept = r.kept;
            size = r.trace;
            distortion = r.distortion;
            elastic = r.modes;
        }
        const Number pressure = law.bulk * size;
        Symmetric<Number> t = ((2 * law.shear) * kept) * distortion;
        t.xx = t.xx + pressure, t.yy = t.yy + pressure, t.zz = t.zz + pressure;
        const Symmetric<Number> stress = (volume * fill) * material_stress(strain, t);
        mode_force = (mode_fill(fill) * kept) * mode_stress(law, elastic);
        freeze_turn();
        first = f * stress;
    }
    const CornerSums<Number> r = sum_forces(c, f, first, mode_force, at, law.spacing);
    const auto minus = [](const Triple<Number>& a) __attribute__((always_inline)) {
        const Triple<Lanes> s = slope(a);
        return Triple<Lanes>{-s.x, -s.y, -s.z};
    };
    return {minus(r.x),  minus(r.y),  minus(r.z),  minus(r.xy),
            minus(r.yz), minus(r.zx), minus(r.xyz)};
}

SWAGE_INLINE void spread(const CornerSums<Lanes>& r, Lanes (&force)[3][8]) {
    spread_corners(r.x.x, r.y.x, r.z.x, r.xy.x, r.yz.x, r.zx.x, r.xyz.x, force[0]);
    spread_corners(r.x.y, r.y.y, r.z.y, r.xy.y, r.yz.y, r.zx.y, r.xyz.y, force[1]);
    spread_corners(r.x.z, r.y.z, r.z.z, r.xy.z, r.yz.z, r.zx.z, r.xyz.z, force[2]);
}

template <bool kYields, bool kRubber>
SWAGE_INLINE void run_product(const CellModuli& law, const RunView& run, double geometric,
                              const double* const (&direction)[3][4], double* const (&to)[3][4]) {
    Lanes carry[3][4] = {};  // lane 0: what the last batch left for its last particle
    for (int done = 0; done < run.count; done += kLanes) {
        const int left = run.count - done, count = left < kLanes ? left : kLanes;
        CornerSums<Lanes> x, p;
        gather(run.x, done, left, x);
        gather(direction, done, left, p);
        Lanes force[3][8];
        spread(tangent_forces<kYields, kRubber>(law, run, done, geometric, x, p), force);
        for (int i = 0; i < 3; ++i) {
            for (int q = 0; q < 4; ++q) {
                typedef long long Index __attribute__((vector_size(8 * kLanes)));
                const Lanes high = force[i][2 * q + 1];
                const Lanes sum =
                    force[i][2 * q] +
                    __builtin_shuffle(high, carry[i][q], Index{8, 0, 1, 2, 3, 4, 5, 6});
                double* at = to[i][q] + done;
                for (int l = 0; l < count; ++l) at[l] += sum[l];
                carry[i][q][0] = high[count - 1];
            }
        }
    }
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) to[i][q][run.count] += carry[i][q][0];
    }
}

// A direction along one axis, from the sums of how far each corner goes.
SWAGE_INLINE CornerSums<Lanes> along_axis(const Lanes (&sum)[7], int axis) {
    const Lanes none{};
    const auto along = [&](const Lanes& v) __attribute__((always_inline)) {
        return Triple<Lanes>{axis == 0 ? v : none, axis == 1 ? v : none, axis == 2 ? v : none};
    };
    return {along(sum[0]), along(sum[1]), along(sum[2]), along(sum[3]),
            along(sum[4]), along(sum[5]), along(sum[6])};
}

// Places of the low and high side of eight cells in their coarse cells, along each axis, 0 to 1.
struct Places {
    Lanes low[3], high[3];
};

// Tangent of eight cells in terms of their coarse cells' corners, upper triangle by columns.
template <bool kYields, bool kRubber>
SWAGE_INLINE void batch_matrices(const CellModuli& law, const RunView& run, int done,
                                 double geometric, const Places& place, Lanes* matrix) {
    CornerSums<Lanes> x;
    gather(run.x, done, run.count - done, x);
    for (int corner = 0; corner < 8; ++corner) {
        // How the cell's corners follow this coarse corner.
        Lanes follow[8], sum[7];
        for (int c = 0; c < 8; ++c) {
            follow[c] = 1.0 + Lanes{};
            for (int d = 0; d < 3; ++d) {
                const Lanes t = c >> d & 1 ? place.high[d] : place.low[d];
                follow[c] *= corner >> d & 1 ? t : 1.0 - t;
            }
        }
        sum_corners(follow, sum[0], sum[1], sum[2], sum[3], sum[4], sum[5], sum[6]);
        for (int axis = 0; axis < 3; ++axis) {
            Lanes force[3][8];
            spread(tangent_forces<kYields, kRubber>(law, run, done, geometric, x,
                                                    along_axis(sum, axis)),
                   force);
            const int column = 3 * corner + axis;
            for (int i = 0; i < 3; ++i) {
                // Back to the coarse corners, axis by axis.
                Lanes(&f)[8] = force[i];
                for (int d = 0; d < 3; ++d) {
                    for (int c = 0; c < 8; ++c) {
                        if (c >> d & 1) continue;
                        const Lanes low = f[c], high = f[c | 1 << d];
                        f[c | 1 << d] = place.low[d] * low + place.high[d] * high;
                        f[c] = (1.0 - place.low[d]) * low + (1.0 - place.high[d]) * high;
                    }
                }
                for (int c = 0; c < 8; ++c) {
                    const int row = 3 * c + i;
                    if (row <= column) matrix[CellMatrix::place(row, column)] = f[c];
                }
            }
        }
    }
}

// Of eight cells' corners, the blocks that are their own: xx, yy, zz, xy, yz, zx.
template <bool kYields, bool kRubber>
SWAGE_INLINE void batch_blocks(const CellModuli& law, const RunView& run, int done,
                               double geometric, Lanes (*block)[6]) {
    CornerSums<Lanes> x;
    gather(run.x, done, run.count - done, x);
    for (int corner = 0; corner < 8; ++corner) {
        Lanes alone[8] = {}, sum[7], column[3][3];
        alone[corner] = 1.0 + Lanes{};
        sum_corners(alone, sum[0], sum[1], sum[2], sum[3], sum[4], sum[5], sum[6]);
        for (int axis = 0; axis < 3; ++axis) {
            Lanes force[3][8];
            spread(tangent_forces<kYields, kRubber>(law, run, done, geometric, x,
                                                    along_axis(sum, axis)),
                   force);
            for (int i = 0; i < 3; ++i) column[axis][i] = force[i][corner];
        }
        const Lanes own[6] = {column[0][0], column[1][1], column[2][2],
                              column[1][0], column[2][1], column[2][0]};
        for (int n = 0; n < 6; ++n) block[corner][n] = own[n];
    }
}

#define SWAGE_TANGENT(name, yields, rubber)                                                     \
    SWAGE_VECTOR_CLONES                                                                         \
    void name##_product(const CellModuli& law, const RunView& run, double geometric,            \
                        const double* const(&direction)[3][4], double* const(&to)[3][4]) {      \
        run_product<yields, rubber>(law, run, geometric, direction, to);                        \
    }                                                                                           \
    SWAGE_VECTOR_CLONES                                                                         \
    void name##_matrices(const CellModuli& law, const RunView& run, int done, double geometric, \
                         const Places& place, Lanes* matrix) {                                  \
        batch_matrices<yields, rubber>(law, run, done, geometric, place, matrix);               \
    }                                                                                           \
    SWAGE_VECTOR_CLONES                                                                         \
    void name##_blocks(const CellModuli& law, const RunView& run, int done, double geometric,   \
                       Lanes(*block)[6]) {                                                      \
        batch_blocks<yields, rubber>(law, run, done, geometric, block);                         \
    }
SWAGE_TANGENT(elastic, false, false)
SWAGE_TANGENT(yielding, true, false)
SWAGE_TANGENT(rubber, false, true)
#undef SWAGE_TANGENT

}  // namespace

CellTangent::CellTangent(const Aggregate& matter, const std::vector<float>& fill) : fill_(fill) {
    for (int i = 0; i < 3; ++i) {
        for (const Eigen::Vector3f& c : matter.cell_centroid) at_[i].push_back(2 * c[i]);
    }
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const std::size_t cells = matter.cell_fill.size();
    const std::size_t slabs = std::clamp<std::size_t>(cells / kSlabCells, 1, 64);
    std::size_t r = 0;
    for (std::size_t s = 0; s < slabs; ++s) {
        const std::size_t begin = r, stop = cells * (s + 1) / slabs;
        ForceSlab part{std::numeric_limits<ParticleId>::max(), 0, {}};
        for (; r < runs.size() && (s + 1 == slabs || std::size_t(runs[r].first) < stop); ++r) {
            for (ParticleId p : runs[r].row) {
                part.begin = std::min(part.begin, p);
                part.reach = std::max(part.reach, p + runs[r].count + 1);
            }
        }
        if (r == begin) continue;
        part.part.resize(static_cast<std::size_t>(part.reach - part.begin));
        slab_.push_back({begin, r});
        part_.push_back(std::move(part));
    }
}

CellTangent::Law CellTangent::law_for(const Aggregate& matter, Flow flow) const {
    const Material& m = matter.material;
    const bool yields = std::isfinite(m.yield_stress) &&
                        (flow == Flow::trial || !matter.cell_plastic_strain[0].empty());
    const double yield_stress = flow == Flow::none ? 1e100 : m.yield_stress;
    return {cell_moduli(m.young_modulus, m.poisson_ratio, matter.lattice.spacing,
                        yields ? yield_stress : 0, yields ? m.hardening : 0),
            yields, m.elasticity == Elasticity::neo_hookean};
}

namespace {

RunView view_of(const Aggregate& matter, const CellRun& run, const std::vector<float>& fill,
                const std::array<std::vector<float>, 3>& at) {
    RunView view{};
    const Vec3Array& x = matter.particle_position;
    const std::vector<double>* component[3] = {&x.x, &x.y, &x.z};
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) view.x[i][q] = component[i]->data() + run.row[q];
        view.at[i] = at[i].data() + run.first;
    }
    view.fill = fill.data() + run.first;
    view.count = run.count;
    if (!matter.cell_plastic_strain[0].empty()) {
        for (int s = 0; s < kStrains; ++s) {
            view.strain[s] = matter.cell_plastic_strain[s].data() + run.first;
        }
        for (int s = 0; s < kModes; ++s) {
            view.modes[s] = matter.cell_plastic_modes[s].data() + run.first;
        }
        view.alpha = matter.cell_hardening.data() + run.first;
    }
    return view;
}

}  // namespace

void CellTangent::product(const Aggregate& matter, Kind kind, const Vec3Array& direction,
                          Vec3Array& result) {
    const Law law = law_for(matter, kind.flow);
    const std::vector<double>* from[3] = {&direction.x, &direction.y, &direction.z};
    parallel_for(slab_.size(), [&](std::size_t index) {
        ForceSlab& slab = part_[index];
        slab.clear();
        double* component[3] = {slab.part.x.data(), slab.part.y.data(), slab.part.z.data()};
        for (std::size_t r = slab_[index].run_begin; r < slab_[index].run_end; ++r) {
            const CellRun& run = matter.lattice.cell_run[r];
            const RunView view = view_of(matter, run, fill_, at_);
            const double* along[3][4];
            double* to[3][4];
            for (int i = 0; i < 3; ++i) {
                for (int q = 0; q < 4; ++q) {
                    along[i][q] = from[i]->data() + run.row[q];
                    to[i][q] = component[i] + (run.row[q] - slab.begin);
                }
            }
            const auto sweep = law.rubber   ? rubber_product
                               : law.yields ? yielding_product
                                            : elastic_product;
            sweep(law.moduli, view, kind.geometric, along, to);
        }
    });
    sum_slabs(part_, matter.particle_count(), result);
}

std::vector<Mat3> CellTangent::own_blocks(const Aggregate& matter, Kind kind) const {
    const Law law = law_for(matter, kind.flow);
    const auto blocks = law.rubber ? rubber_blocks : law.yields ? yielding_blocks : elastic_blocks;
    std::vector<Mat3> own(matter.particle_count(), Mat3::Zero());
    // Planes of cells share particles with the next ones only: every other plane at a time.
    std::vector<std::size_t> plane(matter.lattice.cell_count.z() + 1, 0);
    for (const CellRun& run : matter.lattice.cell_run) ++plane[run.k + 1];
    for (std::size_t n = 1; n < plane.size(); ++n) plane[n] += plane[n - 1];
    for (std::size_t odd = 0; odd < 2; ++odd) {
        parallel_for(plane.size() / 2, [&](std::size_t half) {
            const std::size_t index = 2 * half + odd;
            if (index + 1 >= plane.size()) return;
            Lanes block[8][6];
            for (std::size_t r = plane[index]; r < plane[index + 1]; ++r) {
                const CellRun& run = matter.lattice.cell_run[r];
                const RunView view = view_of(matter, run, fill_, at_);
                for (int done = 0; done < run.count; done += kLanes) {
                    blocks(law.moduli, view, done, kind.geometric, block);
                    for (int l = 0; l < kLanes && done + l < run.count; ++l) {
                        for (int c = 0; c < 8; ++c) {
                            const Lanes(&b)[6] = block[c];
                            Mat3 add;
                            add << b[0][l], b[3][l], b[5][l], b[3][l], b[1][l], b[4][l], b[5][l],
                                b[4][l], b[2][l];
                            own[run.row[c >> 1] + done + l + (c & 1)] += add;
                        }
                    }
                }
            }
        });
    }
    return own;
}

std::vector<CellMatrix> CellTangent::coarse_cells(const Aggregate& matter, Kind kind,
                                                  const Lattice& coarse, const Vec3i& ratio) const {
    const Law law = law_for(matter, kind.flow);
    const auto matrices = law.rubber   ? rubber_matrices
                          : law.yields ? yielding_matrices
                                       : elastic_matrices;
    std::size_t count = 0;
    for (const CellRun& run : coarse.cell_run) count += run.count;
    std::vector<CellMatrix> sum(count);
    // Each chunk is a plane of coarse cells.
    std::vector<std::size_t> plane(coarse.cell_count.z() + 1, 0);
    for (const CellRun& run : matter.lattice.cell_run) ++plane[run.k / ratio.z() + 1];
    for (std::size_t n = 1; n < plane.size(); ++n) plane[n] += plane[n - 1];
    parallel_for(plane.size() - 1, [&](std::size_t index) {
        Lanes matrix[std::tuple_size_v<decltype(CellMatrix::upper)>];
        for (std::size_t r = plane[index]; r < plane[index + 1]; ++r) {
            const CellRun& run = matter.lattice.cell_run[r];
            const RunView view = view_of(matter, run, fill_, at_);
            const Vec3i site(run.i, run.j, run.k);
            for (int done = 0; done < run.count; done += kLanes) {
                Places place;
                CellId cell[kLanes];
                const int many = std::min(kLanes, run.count - done);
                for (int l = 0; l < kLanes; ++l) {
                    const Vec3i at = site + Vec3i(done + l, 0, 0);
                    for (int d = 0; d < 3; ++d) {
                        place.low[d][l] = double(at[d] % ratio[d]) / ratio[d];
                        place.high[d][l] = double(at[d] % ratio[d] + 1) / ratio[d];
                    }
                    if (l < many) {
                        cell[l] = coarse.cell_at(at.x() / ratio.x(), at.y() / ratio.y(),
                                                 at.z() / ratio.z());
                    }
                }
                matrices(law.moduli, view, done, kind.geometric, place, matrix);
                for (int l = 0; l < many; ++l) {
                    auto& to = sum[cell[l]].upper;
                    for (std::size_t e = 0; e < to.size(); ++e) to[e] += matrix[e][l];
                }
            }
        }
    });
    return sum;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "laws/cell.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kSlabCells = 8192;
constexpr double kNeverYields = 1e100;  // [Pa]
constexpr int kStrains = 6, kModes = 12;
// Cells that share a particle never all move in their stiffest way at once. Of the sum over eight
// cells the fastest motion of a block has, measured for nu = 0 to 0.49, this much of each modulus.
constexpr double kAssembledBulk = 0.47, kAssembledShear = 0.55;

typedef float FloatLanes __attribute__((vector_size(4 * kLanes)));

SWAGE_INLINE Lanes load(const double* from) {
    Lanes v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
SWAGE_INLINE Lanes load(const float* from) {
    FloatLanes v;
    std::memcpy(&v, from, sizeof v);
    return __builtin_convertvector(v, Lanes);
}

// What the sweep reads of eight cells of a run; the last batch of a run is copied out, its lanes
// past the end empty.
struct Batch {
    const double* corner[3][4];  // component, row: of the first cell's low end
    const float* fill;
    const float* at[3];
    const float* strain[kStrains];  // committed; null while nothing has flowed
    const float* modes[kModes];
    const float* alpha;
};

struct Tail {
    double corner[3][4][kLanes + 1];
    float number[4 + kStrains + kModes + 1][kLanes];
};

template <typename T>
SWAGE_INLINE void copy_out(const T*& from, T* to, int count, int room) {
    for (int n = 0; n < room; ++n) to[n] = n < count ? from[n] : T(0);
    from = to;
}

// The floor on slivers: f^3 alone leaves nothing to hold their corners.
template <typename N>
SWAGE_INLINE N mode_fill(const N& fill) {
    return larger(fill * fill * fill, 1e-3 * fill);
}

// Stress in the material's axes times the cell's volume of material, and the stress of its modes.
template <typename N, bool kYields>
SWAGE_INLINE void cell_stress(const CellModuli& law, const CellStrain<N>& strain,
                              const CellModes<N>& modes, const CellHistory<N>& history,
                              const N& fill, Symmetric<N>& stress, CellModes<N>& mode_force) {
    const double volume = law.spacing * law.spacing * law.spacing;
    N kept = 1.0 + 0.0 * fill;
    CellFlowed<N> r;
    if constexpr (kYields) {
        r = flow_cell(law, history, strain.log, modes, fill);
        kept = r.kept;
    } else {
        r.trace = trace(strain.log);
        r.distortion = deviator(strain.log);
        r.modes = modes;
    }
    const N pressure = law.bulk * r.trace;
    Symmetric<N> t = ((2 * law.shear) * kept) * r.distortion;
    t.xx = t.xx + pressure, t.yy = t.yy + pressure, t.zz = t.zz + pressure;
    stress = (volume * fill) * material_stress(strain, t);
    mode_force = (mode_fill(fill) * kept) * mode_stress(law, r.modes);
}

template <bool kYields, bool kRubber>
SWAGE_INLINE void batch_forces(const CellModuli& law, const Batch& b, Lanes (&force)[3][8]) {
    CornerSums<Lanes> c;
    Lanes corner[8];
    const auto gather = [&](int i) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            corner[2 * q] = load(b.corner[i][q]);
            corner[2 * q + 1] = load(b.corner[i][q] + 1);
        }
    };
    gather(0);
    sum_corners(corner, c.x.x, c.y.x, c.z.x, c.xy.x, c.yz.x, c.zx.x, c.xyz.x);
    gather(1);
    sum_corners(corner, c.x.y, c.y.y, c.z.y, c.xy.y, c.yz.y, c.zx.y, c.xyz.y);
    gather(2);
    sum_corners(corner, c.x.z, c.y.z, c.z.z, c.xy.z, c.yz.z, c.zx.z, c.xyz.z);
    const Lanes fill = load(b.fill);
    const Triple<Lanes> at = {load(b.at[0]), load(b.at[1]), load(b.at[2])};
    const Columns<Lanes> f = centroid_gradient(c, at, law.spacing);
    const CellModes<Lanes> modes = {transposed_times(f, c.xy), transposed_times(f, c.yz),
                                    transposed_times(f, c.zx), transposed_times(f, c.xyz)};
    CornerSums<Lanes> r;
    if constexpr (kRubber) {
        const double volume = law.spacing * law.spacing * law.spacing;
        const Columns<Lanes> first = rubber_stress(law, f);
        const Lanes scale = volume * fill;
        r = sum_forces(c, f, Columns<Lanes>{scale * first.x, scale * first.y, scale * first.z},
                       mode_fill(fill) * mode_stress(law, modes), at, law.spacing);
    } else {
        CellHistory<Lanes> history{};
        if constexpr (kYields) {
            history.strain = {load(b.strain[0]), load(b.strain[1]), load(b.strain[2]),
                              load(b.strain[3]), load(b.strain[4]), load(b.strain[5])};
            const auto mode = [&](int m) __attribute__((always_inline)) {
                return Triple<Lanes>{load(b.modes[m]), load(b.modes[m + 1]), load(b.modes[m + 2])};
            };
            history.modes = {mode(0), mode(3), mode(6), mode(9)};
            history.alpha = load(b.alpha);
        }
        Symmetric<Lanes> stress;
        CellModes<Lanes> mode_force;
        cell_stress<Lanes, kYields>(law, cell_strain(f), modes, history, fill, stress, mode_force);
        r = sum_forces(c, f, f * stress, mode_force, at, law.spacing);
    }
    spread_corners(r.x.x, r.y.x, r.z.x, r.xy.x, r.yz.x, r.zx.x, r.xyz.x, force[0]);
    spread_corners(r.x.y, r.y.y, r.z.y, r.xy.y, r.yz.y, r.zx.y, r.xyz.y, force[1]);
    spread_corners(r.x.z, r.y.z, r.z.z, r.xy.z, r.yz.z, r.zx.z, r.xyz.z, force[2]);
}

// Everything of a run that a batch reads, from its first cell on.
struct RunArrays {
    Batch batch;
    double* force[3][4];
    int count;
};

// Forces of the two ends of a cell's edges along x meet on the particles between: they are added in
// registers, so that no particle is written twice in a row.
template <bool kYields, bool kRubber>
SWAGE_INLINE void run_forces(const CellModuli& law, const RunArrays& run) {
    Lanes carry[3][4] = {};  // lane 0: what the last batch left for its last particle
    Tail tail;
    for (int done = 0; done < run.count; done += kLanes) {
        Batch b = run.batch;
        const int left = run.count - done;
        for (auto& rows : b.corner) {
            for (const double*& row : rows) row += done;
        }
        b.fill += done;
        for (const float*& v : b.at) v += done;
        if constexpr (kYields) {
            for (const float*& v : b.strain) v += done;
            for (const float*& v : b.modes) v += done;
            b.alpha += done;
        }
        if (left < kLanes) {
            for (int i = 0; i < 3; ++i) {
                for (int q = 0; q < 4; ++q) {
                    copy_out(b.corner[i][q], tail.corner[i][q], left + 1, kLanes + 1);
                }
            }
            int slot = 0;
            copy_out(b.fill, tail.number[slot++], left, kLanes);
            for (const float*& v : b.at) copy_out(v, tail.number[slot++], left, kLanes);
            if constexpr (kYields) {
                for (const float*& v : b.strain) copy_out(v, tail.number[slot++], left, kLanes);
                for (const float*& v : b.modes) copy_out(v, tail.number[slot++], left, kLanes);
                copy_out(b.alpha, tail.number[slot++], left, kLanes);
            }
        }
        Lanes force[3][8];
        batch_forces<kYields, kRubber>(law, b, force);
        const int count = left < kLanes ? left : kLanes;
        for (int i = 0; i < 3; ++i) {
            for (int q = 0; q < 4; ++q) {
                typedef long long Index __attribute__((vector_size(8 * kLanes)));
                const Lanes high = force[i][2 * q + 1];
                const Lanes shifted =
                    __builtin_shuffle(high, carry[i][q], Index{8, 0, 1, 2, 3, 4, 5, 6});
                const Lanes sum = force[i][2 * q] + shifted;
                double* to = run.force[i][q] + done;
                if (count == kLanes) {
                    Lanes old;
                    std::memcpy(&old, to, sizeof old);
                    old += sum;
                    std::memcpy(to, &old, sizeof old);
                    carry[i][q][0] = high[kLanes - 1];
                } else {
                    for (int l = 0; l < count; ++l) to[l] += sum[l];
                    carry[i][q][0] = high[count - 1];
                }
            }
        }
    }
    for (int i = 0; i < 3; ++i) {
        for (int q = 0; q < 4; ++q) run.force[i][q][run.count] += carry[i][q][0];
    }
}

SWAGE_VECTOR_CLONES
void elastic_run(const CellModuli& law, const RunArrays& run) {
    run_forces<false, false>(law, run);
}
SWAGE_VECTOR_CLONES
void yielding_run(const CellModuli& law, const RunArrays& run) {
    run_forces<true, false>(law, run);
}
SWAGE_VECTOR_CLONES
void rubber_run(const CellModuli& law, const RunArrays& run) { run_forces<false, true>(law, run); }

// One cell as plain numbers, for what is done once a frame.
struct OneCell {
    CornerSums<double> sums;
    Columns<double> gradient;
    CellModes<double> modes;
};

OneCell one_cell(const Aggregate& matter, const CellRun& run, int n,
                 const std::array<std::vector<float>, 3>& at) {
    const CellId cell = run.first + n;
    OneCell r;
    CornerSums<double>& c = r.sums;
    double corner[8];
    const auto gather = [&](const std::vector<double>& x) {
        for (int q = 0; q < 8; ++q) corner[q] = x[run.row[q >> 1] + n + (q & 1)];
    };
    const Vec3Array& x = matter.particle_position;
    gather(x.x);
    sum_corners(corner, c.x.x, c.y.x, c.z.x, c.xy.x, c.yz.x, c.zx.x, c.xyz.x);
    gather(x.y);
    sum_corners(corner, c.x.y, c.y.y, c.z.y, c.xy.y, c.yz.y, c.zx.y, c.xyz.y);
    gather(x.z);
    sum_corners(corner, c.x.z, c.y.z, c.z.z, c.xy.z, c.yz.z, c.zx.z, c.xyz.z);
    r.gradient = centroid_gradient(c, Triple<double>{at[0][cell], at[1][cell], at[2][cell]},
                                   matter.lattice.spacing);
    r.modes = {transposed_times(r.gradient, c.xy), transposed_times(r.gradient, c.yz),
               transposed_times(r.gradient, c.zx), transposed_times(r.gradient, c.xyz)};
    return r;
}

CellHistory<double> history_of(const Aggregate& matter, CellId cell) {
    if (matter.cell_plastic_strain[0].empty()) return {};
    const auto& s = matter.cell_plastic_strain;
    const auto& m = matter.cell_plastic_modes;
    const auto mode = [&](int slot) {
        return Triple<double>{m[slot][cell], m[slot + 1][cell], m[slot + 2][cell]};
    };
    return {{s[0][cell], s[1][cell], s[2][cell], s[3][cell], s[4][cell], s[5][cell]},
            {mode(0), mode(3), mode(6), mode(9)},
            matter.cell_hardening[cell]};
}

template <typename Act>
void for_each_cell(const Aggregate& matter, std::size_t begin, std::size_t end, const Act& act) {
    for (std::size_t r = begin; r < end; ++r) {
        const CellRun& run = matter.lattice.cell_run[r];
        for (int n = 0; n < run.count; ++n) act(run, n, run.first + n);
    }
}

}  // namespace

CellSweep::CellSweep(const Aggregate& matter)
    : law_(cell_moduli(matter.material.young_modulus, matter.material.poisson_ratio,
                       matter.lattice.spacing)),
      yields_(std::isfinite(matter.material.yield_stress)),
      rubber_(matter.material.elasticity == Elasticity::neo_hookean) {
    if (yields_) {
        law_.yield_stress = matter.material.yield_stress;
        law_.hardening = matter.material.hardening;
    }
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
    cells_changed(matter);
}

void CellSweep::cells_changed(const Aggregate& matter) {
    fill_ = matter.cell_fill;
    for_each_cell(matter, 0, matter.lattice.cell_run.size(),
                  [&](const CellRun& run, int n, CellId cell) {
                      std::array<ParticleId, 4> row = run.row;
                      for (ParticleId& p : row) p += n;
                      if (!cell_is_whole(matter, row)) fill_[cell] = 0;
                  });
}

void CellSweep::forces(const Aggregate& matter, Flow flow, Vec3Array& force) {
    CellModuli law = law_;
    if (flow == Flow::none) law.yield_stress = kNeverYields;
    const Vec3Array& x = matter.particle_position;
    const double* const component[3] = {x.x.data(), x.y.data(), x.z.data()};
    const std::vector<float> fresh(yields_ && matter.cell_plastic_strain[0].empty() ? fill_.size()
                                                                                    : 0);
    parallel_for(slab_.size(), [&](std::size_t index) {
        ForceSlab& slab = part_[index];
        slab.clear();
        double* const part[3] = {slab.part.x.data(), slab.part.y.data(), slab.part.z.data()};
        for (std::size_t r = slab_[index].run_begin; r < slab_[index].run_end; ++r) {
            const CellRun& run = matter.lattice.cell_run[r];
            RunArrays arrays;
            arrays.count = run.count;
            for (int i = 0; i < 3; ++i) {
                for (int q = 0; q < 4; ++q) {
                    arrays.batch.corner[i][q] = component[i] + run.row[q];
                    arrays.force[i][q] = part[i] + (run.row[q] - slab.begin);
                }
                arrays.batch.at[i] = at_[i].data() + run.first;
            }
            arrays.batch.fill = fill_.data() + run.first;
            if (rubber_) {
                rubber_run(law, arrays);
            } else if (yields_) {
                const auto from = [&](const std::vector<float>& v) {
                    return (v.empty() ? fresh : v).data() + run.first;
                };
                for (int n = 0; n < kStrains; ++n) {
                    arrays.batch.strain[n] = from(matter.cell_plastic_strain[n]);
                }
                for (int n = 0; n < kModes; ++n) {
                    arrays.batch.modes[n] = from(matter.cell_plastic_modes[n]);
                }
                arrays.batch.alpha = from(matter.cell_hardening);
                yielding_run(law, arrays);
            } else {
                elastic_run(law, arrays);
            }
        }
    });
    sum_slabs(part_, matter.particle_count(), force);
}

double CellSweep::commit(Aggregate& matter) const {
    if (!yields_) return 0;
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    bool fresh = matter.cell_plastic_strain[0].empty();
    const double volume = law_.spacing * law_.spacing * law_.spacing;
    double lost = 0;
    for_each_cell(matter, 0, runs.size(), [&](const CellRun& run, int n, CellId cell) {
        if (fill_[cell] <= 0) return;
        const OneCell c = one_cell(matter, run, n, at_);
        const CellFlowed<double> r =
            flow_cell(law_, history_of(matter, cell), cell_strain(c.gradient).log, c.modes,
                      double(fill_[cell]));
        if (!(r.d_alpha > 0)) return;
        if (fresh) {
            for (auto& v : matter.cell_plastic_strain) v.assign(fill_.size(), 0.0f);
            for (auto& v : matter.cell_plastic_modes) v.assign(fill_.size(), 0.0f);
            matter.cell_hardening.assign(fill_.size(), 0.0f);
            fresh = false;
        }
        // The stress that did the flow's work is the one after the return, less what hardening
        // stores: linear hardening is booked as lost.
        const double alpha = matter.cell_hardening[cell];
        lost += volume * fill_[cell] * r.d_alpha *
                (law_.yield_stress + law_.hardening * (alpha + 0.5 * r.d_alpha));
        const double flows = 1 - r.kept;
        const double e[kStrains] = {r.distortion.xx, r.distortion.yy, r.distortion.zz,
                                    r.distortion.xy, r.distortion.yz, r.distortion.zx};
        const double q[kModes] = {r.modes.xy.x, r.modes.xy.y,  r.modes.xy.z,  r.modes.yz.x,
                                  r.modes.yz.y, r.modes.yz.z,  r.modes.zx.x,  r.modes.zx.y,
                                  r.modes.zx.z, r.modes.xyz.x, r.modes.xyz.y, r.modes.xyz.z};
        for (int s = 0; s < kStrains; ++s) {
            matter.cell_plastic_strain[s][cell] += static_cast<float>(flows * e[s]);
        }
        for (int s = 0; s < kModes; ++s) {
            matter.cell_plastic_modes[s][cell] += static_cast<float>(flows * q[s]);
        }
        matter.cell_hardening[cell] += static_cast<float>(r.d_alpha);
    });
    return lost;
}

double CellSweep::elastic_energy(const Aggregate& matter) const {
    const double volume = law_.spacing * law_.spacing * law_.spacing;
    return ordered_sum(slab_.size(), [&](std::size_t s) {
        double sum = 0;
        for_each_cell(matter, slab_[s].run_begin, slab_[s].run_end,
                      [&](const CellRun& run, int n, CellId cell) {
                          const double fill = fill_[cell];
                          if (fill <= 0) return;
                          const OneCell c = one_cell(matter, run, n, at_);
                          const CellHistory<double> history = history_of(matter, cell);
                          const CellModes<double> q = c.modes - history.modes;
                          const double modes =
                              0.5 * mode_fill(fill) * product(mode_stress(law_, q), q);
                          const double mean =
                              rubber_ ? rubber_energy(law_, c.gradient)
                                      : strain_energy(law_, cell_strain(c.gradient).log, history);
                          sum += volume * fill * mean + modes;
                      });
        return sum;
    });
}

// Of one cell: the mean strain's share is bounded by the largest eigenvalue of Hooke's law times
// that of the gradient's Gram matrix, which grows as the centroid leaves the middle; the modes' by
// the largest of the blocks in laws/cell.h. The fewer cells a particle has, the less they hold each
// other back.
void CellSweep::add_stiffness_bound(const Aggregate& matter, std::vector<double>& bound) const {
    const double a = law_.spacing;
    const double alone = std::max(2 * law_.shear, 3 * law_.bulk);
    const double among = kAssembledShear * 2 * law_.shear + kAssembledBulk * 3 * law_.bulk;
    const double modes = 8 * std::max(law_.edge + 2 * law_.diagonal, 4 * law_.diagonal);
    std::vector<double> held_back(bound.size(), 0.0);
    std::vector<char> cells(bound.size(), 0);
    for_each_cell(matter, 0, matter.lattice.cell_run.size(),
                  [&](const CellRun& run, int n, CellId cell) {
                      const double fill = fill_[cell];
                      if (fill <= 0) return;
                      const Vec3 at(at_[0][cell], at_[1][cell], at_[2][cell]);
                      const bool centred = at == Vec3::Zero();
                      double gram = 1;  // times 1 / (2 a^2)
                      if (!centred) {
                          Mat3 g;
                          for (int i = 0; i < 3; ++i) {
                              const int j = (i + 1) % 3, k = (i + 2) % 3;
                              g(i, i) = (1 + at[j] * at[j]) * (1 + at[k] * at[k]);
                              g(i, j) = g(j, i) = at[i] * at[j] * (1 + at[k] * at[k]);
                          }
                          gram = g.cwiseAbs().rowwise().sum().maxCoeff();
                      }
                      const double mean = 0.5 * fill * a * gram, own = mode_fill(fill) * modes;
                      const auto of = [&](double hooke) {
                          return centred ? std::max(mean * hooke, own) : mean * hooke + own;
                      };
                      const double most = of(alone), less = of(among);
                      for (int c = 0; c < 8; ++c) {
                          const ParticleId p = run.row[c >> 1] + n + (c & 1);
                          bound[p] += most;
                          held_back[p] += most - less;
                          ++cells[p];
                      }
                  });
    for (std::size_t p = 0; p < bound.size(); ++p) bound[p] -= cells[p] / 8.0 * held_back[p];
}

}  // namespace swage

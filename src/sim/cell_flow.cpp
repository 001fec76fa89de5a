// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/portable_math.h"
#include "laws/spring_damper.h"
#include "laws/volume_guard.h"
#include "laws/yield.h"
#include "sim/cell_batch.h"
#include "sim/cell_volume.h"
#include "sim/connection_shares.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 256;
constexpr std::size_t kSpansPerChunk = 1024;
constexpr double kNearYield = 1e-4;  // of it: strains are kept as floats
// Of S with c = w and i = 1, which is soon found: below it no cell yields that never has.
constexpr double kUnyielded = 0.25;

constexpr Springs kShares = [] {
    Springs shares{};
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        shares[slot] = kCellConnection[slot].direction < kEdgeCount ? kEdgeShare : kDiagonalShare;
    }
    return shares;
}();

ParticleId at_corner(const std::array<ParticleId, 4>& row, int corner) {
    return row[corner >> 1] + (corner & 1);
}
ParticleId lower_end(const std::array<ParticleId, 4>& row, int slot) {
    return at_corner(row, kCellConnection[slot].corner);
}

SWAGE_VECTOR_CLONES
void strain_block(const double* x, const double* y, const double* z, const double* ux,
                  const double* uy, const double* uz, int count, double inverse_reference,
                  float* __restrict strain) {
    for (int n = 0; n < count; ++n) {
        const double dx = ux[n] - x[n], dy = uy[n] - y[n], dz = uz[n] - z[n];
        const double ratio = std::sqrt(dx * dx + dy * dy + dz * dz) * inverse_reference;
        strain[n] = static_cast<float>(log_ratio(ratio));
    }
}

SWAGE_VECTOR_CLONES
void distortion_block(const float* strain, const float* weight, const float* plastic,
                      const double* theta, double share, int count, float* __restrict shortest,
                      float* __restrict longest, double* __restrict distortion) {
    for (int n = 0; n < count; ++n) {
        shortest[n] = strain[n] < shortest[n] ? strain[n] : shortest[n];
        longest[n] = strain[n] > longest[n] ? strain[n] : longest[n];
        const double s = double(strain[n]) - double(plastic[n]) - theta[n];
        distortion[n] += weight[n] > 0 ? share * s * s : 0.0;
    }
}

// At least S / root S_0 (laws/yield.h) of any cell of a run that has never flowed. With q = r^2 - 1
// of a connection's ratio r, its logarithm is q/2 to within 0.3 q^2, a third of the volume's j/3 to
// within 0.2 j^2, where these are below a tenth; r^2 and what it makes of i are as near to 1 as q
// is to 0. Beyond, it is told as more than anything.
SWAGE_VECTOR_CLONES
double most_distorted(const Aggregate& matter, const CellRun& run) {
    constexpr double kTenth = 0.01;
    const Vec3Array& x = matter.particle_position;
    const double a = matter.lattice.spacing, s = 0.25 / a;
    CornerRows<const double> rows;
    for (int q = 0; q < 4; ++q) {
        rows.at[0][q] = x.x.data() + run.row[q];
        rows.at[1][q] = x.y.data() + run.row[q];
        rows.at[2][q] = x.z.data() + run.row[q];
    }
    const int room = static_cast<int>(x.size()) - run.row[3];
    double most = 0;
    for (int begin = 0; begin < run.count; begin += kFewLanes) {
        const int count = std::min(kFewLanes, run.count - begin);
        const CornerSums<FewLanes> c = gather<FewLanes>(rows, begin, count, room);
        const FewLanes j = (s * s * s) * dot(c.x, cross(c.y, c.z)) - 1.0, third = (1.0 / 3) * j;
        FewLanes edges{}, diagonals{}, squares = j * j;
        const auto add = [&](const Triple<FewLanes>& way, double scale, FewLanes& sum)
            __attribute__((always_inline)) {
            const FewLanes q = scale * dot(way, way) - 1.0, off = 0.5 * q - third;
            sum += off * off;
            squares += q * q;
        };
        // `m`, `n`: the modes with the axes beside; of the four edges along one axis, and of the
        // four diagonals in the planes of two.
        const auto four_edges = [&](const Triple<FewLanes>& d, const Triple<FewLanes>& m,
                                    const Triple<FewLanes>& n) __attribute__((always_inline)) {
            add(d + m + n + c.xyz, s * s, edges);
            add(d + m - n - c.xyz, s * s, edges);
            add(d - m + n - c.xyz, s * s, edges);
            add(d - m - n + c.xyz, s * s, edges);
        };
        const auto four_diagonals = [&](const Triple<FewLanes>& d, const Triple<FewLanes>& e,
                                        const Triple<FewLanes>& m, const Triple<FewLanes>& n)
            __attribute__((always_inline)) {
            add(d + e + m + n, 0.5 * s * s, diagonals);
            add(d + e - m - n, 0.5 * s * s, diagonals);
            add(d - e + m - n, 0.5 * s * s, diagonals);
            add(d - e - m + n, 0.5 * s * s, diagonals);
        };
        four_edges(c.x, c.xy, c.zx);
        four_edges(c.y, c.xy, c.yz);
        four_edges(c.z, c.yz, c.zx);
        four_diagonals(c.x, c.y, c.zx, c.yz);
        four_diagonals(c.y, c.z, c.xy, c.zx);
        four_diagonals(c.z, c.x, c.yz, c.xy);
        const FewLanes about = kEdgeShare * edges + kDiagonalShare * diagonals;
        for (int l = 0; l < count; ++l) {
            if (!(squares[l] < kTenth)) return std::numeric_limits<double>::infinity();
            most = std::max(most, std::sqrt(about[l]) * (1 + 2 * std::sqrt(squares[l])) +
                                      1.2 * std::sqrt(kAllShares) * squares[l]);
        }
    }
    return most;
}

}  // namespace

CellFlow::CellFlow(const Aggregate& matter) {
    if (!std::isfinite(matter.material.yield_stress)) return;
    const double shear = lattice_stiffness(matter.material.young_modulus, 1.0);
    law_ = {matter.material.yield_stress, matter.material.hardening, shear,
            flow_curve(matter.material.flow_curve, shear)};
    yield_distortion_ = yield_distortion(law_);
    for (auto& strain : strain_) strain.resize(matter.particle_count());
    history_changed(matter);
}

void CellFlow::history_changed(const Aggregate& matter) {
    for (int d = 0; d < kForwardCount; ++d) {
        rest_[d] = matter.connection[d].plastic;
        rest_[d].resize(matter.particle_count());
    }
    flowing_.clear();
}

// Nothing has ever flowed and nothing does.
bool CellFlow::is_far_from_yield(const Aggregate& matter) const {
    if (!matter.cell_plastic[0].empty()) return false;
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const double least = (1 - kNearYield) * std::sqrt(yield_distortion_);
    const auto are_far = [&](std::size_t begin, std::size_t end) -> char {
        return std::all_of(runs.begin() + begin, runs.begin() + end,
                           [&](const CellRun& run) { return most_distorted(matter, run) < least; });
    };
    const std::vector<char> far = parallel_parts(runs.size(), kRunsPerChunk, are_far);
    return std::all_of(far.begin(), far.end(), [](char one) { return one != 0; });
}

void CellFlow::find_strains(const Aggregate& matter) {
    const Vec3Array& x = matter.particle_position;
    const std::vector<Span>& spans = matter.lattice.span;
    parallel_each(spans.size(), kSpansPerChunk, [&](std::size_t n) {
        const Span& s = spans[n];
        strain_block(x.x.data() + s.lower, x.y.data() + s.lower, x.z.data() + s.lower,
                     x.x.data() + s.upper, x.y.data() + s.upper, x.z.data() + s.upper, s.count,
                     1 / reference_length(matter.lattice, s.direction),
                     strain_[s.direction].data() + s.lower);
    });
}

CellSprings CellFlow::springs_of(const Aggregate& matter, CellId cell,
                                 const std::array<ParticleId, 4>& row) const {
    CellSprings springs;
    for (int slot = 0; slot < kCellConnectionCount; ++slot) {
        const int d = kCellConnection[slot].direction;
        const ParticleId lower = lower_end(row, slot);
        const ParticleId upper = at_corner(row, upper_corner(kCellConnection[slot]));
        const double plastic =
            matter.cell_plastic[slot].empty() ? 0.0 : double(matter.cell_plastic[slot][cell]);
        springs.way[slot] =
            (matter.particle_position.at(upper) - matter.particle_position.at(lower)) /
            reference_length(matter.lattice, d);
        springs.strain[slot] = double(strain_[d][lower]) - plastic;
    }
    return springs;
}

void CellFlow::find_flowing(const Aggregate& matter) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const bool fresh = matter.cell_plastic[0].empty();
    const std::vector<float>& hardening = matter.cell_history.hardening();
    const std::array<float, kCellBlock> unyielded{};
    const auto find = [&](std::size_t first, std::size_t last, std::vector<FlowingCell>& flowing) {
        double theta[kCellBlock], distortion[kCellBlock];
        float weight[kCellBlock], shortest[kCellBlock], longest[kCellBlock];
        for (std::size_t r = first; r < last; ++r) {
            const CellRun& run = runs[r];
            for (int at = 0; at < run.count; at += kCellBlock) {
                const int count = std::min(kCellBlock, run.count - at);
                const auto plastic = [&](int slot) {
                    return fresh ? unyielded.data()
                                 : matter.cell_plastic[slot].data() + run.first + at;
                };
                cell_volumes(matter, run, at, count, theta);
                for (int n = 0; n < count; ++n) {
                    theta[n] =
                        log_ratio(std::clamp(theta[n], kGuardedVolume, 1 / kGuardedVolume)) / 3;
                }
                std::fill_n(distortion, count, 0.0);
                std::fill_n(shortest, count, std::numeric_limits<float>::infinity());
                std::fill_n(longest, count, -std::numeric_limits<float>::infinity());
                for (int slot = 0; slot < kCellConnectionCount; ++slot) {
                    const int d = kCellConnection[slot].direction;
                    const ParticleId lower = lower_end(run.row, slot) + at;
                    matter.connection[d].weight.copy(lower, count, weight);
                    distortion_block(strain_[d].data() + lower, weight, plastic(slot), theta,
                                     kShares[slot], count, shortest, longest, distortion);
                }
                for (int n = 0; n < count; ++n) {
                    const CellId id = run.first + at + n;
                    const double alpha = fresh ? 0.0 : double(hardening[id]);
                    const bool is_far =
                        alpha > 0 ? law_.shear_modulus * most_stress(distortion[n], theta[n],
                                                                     shortest[n], longest[n]) <
                                        flow_stress(law_, alpha)
                                  : !(distortion[n] > kUnyielded * yield_distortion_);
                    if (is_far) continue;
                    const std::array<ParticleId, 4> row = run.row_at(at + n);
                    if (!cell_is_sound(matter, id, row)) continue;  // has no size any more
                    if (const auto flow = return_springs(law_, springs_of(matter, id, row), kShares,
                                                         theta[n], alpha)) {
                        flowing.push_back({id, row, *flow});
                    }
                }
            }
        }
    };
    flowing_ = parallel_collect<FlowingCell>(runs.size(), kRunsPerChunk, find);
}

const RestStrains& CellFlow::rest_strains(const Aggregate& matter) {
    // Only what flowed last time has to be put back.
    for (const FlowingCell& cell : flowing_) {
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const int d = kCellConnection[slot].direction;
            const ParticleId lower = lower_end(cell.row, slot);
            rest_[d][lower] = static_cast<float>(matter.connection[d].plastic_of(lower));
        }
    }
    if (is_far_from_yield(matter)) {
        flowing_.clear();
        return rest_;
    }
    find_strains(matter);
    find_flowing(matter);
    for (const FlowingCell& cell : flowing_) {
        const double fill = matter.cell_fill[cell.cell];
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const int d = kCellConnection[slot].direction;
            const ParticleId lower = lower_end(cell.row, slot);
            const double weight = matter.connection[d].weight[lower];
            if (weight <= 0) continue;  // severed: its rest length no longer matters
            const double share = cell_share(d) * fill / weight;
            rest_[d][lower] = static_cast<float>(
                (1.0 + rest_[d][lower]) * portable::exp(share * cell.flow.grows[slot]) - 1.0);
        }
    }
    return rest_;
}

// What a growing rest length takes from a connection's elastic energy: its tension times the
// growth.
double CellFlow::plastic_work(const Aggregate& matter, int d, ParticleId lower,
                              double growth) const {
    const double reference = reference_length(matter.lattice, d);
    const double elastic = portable::exp(double(strain_[d][lower])) - 1 - rest_[d][lower];
    return lattice_stiffness(matter) * matter.connection[d].weight[lower] * reference * reference *
           elastic * growth;
}

double CellFlow::commit(Aggregate& matter, bool found, RestGrowths* growths) {
    if (!(yield_distortion_ > 0)) return 0;
    if (!found) rest_strains(matter);
    if (flowing_.empty()) return 0;
    double lost = 0;
    for (std::vector<float>& slot : matter.cell_plastic) slot.resize(matter.cell_fill.size());
    for (ConnectionArrays& c : matter.connection) c.plastic.resize(matter.particle_count());
    std::vector<float>& hardening = matter.cell_history.hardening();
    hardening.resize(matter.cell_fill.size());
    for (const FlowingCell& cell : flowing_) {
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const int d = kCellConnection[slot].direction;
            const ParticleId lower = lower_end(cell.row, slot);
            float& plastic = matter.connection[d].plastic[lower];
            if (plastic != rest_[d][lower]) {
                const double growth = rest_[d][lower] - plastic;
                lost += plastic_work(matter, d, lower, growth);
                plastic = rest_[d][lower];
                if (growths) {
                    const double weight = matter.connection[d].weight[lower];
                    (*growths)[d].push_back(
                        {lower,
                         static_cast<float>(weight * growth / (1 + plastic - 0.5 * growth))});
                }
            }
            matter.cell_plastic[slot][cell.cell] += static_cast<float>(cell.flow.grows[slot]);
        }
        hardening[cell.cell] += static_cast<float>(cell.flow.d_alpha);
    }
    flowing_.clear();
    return lost;
}

}  // namespace swage

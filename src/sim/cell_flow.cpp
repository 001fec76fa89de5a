// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cell_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "laws/spring_damper.h"
#include "sim/cell_batch.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 256;
constexpr std::size_t kCellsPerChunk = 1024;  // about
constexpr std::size_t kSpansPerChunk = 1024;
constexpr double kNoLength = 1e-150;  // of the reference length
constexpr double kNearYield = 1e-4;   // of it: strains are kept as floats

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

// At least S / root S_0 (laws/yield.h) of any cell of a run that has never flowed. With q = r^2 - 1
// of a connection's ratio r, its logarithm is q/2 to within 0.3 q^2, a third of the volume's j/3 to
// within 0.2 j^2, where these are below a tenth; r^2 and what it makes of i are as near to 1 as q
// is to 0. Beyond, it is told as more than anything.
SWAGE_VECTOR_CLONES
double most_distorted(const Aggregate& matter, const CellRun& run) {
    constexpr double kTenth = 0.01;
    const double a = matter.lattice.spacing, s = 0.25 / a;
    const CornerRows rows = corner_rows(matter.particle_position, run);
    double most = 0;
    for (int begin = 0; begin < run.count; begin += kFewLanes) {
        const int count = std::min(kFewLanes, run.count - begin);
        const CornerSums<FewLanes> c = gather<FewLanes>(rows, begin, count);
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
    for (auto& strain : strain_) strain.resize(matter.particle_count() + kStrainsBehind);
    history_changed(matter);
}

void CellFlow::history_changed(const Aggregate& matter) {
    for (int d = 0; d < kForwardCount; ++d) {
        rest_[d] = matter.connection[d].plastic;
        rest_[d].resize(matter.particle_count());
    }
    flowing_.clear();
    sound_.clear();
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

void CellFlow::find_sound(const Aggregate& matter) {
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    sound_.resize(matter.cell_fill.size());
    parallel_each(runs.size(), kRunsPerChunk, [&](std::size_t r) {
        for (int n = 0; n < runs[r].count; ++n) {
            const CellId cell = runs[r].first + n;
            sound_[cell] = cell_is_sound(matter, cell, runs[r].row_at(n));
        }
    });
}

const RestStrains& CellFlow::rest_strains(const Aggregate& matter) {
    // Only what flowed last time has to be put back.
    for (const FlowingCells& cells : flowing_) {
        for (int slot = 0; slot < kCellConnectionCount; ++slot) {
            const int d = kCellConnection[slot].direction;
            const ParticleId lower = cells.lower(slot);
            const std::vector<float>& plastic = matter.connection[d].plastic;
            if (plastic.empty()) {
                std::fill_n(rest_[d].begin() + lower, cells.count, 0.0f);
            } else {
                std::copy_n(plastic.begin() + lower, cells.count, rest_[d].begin() + lower);
            }
        }
    }
    flowing_.clear();
    if (is_far_from_yield(matter)) return rest_;
    if (sound_.empty()) find_sound(matter);  // others have no size any more
    find_strains(matter);
    const std::vector<CellRun>& runs = matter.lattice.cell_run;
    const std::size_t chunks = matter.cell_fill.size() / kCellsPerChunk + 1;
    flowing_ = parallel_collect<FlowingCells>(
        chunks, 1, [&](std::size_t begin, std::size_t end, std::vector<FlowingCells>& found) {
            find_flowing({matter, law_, strain_, sound_},
                         runs.data() + runs.size() * begin / chunks,
                         runs.data() + runs.size() * end / chunks, found);
        });
    add_flow(matter, flowing_, rest_);
    return rest_;
}

// What flow takes in a step, over stiffness and spacing squared. With f the force of a connection,
// u the way of its ends against each other and W its energy, the books of a step have 1/2 (f_0 +
// f_1) u as the work of the one, and W_1 - W_0 as what is stored of it: the rest has gone into
// flow. With the tension at the end alone a step in which something begins to flow, or turns, took
// too much.
double CellFlow::taken_in(double step, const Aggregate& matter) const {
    const Vec3Array &x = matter.particle_position, &v = matter.particle_velocity;
    const std::vector<Span>& spans = matter.lattice.span;
    if (flowing_.empty()) return 0;
    const auto taken = [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t n = begin; n < end; ++n) {
            const Span& s = spans[n];
            const ConnectionArrays& c = matter.connection[s.direction];
            const float *was = c.plastic.empty() ? nullptr : c.plastic.data() + s.lower,
                        *is = rest_[s.direction].data() + s.lower;
            const double inverse = 1 / reference_length(matter.lattice, s.direction);
            double sum_here = 0;
            for (int i = 0; i < s.count; ++i) {
                const double p0 = was ? was[i] : 0, p1 = is[i];
                if (p0 == p1) continue;
                const Vec3 last = inverse * (x.at(s.upper + i) - x.at(s.lower + i));
                const Vec3 way = step * inverse * (v.at(s.upper + i) - v.at(s.lower + i));
                const Vec3 first = last - way;
                const double d0 = std::max(first.norm(), kNoLength),
                             d1 = std::max(last.norm(), kNoLength);
                const double e0 = d0 - 1 - p0, e1 = d1 - 1 - p1;
                const double work = 0.5 * (e0 / d0 * first.dot(way) + e1 / d1 * last.dot(way));
                sum_here += c.weight[s.lower + i] * (work - 0.5 * (e1 * e1 - e0 * e0));
            }
            sum += (s.direction < kEdgeCount ? 1 : 2) * sum_here;
        }
        return sum;
    };
    double sum = 0;
    for (double part : parallel_parts(spans.size(), kSpansPerChunk, taken)) sum += part;
    return sum;
}

double CellFlow::commit(Aggregate& matter, Forces found, RestGrowths* growths) {
    if (!(yield_distortion_ > 0)) return 0;
    if (found == Forces::stale) rest_strains(matter);
    if (flowing_.empty()) {
        taken_.reset();
        return 0;
    }
    for (std::vector<float>& slot : matter.cell_plastic) slot.resize(matter.cell_fill.size());
    for (ConnectionArrays& c : matter.connection) c.plastic.resize(matter.particle_count());
    matter.cell_history.hardening().resize(matter.cell_fill.size());
    const double held = keep_flow(matter, flowing_, strain_, rest_, growths);
    const double taken = std::exchange(taken_, std::nullopt).value_or(held);
    flowing_.clear();
    const double spacing = matter.lattice.spacing;
    return lattice_stiffness(matter) * spacing * spacing * taken;
}

}  // namespace swage

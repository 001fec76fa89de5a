// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/lattice_transfer.h"

#include <algorithm>

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kRunsPerChunk = 64;

int run_holding(const std::vector<ParticleRun>& runs, int i, int j, int k) {
    const auto after = std::upper_bound(runs.begin(), runs.end(), std::array{k, j, i},
                                        [](const std::array<int, 3>& at, const ParticleRun& r) {
                                            return at < std::array{r.k, r.j, r.i};
                                        });
    return static_cast<int>(after - runs.begin()) - 1;
}

}  // namespace

std::size_t particle_count(const Lattice& lattice) {
    const ParticleRun& last = lattice.particle_run.back();
    return last.first + last.count;
}

Lattice coarse_lattice(const Lattice& fine, const Vec3i& ratio) {
    std::vector<Vec3i> cells;
    for (const CellRun& run : fine.cell_run) {
        const int j = run.j / ratio.y(), k = run.k / ratio.z();
        for (int i = run.i / ratio.x(); i <= (run.i + run.count - 1) / ratio.x(); ++i) {
            cells.emplace_back(i, j, k);
        }
    }
    const auto before = [](const Vec3i& a, const Vec3i& b) {
        return std::array{a.z(), a.y(), a.x()} < std::array{b.z(), b.y(), b.x()};
    };
    std::sort(cells.begin(), cells.end(), before);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    const Vec3i count = (fine.cell_count + ratio - Vec3i::Ones()).cwiseQuotient(ratio);
    return make_lattice(fine.origin, fine.spacing, count, cells);
}

LatticeTransfer::LatticeTransfer(const Lattice& fine, const Lattice& coarse, const Vec3i& ratio)
    : ratio_(ratio.x()), coarse_run_(coarse.particle_run) {
    std::vector<std::vector<Pull>> pulls(coarse_run_.size());
    for (const ParticleRun& run : fine.particle_run) {
        const int y = run.j % ratio.y(), z = run.k % ratio.z(), x = run.i / ratio_;
        Stretch s{run.first, run.count, run.i % ratio_, {}, {}};
        for (int q = 0; q < 4; ++q) {
            const double ty = double(y) / ratio.y(), tz = double(z) / ratio.z();
            s.weight[q] = (q & 1 ? ty : 1 - ty) * (q & 2 ? tz : 1 - tz);
            if (s.weight[q] == 0) continue;
            const int at = run_holding(coarse_run_, x, run.j / ratio.y() + (q & 1),
                                       run.k / ratio.z() + (q >> 1));
            s.row[q] = coarse_run_[at].first + (x - coarse_run_[at].i);
            pulls[at].push_back({static_cast<int>(stretch_.size()), q});
        }
        stretch_.push_back(s);
    }
    for (const std::vector<Pull>& p : pulls) {
        pull_begin_.push_back(static_cast<int>(pull_.size()));
        pull_.insert(pull_.end(), p.begin(), p.end());
    }
    pull_begin_.push_back(static_cast<int>(pull_.size()));
}

void LatticeTransfer::add_prolonged(const Vec3Array& coarse, Vec3Array& fine) const {
    parallel_each(stretch_.size(), kRunsPerChunk, [&](std::size_t n) {
        const Stretch& s = stretch_[n];
        const auto add = [&](const std::vector<double>& from, std::vector<double>& to) {
            int phase = s.phase;
            for (int p = 0, c = 0; p < s.count; ++p) {
                const double high = double(phase) / ratio_;
                double sum = 0;
                for (int q = 0; q < 4; ++q) {
                    if (s.weight[q] == 0) continue;
                    const double* row = from.data() + s.row[q] + c;
                    sum +=
                        s.weight[q] * (phase == 0 ? row[0] : (1 - high) * row[0] + high * row[1]);
                }
                to[s.first + p] += sum;
                if (++phase == ratio_) phase = 0, ++c;
            }
        };
        add(coarse.x, fine.x);
        add(coarse.y, fine.y);
        add(coarse.z, fine.z);
    });
}

void LatticeTransfer::restricted(const Vec3Array& fine, Vec3Array& coarse) const {
    const std::size_t count = coarse_run_.back().first + coarse_run_.back().count;
    coarse.resize(count);
    parallel_each(coarse_run_.size(), kRunsPerChunk, [&](std::size_t r) {
        const ParticleRun& run = coarse_run_[r];
        const auto take = [&](const std::vector<double>& from, std::vector<double>& to) {
            std::fill_n(to.begin() + run.first, run.count, 0.0);
            for (int n = pull_begin_[r]; n < pull_begin_[r + 1]; ++n) {
                const Stretch& s = stretch_[pull_[n].stretch];
                const double weight = s.weight[pull_[n].side];
                double* row = to.data() + s.row[pull_[n].side];
                int phase = s.phase;
                for (int p = 0, c = 0; p < s.count; ++p) {
                    const double high = double(phase) / ratio_, f = weight * from[s.first + p];
                    row[c] += (1 - high) * f;
                    if (phase != 0) row[c + 1] += high * f;
                    if (++phase == ratio_) phase = 0, ++c;
                }
            }
        };
        take(fine.x, coarse.x);
        take(fine.y, coarse.y);
        take(fine.z, coarse.z);
    });
}

}  // namespace swage

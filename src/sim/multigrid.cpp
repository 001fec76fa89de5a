// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/multigrid.h"

#include <cmath>

#include "base/portable_math.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kDirectWork = 1e8;  // multiplications that a direct solution may take
constexpr int kFewCells = 4;         // across, that an axis is not made coarser from
constexpr int kDegree = 2;           // of the smoothing polynomial
constexpr double kSmoothed = 6;      // eigenvalues down to the largest over this are smoothed
constexpr int kFirstIterations = 8, kMoreIterations = 2;  // of the power method
constexpr double kEigenvalueMargin = 1.2;                 // power iterations end below the largest

}  // namespace

Multigrid::Multigrid(const Aggregate& matter) {
    site_.resize(matter.particle_count());
    for (const ParticleRun& run : matter.lattice.particle_run) {
        for (int n = 0; n < run.count; ++n) site_[run.first + n] = {run.i + n, run.j, run.k};
    }
    Vec3i ratio = Vec3i::Ones();
    const Lattice* finer = &matter.lattice;
    while (slab_cholesky_work(*finer) > kDirectWork) {
        Vec3i step = Vec3i::Ones();
        for (int d = 0; d < 3; ++d) step[d] = finer->cell_count[d] > kFewCells ? 2 : 1;
        if (step == Vec3i::Ones()) break;
        ratio = ratio.cwiseProduct(step);
        Level level{ratio, coarse_lattice(*finer, step), nullptr, nullptr, {}, {}, {}, {}};
        level.from_finer = std::make_unique<LatticeTransfer>(*finer, level.lattice, step);
        level_.push_back(std::move(level));
        finer = &level_.back().lattice;
    }
    if (level_.empty()) level_.push_back({ratio, matter.lattice, nullptr, nullptr, {}, {}, {}, {}});
    for (Level& level : level_) level.matrix = std::make_unique<NodeStiffness>(level.lattice);
    direct_ = std::make_unique<SlabCholesky>(level_.back().lattice);
}

// A point follows the coarse corners as the weighted mean of its carriers does.
void Multigrid::add_points(Level& level, const std::vector<HeldPoint>& held) const {
    for (const HeldPoint& h : held) {
        const Vec3i low = site_[h.corner[0]];
        const Vec3i cell = low.cwiseQuotient(level.ratio);
        const CellId id = level.lattice.cell_at(cell);
        std::array<double, 8> weight{};
        for (int c = 0; c < 8; ++c) {
            const double carried = h.weight[c];
            for (int q = 0; q < 8; ++q) {
                double share = carried;
                for (int d = 0; d < 3; ++d) {
                    const double t =
                        double(low[d] + (c >> d & 1) - cell[d] * level.ratio[d]) / level.ratio[d];
                    share *= q >> d & 1 ? t : 1 - t;
                }
                weight[q] += share;
            }
        }
        level.matrix->add_point(level.lattice.cell_corners(id), weight, h.stiffness);
    }
}

bool Multigrid::prepare(const Aggregate& matter, const CellTangent& tangent, CellTangent::Kind kind,
                        const std::vector<HeldPoint>& held, const std::vector<double>& drag,
                        const Product& product) {
    Vec3Array held_back;
    held_back.x = held_back.y = held_back.z = drag;
    for (Level& level : level_) {
        level.matrix->clear();
        level.matrix->add_cells(level.lattice,
                                tangent.coarse_cells(matter, kind, level.lattice, level.ratio));
        add_points(level, held);
        if (level.from_finer) {
            Vec3Array coarse;
            level.from_finer->restricted(held_back, coarse);
            held_back = std::move(coarse);
        }
        level.inverse_diagonal.resize(level.matrix->size());
        double stiffest = 0;
        for (std::size_t p = 0; p < level.matrix->size(); ++p) {
            const auto id = static_cast<ParticleId>(p);
            stiffest = std::max(stiffest, level.matrix->block(id, 13).trace());
        }
        for (std::size_t p = 0; p < level.matrix->size(); ++p) {
            const auto id = static_cast<ParticleId>(p);
            // What hardly any matter follows must not be left loose.
            level.matrix->add_diagonal(id, held_back.x[p] + 1e-12 * stiffest);
            level.inverse_diagonal[p] = level.matrix->block(id, 13).inverse();
        }
    }
    if (!direct_->factor(*level_.back().matrix)) return false;
    if (is_direct()) return true;
    find_own_blocks(matter, tangent, kind, held, drag);
    find_largest(
        product, [&](std::size_t p, const Vec3& v) -> Vec3 { return inverse_blocks_[p] * v; },
        matter.particle_count(), finest_);
    for (std::size_t n = 0; n + 1 < level_.size(); ++n) {
        Level& level = level_[n];
        find_largest(
            [&](const Vec3Array& d, Vec3Array& r) { level.matrix->product(d, r); },
            [&](std::size_t p, const Vec3& v) -> Vec3 { return level.inverse_diagonal[p] * v; },
            level.matrix->size(), level.smoother);
    }
    return true;
}

void Multigrid::find_own_blocks(const Aggregate& matter, const CellTangent& tangent,
                                CellTangent::Kind kind, const std::vector<HeldPoint>& held,
                                const std::vector<double>& drag) {
    inverse_blocks_ = tangent.own_blocks(matter, kind);
    for (const HeldPoint& h : held) {
        for (int c = 0; c < 8; ++c) {
            const double weight = h.weight[c];
            inverse_blocks_[h.corner[c]] += weight * weight * h.stiffness;
        }
    }
    for_each_chunk(drag.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            Mat3& block = inverse_blocks_[p];
            block.diagonal().array() += drag[p];
            const double size = block.trace();
            block = size > 0 ? Mat3(block.inverse()) : Mat3(Mat3::Zero());
        }
    });
}

template <typename Scale>
void Multigrid::find_largest(const Product& product, const Scale& scale, std::size_t count,
                             Smoother& s) {
    int left = kMoreIterations;
    if (s.largest == 0) {
        // Any start that is no eigenvector will do.
        s.mode.resize(count);
        for (std::size_t p = 0; p < count; ++p) {
            const auto wave = [&](double turn) { return portable::sin(turn * double(p) + 0.3); };
            s.mode.set(p, Vec3(wave(2.1), wave(2.7), wave(1.9)));
        }
        left = kFirstIterations;
    }
    for (; left > 0; --left) {
        product(s.mode, s.product);
        for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) s.product.set(p, scale(p, s.product.at(p)));
        });
        const double before = std::sqrt(dot(s.mode, s.mode));
        const double after = std::sqrt(dot(s.product, s.product));
        s.largest = kEigenvalueMargin * after / before;
        std::swap(s.mode, s.product);
        combine(1 / after, 0, s.product, s.mode);
    }
}

template <typename Scale>
void Multigrid::smooth(const Product& product, const Scale& scale, const Vec3Array& b,
                       bool from_zero, Smoother& s, Vec3Array& x) {
    const std::size_t count = b.size();
    const double low = s.largest / kSmoothed;
    const double middle = 0.5 * (s.largest + low), half = 0.5 * (s.largest - low);
    if (from_zero) {
        s.residual = b;
        x.resize(count);
    } else {
        product(x, s.product);
        s.residual.resize(count);
        for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                s.residual.set(p, b.at(p) - s.product.at(p));
            }
        });
    }
    s.step.resize(count);
    double rho = half / middle;
    for (int n = 0; n < kDegree; ++n) {
        double keep = 0, pull = 1 / middle;
        if (n > 0) {
            const double next = 1 / (2 * middle / half - rho);
            keep = next * rho, pull = 2 * next / half;
            rho = next;
            product(s.step, s.product);
        }
        for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                Vec3 r = s.residual.at(p);
                if (n > 0) {
                    r -= s.product.at(p);
                    s.residual.set(p, r);
                }
                Vec3 step = pull * scale(p, r);
                if (n > 0) step += keep * s.step.at(p);
                s.step.set(p, step);
                x.set(p, from_zero && n == 0 ? step : Vec3(x.at(p) + step));
            }
        });
    }
}

void Multigrid::cycle(std::size_t index, const Vec3Array& b, Vec3Array& x) {
    Level& level = level_[index];
    if (index + 1 == level_.size()) {
        direct_->solve(b, x);
        return;
    }
    const Product product = [&](const Vec3Array& d, Vec3Array& r) { level.matrix->product(d, r); };
    const auto scale = [&](std::size_t p, const Vec3& v) -> Vec3 {
        return level.inverse_diagonal[p] * v;
    };
    smooth(product, scale, b, true, level.smoother, x);
    product(x, level.smoother.product);
    Vec3Array rest = b;
    combine(1, -1, level.smoother.product, rest);
    Level& coarser = level_[index + 1];
    coarser.from_finer->restricted(rest, coarser.b);
    cycle(index + 1, coarser.b, coarser.x);
    coarser.from_finer->add_prolonged(coarser.x, x);
    smooth(product, scale, b, false, level.smoother, x);
}

void Multigrid::solve(const Product& product, const Vec3Array& b, Vec3Array& x) {
    if (is_direct()) {
        direct_->solve(b, x);
        return;
    }
    const auto scale = [&](std::size_t p, const Vec3& v) -> Vec3 { return inverse_blocks_[p] * v; };
    smooth(product, scale, b, true, finest_, x);
    product(x, finest_.product);
    Vec3Array rest = b;
    combine(1, -1, finest_.product, rest);
    level_[0].from_finer->restricted(rest, coarse_);
    cycle(0, coarse_, level_[0].x);
    level_[0].from_finer->add_prolonged(level_[0].x, x);
    smooth(product, scale, b, false, finest_, x);
}

}  // namespace swage

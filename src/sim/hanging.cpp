// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/hanging.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "geometry/disjoint_sets.h"

namespace swage {

namespace {

constexpr std::size_t kMostFirmPieces = 200;
// Of the stiffness of a connection, against a motion by one of a piece's own points (root of the
// mean square): less is none.
constexpr double kFree = 1e-5;
constexpr double kTakesPart = 1e-3;  // share of a piece in the free motions
constexpr double kTogether = 1e-6;   // what is less apart than this is not, squared
constexpr double kNoMotion = 1e-9;   // that a turn is of the points of a piece, squared

template <typename Act>
void for_each_connection(const Aggregate& matter, const Act& act) {
    for (const Span& span : matter.lattice.span) {
        const SparseArray<float>& weight = matter.connection[span.direction].weight;
        for (int n = 0; n < span.count; ++n) {
            const float share = weight[span.lower + n];
            if (share > 0) act(span.lower + n, span.upper + n, share);
        }
    }
}

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Motion = Eigen::Matrix<double, 6, 1>;  // along, and a turn about the piece's centre

// Motions of the firm pieces of one piece, up to six each, of which every one moves their points by
// one (root of the mean square). Lengths are in spacings.
class FirmMotions {
  public:
    // `of`: the number of each particle's firm piece, from 0; less than 0: not of this piece.
    FirmMotions(const Aggregate& matter, std::vector<int> of, std::size_t count)
        : matter_(matter), of_(std::move(of)), center_(count, Vec3::Zero()), members_(count, 0.0) {
        each_particle([&](std::size_t p, std::size_t n) {
            center_[n] += place(p);
            ++members_[n];
        });
        for (std::size_t n = 0; n < count; ++n) center_[n] /= members_[n];
        square_.assign(count, Mat6::Zero());
        each_particle([&](std::size_t p, std::size_t n) {
            const Moves moves = moves_of(p);
            square_[n] += moves.transpose() * moves / members_[n];
        });
        for (const Mat6& s : square_) {
            const Eigen::SelfAdjointEigenSolver<Mat6> ways(s);
            Own own(6, 0);
            for (int w = 0; w < 6; ++w) {
                const double moved = ways.eigenvalues()[w];
                if (moved < kNoMotion * s.trace()) continue;
                own.conservativeResize(6, own.cols() + 1);
                own.rightCols<1>() = ways.eigenvectors().col(w) / std::sqrt(moved);
            }
            first_.push_back(first_.back() + own.cols());
            own_.push_back(own);
        }
    }

    Eigen::Index count() const { return first_.back(); }
    std::size_t pieces() const { return own_.size(); }
    bool has(std::size_t p) const { return of_[p] >= 0; }
    std::size_t firm_piece(std::size_t p) const { return std::size_t(of_[p]); }
    Vec3 place(std::size_t p) const {
        return matter_.particle_position.at(p) / matter_.lattice.spacing;
    }
    // Of each firm piece, how much of `motion`, a unit vector, is its.
    double part(std::size_t piece, const Vector& motion) const {
        return motion.segment(first_[piece], own_[piece].cols()).squaredNorm();
    }
    // The motions in which all go together, by columns.
    Matrix together() const {
        Matrix all(count(), 6);
        const Vec3 middle = center_[0];
        for (std::size_t n = 0; n < own_.size(); ++n) {
            for (int m = 0; m < 6; ++m) {
                const Vec3 turn = m < 3 ? Vec3(Vec3::Zero()) : Vec3(Vec3::Unit(m - 3));
                Motion motion;
                motion << (m < 3 ? Vec3(Vec3::Unit(m)) : Vec3(turn.cross(center_[n] - middle))),
                    turn;
                all.col(m).segment(first_[n], own_[n].cols()) =
                    own_[n].transpose() * (square_[n] * motion);
            }
        }
        return all;
    }
    // What moves a mean of particles by these shares is held by `stiffness`: adds it.
    void add(const std::vector<std::pair<std::size_t, double>>& share, const Mat3& stiffness,
             Matrix& sum) const {
        for (const auto& [p, w] : share) {
            for (const auto& [q, v] : share) {
                const std::size_t n = firm_piece(p), m = firm_piece(q);
                sum.block(first_[n], first_[m], own_[n].cols(), own_[m].cols()) +=
                    own_[n].transpose() *
                    (w * v * moves_of(p).transpose() * stiffness * moves_of(q)) * own_[m];
            }
        }
    }

  private:
    using Mat6 = Eigen::Matrix<double, 6, 6>;
    using Moves = Eigen::Matrix<double, 3, 6>;
    using Own = Eigen::Matrix<double, 6, Eigen::Dynamic>;

    template <typename Act>
    void each_particle(const Act& act) const {
        for (std::size_t p = 0; p < of_.size(); ++p) {
            if (has(p)) act(p, firm_piece(p));
        }
    }
    Moves moves_of(std::size_t p) const {
        const Vec3 arm = place(p) - center_[firm_piece(p)];
        Moves moves;
        moves << 1, 0, 0, 0, arm.z(), -arm.y(),  //
            0, 1, 0, -arm.z(), 0, arm.x(),       //
            0, 0, 1, arm.y(), -arm.x(), 0;
        return moves;
    }

    const Aggregate& matter_;
    std::vector<int> of_;
    std::vector<Vec3> center_;
    std::vector<double> members_;
    std::vector<Mat6> square_;               // of the points' motions, the mean
    std::vector<Eigen::Index> first_ = {0};  // of each one's motions; one more at the end
    std::vector<Own> own_;
};

// Motions, of those that have no stiffness, in which the firm pieces do not all go together.
Matrix free_motions(const FirmMotions& motions, const Matrix& stiffness) {
    const Eigen::SelfAdjointEigenSolver<Matrix> modes(stiffness);
    const Eigen::Index count = (modes.eigenvalues().array() < kFree).count();
    if (count == 0) return Matrix(motions.count(), 0);
    const Matrix free = modes.eigenvectors().leftCols(count);
    const Eigen::HouseholderQR<Matrix> split(motions.together());
    const Matrix together =
        split.householderQ() *
        Matrix::Identity(motions.count(), std::min<Eigen::Index>(6, motions.count()));
    const Matrix apart = free - together * (together.transpose() * free);
    const Eigen::SelfAdjointEigenSolver<Matrix> kinds(free.transpose() * apart);
    const Eigen::Index kept = (kinds.eigenvalues().array() > kTogether).count();
    return free * kinds.eigenvectors().rightCols(kept);
}

std::vector<int> hanging_of_piece(const Aggregate& matter, const FirmMotions& motions,
                                  const std::vector<HeldPoint>& held) {
    Matrix stiffness = Matrix::Zero(motions.count(), motions.count());
    for_each_connection(matter, [&](std::size_t a, std::size_t b, double share) {
        if (!motions.has(a) || !motions.has(b) || motions.firm_piece(a) == motions.firm_piece(b))
            return;
        const Vec3 along = (motions.place(b) - motions.place(a)).normalized();
        motions.add({{a, -1}, {b, 1}}, share * along * along.transpose(), stiffness);
    });
    std::vector<char> is_held(motions.pieces(), 0);
    const double unit = matter.mean_modulus() * matter.lattice.spacing;
    for (const HeldPoint& h : held) {
        std::vector<std::pair<std::size_t, double>> share;
        for (int c = 0; c < 8; ++c) {
            if (h.weight[c] != 0 && motions.has(h.corner[c])) {
                share.emplace_back(h.corner[c], h.weight[c]);
                is_held[motions.firm_piece(h.corner[c])] = 1;
            }
        }
        motions.add(share, h.stiffness / unit, stiffness);
    }
    const Matrix free = free_motions(motions, stiffness);
    std::vector<int> hanging;
    for (std::size_t n = 0; n < motions.pieces(); ++n) {
        double part = 0;
        for (const auto& motion : free.colwise()) part += motions.part(n, motion);
        if (part > kTakesPart && !is_held[n]) hanging.push_back(static_cast<int>(n));
    }
    return hanging;
}

}  // namespace

Pieces find_firm_pieces(const Aggregate& matter, const std::vector<HeldPoint>& held) {
    DisjointSets sets(matter.particle_count());
    std::vector<char> joined(matter.particle_count(), 0);
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            std::array<ParticleId, 4> row = run.row;
            for (ParticleId& p : row) p += n;
            if (!cell_is_whole(matter, row)) continue;
            for (ParticleId p : row) {
                sets.unite(row[0], p);
                sets.unite(row[0], p + 1);
                joined[p] = joined[p + 1] = 1;
            }
        }
    }
    // Of the others, each by itself: what stiffness it has where all else stands still.
    std::vector<Mat3> stiffness(joined.size(), Mat3::Zero());
    for_each_connection(matter, [&](std::size_t a, std::size_t b, double share) {
        if (joined[a] && joined[b]) return;
        const Vec3Array& x = matter.particle_position;
        const Vec3 along = (x.at(b) - x.at(a)).normalized();
        stiffness[a] += share * along * along.transpose();
        stiffness[b] += share * along * along.transpose();
    });
    const double unit = matter.mean_modulus() * matter.lattice.spacing;
    for (const HeldPoint& h : held) {
        for (int c = 0; c < 8; ++c) {
            stiffness[h.corner[c]] += h.weight[c] * h.weight[c] / unit * h.stiffness;
        }
    }
    const auto is_firm = [&](std::size_t p) {
        const Eigen::SelfAdjointEigenSolver<Mat3> ways(stiffness[p], Eigen::EigenvaluesOnly);
        return joined[p] || ways.eigenvalues()[0] > kFree;
    };
    bool goes_on = true;
    while (std::exchange(goes_on, false)) {
        for_each_connection(matter, [&](std::size_t a, std::size_t b, double) {
            if (joined[a] == joined[b] || !is_firm(joined[a] ? b : a)) return;
            sets.unite(static_cast<int>(a), static_cast<int>(b));
            joined[a] = joined[b] = 1;
            goes_on = true;
        });
    }
    Pieces firm;
    firm.count = sets.number_sets(firm.particle_piece);
    return firm;
}

std::vector<int> find_hanging(const Aggregate& matter, const Pieces& pieces, const Pieces& firm,
                              const std::vector<HeldPoint>& held) {
    std::vector<int> size(static_cast<std::size_t>(firm.count), 0);
    for (int n : firm.particle_piece) ++size[n];
    std::vector<std::vector<int>> of_piece(static_cast<std::size_t>(pieces.count));
    std::vector<int> number(size.size(), -1), hanging;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const int f = firm.particle_piece[p];
        std::vector<int>& of = of_piece[pieces.particle_piece[p]];
        if (number[f] >= 0) continue;
        if (size[f] == 1) {
            hanging.push_back(f);
            continue;
        }
        number[f] = static_cast<int>(of.size());
        of.push_back(f);
    }
    for (std::size_t n = 0; n < of_piece.size(); ++n) {
        if (of_piece[n].size() < 2 || of_piece[n].size() > kMostFirmPieces) continue;
        std::vector<int> of(matter.particle_count(), -1);
        for (std::size_t p = 0; p < of.size(); ++p) {
            if (pieces.particle_piece[p] == int(n)) of[p] = number[firm.particle_piece[p]];
        }
        const FirmMotions motions(matter, std::move(of), of_piece[n].size());
        for (int h : hanging_of_piece(matter, motions, held)) hanging.push_back(of_piece[n][h]);
    }
    return hanging;
}

}  // namespace swage

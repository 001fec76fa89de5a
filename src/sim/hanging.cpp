// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/hanging.h"

#include <Eigen/Eigenvalues>
#include <utility>

#include "base/principal_axes.h"
#include "geometry/disjoint_sets.h"
#include "matter/connections.h"

namespace swage {

namespace {

constexpr std::size_t kMostFirmPieces = 200;
// Of the stiffness of a connection, against a motion by one of a piece's own points (root of the
// mean square): less is none.
constexpr double kFree = 1e-5;
constexpr double kTakesPart = 1e-3;  // share of a piece in the free motions
constexpr double kTogether = 1e-6;   // what is less apart than this is not, squared
constexpr double kNoMotion = 1e-9;   // that a turn is of the points of a piece, squared

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Motion = Eigen::Matrix<double, 6, 1>;  // along, and a turn about the piece's centre

// Motions of the firm pieces of one piece, up to six each, of which every one moves their points by
// one (root of the mean square). Lengths are in spacings.
class FirmMotions {
  public:
    // `particle`: of these firm pieces; `number`: of each particle's firm piece among them.
    FirmMotions(const Aggregate& matter, const std::vector<ParticleId>& particle,
                const std::vector<int>& number, std::size_t count)
        : matter_(matter), number_(number), center_(count, Vec3::Zero()) {
        std::vector<double> members(count, 0.0);
        for (ParticleId p : particle) {
            center_[firm_piece(p)] += place(p);
            ++members[firm_piece(p)];
        }
        for (std::size_t n = 0; n < count; ++n) center_[n] /= members[n];
        square_.assign(count, Mat6::Zero());
        for (ParticleId p : particle) {
            const Moves moves = moves_of(p);
            square_[firm_piece(p)] += moves.transpose() * moves / members[firm_piece(p)];
        }
        for (const Mat6& s : square_) {
            const Eigen::SelfAdjointEigenSolver<Matrix> ways(s);
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
    std::size_t firm_piece(ParticleId p) const { return std::size_t(number_[p]); }
    Vec3 place(ParticleId p) const {
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
    void add(const std::vector<std::pair<ParticleId, double>>& share, const Mat3& stiffness,
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

    Moves moves_of(ParticleId p) const {
        const Vec3 arm = place(p) - center_[firm_piece(p)];
        Moves moves;
        moves << 1, 0, 0, 0, arm.z(), -arm.y(),  //
            0, 1, 0, -arm.z(), 0, arm.x(),       //
            0, 0, 1, arm.y(), -arm.x(), 0;
        return moves;
    }

    const Aggregate& matter_;
    const std::vector<int>& number_;
    std::vector<Vec3> center_;
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
    const Matrix together = motions.together();
    const Eigen::SelfAdjointEigenSolver<Matrix> ways(together.transpose() * together);
    Matrix apart = free;
    for (int w = 0; w < 6; ++w) {
        const double size = ways.eigenvalues()[w];
        if (size < kNoMotion * ways.eigenvalues()[5]) continue;
        const Vector way = together * ways.eigenvectors().col(w);
        apart -= way * (way.transpose() * free) / size;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> kinds(free.transpose() * apart);
    const Eigen::Index kept = (kinds.eigenvalues().array() > kTogether).count();
    return free * kinds.eigenvectors().rightCols(kept);
}

// A connection between firm pieces.
struct Link {
    ParticleId lower, upper;
    double share;
};

// A piece of two firm ones or more.
struct LinkedPiece {
    std::vector<int> firm;  // by their numbers in the piece
    std::vector<ParticleId> particle;
    std::vector<Link> link;
};

// By their numbers in the piece. `own`: of each particle, whether it is of this piece.
template <typename Own>
std::vector<int> hanging_of(const Aggregate& matter, const LinkedPiece& piece,
                            const std::vector<int>& number, const std::vector<HeldPoint>& held,
                            const Own& own) {
    const FirmMotions motions(matter, piece.particle, number, piece.firm.size());
    Matrix stiffness = Matrix::Zero(motions.count(), motions.count());
    for (const Link& l : piece.link) {
        const Vec3 along = (motions.place(l.upper) - motions.place(l.lower)).normalized();
        motions.add({{l.lower, -1}, {l.upper, 1}}, l.share * along * along.transpose(), stiffness);
    }
    std::vector<char> is_held(piece.firm.size(), 0);
    const double unit = matter.mean_modulus() * matter.lattice.spacing;
    for (const HeldPoint& h : held) {
        std::vector<std::pair<ParticleId, double>> share;
        for (int c = 0; c < 8; ++c) {
            if (h.weight[c] == 0 || !own(h.corner[c])) continue;
            share.emplace_back(h.corner[c], h.weight[c]);
            is_held[motions.firm_piece(h.corner[c])] = 1;
        }
        motions.add(share, h.stiffness / unit, stiffness);
    }
    const Matrix free = free_motions(motions, stiffness);
    std::vector<int> hanging;
    for (std::size_t n = 0; n < piece.firm.size(); ++n) {
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
            const std::array<ParticleId, 4> row = run.row_at(n);
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
    const Vec3Array& x = matter.particle_position;
    for_each_connection(matter.lattice, matter.connection,
                        [&](ParticleId a, ParticleId b, double share) {
                            if (joined[a] && joined[b]) return;
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
    std::vector<char> is_firm = joined;
    for (std::size_t p = 0; p < is_firm.size(); ++p) {
        if (joined[p]) continue;
        is_firm[p] = principal_values(stiffness[p])[0] > kFree;
    }
    // From whole cells on, then from what has none near it.
    for (bool anew : {false, true}) {
        bool goes_on = true;
        while (std::exchange(goes_on, false)) {
            for_each_connection(
                matter.lattice, matter.connection, [&](ParticleId a, ParticleId b, float) {
                    if (joined[a] && joined[b]) return;
                    if (!is_firm[a] || !is_firm[b] || !(anew || joined[a] || joined[b])) return;
                    sets.unite(a, b);
                    joined[a] = joined[b] = 1;
                    goes_on = true;
                });
        }
    }
    Pieces firm;
    firm.count = sets.number_sets(firm.particle_piece);
    return firm;
}

std::vector<int> find_hanging(const Aggregate& matter, const Pieces& pieces, const Pieces& firm,
                              const std::vector<HeldPoint>& held) {
    std::vector<int> size(static_cast<std::size_t>(firm.count), 0);
    for (int n : firm.particle_piece) ++size[n];
    std::vector<LinkedPiece> linked(static_cast<std::size_t>(pieces.count));
    std::vector<int> number_of(size.size(), -1), number(firm.particle_piece.size(), -1), hanging;
    for (std::size_t p = 0; p < number.size(); ++p) {
        const int f = firm.particle_piece[p];
        if (size[f] == 1) {
            hanging.push_back(f);
            continue;
        }
        LinkedPiece& piece = linked[pieces.particle_piece[p]];
        if (number_of[f] < 0) {
            number_of[f] = static_cast<int>(piece.firm.size());
            piece.firm.push_back(f);
        }
        number[p] = number_of[f];
        piece.particle.push_back(static_cast<ParticleId>(p));
    }
    for_each_connection(matter.lattice, matter.connection,
                        [&](ParticleId a, ParticleId b, double share) {
                            if (number[a] < 0 || number[b] < 0 || number[a] == number[b]) return;
                            linked[pieces.particle_piece[a]].link.push_back({a, b, share});
                        });
    for (std::size_t n = 0; n < linked.size(); ++n) {
        const LinkedPiece& piece = linked[n];
        if (piece.firm.size() < 2 || piece.firm.size() > kMostFirmPieces) continue;
        const auto own = [&](ParticleId p) {
            return number[p] >= 0 && pieces.particle_piece[p] == static_cast<int>(n);
        };
        for (int h : hanging_of(matter, piece, number, held, own)) {
            hanging.push_back(piece.firm[h]);
        }
    }
    return hanging;
}

}  // namespace swage

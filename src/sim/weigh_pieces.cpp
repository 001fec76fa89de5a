// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/weigh_pieces.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "geometry/disjoint_sets.h"
#include "matter/piece_shares.h"

namespace swage {

namespace {

constexpr double kLeast = 0.25;  // of what its particles had, that a piece gets
constexpr double kSlope = 0.5;   // by how much of the mean a particle's factor differs at most
constexpr double kFlat = 0.01;   // mean square of a piece's extent, below which it is flat [cells2]

// Of the particles that have the same number.
struct Sum {
    double mass = 0;
    Vec3 moment = Vec3::Zero(), momentum = Vec3::Zero(), spin = Vec3::Zero();  // spin: about centre
    Mat3 second = Mat3::Zero();  // of mass about the centre

    Vec3 centre() const { return moment / mass; }
    Mat3 inertia() const { return second.trace() * Mat3::Identity() - second; }
};

std::vector<Sum> sums(const Aggregate& matter, std::span<const int> number, std::size_t count,
                      const auto& place) {
    std::vector<Sum> all(count);
    for (std::size_t p = 0; p < number.size(); ++p) {
        Sum& own = all[number[p]];
        const double m = matter.particle_mass[p];
        own.mass += m;
        own.moment += m * place(p);
        own.momentum += m * matter.particle_velocity.at(p);
    }
    for (std::size_t p = 0; p < number.size(); ++p) {
        Sum& own = all[number[p]];
        const double m = matter.particle_mass[p];
        const Vec3 arm = place(p) - own.centre();
        own.spin += m * arm.cross(matter.particle_velocity.at(p) - own.momentum / own.mass);
        own.second += m * arm * arm.transpose();
    }
    return all;
}

// Of each piece, given which it was part of: all the mass that this had is shared out.
void share_out(const std::vector<Sum>& have, const std::vector<int>& was,
               std::vector<PieceShare>& share) {
    struct Whole {
        double mass = 0, at_particles = 0, least = 0, more = 0;
    };
    std::vector<Whole> whole(share.size());
    const auto is_least = [](const PieceShare& own) {
        return own.mass < kLeast * own.at_particles;
    };
    for (std::size_t n = 0; n < share.size(); ++n) {
        Whole& of = whole[was[n]];
        of.mass += have[n].mass;
        of.at_particles += share[n].at_particles;
        is_least(share[n]) ? of.least += kLeast * share[n].at_particles : of.more += share[n].mass;
    }
    for (std::size_t n = 0; n < share.size(); ++n) {
        PieceShare& own = share[n];
        const Whole& of = whole[was[n]];
        const bool is_enough = of.more > 0 && of.mass > of.least;
        const double mass = !is_enough      ? of.mass * own.at_particles / of.at_particles
                            : is_least(own) ? kLeast * own.at_particles
                                            : own.mass * (of.mass - of.least) / of.more;
        own.moment = own.mass > 0 ? mass / own.mass * own.moment : mass * have[n].centre();
        own.mass = mass;
    }
}

// What the factor of a piece's particles grows by along a line [1/m], beside a mean of 1.
Vec3 slope_of(const Sum& have, const PieceShare& wanted, double spacing) {
    const Vec3 off = wanted.moment / wanted.mass - have.centre();
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(have.second / have.mass);
    Vec3 slope = Vec3::Zero();
    for (int d = 0; d < 3; ++d) {
        const double square = axes.eigenvalues()[d];
        if (square < kFlat * spacing * spacing) continue;
        const Vec3 axis = axes.eigenvectors().col(d);
        slope += axis.dot(off) / square * axis;
    }
    return slope;
}

void keep_motion(const std::vector<Sum>& before, std::span<const int> number, Aggregate& matter) {
    const auto place = [&](std::size_t p) { return matter.particle_position.at(p); };
    const std::vector<Sum> after = sums(matter, number, before.size(), place);
    std::vector<Vec3> shift(before.size(), Vec3::Zero()), turn = shift;
    for (std::size_t n = 0; n < after.size(); ++n) {
        const bool is_same =
            after[n].momentum == before[n].momentum && after[n].spin == before[n].spin;
        if (after[n].mass == 0 || is_same) continue;
        shift[n] = (before[n].momentum - after[n].momentum) / after[n].mass;
        turn[n] = solve_symmetric(after[n].inertia(), before[n].spin - after[n].spin);
    }
    for (std::size_t p = 0; p < number.size(); ++p) {
        const std::size_t n = number[p];
        if (shift[n] == Vec3::Zero() && turn[n] == Vec3::Zero()) continue;
        matter.particle_velocity.add(p, shift[n] + turn[n].cross(place(p) - after[n].centre()));
    }
}

}  // namespace

double kinetic_energy(const Aggregate& matter) {
    double sum = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        sum += 0.5 * matter.particle_mass[p] * matter.particle_velocity.at(p).squaredNorm();
    }
    return sum;
}

double weigh_pieces(Aggregate& matter, std::span<const SeverEvent> events) {
    const Pieces pieces = find_pieces(matter);
    const std::size_t count = pieces.count;
    DisjointSets joined(count);
    std::vector<char> is_new(count, 0);
    bool parts = false;
    for (const SeverEvent& e : events) {
        const int one = pieces.particle_piece[e.lower], other = pieces.particle_piece[e.upper];
        if (one == other) continue;
        joined.unite(one, other);
        is_new[one] = is_new[other] = 1;
        parts = true;
    }
    if (!parts) return 0;
    std::vector<int> was, whole;  // of each piece the number of what it was part of; of particles
    for (std::size_t n = 0; n < count; ++n) was.push_back(joined.root(static_cast<int>(n)));
    for (int piece : pieces.particle_piece) whole.push_back(was[piece]);
    const auto place = [&](std::size_t p) { return matter.particle_position.at(p); };
    const auto molded = [&](std::size_t p) { return matter.particle_reference.at(p); };
    const double energy = kinetic_energy(matter);
    std::vector<Sum> before;
    if (energy > 0) before = sums(matter, whole, count, place);

    const std::vector<Sum> have = sums(matter, pieces.particle_piece, count, molded);
    std::vector<PieceShare> wanted = shares_of_pieces(matter, pieces);
    share_out(have, was, wanted);
    std::vector<Vec3> slope(count, Vec3::Zero());
    std::vector<double> most(count, 0.0);
    for (std::size_t n = 0; n < count; ++n) {
        if (is_new[n]) slope[n] = slope_of(have[n], wanted[n], matter.lattice.spacing);
    }
    const auto rise = [&](std::size_t p) {
        const int n = pieces.particle_piece[p];
        return slope[n].dot(molded(p) - have[n].centre());
    };
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        double& of = most[pieces.particle_piece[p]];
        of = std::max(of, std::abs(rise(p)));
    }
    for (std::size_t n = 0; n < count; ++n) {
        if (most[n] > kSlope) slope[n] *= kSlope / most[n];
    }
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const int n = pieces.particle_piece[p];
        if (is_new[n]) matter.particle_mass[p] *= wanted[n].mass / have[n].mass * (1 + rise(p));
    }
    if (!(energy > 0)) return 0;
    keep_motion(before, whole, matter);
    return energy - kinetic_energy(matter);
}

}  // namespace swage

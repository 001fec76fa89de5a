// SPDX-License-Identifier: GPL-3.0-or-later
// What makes slow motions come to rest: smooth motions, their stiffness and its factor.
#include <Eigen/Geometry>
#include <random>

#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/coarse_space.h"
#include "sim/lattice_forces.h"
#include "sim/vector_sums.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1;

// A box with a hole through it and a corner gone: rows in parts, nodes that no particle follows,
// and beside the hole two where splines as coarse as it stand once.
Lattice pierced_lattice(const Vec3i& count) {
    std::vector<Vec3i> cells;
    for (int k = 0; k < count.z(); ++k) {
        for (int j = 0; j < count.y(); ++j) {
            for (int i = 0; i < count.x(); ++i) {
                const bool hole = std::abs(i - 9) < 4 && std::abs(j - 6) < 3;
                if (!hole && !(i > 15 && j > 8)) cells.emplace_back(i, j, k);
            }
        }
    }
    return make_lattice(Vec3::Zero(), 1, count, cells);
}

std::array<ConnectionArrays, kForwardCount> whole_connections(std::size_t particles) {
    std::array<ConnectionArrays, kForwardCount> connection;
    for (ConnectionArrays& one : connection) one.weight = SparseArray<float>(particles, 1.0f);
    return connection;
}

Eigen::VectorXd random_vector(Eigen::Index size, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    Eigen::VectorXd v(size);
    for (double& x : v) x = draw(engine);
    return v;
}

}  // namespace

TEST_CASE("a spline space holds what bends and shears, and goes back as it goes on") {
    const Vec3i count(23, 14, 9);
    const Lattice lattice = pierced_lattice(count);
    std::size_t particles = 0;
    for (const ParticleRun& run : lattice.particle_run) particles += run.count;
    for (const Vec3i& elements : {Vec3i(1, 1, 1), Vec3i(5, 3, 2), Vec3i(23, 14, 9)}) {
        const SplineSpace space(lattice, whole_connections(particles), elements);
        // x^2 has the coefficients c^2 - 1/4, c being a node's middle (by the splines' blossoms).
        Eigen::VectorXd motion(3 * space.node_count());
        for (int n = 0; n < space.node_count(); ++n) {
            const Vec3 c = space.parts().place[n].cast<double>() - Vec3::Constant(0.5);
            motion.segment<3>(3 * n) =
                Vec3(1 + c.x() * c.y(), c.x() * c.x() - 0.25 + 2 * c.z(),
                     (c.y() * c.y() - 0.25) * (c.z() * c.z() - 0.25) * c.x());
        }
        Vec3Array fine;
        fine.x.assign(particles, 2.0), fine.y = fine.x, fine.z = fine.x;
        space.add(motion, 0.5, fine);
        double off = 0;
        for (const ParticleRun& run : lattice.particle_run) {
            for (int n = 0; n < run.count; ++n) {
                const Vec3 at = Vec3(run.i + n, run.j, run.k)
                                    .cwiseProduct(elements.cast<double>())
                                    .cwiseQuotient(count.cast<double>());
                const Vec3 asked(2 + at.x() * at.y(), 1 + at.x() * at.x() + 2 * at.z(),
                                 1 + at.y() * at.y() * at.z() * at.z() * at.x());
                off = std::max(off, (fine.at(run.first + n) - asked).norm() / asked.norm());
            }
        }
        CHECK(off < 1e-13);

        Vec3Array force;
        const auto part = [&](unsigned seed) {
            const Eigen::VectorXd v = random_vector(Eigen::Index(particles), seed);
            return std::vector<double>(v.begin(), v.end());
        };
        force.x = part(1), force.y = part(2), force.z = part(3);
        const Eigen::VectorXd way = random_vector(3 * space.node_count(), 4);
        Vec3Array moved;
        set_zero(particles, moved);
        space.add(way, 1, moved);
        CHECK(space.restricted(force).dot(way) == Approx(dot(force, moved)).epsilon(1e-11));
    }
}

TEST_CASE("a spline space reaches over no cut, and round the end of one") {
    constexpr int kLong = 40, kCut = 17;
    Aggregate m = make_block(kLong, 8, 3, kSpacing, {});
    // Severed between the sites kCut and kCut + 1 along x, from y = 0 to `deep`.
    const auto cut = [&](int deep) {
        for (const Span& span : m.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                const ParticleId low = span.lower + n, high = span.upper + n;
                const auto site = [&](ParticleId p) {
                    return Vec3((m.particle_reference.at(p) - m.lattice.origin) / kSpacing);
                };
                const double side = (site(low).x() - kCut - 0.5) * (site(high).x() - kCut - 0.5);
                if (side > 0 || std::min(site(low).y(), site(high).y()) > deep + 0.5) continue;
                m.connection[span.direction].weight.set(low, 0);
            }
        }
    };
    const auto is_left = [&](std::size_t p) {
        return m.particle_reference.at(p).x() < m.lattice.origin.x() + (kCut + 0.5) * kSpacing;
    };
    const Vec3i elements(10, 2, 1);
    const int whole = SplineSpace(m.lattice, m.connection, elements).node_count();
    CHECK(whole == 12 * 4 * 3);

    cut(4);
    const SplineSpace slit(m.lattice, m.connection, elements);
    // Of those across the slit only the ones that do not reach its end stand twice.
    CHECK(slit.node_count() == whole + 3 * 1 * 3);
    for (int n = whole; n < slit.node_count(); ++n) CHECK(slit.parts().place[n].y() == 0);

    cut(8);
    const SplineSpace space(m.lattice, m.connection, elements);
    CHECK(space.node_count() == whole + 3 * 4 * 3);
    Vec3Array left, moved;
    set_zero(m.particle_count(), left);
    set_zero(m.particle_count(), moved);
    for (std::size_t p = 0; p < left.size(); ++p) {
        if (is_left(p)) left.set(p, Vec3(1, std::sin(double(p)), 2));
    }
    const Eigen::VectorXd motion = space.restricted(left);
    space.add(motion, 1, moved);
    CHECK(motion.squaredNorm() == Approx(dot(left, moved)).epsilon(1e-12));
    double over = 0, own = 0;
    for (std::size_t p = 0; p < left.size(); ++p) {
        double& most = is_left(p) ? own : over;
        most = std::max(most, moved.at(p).norm());
    }
    CHECK(own > 1);
    CHECK(over == 0);

    // Nor does what these motions ask of the matter.
    LatticeForces lattice(m);
    CoarseSpace coarse(m);
    coarse.limit_gain(1e4);
    coarse.find_stiffness(m, [&](Vec3Array& f) { lattice.find(m, Flow::none, f); });
    coarse.find_masses(std::vector<double>(m.particle_count(), 1e5));
    coarse.hold(m, {});
    REQUIRE(coarse.gains());
    set_zero(m.particle_count(), moved);
    coarse.add(left, 1, 0, moved);
    own = over = 0;
    for (std::size_t p = 0; p < left.size(); ++p) {
        double& most = is_left(p) ? own : over;
        most = std::max(most, moved.at(p).norm());
    }
    CHECK(own > 0);
    CHECK(over < 1e-12 * own);

    // Where both sides press on each other they move less for it, still each by itself.
    PressedPlaces both{};
    const auto end_of = [&](bool of_left) {
        for (std::size_t p = 0; p < left.size(); ++p) {
            const double x = m.particle_reference.at(p).x() - m.lattice.origin.x();
            if (is_left(p) == of_left && std::abs(x - (kCut + 0.5) * kSpacing) < kSpacing) return p;
        }
        return left.size();
    };
    both.particle[0] = ParticleId(end_of(true)), both.particle[8] = ParticleId(end_of(false));
    both.weight[0] = 1, both.weight[8] = -1;
    both.stiffness = 1e12;
    coarse.hold(m, {}, {both});
    REQUIRE(coarse.gains());
    Vec3Array held;
    set_zero(m.particle_count(), held);
    coarse.add(left, 1, 0, held);
    CHECK(held.at(end_of(true)).norm() < 0.01 * moved.at(end_of(true)).norm());
    for (std::size_t p = 0; p < left.size(); ++p) {
        if (!is_left(p)) CHECK(held.at(p).norm() < 1e-12 * own);
    }
}

TEST_CASE("of very many pieces none is told from what is beside it") {
    Aggregate m = make_block(12, 12, 12, kSpacing, {});
    for (ConnectionArrays& c : m.connection) {
        c.weight = SparseArray<float>(m.particle_count(), 0.0f);
    }
    const SplineSpace space(m.lattice, m.connection, Vec3i::Constant(12));
    CHECK(space.node_count() == 14 * 14 * 14);
    Vec3Array moved;
    set_zero(m.particle_count(), moved);
    space.add(Eigen::VectorXd::Ones(3 * space.node_count()), 1, moved);
    for (std::size_t p = 0; p < moved.size(); ++p) {
        REQUIRE((moved.at(p) - Vec3::Ones()).norm() < 1e-14);
    }
}

TEST_CASE("sums of masses by part are those of the motions that its nodes make") {
    const Vec3i count(23, 14, 9), elements(5, 3, 2);
    const Lattice lattice = pierced_lattice(count);
    std::size_t particles = 0;
    for (const ParticleRun& run : lattice.particle_run) particles += run.count;
    const SplineSpace space(lattice, whole_connections(particles), elements);
    Eigen::VectorXd mass = random_vector(Eigen::Index(particles), 8);
    mass.array() += 2;
    const auto sums = space.masses({mass.begin(), mass.end()});
    const Eigen::VectorXd motion = random_vector(3 * space.node_count(), 9);
    Vec3Array moved;
    set_zero(particles, moved);
    space.add(motion, 1, moved);
    double asked = 0, found = 0;
    for (std::size_t p = 0; p < particles; ++p) {
        asked += mass[Eigen::Index(p)] * moved.at(p).squaredNorm();
    }
    for (std::size_t part = 0; part < sums.size(); ++part) {
        const SplineParts::Nodes& node = space.parts().node[part];
        for (int a = 0; a < SplineParts::kNodes; ++a) {
            for (int b = 0; b < SplineParts::kNodes; ++b) {
                found += sums[part][SplineSpace::pair_of(a % 3, b % 3) +
                                    6 * SplineSpace::pair_of(a / 3 % 3, b / 3 % 3) +
                                    36 * SplineSpace::pair_of(a / 9, b / 9)] *
                         motion.segment<3>(3 * node[a]).dot(motion.segment<3>(3 * node[b]));
            }
        }
    }
    CHECK(found == Approx(asked).epsilon(1e-12));
}

TEST_CASE("a factor in panels solves what its matrix asks, and tells what is not definite") {
    constexpr int kNodes = 60;
    std::vector<std::pair<int, int>> pair;
    std::mt19937 engine(5);
    std::uniform_int_distribution<int> draw(0, kNodes - 1);
    Eigen::MatrixXi coupled = Eigen::MatrixXi::Zero(kNodes, kNodes);
    const auto couple = [&](int a, int b) {
        if (coupled(a, b)++ == 0) pair.emplace_back(a, b), coupled(b, a) = 1;
    };
    for (int n = 0; n < kNodes; ++n) couple(n, n), couple(n, (n + 1) % kNodes);
    for (int n = 0; n < 40; ++n) couple(draw(engine), draw(engine));
    PanelCholesky factor(kNodes, pair);
    Eigen::SparseMatrix<double>& matrix = factor.matrix();
    const Eigen::VectorXd value = random_vector(matrix.nonZeros(), 6);
    for (double diagonal : {12.0, -1.0}) {
        std::copy(value.begin(), value.end(), matrix.valuePtr());
        for (int n = 0; n < 3 * kNodes; ++n) matrix.coeffRef(n, n) = diagonal;
        REQUIRE(factor.factor() == (diagonal > 0));
        if (diagonal < 0) continue;
        const Eigen::VectorXd b = random_vector(3 * kNodes, 7), x = factor.solved(b);
        Eigen::VectorXd by_place(3 * kNodes), asked(3 * kNodes);
        for (int n = 0; n < kNodes; ++n) {
            by_place.segment<3>(3 * n) = x.segment<3>(3 * factor.node_at(n));
            asked.segment<3>(3 * n) = b.segment<3>(3 * factor.node_at(n));
        }
        CHECK((matrix.selfadjointView<Eigen::Lower>() * by_place - asked).norm() < 1e-13);
    }
}

TEST_CASE("a force that a smooth motion asks for moves the body by half of that motion") {
    Aggregate m = make_block(21, 6, 4, kSpacing, {.young_modulus = 1e6, .poisson_ratio = 0.4});
    LatticeForces lattice(m);
    const auto forces = [&](Vec3Array& f) { lattice.find(m, Flow::none, f); };
    // Turned, and drawn a little, so that stress turns with the matter.
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        m.particle_position.set(p, turn * Vec3(1.02 * x.x(), x.y(), x.z()));
    }
    // Held across one end.
    std::vector<HeldPoint> held;
    for (int point : points_where(m, [](const Vec3& x) { return x.x() < -1.04; })) {
        held.push_back(
            held_point(m.surface, point, 2e4 * Vec3(1, 0.5, 0.1).asDiagonal().toDenseMatrix()));
    }
    CoarseSpace coarse(m);
    coarse.limit_gain(1e8);
    CHECK(coarse.is_stale(m.particle_position));
    coarse.find_stiffness(m, forces);
    coarse.find_masses(std::vector<double>(m.particle_count(), 1e5));
    coarse.hold(m, held);
    REQUIRE(coarse.gains());

    const double step = 1e-6 * kSpacing;
    const Vec3Array before = m.particle_position;
    Vec3Array here, way, force;
    forces(here);
    way.resize(before.size());
    for (std::size_t p = 0; p < way.size(); ++p) {
        const Vec3 x = m.particle_reference.at(p);
        way.set(p, step * Vec3(1 + x.y() * x.x(), x.x() * x.x() - x.z(), 2 * x.x() * x.z()));
    }
    combine(1, 1, way, m.particle_position);
    forces(force);
    m.particle_position = before;
    combine(-1, 1, here, force);  // K times the way
    for (const HeldPoint& h : held) {
        Vec3 moved = Vec3::Zero();
        for (int c = 0; c < 8; ++c) moved += h.weight[c] * way.at(h.corner[c]);
        for (int c = 0; c < 8; ++c) {
            force.set(h.corner[c], force.at(h.corner[c]) + h.weight[c] * (h.stiffness * moved));
        }
    }
    Vec3Array found;
    set_zero(way.size(), found);
    coarse.add(force, 2, 0, found);
    combine(-1, 1, way, found);
    // As well as differences tell the stiffness of what is softest.
    CHECK(std::sqrt(dot(found, found) / dot(way, way)) < 5e-3);

    // What only goes along and turns a little is known still; what has turned further is not.
    const auto turned = [&](double angle) {
        const Mat3 more = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
        Vec3Array x = before;
        for (std::size_t p = 0; p < x.size(); ++p) x.set(p, more * x.at(p) + Vec3(3, 0, 0));
        return x;
    };
    CHECK(!coarse.is_stale(turned(0.08)));
    CHECK(coarse.is_stale(turned(0.15)));
}

TEST_CASE("a bar under a tool comes to rest in a time that grows no faster than its length") {
    const auto iterations = [](int cells) {
        const double length = cells * kSpacing;
        Aggregate m = make_block(cells, 2, 6, kSpacing, {.young_modulus = 1e7});
        Apparatus apparatus;
        Grip grip;
        for (int point : points_where(m, [&](const Vec3& x) { return x.x() < -0.499 * length; })) {
            grip.point.push_back(point);
            grip.anchor.push_back(m.surface_reference(point));
        }
        apparatus.grip.push_back(grip);
        apparatus.tool.push_back({"roller", CylinderShape{2 * kSpacing, 2}, 0.2});
        Drive from, to;
        from.world_from_grip = to.world_from_grip = {Pose{}};
        const Vec3 above(0.4 * length, 3 * kSpacing, 0);
        from.world_from_tool = {{Quat::Identity(), above}};
        to.world_from_tool = {{Quat::Identity(), above - Vec3(0, 0.02 * length, 0)}};
        to.time = 1;
        Simulation simulation(m, apparatus, {});
        const FrameReport report = simulation.advance(from, to);
        return double(report.iterations) / report.increments;
    };
    // By masses alone it takes the square of the length, and more.
    const double brief = iterations(12);
    CHECK(iterations(48) < 6 * brief);
    CHECK(iterations(96) < 10 * brief);
    CHECK(iterations(96) < 1000);
}

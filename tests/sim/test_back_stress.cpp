// SPDX-License-Identifier: GPL-3.0-or-later
// Cells with a back stress (laws/cell_back.h), as the sweep, the books and Newton have them.
#include <random>

#include "matter/matter_state.h"
#include "sim/lattice_forces.h"
#include "sim/vector_clones.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kYield = 1e3, kRise = 2e4, kBack = 800, kOver = 0.01;
const Material kMetal{.young_modulus = 1e6,
                      .poisson_ratio = 0.3,
                      .yield_stress = kYield,
                      .hardening = kRise,
                      .back_stress = kBack,
                      .back_strain = kOver};
const double kFirm = 3 * kMetal.young_modulus / 2.6;  // 3 mu

void shake(Vec3Array& v, std::mt19937& engine, double by) {
    std::uniform_real_distribution<double> draw(-1, 1);
    for (auto* x : {&v.x, &v.y, &v.z}) {
        for (double& c : *x) c += by * draw(engine);
    }
}

Mat3 drawn(double strain) {
    const double thin = std::exp(-0.5 * strain);
    return Vec3(std::exp(strain), thin, thin).asDiagonal();
}
void put(Aggregate& m, const Mat3& gradient) {
    deform(m, [&](const Vec3& x) { return Vec3(gradient * x); });
}
// Kirchhoff's stress of a uniform block.
Mat3 stress_of(const Aggregate& m, LatticeForces& forces) {
    Vec3Array f;
    forces.find(m, Flow::trial, f);
    Mat3 sum = Mat3::Zero();
    for (std::size_t p = 0; p < m.particle_count(); ++p) {
        sum -= f.at(p) * m.particle_position.at(p).transpose();
    }
    return sum / m.volume();
}
double tension(const Aggregate& m, LatticeForces& forces) {
    const Mat3 s = stress_of(m, forces);
    return s(0, 0) - 0.5 * (s(1, 1) + s(2, 2));
}
double back_stress(double p) { return kBack * (1 - std::exp(-p / kOver)); }
double radius(double p) { return kYield + kRise * p - back_stress(p); }

}  // namespace

TEST_CASE("a block that was pulled flows back at the stress that the back stress leaves") {
    for (int steps : {1, 12}) {
        Aggregate m = make_block(9, 2, 2, 0.1, kMetal);
        LatticeForces forces(m);
        double lost = 0;
        for (int n = 1; n <= steps; ++n) {
            put(m, drawn(0.03 * n / steps));
            lost += forces.commit(m).plastic;
        }
        const double p = m.cell_history.hardening()[0];
        const double pulled = tension(m, forces);
        CHECK(pulled == Approx(kYield + kRise * p).epsilon(1e-5));  // what the curve says
        CHECK(lost == Approx(m.volume() * (kYield * p + 0.5 * kRise * p * p)).epsilon(1e-5));
        // Back from there: elastic by the whole width of the surface, no more.
        const double flowed = 0.03 - pulled / kFirm;
        const double onset = flowed + (back_stress(p) - radius(p)) / kFirm;
        put(m, drawn(onset + 2e-5));
        CHECK(forces.commit(m).plastic == 0);
        CHECK(tension(m, forces) > -0.7 * pulled);  // hardened alike it would be as far as that
        put(m, drawn(onset - 2e-5));
        CHECK(forces.commit(m).plastic != 0);
        // Pressed on, and the work of that: the back stress falls from one side to the other.
        double back = 0;
        const double began = m.cell_history.hardening()[0];
        for (int n = 1; n <= steps; ++n) {
            put(m, drawn(onset - 0.02 * n / steps));
            back += forces.commit(m).plastic;
        }
        const double d = m.cell_history.hardening()[0] - p;
        const double fades = std::exp(-d / kOver);
        const double shift = -kBack + (back_stress(p) + kBack) * fades;
        CHECK(tension(m, forces) == Approx(shift - radius(p + d)).epsilon(2e-5));
        const double gone = m.cell_history.hardening()[0] - began;
        const auto integral = [&](double d) {  // of the stress over the flow back
            const double grown = (kYield * (p + d) + 0.5 * kRise * (p + d) * (p + d)) -
                                 kBack * ((p + d) + kOver * std::exp(-(p + d) / kOver));
            return grown + kBack * d + (back_stress(p) + kBack) * kOver * std::exp(-d / kOver);
        };
        CHECK(back == Approx(m.volume() * (integral(d) - integral(d - gone))).epsilon(2e-5));
    }
}

TEST_CASE("a back stress turns with the matter") {
    // Pulled along x, turned by 90 degrees about z, pressed along y: as if it had not been turned.
    Aggregate m = make_block(3, 2, 2, 0.1, kMetal), other = m;
    LatticeForces forces(m), others(other);
    const Mat3 turn = Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitZ()).toRotationMatrix();
    for (double strain : {0.01, 0.03}) {
        put(m, drawn(strain)), put(other, drawn(strain));
        forces.commit(m), others.commit(other);
    }
    for (int n = 1; n <= 6; ++n) {  // what turns does not flow
        put(m, Eigen::AngleAxisd(n * kPi / 12, Vec3::UnitZ()).toRotationMatrix() * drawn(0.03));
        CHECK(forces.commit(m).plastic < 1e-7 * m.volume() * kYield);
    }
    for (double strain : {0.025, 0.01, -0.01}) {
        put(m, turn * drawn(strain)), put(other, drawn(strain));
        const Mat3 stress = stress_of(m, forces), expected = stress_of(other, others);
        CHECK((stress - turn * expected * turn.transpose()).norm() < 1e-5 * expected.norm());
        forces.commit(m), others.commit(other);
    }
    CHECK(m.cell_history.hardening()[0] > 0.045);
}

TEST_CASE(
    "over a cycle work is what is held and what flow took, the back stress's part given back") {
    // Out and back, round corners, each leg in steps; work along them by Simpson's rule.
    for (bool uniform : {true, false}) {
        Aggregate m = make_block(5, 3, 2, 0.1, kMetal);
        std::mt19937 engine(4);
        std::uniform_real_distribution<double> draw(-1, 1);
        if (!uniform) {
            for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
                m.cell_fill[c] = static_cast<float>(0.6 + 0.4 * draw(engine));
                m.cell_centroid.set(c, Eigen::Vector3f(0.2f, -0.1f, 0.1f));
            }
        }
        LatticeForces forces(m);
        const Vec3Array start = m.particle_position;
        std::vector<Vec3Array> corner;
        for (int n = 0; n < 3; ++n) {
            if (uniform) {
                put(m,
                    drawn(0.01 * (n - 1)) + 0.02 * Mat3::NullaryExpr([&] { return draw(engine); }));
            } else {
                m.particle_position = start;
                shake(m.particle_position, engine, 0.002);
            }
            corner.push_back(m.particle_position);
        }
        corner.push_back(start);
        Vec3Array from = start, f;
        double work = 0, lost = 0, flowed = 0;
        for (const Vec3Array& to : corner) {
            constexpr int kSteps = 10, kParts = 16;
            for (int n = 0; n < kSteps; ++n) {
                for (int part = 0; part <= 2 * kParts; ++part) {
                    const double t = (n + 0.5 * part / kParts) / kSteps;
                    for (std::size_t p = 0; p < from.size(); ++p) {
                        m.particle_position.set(p, from.at(p) + t * (to.at(p) - from.at(p)));
                    }
                    forces.find(m, Flow::trial, f);
                    const double weight = part % (2 * kParts) == 0 ? 1 : part % 2 ? 4 : 2;
                    double along = 0;
                    for (std::size_t p = 0; p < from.size(); ++p) {
                        along -= f.at(p).dot(to.at(p) - from.at(p));
                    }
                    work += weight / (6 * kParts * kSteps) * along;
                }
                lost += forces.commit(m).plastic;
            }
            from = to;
        }
        for (float one : m.cell_history.hardening()) flowed += one;
        CHECK(flowed > 0.02 * m.cell_fill.size());
        const double held = forces.elastic_energy(m);
        INFO(work << " = " << held << " + " << lost);
        CHECK(std::abs(work - held - lost) < (uniform ? 1e-5 : 2e-3) * work);
    }
}

TEST_CASE("matter with a back stress has the same bytes by vectors of any width") {
    std::vector<std::vector<double>> force;
    std::vector<std::uint64_t> hash;
    Material curved = kMetal;
    curved.flow_along({{0, 1e3}, {0.005, 1.6e3}, {0.03, 2e3}, {0.2, 3e3}});
    for (const Material& material : {kMetal, curved}) {
        force.clear(), hash.clear();
        for (int width : {8, 4, 2}) {
            limit_vector_width(width);
            Aggregate m = make_block(11, 3, 3, 0.1, material);
            std::mt19937 engine(9);
            LatticeForces forces(m);
            for (int step = 0; step < 4; ++step) {
                shake(m.particle_position, engine, 0.002);
                CHECK(forces.commit(m).plastic > 0);
            }
            Vec3Array f;
            forces.find(m, Flow::trial, f);
            force.push_back(f.x);
            hash.push_back(state_hash(m));
        }
        limit_vector_width(0);
        for (int other : {1, 2}) {
            CHECK(force[other] == force[0]);
            CHECK(hash[other] == hash[0]);
        }
    }
}

TEST_CASE("a look at the forces leaves no trace in the back stress, and a step taken back none") {
    Aggregate m = make_block(3, 2, 2, 0.1, kMetal);
    LatticeForces forces(m);
    put(m, drawn(0.02));
    CHECK(m.cell_back.empty());
    forces.commit(m);
    CHECK(m.cell_back.row[0].size() == m.cell_fill.size());
    MatterState state;
    state.save(m);
    const auto before = state_hash(m);
    const double bears = tension(m, forces);
    put(m, drawn(-0.02));
    tension(m, forces);
    forces.commit(m);
    CHECK(state_hash(m) != before);
    state.restore(m);
    CHECK(state_hash(m) == before);
    CHECK(tension(m, forces) == bears);
}

TEST_CASE("what has no back stress keeps none") {
    Material plain = kMetal;
    plain.back_stress = 0;
    Aggregate m = make_block(3, 2, 2, 0.1, plain);
    LatticeForces forces(m);
    put(m, drawn(0.02));
    CHECK(forces.commit(m).plastic > 0);
    CHECK(m.cell_back.empty());
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "base/parallel.h"
#include "sim/advance.h"
#include "sim/cracking.h"
#include "sim/lattice_forces.h"
#include "tests/catch.h"
#include "tests/shared/block.h"
#include "tests/sim/pulled_bar.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kModulus = 1e9, kStrength = 1e6, kToughness = 20;  // l_c = 2 cm
constexpr double kSide = 0.008, kLength = 0.024;

const Material kPlaster{.young_modulus = 5e8,
                        .poisson_ratio = 0.2,
                        .density = 1200,
                        .strength = 1e6,
                        .toughness = 40,
                        .damping_ratio = 0.02,
                        .friction = 0.5};

Material brittle(Mechanics mechanics) {
    return {.mechanics = mechanics,
            .young_modulus = kModulus,
            .strength = kStrength,
            .toughness = kToughness};
}

// Thinner by a tenth in the cells beyond its middle.
struct Bar : PulledBar {
    double section = 0.9 * kSide * kSide;  // of the thin cells

    Bar(const Material& material, int across, double tolerance = 1e-4)
        : PulledBar(body(material, across), kLength, tolerance) {}
    static Aggregate body(const Material& material, int across) {
        Aggregate m = make_block(int(std::lround(kLength / kSide * across)), across, across,
                                 kSide / across, material);
        for (std::size_t c = 0; c < m.cell_fill.size(); ++c) {
            if (m.lattice.cell_site(int(c)).x() != m.lattice.cell_count.x() / 2) continue;
            m.cell_fill[c] = 0.9f;
            const auto corner = m.lattice.cell_corners(int(c));
            for (const CellConnection& slot : kCellConnection) {
                const bool edge = slot.direction < kEdgeCount;
                SparseArray<float>& weight = m.connection[slot.direction].weight;
                const ParticleId lower = corner[slot.corner];
                weight.set(lower, weight[lower] - (edge ? 0.025f : 0.05f));
            }
        }
        return m;
    }
};

constexpr double kOpening = 2.3 * kToughness / kStrength;  // by which the bar has parted

}  // namespace

TEST_CASE("a bar pulled past its strength parts in two, and its curve's area is the toughness") {
    for (Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        std::vector<double> area;
        for (int across : {2, 4}) {
            Bar bar(brittle(mechanics), across);
            constexpr int kFrames = 40;
            double largest = 0;
            FrameReport r;
            int broken = 0;
            for (int n = 1; n <= kFrames; ++n) {
                r = bar.pull_to(kOpening * n / kFrames);
                largest = std::max(largest, pull(r));
                broken += r.broken;
                CHECK(r.elastic + r.fracture + r.set_free ==
                      Approx(r.work).margin(0.02 * kToughness * bar.section));
            }
            INFO(across << " cells, springs: " << (mechanics == Mechanics::springs));
            CHECK(largest / bar.section == Approx(kStrength).epsilon(0.06));
            CHECK(r.pieces == 2);
            CHECK(broken > 0);
            CHECK(std::abs(pull(r)) < 1e-3 * largest);
            area.push_back(r.work / bar.section);
            CHECK(area.back() == Approx(kToughness).epsilon(across == 2 ? 0.06 : 0.03));
        }
        CHECK(area[0] == Approx(area[1]).epsilon(0.04));
    }
}

TEST_CASE(
    "what a bar holds beyond its toughness when it snaps is set free, however it came there") {
    for (int across : {2, 3}) {
        for (int frames : {3, 5, 16}) {
            Material material = brittle(Mechanics::cells);
            material.toughness *= 0.1;
            Bar bar(material, across);
            FrameReport r;
            const double way = 1.3 * kStrength / kModulus * kLength;
            for (int n = 1; n <= frames; ++n) r = bar.pull_to(way * n / frames);
            INFO(across << " cells, " << frames << " frames");
            REQUIRE(r.pieces == 2);
            CHECK(std::abs(r.remainder) < 0.02 * r.work);
        }
    }
}

TEST_CASE("a blade severs nothing where a crack ran ahead of it since its cut was planned") {
    Bar bar(brittle(Mechanics::cells), 2);
    bar.apparatus.blade.push_back({"blade", {Vec3(0.002, 0, -1), Vec3(0.002, 0, 1)}, {}});
    bar.drive.world_from_blade = {Pose{Quat::Identity(), Vec3(0, 0.5, 0)}};
    bar.start();
    constexpr int kFrames = 20;
    std::vector<Drive> way(kFrames + 1, bar.drive);
    way.push_back(bar.drive);
    way.back().world_from_blade[0].translation.y() = -0.5;
    bar.simulation->plan_cuts(0, way, 1);
    FrameReport r;
    for (int n = 1; n <= kFrames; ++n) r = bar.pull_to(kOpening * n / kFrames);
    REQUIRE(r.pieces == 2);
    Drive through = bar.drive;
    through.world_from_blade[0].translation.y() = -0.5;
    r = bar.simulation->advance(bar.drive, through);
    CHECK(r.severed == 0);
    CHECK(r.severed_energy == 0);
}

TEST_CASE("a bar half torn unloads to the origin, and goes on from where it was") {
    Bar bar(brittle(Mechanics::cells), 2);
    double torn = 0;
    const double half = 0.65 * kOpening;
    for (int n = 1; n <= 20; ++n) torn = pull(bar.pull_to(half * n / 20));
    REQUIRE(torn < 0.8 * kStrength * bar.section);
    const double fracture = bar.pull_to(half).fracture;
    CHECK(pull(bar.pull_to(0.6 * half)) == Approx(0.6 * torn).epsilon(0.01));
    CHECK(pull(bar.pull_to(0.2 * half)) == Approx(0.2 * torn).epsilon(0.02));
    CHECK(std::abs(pull(bar.pull_to(0))) < 0.01 * torn);
    const FrameReport r = bar.pull_to(half);
    CHECK(pull(r) == Approx(torn).epsilon(0.01));
    CHECK(r.fracture == Approx(fracture).epsilon(1e-3));
}

TEST_CASE("a broken bar carries again when it is pressed, and slides without resistance") {
    for (Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        Bar sound(brittle(mechanics), 2, 1e-6), bar(brittle(mechanics), 2, 1e-6);
        const double press = -0.05 * kStrength / kModulus * kLength;
        const double whole = pull(sound.pull_to(press));
        for (int n = 1; n <= 20; ++n) bar.pull_to(kOpening * n / 20);
        bar.pull_to(0);
        CHECK(std::abs(pull(bar.pull_to(0))) < 1e-3 * std::abs(whole));
        const double pressed = pull(bar.pull_to(press));
        CHECK(pressed / whole == Approx(1).epsilon(0.05));
        const auto slide = [&](Bar& one) {
            Drive to = one.drive;
            to.world_from_grip[1].translation.y() = -0.5 * press;
            return one.simulation->advance(one.drive, to).load[1].force.y();
        };
        CHECK(std::abs(slide(bar)) < 0.01 * slide(sound));
    }
}

TEST_CASE("matter under its strength is as if it had none, and nothing breaks when pressed hard") {
    Material unbreakable = brittle(Mechanics::cells);
    unbreakable.strength = unbreakable.toughness = std::numeric_limits<double>::infinity();
    Bar plain(unbreakable, 2), bar(brittle(Mechanics::cells), 2);
    const double way = 0.8 * kStrength / kModulus * kLength;
    CHECK(pull(bar.pull_to(way)) == pull(plain.pull_to(way)));
    CHECK(state_hash(bar.matter) == state_hash(plain.matter));
    const FrameReport r = bar.pull_to(-2 * way);
    CHECK(r.broken == 0);
    CHECK(r.fracture == 0);
}

TEST_CASE("a break leaves the same bytes at any number of threads") {
    std::vector<std::uint64_t> hash;
    for (int threads : {1, 2, 3}) {
        set_thread_count(threads);
        Bar bar(brittle(Mechanics::cells), 4, 1e-3);
        for (int n = 1; n <= 6; ++n) bar.pull_to(kOpening * n / 6);
        hash.push_back(state_hash(bar.matter));
    }
    set_thread_count(0);
    CHECK(hash[0] == hash[1]);
    CHECK(hash[0] == hash[2]);
}

TEST_CASE("explicit steps break a bar too, and keep the books") {
    Material material = brittle(Mechanics::cells);
    material.damping_ratio = 0.02;
    Bar bar(material, 2);
    bar.settings.solver = Solver::explicit_steps;
    bar.start();
    double largest = 0;
    FrameReport r;
    for (int n = 1; n <= 50; ++n) {
        Drive to = bar.drive;
        to.time += 2e-4;
        to.world_from_grip[1].translation.x() = kOpening * n / 40;
        r = bar.simulation->advance(bar.drive, to);
        bar.drive = to;
        largest = std::max(largest, pull(r));
    }
    CHECK(largest / bar.section == Approx(kStrength).epsilon(0.1));
    CHECK(r.pieces == 2);
    CHECK(std::abs(pull(r)) < 0.05 * largest);
    CHECK(r.kinetic + r.elastic + r.damped + r.fracture ==
          Approx(r.work).margin(0.05 * kToughness * bar.section));
}

TEST_CASE("what breaks while it rubs loses nothing that the books do not tell") {
    Material plaster = kPlaster;
    plaster.damping_ratio = 0;
    Aggregate board = make_block(60, 2, 8, 0.005, plaster);
    const Pose pose{Quat(Eigen::AngleAxisd(0.2, Vec3(0.2, 0, 1).normalized())), Vec3::Zero()};
    place(board, pose);
    std::vector<double>& height = board.particle_position.y;
    const double lift = 1e-4 - *std::min_element(height.begin(), height.end());
    for (double& y : height) y += lift;
    for (double& v : board.particle_velocity.y) v = -6;
    const Apparatus apparatus = floor_with(0.5);
    SimSettings settings = motion_settings();
    settings.step_safety = 0.2;
    Simulation simulation(board, apparatus, settings);
    FrameReport r;
    for (int n = 0; n < 8; ++n) {
        r = simulation.advance(floor_at(2.5e-4 * n), floor_at(2.5e-4 * (n + 1)));
    }
    CHECK(r.pieces > 2);
    CHECK(r.friction > 0.1 * r.fracture);
    CHECK(std::abs(r.remainder) < 0.02 * r.fracture);
}

namespace {

// A bar along x, broken across its middle but for its lowest layer, its right half turned about
// what is left.
struct Thread {
    Aggregate matter;
    explicit Thread(const Material& material, double angle)
        : matter(make_block(12, 3, 3, 0.01, material)) {
        for (ConnectionArrays& all : matter.connection) {
            all.damage.assign(matter.particle_count(), 0.0f);
        }
        const auto is_right = [&](ParticleId p) {
            return matter.particle_reference.at(p).x() > 0.001;
        };
        const auto is_low = [&](ParticleId p) {
            return matter.particle_reference.at(p).y() < -0.014;
        };
        for (const Span& span : matter.lattice.span) {
            for (int n = 0; n < span.count; ++n) {
                const ParticleId lower = span.lower + n, upper = span.upper + n;
                if (is_right(lower) == is_right(upper)) continue;
                if (is_low(lower) && is_low(upper)) continue;
                matter.connection[span.direction].weight.set(lower, 0);
                matter.connection[span.direction].damage[lower] = 1;
            }
        }
        matter.cell_cracked.assign(matter.cell_fill.size(), 0);
        const Quat turn(Eigen::AngleAxisd(-angle, Vec3::UnitZ()));
        const Vec3 about(0, -0.015, 0);
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            if (!is_right(static_cast<ParticleId>(p))) continue;
            matter.particle_position.set(p,
                                         about + turn * (matter.particle_reference.at(p) - about));
        }
    }
};

}  // namespace

TEST_CASE("a thread of brittle matter snaps when it is bent by more than it can be stretched") {
    const Mechanics mechanics = GENERATE(Mechanics::cells, Mechanics::springs);
    const Material material = brittle(mechanics);
    const double breaks =
        fracture_law(material.young_modulus, material.strength, material.toughness, 0.01).broken;
    for (const double bent : {2., 4.}) {
        Thread body(material, 2 * bent * breaks);
        for (double& z : body.matter.particle_position.z) z *= 1 + 0.5 * breaks;
        LatticeForces forces(body.matter);
        forces.commit(body.matter);
        REQUIRE(find_pieces(body.matter).count == 1);
        const double before = forces.elastic_energy(body.matter);
        REQUIRE(before > 0);
        double lost = 0;
        for (int n = 0; n < 20; ++n) lost += forces.snap(body.matter).fracture;
        CHECK(find_pieces(body.matter).count == (bent > 3 ? 2 : 1));
        CHECK(before - forces.elastic_energy(body.matter) ==
              Approx(lost).margin(1e-12 + 1e-9 * before));
    }
    Material ductile = material;
    ductile.yield_stress = 0.9 * material.strength;
    Thread hangs(ductile, 1);
    CHECK_FALSE(LatticeForces(hangs.matter).may_snap());
    Thread turned(material, 0);
    place(turned.matter, {Quat(Eigen::AngleAxisd(2, Vec3(1, 2, 3).normalized())), Vec3(1, 0, 0)});
    LatticeForces forces(turned.matter);
    CHECK(forces.snap(turned.matter).broken == 0);
}

TEST_CASE("a thread that would break before it flows snaps as one that never flows") {
    const Material brittle_one = brittle(GENERATE(Mechanics::cells, Mechanics::springs));
    for (const double share : {1., 1.5, 100.}) {
        Material flows_late = brittle_one;
        flows_late.yield_stress = share * brittle_one.strength;
        Thread with(flows_late, 1), without(brittle_one, 1);
        LatticeForces forces(with.matter), same(without.matter);
        CHECK(forces.may_snap());
        for (int n = 0; n < 20; ++n) {
            CHECK(forces.snap(with.matter).broken == same.snap(without.matter).broken);
        }
        CHECK(find_pieces(with.matter).count == 2);
    }
}

TEST_CASE("damping that is slow to yield does not hold a crack together") {
    for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        const auto work_to_part = [&](double damping) {
            Material material = brittle(mechanics);
            material.damping_ratio = damping;
            Bar bar(material, 2);
            bar.settings.solver = Solver::explicit_steps;
            bar.start();
            FrameReport r;
            for (int n = 1; n <= 80 && (n < 2 || r.pieces < 2); ++n) {
                Drive to = bar.drive;
                to.time += 4e-5;
                to.world_from_grip[1].translation.x() = kOpening * n / 40;
                r = bar.simulation->advance(bar.drive, to);
                bar.drive = to;
            }
            REQUIRE(r.pieces == 2);
            return r.work;
        };
        const double free = work_to_part(0), damped = work_to_part(0.1);
        INFO("work " << free << " and damped " << damped);
        CHECK(damped < 1.35 * free);
    }
}

TEST_CASE("a cell that turns into springs sets no energy free, however little of it is matter") {
    std::mt19937 engine(3);
    std::normal_distribution<double> draw;
    const double fill = GENERATE(0.04, 0.2, 0.6, 1.0), ratio = GENERATE(0.0, 0.2, 0.45);
    Material material = brittle(Mechanics::cells);
    material.poisson_ratio = ratio;
    const double a = 1e-3, onset = kStrength / kModulus;
    int turned = 0;
    for (int round = 0; round < 40; ++round) {
        // Two cells, matter in the corner of one; stretched by its strength, and bent.
        Aggregate matter = make_block(2, 1, 1, a, material);
        const float at = 0.5f - 0.5f * static_cast<float>(std::cbrt(fill));
        matter.cell_fill[1] = static_cast<float>(fill);
        matter.cell_centroid.set(1, {at, -at, at});
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            Vec3 x = matter.particle_position.at(p);
            x.x() *= 1 + 1.2 * onset;
            for (int i = 0; i < 3; ++i) x[i] += 2 * onset * a * draw(engine);
            matter.particle_position.set(p, x);
        }
        LatticeForces forces(matter, Excess::lives_on);
        const double before = forces.elastic_energy(matter);
        const Cracked cracked = forces.crack(matter);
        if (cracked.cells == 0) continue;
        turned += cracked.cells;
        CHECK(cracked.lost >= -1e-6 * before);  // kept as floats
        const double after = forces.elastic_energy(matter);
        CHECK(after <= before * (1 + 1e-6));
        // And back from what was kept.
        CHECK(LatticeForces(matter).elastic_energy(matter) == after);
    }
    CHECK(turned > 10);
}

TEST_CASE("a sliver breaks by the strain of its matter, not of the void around it") {
    const double a = 1e-3, onset = kStrength / kModulus;
    const auto cracked = [&](double at, double pull) {
        // One cell with matter at one corner, whose far corners are driven away by `pull`.
        Aggregate m = make_block(1, 1, 1, a, brittle(Mechanics::cells));
        m.cell_fill[0] = 0.05f;
        const float centre = static_cast<float>(at);
        m.cell_centroid.set(0, {centre, centre, centre});
        const auto corner = m.lattice.cell_corners(0);
        for (int c : {1, 3, 5, 7}) {
            const int far = (c >> 1 & 1) + (c >> 2 & 1);
            Vec3 x = m.particle_position.at(corner[c]);
            x.x() += pull * onset * a * far * 0.5;
            m.particle_position.set(corner[c], x);
        }
        return LatticeForces(m).crack(m).cells == 1;
    };
    CHECK_FALSE(cracked(-0.45, 4));  // its matter is pulled by a fifth of its strength
    CHECK(cracked(0.45, 1.2));
}

TEST_CASE("what the sweep tells of flow and strength is what a look at every cell finds") {
    Material ductile{.young_modulus = 1e6, .poisson_ratio = 0.3};
    ductile.yield_stress = 1e4, ductile.hardening = 1e4;
    for (int kind : {0, 1, 2}) {
        Material material = kind == 0 ? brittle(Mechanics::cells) : ductile;
        material.strength = 0.02 * material.young_modulus;
        material.toughness = 0.1 * material.strength;
        Aggregate told = make_block(37, 20, 20, 0.01, material);
        if (kind == 2) {
            told.inset.push_back(material);
            told.inset[0].yield_stress = std::numeric_limits<double>::infinity();
            told.cell_material.assign(told.cell_fill.size(), 0);
            for (std::size_t c = 0; c < told.cell_fill.size(); c += 3) told.cell_material[c] = 1;
        }
        Aggregate all = told;
        LatticeForces some(told), every(all);
        std::mt19937 engine(3);
        std::uniform_real_distribution<double> draw(-1, 1);
        int cracked = 0;
        double flowed = 0;
        for (int step = 1; step <= 4; ++step) {
            for (std::size_t p = 0; p < told.particle_count(); ++p) {
                const Vec3 x = told.particle_reference.at(p);
                const double pull = 0.011 * step * (x.x() > 0 ? x.x() / 0.18 : 0);
                const Vec3 u = x + pull * Vec3(x.x(), -0.3 * x.y(), -0.3 * x.z()) +
                               2e-6 * step * Vec3(draw(engine), draw(engine), draw(engine));
                told.particle_position.set(p, u);
                all.particle_position.set(p, u);
            }
            Vec3Array f, g;
            some.find(told, Flow::trial, f);
            every.find(all, Flow::trial, g);
            CHECK(f.x == g.x);
            const double plastic = every.commit(all).plastic;
            CHECK(some.commit(told, Forces::fresh).plastic == plastic);
            flowed += plastic;
            const Cracked one = some.crack(told, Forces::fresh), other = every.crack(all);
            CHECK(one.cells == other.cells);
            CHECK(one.lost == other.lost);
            CHECK(state_hash(told) == state_hash(all));
            cracked += one.cells;
        }
        CHECK(cracked > 0);
        CHECK((flowed > 0) == (kind > 0));
    }
}

TEST_CASE("a board that shatters meets itself, and no energy comes of it") {
    Aggregate board = make_block(40, 2, 5, 0.005, kPlaster);
    const Pose pose{Quat(Eigen::AngleAxisd(0.2, Vec3(0.2, 0, 1).normalized())), Vec3(0, 0.035, 0)};
    for (std::size_t p = 0; p < board.particle_count(); ++p) {
        board.particle_position.set(p, pose * board.particle_reference.at(p));
        board.particle_velocity.set(p, Vec3(0, -4, 0));
    }
    Apparatus floor;
    floor.name = "floor";
    floor.tool.push_back({"floor", BoxShape{Vec3(2, 0.2, 2), 0}, 0.5});
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.self_contact = true;
    settings.gravity = Vec3(0, -9.81, 0);
    const double energy = 0.5 * board.mass() * 16;
    Simulation simulation(board, floor, settings);
    Drive now;
    now.world_from_tool = {{Quat::Identity(), Vec3(0, -0.1, 0)}};
    FrameReport r;
    for (int n = 1; n <= 16; ++n) {
        Drive to = now;
        to.time = 1e-3 * n;
        r = simulation.advance(now, to);
        now = to;
    }
    CHECK(r.pieces > 3);
    CHECK(std::abs(r.remainder) < 0.03 * energy);
    CHECK(r.kinetic + r.elastic + r.contact < energy);
}

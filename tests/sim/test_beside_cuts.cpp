// SPDX-License-Identifier: GPL-3.0-or-later
// Tools, grips and bodies on the surface beside a cut.
#include "base/bytes.h"
#include "sim/gripped_pieces.h"
#include "sim/resting_contacts.h"
#include "tests/sim/loads_fixture.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kA = 0.1;  // a cell

enum class Kind { whole, cut, half };

// An edge of half a cell, across the block, pressed in by `way`; its near side `off` cells to the
// right of a plane through (cut, 0, 0) that leans by `lean`. Of Kind::half what is right of an
// upright plane is molded alone.
double pin_force(Kind kind, double cut, double lean, double off, double way = 0.2,
                 double wide = 0.6) {
    const double top = 2.5 * kA;
    const double at_top = cut * kA + lean * top;
    Aggregate block = make_block(12, 5, 3, kA, kSoft);
    if (kind == Kind::half) {
        block = make_block(6, 5, 3, kA, kSoft);
        for (std::size_t p = 0; p < block.particle_count(); ++p) {
            block.particle_position.x[p] += 3 * kA + at_top;
        }
    }
    if (kind == Kind::cut) {
        sever_plane(block, Vec3(cut * kA, 0, 0), Vec3(1, -lean, 0).normalized());
    }
    Apparatus apparatus;
    apparatus.tool.push_back({"pin", BoxShape{Vec3(wide * kA, 4 * kA, 6 * kA), 0}, 0.3});
    apparatus.grip.push_back(
        hold(block, points_where(block, [&](const Vec3& x) { return x.y() < -0.2499; })));
    SimSettings settings;
    settings.self_contact = false;
    const auto at = [&](double time, double down) {
        Drive d = drive_of(apparatus, time, 1);
        d.world_from_tool.push_back({Quat::Identity(), Vec3(at_top + (off + 0.5 * wide) * kA,
                                                            top + 2 * kA - down * kA, 0)});
        return d;
    };
    Simulation simulation(block, apparatus, settings);
    FrameReport report;
    for (int f = 0; f < 2; ++f) {
        report = simulation.advance(at(f, f * 0.5 * way), at(f + 1, (f + 1) * 0.5 * way));
    }
    return report.load[0].force.norm();
}

// What a grip bears that draws half a bar, held at its far end, by all that lies within `wide`
// cells of where it ends: at (cut, 0, 0) a plane that leans by `lean`.
double grip_force(Kind kind, double cut, double lean, double wide) {
    Aggregate bar = make_block(12, 3, 3, kA, kSoft);
    if (kind == Kind::half) {
        bar = make_block(6, 3, 3, kA, kSoft);
        for (std::size_t p = 0; p < bar.particle_count(); ++p) {
            bar.particle_position.x[p] += (3 + cut) * kA;
        }
    }
    if (kind == Kind::cut) sever_plane(bar, Vec3(cut * kA, 0, 0), Vec3(1, -lean, 0).normalized());
    const auto from_cut = [&](const Vec3& x) { return x.x() - cut * kA - lean * x.y(); };
    Apparatus apparatus;
    for (const bool draws : {true, false}) {
        Grip grip;
        grip.name = draws ? "draw" : "hold";
        for (std::size_t p = 0; p < bar.surface.size(); ++p) {
            const Vec3 x = bar.surface_position(p);
            const double low = std::max(from_cut(x) - 0.25 * kA, 0.0),
                         high = std::min(from_cut(x) + 0.25 * kA, wide * kA);
            const bool is_in = draws ? high > low && std::abs(bar.surface.normal(p).x()) < 0.5
                                     : x.x() > (5.9 + (kind == Kind::half ? cut : 0)) * kA;
            if (!is_in) continue;
            grip.point.push_back(static_cast<int>(p));
            grip.share.push_back(draws ? (high - low) / (0.5 * kA) : 1);
            grip.anchor.push_back(x);
        }
        apparatus.grip.push_back(grip);
    }
    SimSettings settings;
    settings.self_contact = false;
    const Drive from = drive_of(apparatus, 0, 1);
    Drive to = drive_of(apparatus, 1, 1);
    to.world_from_grip[0].translation.x() = -0.1 * kA;
    Simulation simulation(bar, apparatus, settings);
    return simulation.advance(from, to).load[0].force.norm();
}

}  // namespace

TEST_CASE("beside a cut a narrow tool bears about as much as on a body that ends there") {
    struct At {
        double cut, off;  // [cells]
    };
    for (const auto& [cut, off] : {At{0.02, 0.5}, At{0.3, 0.1}, At{0.5, 0.1}, At{0.5, 0.5}}) {
        CAPTURE(cut, off);
        const double half = pin_force(Kind::half, cut, 0, off);
        const double beside = pin_force(Kind::cut, cut, 0, off);
        CHECK(beside > 0.5 * half);
        CHECK(beside < 1.2 * half);
    }
    for (const double cut : {0.02, 0.3, 0.5}) {  // aslant
        CAPTURE(cut);
        const double whole = pin_force(Kind::whole, cut, 0.3, 0.25);
        const double beside = pin_force(Kind::cut, cut, 0.3, 0.25);
        CHECK(beside > 0.5 * whole);
        CHECK(beside < whole);
    }
}

TEST_CASE("a grip beside a cut draws about as hard as on a body that ends there") {
    for (const double cut : {0.2, 0.4, 0.6}) {
        for (const double wide : {0.4, 0.8}) {
            CAPTURE(cut, wide);
            const double half = grip_force(Kind::half, cut, 0, wide);
            const double beside = grip_force(Kind::cut, cut, 0, wide);
            CHECK(beside > 0.65 * half);
            CHECK(beside < 1.2 * half);
        }
    }
}

TEST_CASE("a grip that ends at a cut holds one side alone, and goes on so from a checkpoint") {
    const double cut = GENERATE(0.01, 0.03, 0.06, 0.08);
    Aggregate bar = make_block(6, 3, 3, kA, kSoft);
    Apparatus apparatus;
    Grip grip = hold(bar, points_where(bar, [&](const Vec3& x) {
                         return std::abs(x.y()) > 0.1499 && x.x() > cut - 0.0249;
                     }));
    for (int p : grip.point) {
        const double x = bar.surface_reference(std::size_t(p)).x();
        grip.share.push_back(std::min(1.0, (x + 0.025 - cut) / 0.05));
    }
    apparatus.grip.push_back(grip);
    GripSet grips(bar, apparatus, {}, 0);
    sever_plane(bar, Vec3(cut, 0, 0), Vec3::UnitX());
    grips.connections_changed(bar);
    const Pieces pieces = find_pieces(bar);
    const GrippedPieces gripped = find_gripped_pieces(bar, apparatus);
    CHECK(std::ranges::count(gripped.by, GrippedPieces::kNone) == 1);
    // Each side goes its own way.
    deform(bar, [&](const Vec3& x) { return Vec3(x + Vec3(x.x() < cut ? -0.01 : 0.002, 0, 0)); });
    const Drive now = drive_of(apparatus, 0, 1);
    const auto borne = [&](const GripSet& by) {
        Vec3Array force;
        force.resize(bar.particle_count());
        by.add_forces(bar, now, force);
        return force;
    };
    const Vec3Array force = borne(grips);
    double held = 0;
    for (std::size_t p = 0; p < force.size(); ++p) {
        if (pieces.particle_piece[p] == pieces.particle_piece[0]) {
            CHECK(force.at(p).norm() == 0);
        } else {
            held -= force.at(p).x();
        }
    }
    double whole = 0;  // of the patches on that side and what the edge leaves of them
    for (std::size_t n = 0; n < grip.point.size(); ++n) {
        const double x = bar.surface_reference(std::size_t(grip.point[n])).x();
        if (x > cut) whole += grip.share[n] * grip.share[n];
    }
    const SurfaceLayer layer(bar, bar.surface, Solver::quasistatic);
    whole *= 0.002 * layer.stiffness(bar.surface, 0, SimSettings{}.grip_stiffness);
    CHECK(held == Approx(whole));
    ByteWriter out;
    out(grips);
    const std::string& bytes = out.bytes();
    GripSet again(make_block(6, 3, 3, kA, kSoft), apparatus, {}, 0);
    ByteReader in(bytes);
    in(again);
    const Vec3Array after = borne(again);
    CHECK(after.x == force.x);
}

TEST_CASE("a cut through bent matter neither moves what a grip holds nor loads it") {
    const double lean = GENERATE(0.0, 0.3);
    Aggregate bar = make_block(6, 3, 3, kA, kSoft);
    Apparatus apparatus;
    apparatus.grip.push_back(
        hold(bar, points_where(bar, [&](const Vec3& x) { return std::abs(x.y()) > 0.1499; })));
    Grip& grip = apparatus.grip.front();
    GripSet grips(bar, apparatus, {}, 0);
    const auto cut = [&](double x) {
        sever_plane(bar, Vec3(x, 0, 0), Vec3(1, -lean, 0).normalized());
    };
    cut(0.03);
    deform(bar, [](const Vec3& x) {
        return Vec3(x.x() + x.y() * x.y(), x.y() * (1 + 2 * x.x()) + 2 * x.x() * x.x(), x.z());
    });
    for (std::size_t n = 0; n < grip.point.size(); ++n) {
        grip.anchor[n] = bar.surface_position(std::size_t(grip.point[n]));
    }
    const Drive now = drive_of(apparatus, 0, 1);
    const auto held = [&] {
        std::vector<HeldPoint> all;
        grips.add_held_points(bar, now, all);
        return all.size();
    };
    const double as_much = kSoft.young_modulus * std::pow(kA, 3);
    REQUIRE(grips.stored_energy(bar, now) < 1e-20 * as_much);
    grips.connections_changed(bar);
    CHECK(grips.stored_energy(bar, now) < 1e-11 * as_much);  // places in cells are floats
    CHECK(held() == grip.point.size());
    // Nor does another, which takes from some what has held them since.
    deform(bar, [](const Vec3& x) { return Vec3(x.x(), x.y(), x.z() + 0.2 * x.x() * x.y()); });
    const double before = grips.stored_energy(bar, now);
    const auto points = held();
    Aggregate flat = make_block(6, 3, 3, kA, kSoft);
    std::swap(flat.particle_position, bar.particle_position);
    cut(0.13);
    std::swap(flat.particle_position, bar.particle_position);
    grips.connections_changed(bar);
    CHECK(before > 1e-6 * as_much);
    CHECK(grips.stored_energy(bar, now) < 1.001 * before);
    CHECK(held() > points / 2);
}

namespace {

// What two pins, to either side of a cut, have braked a falling block by [m/s], and what is not
// accounted for of the energy that it fell with.
struct Struck {
    double braked, remainder;
};
Struck struck(double cut, double off, double lean, bool is_cut, bool is_cut_on_the_way) {
    const double bottom = -2 * kA, at_bottom = cut * kA + lean * bottom, speed = 1, frame = 1e-3;
    Aggregate block = make_block(8, 4, 3, kA, kSoft);
    const Vec3 normal = Vec3(1, -lean, 0).normalized();
    if (is_cut) sever_plane(block, Vec3(cut * kA, 0, 0), normal);
    for (double& v : block.particle_velocity.y) v = -speed;
    Apparatus apparatus;
    apparatus.name = "pins";
    for (const double side : {-1.0, 1.0}) {
        apparatus.tool.push_back(
            {side < 0 ? "left" : "right", BoxShape{Vec3(0.6 * kA, 4 * kA, 6 * kA), 0}, 0.3});
    }
    const Vec3 along = Vec3(lean, 1, 0) * kA;
    const Vec3 through(cut * kA, 0, 0);
    if (is_cut_on_the_way) {
        apparatus.blade.push_back({"blade",
                                   {through + 6 * along - 10 * kA * Vec3::UnitZ(),
                                    through - 6 * along - 10 * kA * Vec3::UnitZ()},
                                   {}});
    }
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.self_contact = false;
    const auto at = [&](int f) {
        Drive d = drive_of(apparatus, f * frame, 1);
        for (const double side : {-1.0, 1.0}) {
            const double x = at_bottom + side * (off + 0.3) * kA;
            d.world_from_tool.push_back({Quat::Identity(), Vec3(x, bottom - 2.02 * kA, 0)});
        }
        if (is_cut_on_the_way) {
            d.world_from_blade.push_back(
                {Quat::Identity(), Vec3(0, 0, f < 10 ? 0 : 2 * kA * (f - 10))});
        }
        return d;
    };
    Simulation simulation(block, apparatus, settings);
    Struck struck{};
    FrameReport report;
    for (int f = 0; f < 30; ++f) {
        report = simulation.advance(at(f), at(f + 1));
    }
    for (std::size_t p = 0; p < block.particle_count(); ++p) {
        struck.braked +=
            block.particle_mass[p] / block.mass() * (block.particle_velocity.y[p] + speed);
    }
    struck.remainder = std::abs(report.remainder) / (0.5 * block.mass() * speed * speed);
    return struck;
}

}  // namespace

TEST_CASE("narrow tools brake what falls on them beside a cut") {
    for (const double lean : {0.0, 0.3}) {
        for (const double cut : {0.3, 0.5}) {
            CAPTURE(lean, cut);
            const double whole = struck(cut, 0.05, lean, false, false).braked;
            const Struck before = struck(cut, 0.05, lean, true, false);
            CHECK(before.braked > 0.5 * whole);
            CHECK(before.remainder < 1e-3);
            const Struck on_the_way = struck(cut, 0.05, lean, false, true);  // as they press
            CHECK(on_the_way.braked > 0.6 * whole);
            CHECK(on_the_way.remainder < 0.015);
        }
    }
}

namespace {

struct Fall {
    double deepest, back;  // of the rod's tip below the block's top [cells]; rebound speed [m/s]
    double remainder;      // of the energy, over what the rod fell with
};

// A rod half a cell wide that falls on the block beside a cut.
Fall fall(Kind kind, double cut, double off, double lean = 0) {
    const double top = 2 * kA, at_top = cut * kA + lean * top, speed = 1;
    Aggregate block = make_block(10, 4, 3, kA, kSoft);
    if (kind == Kind::cut) {
        sever_plane(block, Vec3(cut * kA, 0, 0), Vec3(1, -lean, 0).normalized());
    }
    Material hard = kSoft;
    hard.young_modulus = 1e7;
    Aggregate rod = make_block(2, 8, 12, 0.25 * kA, hard);
    for (std::size_t p = 0; p < rod.particle_count(); ++p) {
        rod.particle_position.x[p] += at_top + (off + 0.25) * kA;
        rod.particle_position.y[p] += top + 1.05 * kA;
        rod.particle_velocity.y[p] = -speed;
    }
    Apparatus apparatus;
    apparatus.grip.push_back(
        hold(block, points_where(block, [&](const Vec3& x) { return x.y() < -0.1999; })));
    SimSettings settings;
    settings.solver = Solver::explicit_steps;
    settings.self_contact = false;
    Simulation simulation({&block, &rod}, apparatus, settings);
    Fall fall{};
    FrameReport report;
    const double mass = rod.mass();
    for (int f = 0; f < 24; ++f) {
        report = simulation.advance(drive_of(apparatus, f * 2e-3, 1),
                                    drive_of(apparatus, (f + 1) * 2e-3, 1));
        double tip = 1e9, momentum = 0;
        for (std::size_t p = 0; p < rod.particle_count(); ++p) {
            tip = std::min(tip, rod.particle_position.y[p]);
            momentum += rod.particle_mass[p] * rod.particle_velocity.y[p];
        }
        fall.deepest = std::max(fall.deepest, (top - tip) / kA);
        fall.back = std::max(fall.back, momentum / mass);
    }
    fall.remainder = report.remainder / (0.5 * mass * speed * speed);
    return fall;
}

}  // namespace

TEST_CASE("what falls on a cut edge is thrown back as from a body that ends there") {
    for (const double lean : {0.0, 0.3}) {
        CAPTURE(lean);
        const Fall whole = fall(Kind::whole, 0.5, 0.05, lean);
        const Fall beside = fall(Kind::cut, 0.5, 0.05, lean);
        CHECK(beside.deepest < 0.1);
        CHECK(beside.back > 0.7 * whole.back);
        CHECK(std::abs(beside.remainder) < 1e-3);
    }
}

TEST_CASE("what another cell carries since a cut began the move where it lies, if nothing moved") {
    Aggregate block = make_block(6, 3, 3, kA, kSoft);
    const SurfacePoints as_molded = block.surface;
    Apparatus apparatus;
    apparatus.tool.push_back({"tank", BoxShape{Vec3(20, 20, 20), 0}, 0.3});
    Drive now = drive_of(apparatus, 0, 1);
    now.world_from_tool.emplace_back();
    ToolPairs pairs(block, apparatus, SimSettings{}, 0);
    deform(block, crooked);
    pairs.begin_move(block, now);
    sever_plane(block, Vec3(0.3 * kA, 0, 0), Vec3::UnitX());
    pairs.connections_changed(block);
    pairs.find_candidates(block, now);
    int carried_anew = 0;
    for (const ToolPairs::Pair& pair : pairs) {
        const auto point = static_cast<std::size_t>(pair.point);
        carried_anew +=
            point < as_molded.size() && pairs.points().row(point) != as_molded.row(point);
        CHECK((pairs.start_place(pair) - pairs.place(pair, block)).norm() < 1e-12);
    }
    CHECK(carried_anew > 0);
}

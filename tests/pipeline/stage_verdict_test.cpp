// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_verdict.h"

#include <cmath>
#include <functional>
#include <limits>

#include "geometry/box_mesh.h"
#include "pipeline/stage_machine.h"
#include "sim/static_forces.h"
#include "skin/broken_skin.h"
#include "skin/divided_mesh.h"
#include "tests/catch.h"
#include "tests/scene/scene_folder.h"
#include "tests/shared/block.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/shared/meshes.h"
#include "tests/shared/says.h"

using namespace swage;

namespace {

// A bar that the shipped cutter parts, 20 cm x 5 cm x 5 cm.
struct CutBar {
    explicit CutBar(const std::string& material, const std::string& machine = "\"cut\"") {
        const test::SceneFolder scratch;
        const std::string text = "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"" + material +
                                 "\"\n[[stage]]\nmachine = " + machine + "\nframes = 8\n";
        reading = read_scene(scratch.write("s.toml", text), {}, test::shipped());
        REQUIRE(reading.scene);
        bodies.emplace_back();
        bodies[0].matter = test::make_block(16, 4, 4, 0.0125, reading.scene->work_piece().material);
    }

    int severed = 1;  // in the stage
    bool is_told_deep = false;
    double snapped = 0;  // in one frame [J]

    double modulus() const { return bodies[0].matter.material.young_modulus; }
    double stiffness() const { return modulus() * bodies[0].matter.volume(); }  // E V [J]

    // What is said of a stage in which `work` was done and `remainder` of it is nowhere.
    std::string told(double work, double remainder, double residual = 0) {
        FrameReport last;
        last.pieces = 2;
        last.work = work;
        last.remainder = remainder;
        return told_of(reading.scene->stage[0], last, 1, residual);
    }

    std::string told_of(
        const StageSpec& stage, const FrameReport& last, int first_frame, double residual = 0,
        const std::function<void()>& happens = [] {}) {
        const Machine machine = stage_machine(stage, bodies[0].matter, {}, Box{});
        StageTotals totals;
        totals.severed = severed;
        totals.snapped = snapped;
        totals.residual = residual;
        FrameReport first;
        first.body.resize(last.body.size());
        if (volumes_before.empty()) volumes_before = body_volumes(bodies);
        happens();
        const std::vector<char> told_deep(bodies.size(), is_told_deep);
        const StageEnd end{.stage = stage,
                           .machine = machine,
                           .bodies = bodies,
                           .totals = totals,
                           .first = first,
                           .last = last,
                           .first_frame = first_frame,
                           .last_frame = 9,
                           .legs = 8,
                           .connections_before = 0,
                           .volumes_before = volumes_before,
                           .overlaps_before = {},
                           .told_deep = told_deep,
                           .probes = {}};
        std::string text;
        for (const std::string& line : judge_stage(end, 1, StageEnded::wholly).warning) {
            text += line + "\n";
        }
        return text;
    }

    SceneReading reading;
    std::vector<WorkPiece> bodies;
    std::vector<BodyVolume> volumes_before;  // empty: as now
};

bool is_open(const std::string& told) {
    return told.find("books do not close") != std::string::npos;
}

}  // namespace

TEST_CASE("the work of drawing away what is at rest, of rounded places, is no open book") {
    CutBar bar(GENERATE("copper", "structural_steel", "rubber"));
    // A place of 0.1 m is rounded by up to 1e-17 m, and its particle pushed by E a times that.
    const double force = bar.modulus() * 0.0125 * 1e-17 * 16 * 4 * 4, way = 0.15 * 0.2;
    CHECK_FALSE(is_open(bar.told(-force * way, -force * way)));
    CHECK_FALSE(is_open(bar.told(1e-17 * bar.stiffness(), -1e-17 * bar.stiffness())));
}

TEST_CASE("what cutting gives as the places of gripped points are rounded is no open book") {
    CutBar bar("structural_steel", "\"slice\"\ngap = 0");
    const Aggregate& matter = bar.bodies[0].matter;
    const StageSpec& stage = bar.reading.scene->stage[0];
    double area = 0;
    for (const Grip& grip : stage_machine(stage, matter, {}, Box{}).apparatus.grip) {
        for (int p : grip.point) area += matter.surface.area(static_cast<std::size_t>(p));
    }
    const double a = matter.lattice.spacing;
    const double off = 0.5 * std::numeric_limits<float>::epsilon() * 0.5 * a;  // along one axis
    const double held = 0.5 * stage.sim.grip_stiffness * bar.modulus() * area / a * off * off;
    const auto told = [&](double given) {
        FrameReport last;
        last.pieces = 2;
        last.severed_energy = -given;
        last.set_free = 0.9 * given, last.contact = 0.1 * given;
        return bar.told_of(stage, last, 1);
    };
    CHECK_FALSE(is_open(told(held)));
    CHECK(is_open(told(100 * held)));
    bar.severed = 0;  // where nothing is parted nothing has another place
    CHECK(is_open(told(held)));
}

TEST_CASE("work that nobody did is told as soon as it is that of strains of a millionth") {
    CutBar bar(GENERATE("copper", "structural_steel", "rubber"));
    const double work = 1e-12 * bar.stiffness();
    CHECK(is_open(bar.told(-work, -work)));
    CHECK(is_open(bar.told(work, -0.1 * work)));
    CHECK(is_open(bar.told(1e3 * work, -1e2 * work)));
    CHECK_FALSE(is_open(bar.told(1e3 * work, -1e1 * work)));
}

TEST_CASE("what snaps through at rest is told where it takes a good part of the energy") {
    CutBar bar("copper");
    const double work = 1e-6 * bar.stiffness();
    const auto tells = [&](double snapped) {
        bar.snapped = snapped;
        return test::says(bar.told(work, snapped), "lost at once");
    };
    CHECK(tells(0.06 * work));
    CHECK_FALSE(tells(0.04 * work));
    StageTotals totals;
    FrameReport frame;
    for (double remainder : {-1.0, 2.0, 2.5}) {
        frame.remainder = remainder;
        totals.add(int(10 * remainder), frame, 0);
    }
    CHECK(totals.snapped == 3);
    CHECK(totals.snapped_in == 20);
}

TEST_CASE("a gap in the books is told however much the start has thrown off") {
    CutBar bar("copper");
    const double work = 1e-12 * bar.stiffness();
    const auto told = [&](double thrown) {
        FrameReport last;
        last.pieces = 2;
        last.work = work;
        last.remainder = -0.2 * work;
        last.contact_at_start = last.set_free = thrown;
        return bar.told_of(bar.reading.scene->stage[0], last, 1);
    };
    CHECK(is_open(told(0)));
    CHECK(told(1e3 * work) == told(0));
}

TEST_CASE("a gap is told that is little beside what is stored, and much of what friction took") {
    CutBar bar("copper");
    const double work = 1e-9 * bar.stiffness();
    const auto told = [&](double gap, double friction) {
        FrameReport last;
        last.pieces = 2;
        last.work = work;
        last.elastic = 0.9 * work;
        last.friction = friction * work;
        last.remainder = -gap * work;
        return bar.told_of(bar.reading.scene->stage[0], last, 1).find("friction and flow took") !=
               std::string::npos;
    };
    CHECK(told(0.03, 0.1));
    CHECK_FALSE(told(0.03, 0.3));
    CHECK_FALSE(told(-0.03, 0.1));
    CHECK_FALSE(told(0.003, 0.01));
    CHECK_FALSE(told(0.03, 0));  // nothing was taken
}

TEST_CASE("the work of drawing away what an equilibrium left pushed a little is no open book") {
    CutBar bar(GENERATE("copper", "structural_steel", "rubber"));
    const double left = 0.01, way = 0.03;
    const double pushed = left * least_push(bar.bodies[0].matter);
    CHECK_FALSE(is_open(bar.told(-0.3 * pushed * way, -0.3 * pushed * way, left)));
    CHECK(is_open(bar.told(-100 * pushed * way, -100 * pushed * way, left)));
    CHECK(is_open(bar.told(-0.3 * pushed * way, -0.3 * pushed * way)));
}

TEST_CASE("what is thrown off as a stage begins is told from what, with what can be done then") {
    CutBar bar("rubber");
    bar.bodies[0].name = "bar";
    StageSpec stage = bar.reading.scene->stage[0];
    stage.sim.solver = Solver::explicit_steps;
    const auto told = [&](double among, int first_frame) {
        FrameReport last;
        last.pieces = 2;
        last.body.resize(1);
        last.body[0].contact_at_start = 5;
        last.body[0].among_at_start = among;
        return bar.told_of(stage, last, first_frame);
    };
    const auto says = [](const std::string& text, const char* words) {
        return text.find(words) != std::string::npos;
    };
    CHECK(says(told(0, 1), "bar starts pressed into what it touches"));
    for (const int first : {1, 2}) CHECK(says(told(0, first), "with `at`"));
    CHECK(says(told(0, 9), "leave a gap"));
    CHECK(says(told(5, 9), "bar starts pressed into itself, or its pieces into each other"));
    CHECK(says(told(5, 9), "without self_contact = true"));
    for (const double among : {0.0, 5.0}) CHECK_FALSE(says(told(among, 9), "with `at`"));
    bar.is_told_deep = true;
    CHECK_FALSE(says(told(0, 1), "starts pressed"));
}

TEST_CASE("a skin that swells though its matter flows is told of") {
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::frame4);
    CutBar bar("copper");
    WorkPiece& piece = bar.bodies[0];
    const auto told = [&] {
        FrameReport last;
        last.pieces = 2;
        const std::string text = bar.told_of(bar.reading.scene->stage[0], last, 1);
        return text.find("encloses") != std::string::npos;
    };
    piece.skin = box_mesh({-.1, -.025, -.025}, {.1, .025, .025});
    piece.mount = mount_mesh(piece.skin.position, piece.matter, kind);
    piece.position = piece.skin.position;
    for (Vec3& p : piece.position) p.y() *= 1.02;
    CHECK_FALSE(told());  // nothing has flowed
    piece.matter.cell_history.assign(piece.matter.cell_fill.size());
    CHECK(told());
    for (Vec3& p : piece.position) p.y() *= 1.009 / 1.02;
    CHECK_FALSE(told());
    for (Vec3& p : piece.position) p.y() *= 1.02 / 1.009;
    // Also what has been parted, its pieces each by itself.
    piece.is_parted = true;
    CHECK(told());
    for (Vec3& p : piece.position) p.y() *= 1.009 / 1.02;
    CHECK_FALSE(told());
}

TEST_CASE("of a skin that encloses less it is told where its triangles are longer than cells") {
    CutBar bar("copper");
    WorkPiece& piece = bar.bodies[0];
    piece.matter.cell_history.assign(piece.matter.cell_fill.size());
    const auto told = [&](double longest) {
        piece.skin = divide_edges(box_mesh({-.1, -.025, -.025}, {.1, .025, .025}),
                                  longest * piece.matter.lattice.spacing);
        piece.mount = mount_mesh(piece.skin.position, piece.matter, SkinKind::mount);
        piece.position = piece.skin.position;
        for (Vec3& p : piece.position) p.y() *= 1.02;
        FrameReport last;
        return bar.told_of(bar.reading.scene->stage[0], last, 1);
    };
    CHECK(test::says(told(1.5), "it has folded within single cells, and smaller ones"));
    CHECK_FALSE(test::says(told(1.5), "[skin] divide"));
    CHECK(test::says(told(4),
                     "as long as 4 cells, between which it stays flat: [skin] divide = 1.5"));
}

TEST_CASE("a piece whose skin takes up less than its matter is told of, flow or none, once") {
    const double plastic = GENERATE(0.0, 1.0);
    CutBar bar("copper");
    WorkPiece& piece = bar.bodies[0];
    const auto part = [](double from, double to) {
        return box_mesh({from, -.025, -.025}, {to, .025, .025});
    };
    piece.skin =
        test::together(test::together(part(-.1, -.0692), part(-.0683, -.0192)), part(-.0183, .1));
    const std::size_t per_part = piece.skin.position.size() / 3;
    test::sever_plane(piece.matter, {-.06875, 0, 0}, Vec3::UnitX());
    test::sever_plane(piece.matter, {-.01875, 0, 0}, Vec3::UnitX());
    REQUIRE(find_pieces(piece.matter).count == 3);
    piece.mount = mount_mesh(piece.skin.position, piece.matter, SkinKind::mount);
    piece.is_parted = true;
    const auto narrow = [&](std::size_t n, double by) {
        for (std::size_t v = n * per_part; v < (n + 1) * per_part; ++v) piece.position[v].y() *= by;
    };
    const auto told = [&] {
        FrameReport last;
        last.pieces = 3;
        last.plastic = plastic;
        const std::string text = bar.told_of(bar.reading.scene->stage[0], last, 1);
        UNSCOPED_INFO(text);
        return test::says(text, "a piece of the work-piece encloses 3 % less than its matter");
    };
    piece.position = piece.skin.position;
    bar.volumes_before = body_volumes(bar.bodies);
    CHECK_FALSE(told());
    narrow(1, 0.991);
    CHECK_FALSE(told());
    narrow(1, 0.97 / 0.991);
    CHECK(told());
    bar.volumes_before = body_volumes(bar.bodies);
    CHECK_FALSE(told());  // it was so before
    narrow(1, 1 / 0.97);
    bar.volumes_before = body_volumes(bar.bodies);
    narrow(0, 0.97);
    CHECK(told());
}

namespace {

// Of tools' work this entry of the books took so much, and the rest is stored.
std::string told_of_taken(CutBar& bar, double work, double Books::*entry, double energy) {
    FrameReport last;
    last.pieces = 2;
    last.work = work, last.elastic = work - energy, last.*entry = energy;
    return bar.told_of(bar.reading.scene->stage[0], last, 1);
}

}  // namespace

TEST_CASE("energy that flow gives is from nowhere, but what a back stress has stored") {
    CutBar bar("copper");
    const double work = 1e-6 * bar.stiffness();
    const auto told = [&](double energy) {
        return told_of_taken(bar, work, &FrameReport::plastic, energy);
    };
    CHECK_FALSE(is_open(told(0.3 * work)));
    CHECK_FALSE(is_open(told(-0.01 * work)));
    CHECK(is_open(told(-0.3 * work)));
    const std::string given = "plastic flow has given";
    CHECK(told(-0.3 * work).find(given) != std::string::npos);
    CHECK(bar.told(-work, -work).find(given) == std::string::npos);
    bar.bodies[0].matter.material.back_stress = 1e7;
    bar.bodies[0].matter.material.back_strain = 0.1;
    CHECK_FALSE(is_open(told(-0.3 * work)));
}

TEST_CASE("energy that fracture or cutting gives is told as what it is") {
    struct Giver {
        double Books::*entry;
        std::string name;
    };
    const auto [entry, name] = GENERATE(Giver{&FrameReport::fracture, "fracture"},
                                        Giver{&FrameReport::severed_energy, "cutting"});
    CutBar bar("glass");
    const double work = 1e-6 * bar.stiffness();
    const auto told = [&, entry = entry](double energy) {
        return told_of_taken(bar, work, entry, energy);
    };
    CHECK_FALSE(is_open(told(0.3 * work)));
    CHECK_FALSE(is_open(told(-0.01 * work)));
    CHECK(is_open(told(-0.3 * work)));
    CHECK(told(-0.3 * work).find(name + " has given") != std::string::npos);
    CHECK(told(-0.3 * work).find("more frames") == std::string::npos);
    CHECK(bar.told(-work, -work).find(name) == std::string::npos);
}

TEST_CASE("volume that flow has changed in a stage is told, what pressure changes is not") {
    const bool springs = GENERATE(true, false);
    const auto told_after = [&](double size, double flowed) {
        CutBar bar("copper");
        Aggregate& matter = bar.bodies[0].matter;
        if (springs) matter.material.mechanics = Mechanics::springs;
        FrameReport last;
        last.pieces = 2;
        return bar.told_of(bar.reading.scene->stage[0], last, 1, 0, [&] {
            test::deform(matter, [&](const Vec3& p) -> Vec3 { return size * p; });
            matter.cell_history.assign(matter.cell_fill.size());
            for (float& alpha : matter.cell_history.hardening()) alpha = 0.1f;
            for (auto& slot : matter.cell_plastic) {
                slot.assign(springs ? matter.cell_fill.size() : 0, float(std::log(flowed)));
            }
            for (int n = 0; n < 3 && !springs; ++n) {
                for (float& back : matter.cell_history.row[n]) back = float(1 / flowed - 1);
            }
        });
    };
    const auto tells = [](const std::string& told) {
        return told.find("of its volume by flow") != std::string::npos;
    };
    CHECK_FALSE(tells(told_after(1, 1)));
    CHECK_FALSE(tells(told_after(0.98, 1)));
    CHECK_FALSE(tells(told_after(0.999, 0.999)));
    CHECK(told_after(0.98, 0.98).find("lost 5.9 % of its volume by flow") != std::string::npos);
    CHECK(told_after(1.02, 1.02).find("gained 6.1 % of its volume by flow") != std::string::npos);
}

TEST_CASE("a skin that is stretched from piece to piece is told of, by a cut and later") {
    CutBar bar("copper");
    WorkPiece& piece = bar.bodies[0];
    piece.skin = box_mesh({-.1, -.025, -.025}, {.1, .025, .025});
    piece.mount = mount_mesh(piece.skin.position, piece.matter, SkinKind::mount);
    const auto told = [&](double longer, double plastic) {
        piece.position = piece.skin.position;
        bar.volumes_before = body_volumes(bar.bodies);
        for (Vec3& p : piece.position) p.x() *= longer;
        FrameReport last;
        last.pieces = 2;
        last.plastic = plastic;
        const std::string text = bar.told_of(bar.reading.scene->stage[0], last, 1);
        return test::says(text,
                          "more than its matter: parts of it are stretched from one piece to "
                          "another");
    };
    CHECK_FALSE(told(1.02, 0));  // all of it follows one piece
    test::sever_plane(piece.matter, {.003, 0, 0}, Vec3::UnitX());
    CHECK(told(1.02, 0));
    CHECK_FALSE(told(1.009, 0));
    CHECK(told(1.02, 1));
    bar.severed = 0;
    CHECK(told(1.02, 0));
    // Matter that load broke: also as a cut.
    for (ConnectionArrays& all : piece.matter.connection) {
        all.damage.assign(piece.matter.particle_count(), 0.0f);
        for (std::size_t p = 0; p < all.damage.size(); ++p) {
            if (all.weight[p] <= 0) all.damage[p] = 1;
        }
    }
    REQUIRE(is_broken(piece.matter));
    CHECK(told(1.02, 0));
    bar.severed = 1;
    CHECK(told(1.02, 0));
    piece.look = std::make_shared<NewLook>(piece.skin);  // a boundary is made anew then
    CHECK_FALSE(told(1.02, 0));
}

TEST_CASE("a boundary that breaks leave off its matter's volume is told of, once") {
    CutBar bar("copper");
    WorkPiece& piece = bar.bodies[0];
    piece.skin = box_mesh({-.1, -.025, -.025}, {.1, .025, .025});
    piece.position = piece.skin.position;
    piece.mount = mount_mesh(piece.skin.position, piece.matter, SkinKind::mount);
    piece.look = std::make_shared<NewLook>(piece.skin);
    test::sever_plane(piece.matter, {.003, 0, 0}, Vec3::UnitX());
    for (ConnectionArrays& all : piece.matter.connection) {
        all.damage.assign(piece.matter.particle_count(), 0.0f);
        for (std::size_t p = 0; p < all.damage.size(); ++p) {
            if (all.weight[p] <= 0) all.damage[p] = 1;
        }
    }
    FrameReport last;
    last.pieces = 2;
    last.plastic = 1;
    const auto told = [&](double longer) {
        bar.volumes_before.clear();
        return bar.told_of(bar.reading.scene->stage[0], last, 1, 0, [&] {
            for (Vec3& p : piece.skin.position) p.x() *= longer;
        });
    };
    CHECK(told(1.005).find("the boundary of") == std::string::npos);
    CHECK(told(1.02).find("encloses 2.5 % more than its matter: it was made anew around the "
                          "pieces") != std::string::npos);
    CHECK(told(1).find("the boundary of") == std::string::npos);  // it was so before
    CHECK(told(.95).find("encloses 2.6 % less than its matter") != std::string::npos);
    piece.look = nullptr;
    CHECK(told(1.1).find("the boundary of") == std::string::npos);
}

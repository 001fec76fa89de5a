// SPDX-License-Identifier: GPL-3.0-or-later
// What the skin of a bar tells of its matter, against what is known of bars.
#include "pipeline/piece_fields.h"

#include <cmath>

#include "base/parallel.h"
#include "geometry/box_mesh.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"
#include "tests/sim/pulled_bar.h"

using namespace swage;

namespace {

constexpr double kModulus = 2e9, kLength = 1, kHalf = 0.05;
const std::vector<SkinField> kAll = {SkinField::plastic_strain, SkinField::stress,
                                     SkinField::pressure, SkinField::principal_stress};

Material plastic() {
    Material m;
    m.young_modulus = kModulus;
    m.poisson_ratio = 0.3;
    return m;
}

WorkPiece bar(const Material& material, int across, double length = kLength,
              SkinKind kind = SkinKind::mount, std::vector<InsetSpec> inset = {}) {
    InputMesh input;
    input.mesh = box_mesh({-length / 2, -kHalf, -kHalf}, {length / 2, kHalf, kHalf});
    BodySpec body;
    body.material = material;
    body.mold.across = across;
    body.inset = std::move(inset);
    return make_work_piece(input, body, {kind});
}

// Bent between its ends, which are turned by so much and stay on the arc.
WorkPiece bent(int across, double curvature, SkinKind kind = SkinKind::mount) {
    WorkPiece piece = bar(plastic(), across, kLength, kind);
    Apparatus apparatus;
    apparatus.name = "bend";
    apparatus.grip = test::end_grips(piece.matter, 0.4999 * kLength);
    SimSettings settings;
    settings.tolerance = 1e-5;
    Simulation simulation(piece.matter, apparatus, settings);
    Drive from, to;
    from.world_from_grip = {Pose{}, Pose{}};
    to.time = 1;
    for (int side : {-1, 1}) {
        const double angle = side * curvature * kLength / 2;
        const Quat turn = turn_about(Vec3::UnitZ(), angle);
        const Vec3 middle(side * kLength / 2, 0, 0);
        const Vec3 goes(std::sin(angle) / curvature, (1 - std::cos(angle)) / curvature, 0);
        to.world_from_grip.push_back({turn, goes - turn * middle});
    }
    simulation.advance(from, to);
    follow_matter(piece);
    return piece;
}

bool in_the_middle(const WorkPiece& piece, std::size_t v) {
    return std::abs(piece.mount.reference[v].x()) < 0.2 * kLength;
}

// Largest error of the stress over what its surface bears, where the ends are far.
double bending_error(int across, SkinKind kind) {
    constexpr double kCurvature = 0.02;
    const WorkPiece piece = bent(across, kCurvature, kind);
    const SkinFieldValues is = fields_on_skin(piece, kAll);
    double worst = 0;
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        if (!in_the_middle(piece, v)) continue;
        const double should = -kModulus * kCurvature * piece.mount.reference[v].y();
        worst =
            std::max({worst, std::abs(is[1][v] - std::abs(should)), std::abs(is[2][v] + should / 3),
                      std::abs(is[3][v] - std::max(0.0, should))});
    }
    return worst / (kModulus * kCurvature * kHalf);
}

}  // namespace

TEST_CASE("stress on a bent bar is linear over its height, out to its surface") {
    for (const int across : {4, 8}) CHECK(bending_error(across, SkinKind::mount) < 0.006);
    CHECK(bending_error(4, SkinKind::boundary) < 0.006);
}

TEST_CASE("a bar that hangs is pulled by what hangs below, and its pressure is a third of that") {
    WorkPiece piece = bar(plastic(), 4);
    Apparatus apparatus;
    apparatus.name = "hang";
    apparatus.grip = test::end_grips(piece.matter, 0.4999 * kLength);
    apparatus.grip.pop_back();
    SimSettings settings;
    settings.gravity = Vec3(100, 0, 0);
    settings.tolerance = 1e-6;
    Simulation simulation(piece.matter, apparatus, settings);
    Drive from, to;
    from.world_from_grip = to.world_from_grip = {Pose{}};
    from.gravity_strength = 0, to.gravity_strength = 1;
    to.time = 1;
    simulation.advance(from, to);
    follow_matter(piece);
    const SkinFieldValues is = fields_on_skin(piece, kAll);
    const double most = 1000 * 100 * kLength;
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        const double x = piece.mount.reference[v].x();
        if (x < -0.25 * kLength) continue;  // the grip holds the width
        const double should = 1000 * 100 * (kLength / 2 - x);
        REQUIRE(std::abs(is[1][v] - should) < 1e-2 * most);
        REQUIRE(std::abs(is[2][v] + should / 3) < 1e-2 * most);
        REQUIRE(std::abs(is[3][v] - should) < 1e-2 * most);
        REQUIRE(is[0][v] == 0);
    }
}

TEST_CASE("a bar drawn past its yield stress has flowed by what is left of the strain") {
    Material metal = plastic();
    metal.yield_stress = 10e6;
    metal.hardening = 200e6;
    WorkPiece piece = bar(metal, 3, 0.6);
    Apparatus apparatus;
    apparatus.name = "pull";
    apparatus.grip = test::end_grips(piece.matter, 0.4999 * 0.6);
    for (Grip& grip : apparatus.grip) grip.hold = Vec3(1, 0, 0);  // no more than along the bar
    SimSettings settings;
    settings.tolerance = 1e-7;
    settings.grip_stiffness = 100;
    Simulation simulation(piece.matter, apparatus, settings);
    Drive from, to;
    from.world_from_grip = to.world_from_grip = {Pose{}, Pose{}};
    for (int n = 1; n <= 5; ++n) {
        to.time = n;
        to.world_from_grip[1].translation.x() = 0.004 * n * 0.6;
        simulation.advance(from, to);
        from = to;
    }
    follow_matter(piece);
    const SkinFieldValues is = fields_on_skin(piece, kAll);
    // What the matter itself has become longer by: its grips give way a little.
    const auto ends =
        std::minmax_element(piece.position.begin(), piece.position.end(),
                            [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); });
    const double strain = std::log((ends.second->x() - ends.first->x()) / 0.6);
    const double flowed = (kModulus * strain - 10e6) / (kModulus + 200e6);
    const double bears = 10e6 + 200e6 * flowed;
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        REQUIRE(is[0][v] == Approx(flowed).epsilon(2e-3));
        REQUIRE(is[1][v] == Approx(bears).epsilon(5e-3));
        REQUIRE(is[2][v] == Approx(-bears / 3).epsilon(5e-3));
    }
}

TEST_CASE("each material of a stretched bar bears its own, to the boundary within a cell") {
    Material stiff = plastic();
    stiff.young_modulus = 3 * kModulus;
    InsetSpec inset;
    inset.from = Vec3(0, 0.57, 0);
    inset.material = stiff;
    WorkPiece piece = bar(plastic(), 4, 0.4, SkinKind::mount, {inset});
    REQUIRE_FALSE(piece.matter.mixed_cell.empty());
    constexpr double kStrain = 1e-4;
    test::deform(piece.matter, [](const Vec3& x) -> Vec3 {
        return x.cwiseProduct(Vec3(1 + kStrain, 1 - 0.3 * kStrain, 1 - 0.3 * kStrain));
    });
    follow_matter(piece);
    const SkinFieldValues is = fields_on_skin(piece, kAll);
    const double boundary = -kHalf + 0.57 * 2 * kHalf;
    int above = 0;
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        const double y = piece.mount.reference[v].y();
        if (std::abs(y - boundary) < 1e-6) continue;
        above += y > boundary;
        const double should = (y > boundary ? 3 : 1) * kModulus * kStrain;
        REQUIRE(is[1][v] == Approx(should).epsilon(2e-3));
        REQUIRE(is[3][v] == Approx(should).epsilon(2e-3));
    }
    CHECK(above > 0);
}

TEST_CASE("what is cut or broken off tells nothing of the stress on the other side") {
    const bool cut = GENERATE(true, false);
    const SkinKind kind = GENERATE(SkinKind::mount, SkinKind::boundary);
    Material material = plastic();
    material.strength = 1e8, material.toughness = 1e4;
    WorkPiece piece = bar(material, 4, 0.4, kind);
    constexpr double kPlane = 0.013, kStrain = 1e-4;
    if (cut) {
        const Vec3 a(kPlane, -1, -1), b(kPlane, 1, -1), up(0, 0, 2);
        cut_skins(piece, {{a, b, b + up}, {a, b + up, a + up}});
    }
    test::sever_plane(piece.matter, {kPlane, 0, 0}, Vec3::UnitX());
    for (ConnectionArrays& all : piece.matter.connection) {
        if (cut) break;
        all.damage.resize(piece.matter.particle_count());
        for (std::size_t p = 0; p < piece.matter.particle_count(); ++p) {
            if (all.weight[p] == 0) all.damage[p] = 1;
        }
    }
    // The right one is stretched and far off, the left one lies still.
    test::deform(piece.matter, [](const Vec3& x) -> Vec3 {
        if (x.x() < kPlane) return x;
        return x.cwiseProduct(Vec3(1 + kStrain, 1 - 0.3 * kStrain, 1 - 0.3 * kStrain)) +
               Vec3(0.5, 0, 0);
    });
    show_matter(piece, true);
    const SkinFieldValues is = fields_on_skin(piece, kAll);
    int right = 0;
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        const bool far_off = piece.position[v].x() > 0.3;
        right += far_off;
        const double should = far_off ? kModulus * kStrain : 0;
        REQUIRE(std::abs(is[1][v] - should) < 2e-3 * kModulus * kStrain);
    }
    CHECK(right > 20);
    CHECK(right < int(piece.position.size()) - 20);
}

TEST_CASE("springs bear what they pull, and no field costs nothing") {
    Material springs = plastic();
    springs.mechanics = Mechanics::springs;
    WorkPiece piece = bar(springs, 3, 0.4);
    constexpr double kStrain = 1e-4;
    test::deform(piece.matter, [](const Vec3& x) -> Vec3 {
        return x.cwiseProduct(Vec3(1 + kStrain, 1 - kStrain / 4, 1 - kStrain / 4));
    });
    follow_matter(piece);
    const SkinFieldValues is = fields_on_skin(piece, kAll);
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        REQUIRE(is[1][v] == Approx(kModulus * kStrain).epsilon(1e-3));
        REQUIRE(is[2][v] == Approx(-kModulus * kStrain / 3).epsilon(1e-3));
    }
    CHECK(fields_on_skin(piece, {}).empty());
}

TEST_CASE("fields of a bent bar are the same bytes at any number of threads") {
    const WorkPiece piece = bent(4, 0.05);
    set_thread_count(1);
    const SkinFieldValues one = fields_on_skin(piece, kAll);
    for (const int threads : {2, 3, 8}) {
        set_thread_count(threads);
        CHECK(fields_on_skin(piece, kAll) == one);
    }
    set_thread_count(0);
}

TEST_CASE("a bent bar's skin tells what its surface uses of its yield stress and its strength") {
    constexpr double kCurvature = 0.001, kSurface = kModulus * kCurvature * kHalf;
    const std::vector<SkinField> uses = {SkinField::yield_use, SkinField::strength_use};
    Material metal = plastic();
    metal.yield_stress = 2 * kSurface;
    metal.strength = 1.6 * kSurface, metal.toughness = 1e4;
    WorkPiece piece = bar(metal, 4);
    test::deform(piece.matter, [=](const Vec3& p) -> Vec3 {
        const double x = p.x(), y = p.y(), z = p.z();
        return p + kCurvature * Vec3(-x * y, 0.5 * (x * x + 0.3 * (y * y - z * z)), 0.3 * y * z);
    });
    follow_matter(piece);
    const SkinFieldValues is = fields_on_skin(piece, uses);
    for (std::size_t v = 0; v < piece.position.size(); ++v) {
        const double should = -piece.mount.reference[v].y() / kHalf;
        REQUIRE(is[0][v] == Approx(std::abs(should) / 2).margin(0.005));
        // What is pressed is stretched across.
        REQUIRE(is[1][v] == Approx((should > 0 ? 1 : -0.3) * should / 1.6).margin(0.01));
    }
    // By the law of springs, too, whose own stress is another.
    metal.mechanics = Mechanics::springs;
    WorkPiece springs = bar(metal, 4, 0.4);
    test::deform(springs.matter, [](const Vec3& x) -> Vec3 {
        return x.cwiseProduct(Vec3(1 + 5e-5, 1 - 1.25e-5, 1 - 1.25e-5));
    });
    follow_matter(springs);
    const SkinFieldValues of_springs = fields_on_skin(springs, uses);
    for (const float use : of_springs[0]) {
        REQUIRE(use == Approx(kModulus * 5e-5 / metal.yield_stress).epsilon(5e-3));
    }
}

TEST_CASE(
    "the skin of what has broken has used all of its strength, elsewhere as much as it bears") {
    Material brittle = plastic();
    brittle.strength = 1e6, brittle.toughness = 1e4;
    WorkPiece piece = bar(brittle, 4, 0.4);
    piece.matter.cell_cracked.assign(piece.matter.cell_fill.size(), 0);
    int cracked = 0;
    for (std::size_t cell = 0; cell < piece.matter.cell_fill.size(); ++cell) {
        if (piece.matter.lattice.cell_site(static_cast<CellId>(cell)).x() != 5) continue;
        piece.matter.cell_cracked[cell] = 1;
        ++cracked;
    }
    REQUIRE(cracked > 0);
    test::deform(piece.matter, [](const Vec3& x) -> Vec3 {
        return x.cwiseProduct(Vec3(1 + 1e-4, 1 - 0.3e-4, 1 - 0.3e-4));
    });
    follow_matter(piece);
    const SkinFieldValues is = fields_on_skin(piece, {SkinField::strength_use});
    int broken = 0;
    for (const float use : is[0]) {
        broken += use == 1;
        if (use != 1) REQUIRE(use == Approx(kModulus * 1e-4 / 1e6).epsilon(1e-2));
    }
    CHECK(broken > 0);
    CHECK(broken < int(is[0].size()) / 2);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/skin_fields.h"

#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "tests/catch.h"
#include "tests/shared/lattice_fixture.h"

using namespace swage;
using test::make_block;

namespace {

const std::vector<SkinField> kAll = {SkinField::plastic_strain, SkinField::stress,
                                     SkinField::pressure, SkinField::principal_stress};

// A pull along x that `of` gives by the place at molding, and half as much plastic strain.
std::vector<StressSample> pulled(const Aggregate& matter, const std::vector<CellId>& cells,
                                 const std::function<double(const Vec3&)>& of) {
    std::vector<StressSample> all;
    for (const CellId cell : cells) {
        const std::array<ParticleId, 8> corner = matter.lattice.cell_corners(cell);
        const CornerGroups groups = corner_groups(matter, corner);
        CornerMask seen = 0;
        for (const CornerMask group : groups) {
            if (group & seen) continue;
            seen |= group;
            StressSample one;
            one.cell = cell;
            one.corners = group;
            one.sound = group == kAllCorners;
            one.material = static_cast<std::uint8_t>(matter.material_number(cell));
            const Vec3 centroid = matter.cell_centroid[cell].cast<double>();
            one.place =
                matter.lattice.cell_site(cell).cast<double>() + Vec3::Constant(.5) + centroid;
            one.volume = matter.cell_fill[cell] * __builtin_popcount(group) / 8.0;
            Vec3 side = one.place;
            if (!one.sound) side.x() += group & 1 ? -0.25 : 0.25;
            const double value = of(matter.lattice.origin + matter.lattice.spacing * side);
            one.stress[0] = value;
            one.plastic_strain = 0.5 * value;
            one.yields_at = std::numeric_limits<double>::infinity();
            all.push_back(one);
        }
    }
    return all;
}

// Vertices on the block's surface and inside it.
std::vector<Vec3> places_on(const Vec3& half) {
    std::vector<Vec3> places;
    for (int i = -4; i <= 4; ++i) {
        for (int j = -4; j <= 4; ++j) {
            for (int k = -2; k <= 2; ++k) {
                places.push_back(half.cwiseProduct(Vec3(i / 4.0, j / 4.0, k / 2.0)));
            }
        }
    }
    return places;
}

SkinFieldValues fields_of(const Aggregate& matter, const std::vector<Vec3>& places,
                          const std::function<double(const Vec3&)>& of) {
    const Mount mount = mount_mesh(places, matter, SkinKind::mount);
    return skin_fields(mount, matter, pulled(matter, cells_under(mount, matter), of), kAll);
}

}  // namespace

TEST_CASE("a field that is linear in the place reaches the surface exactly") {
    const Aggregate matter = make_block(6, 4, 3, 0.01, Material{});
    const auto linear = [](const Vec3& x) { return 5 + 100 * x.x() + 30 * x.y() - 70 * x.z(); };
    const std::vector<Vec3> places = places_on({0.03, 0.02, 0.015});
    const SkinFieldValues is = fields_of(matter, places, linear);
    for (std::size_t v = 0; v < places.size(); ++v) {
        const double should = linear(places[v]);
        REQUIRE(is[0][v] == Approx(0.5 * should).epsilon(1e-5));
        REQUIRE(is[1][v] == Approx(should).epsilon(1e-5));
        REQUIRE(is[2][v] == Approx(-should / 3).epsilon(1e-5));
        REQUIRE(is[3][v] == Approx(should).epsilon(1e-5));
    }
}

TEST_CASE("partly filled cells draw the same line, and one cell across bears one value") {
    Aggregate matter = make_block(5, 4, 4, 0.01, Material{});
    const auto linear = [](const Vec3& x) { return 10 + 200 * x.y(); };
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.lattice.cell_site(static_cast<CellId>(c)).y() < 3) continue;
        matter.cell_fill[c] = 0.3f;
        matter.cell_centroid.set(c, Eigen::Vector3f(0, -0.35f, 0));
    }
    const std::vector<Vec3> places = {{0, 0.013, 0}, {0.02, 0.0129, 0.02}, {0, -0.02, 0.01}};
    const SkinFieldValues is = fields_of(matter, places, linear);
    for (std::size_t v = 0; v < places.size(); ++v) {
        CHECK(is[1][v] == Approx(linear(places[v])).epsilon(1e-5));
    }
    const Aggregate sheet = make_block(6, 1, 6, 0.01, Material{});
    for (const double y : {-0.005, 0.0, 0.005}) {
        CHECK(fields_of(sheet, {Vec3(0, y, 0)}, linear)[1][0] == Approx(10));
    }
}

TEST_CASE("the sides of a cut and of a crack do not mix, whatever stands beside them") {
    const auto sides = [](const Vec3& x) { return x.x() > 0.005 ? 2.0 : 1.0; };
    for (const bool cracked : {false, true}) {
        Aggregate matter = make_block(8, 4, 4, 0.01, Material{});
        test::sever_plane(matter, Vec3(0.005, 0, 0), Vec3::UnitX());
        if (cracked) {
            for (ConnectionArrays& all : matter.connection) {
                all.damage.assign(matter.particle_count(), 0.0f);
                for (std::size_t p = 0; p < matter.particle_count(); ++p) {
                    if (all.weight[p] == 0) all.damage[p] = 1;
                }
            }
        }
        std::vector<Vec3> places = places_on({0.04, 0.02, 0.02});
        const std::size_t whole = places.size();
        // Both sides' vertices in the plane itself.
        for (int n = 0; n < 18; ++n) places.emplace_back(0.005, 0.0025 * (n / 2 - 4), 0.02);
        Mount mount = mount_mesh(places, matter, SkinKind::mount);
        const CornerMask left = 0b01010101, right = 0b10101010;
        for (std::size_t v = 0; v < places.size(); ++v) {
            const bool on_right = v < whole ? places[v].x() > 0.005 : v % 2;
            mount.side[v] = on_right ? right : left;
        }
        finish_mount(mount, matter);
        const SkinFieldValues is =
            skin_fields(mount, matter, pulled(matter, cells_under(mount, matter), sides), kAll);
        for (std::size_t v = 0; v < places.size(); ++v) {
            REQUIRE(is[1][v] == Approx(mount.side[v] == right ? 2 : 1).epsilon(1e-6));
        }
    }
}

TEST_CASE("a vertex tells of the material that it lies in") {
    Aggregate matter = make_block(6, 4, 4, 0.01, Material{});
    matter.inset = {Material{}};
    matter.cell_material.assign(matter.cell_fill.size(), 0);
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        matter.cell_material[c] = matter.lattice.cell_site(static_cast<CellId>(c)).x() >= 3;
    }
    const std::vector<Vec3> places = places_on({0.03, 0.02, 0.02});
    const SkinFieldValues is =
        fields_of(matter, places, [](const Vec3& x) { return x.x() > 0 ? 7.0 : 1.0; });
    for (std::size_t v = 0; v < places.size(); ++v) {
        if (places[v].x() == 0) continue;  // between them
        const double should = places[v].x() > 0 ? 7 : 1;
        REQUIRE(is[1][v] == Approx(should).epsilon(1e-6));
    }
}

TEST_CASE("no line goes beyond what a material yields at, nor to less flow than none") {
    const Aggregate matter = make_block(6, 4, 4, 0.01, Material{});
    const Mount mount =
        mount_mesh({{0, 0.02, 0}, {0, -0.02, 0}, {0, 0.005, 0}}, matter, SkinKind::mount);
    std::vector<StressSample> samples =
        pulled(matter, cells_under(mount, matter), [](const Vec3& x) { return 100 * x.y(); });
    for (StressSample& one : samples) {
        one.yields_at = 1.6;
        one.plastic_strain = std::max(0.0, one.plastic_strain);
    }
    const SkinFieldValues is = skin_fields(mount, matter, samples, kAll);
    CHECK(is[1][0] == Approx(1.6));
    CHECK(is[3][0] == Approx(2.0 / 3 + 1.6 * 2 / 3));  // mean and what is left of the deviator
    CHECK(is[0][1] == 0);
    CHECK(is[1][2] == Approx(0.5));
}

TEST_CASE("beside matter that flows at far more, use is told by no less than cells flow at") {
    // Its outermost layer bears half of what it flows at, and those below flow at far more.
    const Aggregate matter = make_block(6, 4, 4, 0.01, Material{});
    std::vector<Vec3> places;
    for (int n = -4; n <= 4; ++n) places.emplace_back(0.005 * n, 0.02, 0.003 * n);
    const Mount mount = mount_mesh(places, matter, SkinKind::mount);
    const double times = GENERATE(1.0, 3.0, 15.0, 100.0);
    INFO(times);
    std::vector<StressSample> samples =
        pulled(matter, cells_under(mount, matter), [](const Vec3&) { return 1.0; });
    for (StressSample& one : samples) one.yields_at = one.place.y() > 3 ? 2 : 2 * times;
    const std::vector<std::vector<float>> is =
        skin_fields(mount, matter, samples, {SkinField::yield_use, SkinField::stress});
    for (std::size_t v = 0; v < places.size(); ++v) {
        CHECK(is[0][v] == Approx(0.5));
        CHECK(is[1][v] == Approx(1));
    }
}

TEST_CASE("slivers of cells say hardly anything of the stress at the surface") {
    Aggregate matter = make_block(5, 4, 4, 0.01, Material{});
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        if (matter.lattice.cell_site(static_cast<CellId>(c)).y() < 3) continue;
        matter.cell_fill[c] = 0.05f;
        matter.cell_centroid.set(c, Eigen::Vector3f(0, -0.475f, 0));
    }
    const auto more_in_slivers = [](const Vec3& x) { return x.y() > 0.01 ? 5.0 : 1.0; };
    CHECK(fields_of(matter, {{0, 0.0104, 0}}, more_in_slivers)[1][0] == Approx(1).epsilon(0.3));
}

TEST_CASE("strength is used by the largest strain, of springs by their own Poisson's ratio") {
    for (const Mechanics mechanics : {Mechanics::cells, Mechanics::springs}) {
        Material material;
        material.mechanics = mechanics;
        material.poisson_ratio = 0.45;  // of which springs do not know
        const Aggregate matter = make_block(4, 4, 4, 0.01, material);
        const Mount mount = mount_mesh({{0, 0.02, 0}}, matter, SkinKind::mount);
        std::vector<StressSample> samples =
            pulled(matter, cells_under(mount, matter), [](const Vec3&) { return 1.0; });
        for (StressSample& one : samples) one.stress[2] = 1, one.breaks_at = 2;
        const double ratio = mechanics == Mechanics::springs ? 0.25 : 0.45;
        CHECK(skin_fields(mount, matter, samples, {SkinField::strength_use})[0][0] ==
              Approx((1 - ratio) / 2).epsilon(1e-5));
    }
}

TEST_CASE("of each material as much strength is used as that has, by its own Poisson's ratio") {
    Material stiff, weak;
    stiff.poisson_ratio = 0.2, weak.poisson_ratio = 0.45;
    Aggregate matter = make_block(8, 4, 4, 0.01, stiff);
    matter.inset = {weak};
    matter.cell_material.assign(matter.cell_fill.size(), 0);
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        matter.cell_material[c] = matter.lattice.cell_site(static_cast<CellId>(c)).x() >= 4;
    }
    const Mount mount = mount_mesh({{-0.03, 0.02, 0}, {0.03, 0.02, 0}}, matter, SkinKind::mount);
    std::vector<StressSample> samples =
        pulled(matter, cells_under(mount, matter), [](const Vec3&) { return 1.0; });
    for (StressSample& one : samples) {
        one.stress[2] = 1;
        one.breaks_at = one.material == 0 ? 4 : 2;
    }
    const SkinFieldValues is = skin_fields(mount, matter, samples, {SkinField::strength_use});
    CHECK(is[0][0] == Approx((1 - 0.2) / 4).epsilon(1e-5));
    CHECK(is[0][1] == Approx((1 - 0.45) / 2).epsilon(1e-5));
}

TEST_CASE("where a connection has broken all of the strength is told to be used") {
    Aggregate matter = make_block(4, 4, 4, 0.01, Material{});
    const auto used = [&] {
        const Mount mount = mount_mesh({{0.004, 0.02, 0}}, matter, SkinKind::mount);
        std::vector<StressSample> samples =
            pulled(matter, cells_under(mount, matter), [](const Vec3&) { return 1.0; });
        for (StressSample& one : samples) one.breaks_at = 4;
        return skin_fields(mount, matter, samples, {SkinField::strength_use})[0][0];
    };
    CHECK(used() == Approx(0.25));
    test::sever_plane(matter, Vec3(0.001, 0, 0), Vec3::UnitX());
    for (ConnectionArrays& all : matter.connection) {
        all.damage.assign(matter.particle_count(), 0.0f);
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            if (all.weight[p] == 0) all.damage[p] = 1;
        }
    }
    CHECK(used() == 1);
}

TEST_CASE("fields are the same bytes at any number of threads") {
    const Aggregate matter = make_block(9, 7, 8, 0.01, Material{});
    const auto of = [](const Vec3& x) { return std::sin(300 * x.x()) + x.y() * x.z(); };
    const std::vector<Vec3> places = places_on({0.045, 0.035, 0.04});
    set_thread_count(1);
    const SkinFieldValues one = fields_of(matter, places, of);
    for (const int threads : {2, 3, 8}) {
        set_thread_count(threads);
        CHECK(fields_of(matter, places, of) == one);
    }
    set_thread_count(0);
}

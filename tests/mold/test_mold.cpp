// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/mold.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "matter/material_volumes.h"
#include "mold/prepare.h"
#include "mold/topology.h"
#include "tests/mold/checks.h"

using namespace swage;
using namespace swage::test;

namespace {

template <typename Act>
ExitCode refusal(const Act& act, std::string* sentence = nullptr) {
    try {
        act();
    } catch (const Error& error) {
        if (sentence) *sentence = error.what();
        return error.code();
    }
    return ExitCode::done;
}

}  // namespace

TEST_CASE("a bar of whole cells is molded into exactly these cells") {
    const Vec3 at(0.3, -1.7, 12.1);
    const double h = 0.1;
    const TriMesh bar = box_mesh(at, at + h * Vec3(8, 1, 1) * 2);
    const Aggregate matter = mold_across(bar, 2);
    REQUIRE(matter.lattice.cell_count == Vec3i(16, 2, 2));
    REQUIRE(matter.cell_fill.size() == 64);
    CHECK(matter.particle_count() == 17 * 9);
    CHECK((matter.lattice.origin - at).norm() < 1e-12);
    for (std::size_t c = 0; c < 64; ++c) {
        CHECK(matter.cell_fill[c] == 1.0f);
        CHECK(matter.cell_centroid[c] == Eigen::Vector3f::Zero());
    }
    const int edges = 16 * 3 * 3 + 2 * (17 * 3 * 2), faces = 17 * 4 + 2 * (16 * 3 * 2);
    CHECK(matter.connection_count() == edges + 2 * faces);
    check_matter(bar, matter);
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        // On a face, not on an edge, one of four on the face of a cell.
        CHECK(matter.surface.area(p) == Approx(h * h / 4));
        const Vec3 u = (matter.surface_reference(p) - at) / h;
        int on_face = 0;
        for (int d = 0; d < 3; ++d) {
            const double side = d == 0 ? 16 : 2;
            on_face += std::abs(u[d]) < 1e-9 || std::abs(u[d] - side) < 1e-9;
        }
        CHECK(on_face == 1);
        CHECK(matter.surface.normal(p).cwiseAbs().maxCoeff() == Approx(1));
    }
    CHECK(matter.surface.size() == 4 * (4 * 32 + 2 * 4));
}

TEST_CASE("a connection weighs the share of the cells around it that are solid") {
    const Aggregate matter = mold_across(box_mesh(Vec3::Zero(), Vec3(6, 2, 2)), 2);
    const auto site = [&](int p) {
        return Vec3i((matter.particle_reference.at(p).array() + 0.5).floor().cast<int>());
    };
    for (const Span& span : matter.lattice.span) {
        for (int n = 0; n < span.count; ++n) {
            const Vec3i a = site(span.lower + n), b = site(span.upper + n);
            int around = 0;  // cells of the bar that hold both ends
            for (int k = 0; k < 2; ++k)
                for (int j = 0; j < 2; ++j)
                    for (int i = 0; i < 6; ++i) {
                        const auto holds = [&](const Vec3i& p) {
                            const Vec3i d = p - Vec3i(i, j, k);
                            return d.minCoeff() >= 0 && d.maxCoeff() <= 1;
                        };
                        around += holds(a) && holds(b);
                    }
            const float whole = span.direction < kEdgeCount ? 4 : 2;
            CHECK(matter.connection[span.direction].weight[span.lower + n] == around / whole);
        }
    }
}

TEST_CASE("sides known only to single precision still hold whole cells") {
    const Aggregate matter =
        mold_across(box_mesh({0, 0, 0}, {double(0.7f), double(0.1f), double(0.3f)}), 1);
    CHECK(matter.lattice.cell_count == Vec3i(7, 1, 3));
    for (float fill : matter.cell_fill) CHECK(fill == 1.0f);
}

TEST_CASE(
    "what a file rounds off makes no other cells, does not strain them and weighs what it does") {
    const Aggregate exact = mold_across(box_mesh({0, 0, 0}, {1, 1. / 3, 1. / 3}), 4);
    for (const Vec3& side :
         {Vec3(1, 0.333333, 0.333333), Vec3(1, 0.333334, 0.33333), Vec3(1.0001, 1. / 3, 0.33335)}) {
        const Aggregate matter = mold_across(box_mesh({0, 0, 0}, side), 4);
        const double a = matter.lattice.spacing;
        REQUIRE(matter.lattice.cell_count == exact.lattice.cell_count);
        for (float fill : matter.cell_fill) CHECK(fill == 1.0f);
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3 all = matter.lattice.cell_count.cast<double>() * a;
            const Vec3 span = matter.particle_position.at(matter.particle_count() - 1) -
                              matter.particle_position.at(0);
            CHECK(span[axis] == Approx(all[axis]).epsilon(1e-14));
        }
        CHECK(matter.mass() == Approx(1000 * side.prod()).epsilon(1e-12));
        CHECK((matter.centre() - 0.5 * side).norm() < 1e-12);
    }
    // What is meant is not taken for that.
    CHECK(mold_across(box_mesh({0, 0, 0}, {1.001, 1. / 3, 1. / 3}), 4).lattice.cell_count.x() ==
          13);
}

TEST_CASE("the mold is the same at any number of threads") {
    const TriMesh mesh = moved(knot_mesh(200, 20), some_turn());
    set_thread_count(1);
    const Aggregate one = mold_across(mesh, 14);
    for (int threads : {2, 3, 8}) {
        set_thread_count(threads);
        const Aggregate more = mold_across(mesh, 14);
        CHECK(state_hash(more) == state_hash(one));
        CHECK(more.cell_fill == one.cell_fill);
        CHECK(more.surface == one.surface);
    }
    set_thread_count(0);
}

TEST_CASE("a surface point moves with its cell") {
    Aggregate matter = mold_across(moved(torus_mesh(1, 0.3, 40, 20), some_turn()), 5);
    const Pose pose = some_turn();
    Mat3 strain;
    strain << 1.1, 0.2, 0, 0, 0.9, -0.1, 0.05, 0, 1.2;
    for (std::size_t p = 0; p < matter.particle_count(); ++p)
        matter.particle_position.set(p, pose * (strain * matter.particle_reference.at(p)));
    double farthest = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        const Vec3 expected = pose * (strain * matter.surface_reference(p));
        farthest = std::max(farthest, (matter.surface_position(p) - expected).norm());
        double sum = 0;
        for (double w : matter.surface.carriers(p).weight) sum += w;
        CHECK(sum == Approx(1).epsilon(1e-6));
    }
    CHECK(farthest < 1e-6);
}

TEST_CASE("a surface point is carried by a firm cell, or by the fullest within reach") {
    TriMesh spike = box_mesh(Vec3::Zero(), Vec3::Ones());
    for (Vec3& x : spike.position) {
        if (x.minCoeff() > 0) x = {2, 2.5, 3};
    }
    const Aggregate matter = mold_across(spike, 8);
    const Lattice& lattice = matter.lattice;
    const auto corner = [&](CellId cell, int c) {
        return Vec3(matter.particle_reference.at(lattice.cell_corners(cell)[c]));
    };
    int thin = 0, drawn_in = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        const Vec3 point = matter.surface_reference(p), place = matter.surface.place(p);
        float carrier = 0, fullest = 0;
        double far = 0, nearest = 1;  // of the carrier, of a firm cell [m]
        // No farther outside of it than its weights may grow.
        CHECK(place.minCoeff() >= -0.5);
        CHECK(place.maxCoeff() <= 1.5);
        drawn_in += place.minCoeff() < -0.25 || place.maxCoeff() > 1.25;
        for (CellId cell = 0; cell < static_cast<CellId>(matter.cell_fill.size()); ++cell) {
            const Vec3 low = corner(cell, 0), high = corner(cell, 7);
            if (lattice.cell_corners(cell) == matter.surface.corner(p)) {
                carrier = matter.cell_fill[cell];
                far = (point - point.cwiseMax(low).cwiseMin(high)).norm();
            }
            const double off = (point - point.cwiseMax(low).cwiseMin(high)).norm();
            if (off < 0.45 * lattice.spacing) fullest = std::max(fullest, matter.cell_fill[cell]);
            if (matter.cell_fill[cell] >= 0.4f) nearest = std::min(nearest, off);
        }
        thin += carrier < 0.4f;
        CHECK((carrier >= 0.4f || carrier >= fullest));
        if (carrier >= 0.4f) CHECK(far <= nearest + 1e-6 * lattice.spacing);
    }
    CHECK(thin > 0);
    CHECK(drawn_in > 0);
}

TEST_CASE("a block holds the mesh's box in whole cells") {
    MoldSettings settings;
    settings.kind = MoldKind::block;
    settings.across = 3;
    const TriMesh mesh = torus_mesh(1, 0.31, 40, 20);
    const Aggregate block = mold(mesh, {}, settings);
    const Box box = box_of(mesh.position);
    const Vec3 size = block.lattice.spacing * block.lattice.cell_count.cast<double>();
    for (float fill : block.cell_fill) CHECK(fill == 1.0f);
    CHECK(static_cast<int>(block.cell_fill.size()) == block.lattice.cell_count.prod());
    for (int d = 0; d < 3; ++d) {
        CHECK(block.lattice.origin[d] <= box.low[d] + 1e-12);
        CHECK(block.lattice.origin[d] + size[d] >= box.high[d] - 1e-12);
        CHECK(block.lattice.origin[d] + size[d] / 2 == Approx(box.center()[d]).margin(1e-12));
        CHECK(size[d] < box.size()[d] + block.lattice.spacing);
    }
    check_matter(box_mesh(block.lattice.origin, block.lattice.origin + size), block);
}

TEST_CASE("matter has the mesh's handles once the cells are fine enough") {
    const TriMesh ring = torus_mesh(1, 0.3, 40, 20);
    CHECK(euler_inside(ring) == 0);
    CHECK(euler_of(mold_across(ring, 6)) == 0);
    const TriMesh turned = moved(ring, some_turn());
    CHECK(euler_of(mold_across(turned, 1)) == 1);  // its hole is closed
    CHECK(euler_inside(sphere_mesh(1, 2)) == 1);
    CHECK(euler_of(mold_across(sphere_mesh(1, 2), 7)) == 1);
    const TriMesh shell = together(sphere_mesh(1, 2), turned_inside_out(sphere_mesh(0.5, 2)));
    CHECK(euler_inside(shell) == 2);
    CHECK(euler_of(mold_across(shell, 16)) == 2);
    CHECK(count_bodies(shell) == 1);
    TriMesh open = ring;
    open.triangle.pop_back();
    CHECK_FALSE(euler_inside(open));
}

TEST_CASE("the estimate tells what the mold will hold") {
    for (const TriMesh& mesh : {box_mesh({0, 0, 0}, {8, 2, 2}), sphere_mesh(1, 3),
                                moved(torus_mesh(1, 0.3, 40, 20), some_turn())}) {
        MoldSettings settings;
        for (const int across : {8, 40}) {
            settings.across = across;
            const MoldEstimate estimate = estimate_mold(mesh, settings);
            const Aggregate matter = mold(mesh, {}, settings);
            CHECK(estimate.spacing == matter.lattice.spacing);
            CHECK(estimate.cell_count == matter.lattice.cell_count);
            CHECK(estimate.active_cells == Approx(matter.cell_fill.size()).epsilon(0.1));
            CHECK(estimate.particles == Approx(matter.particle_count()).epsilon(0.1));
            CHECK(estimate.connections == Approx(matter.connection_count()).epsilon(0.12));
            CHECK(estimate.bytes > matter.bytes());
            CHECK(estimate.bytes < 1.5 * matter.bytes());
        }
    }
}

TEST_CASE("what cannot be molded is refused with a reason") {
    std::string sentence;
    const TriMesh box = box_mesh({0, 0, 0}, {3, 1, 2});
    MoldSettings settings;
    const auto code = [&](const TriMesh& mesh) {
        return refusal([&] { mold(mesh, {}, settings); }, &sentence);
    };
    CHECK(code(box) == ExitCode::scene);  // neither across nor spacing
    settings.across = 0;
    CHECK(code(box) == ExitCode::scene);
    settings.across = 4;
    CHECK(code({}) == ExitCode::mesh);
    CHECK(code(turned_inside_out(box)) == ExitCode::mesh);
    TriMesh sheet = box_mesh({0, 0, 0}, {3, 1, 0});
    CHECK(code(sheet) == ExitCode::mesh);
    CHECK(code(moved(sheet, some_turn())) == ExitCode::mesh);  // thick box, no volume
    // One side of a leaf.
    sheet.position = {{0, 0, 0}, {1, 0, 1}, {1, 1, 2}, {0, 1, 1}};
    sheet.triangle = {{0, 1, 2}, {0, 2, 3}};
    CHECK(code(sheet) == ExitCode::mesh);
    CHECK(sentence.find("encloses no volume") != std::string::npos);
    settings.across.reset();
    settings.spacing = 1.5;
    CHECK(code(box) == ExitCode::mesh);
    CHECK(sentence.find("\"1 m\" or less") != std::string::npos);
    settings.spacing = 1e-4;
    CHECK(code(box) == ExitCode::resources);
    CHECK(
        sentence.find("30,000 x 10,000 x 20,000 = 6,000,000,000,000 cells of 100 um are more than "
                      "the 1,000,000,000 that a mold can have") != std::string::npos);
    settings.spacing = 1e-300;
    CHECK(code(box) == ExitCode::resources);
    settings.spacing = 1.0 / 32;
    settings.cell_limit = 1000;
    CHECK(code(box) == ExitCode::resources);
    CHECK(sentence.find("cells of 3.125 cm") != std::string::npos);
    CHECK(sentence.find("are more than [mold] cell_limit = 1,000: use a larger spacing, or set "
                        "cell_limit higher") != std::string::npos);
    settings.cell_limit = 10'000'000;
    CHECK(code(box) == ExitCode::done);
    // A film so thin that no cell holds a thousandth of it.
    settings.spacing = 0.25;
    CHECK(code(moved(box_mesh({0, 0, 0}, {3, 1, 1e-4}), some_turn())) == ExitCode::mesh);
    CHECK(sentence.find("\"99 um\" or less") != std::string::npos);
    // Dust.
    settings.spacing = 1.0;
    const TriMesh grain = box_mesh(Vec3::Constant(0.4), Vec3::Constant(0.45));
    CHECK(code(together(grain, moved(grain, {Quat::Identity(), {3, 3, 3}}))) == ExitCode::mesh);
}

TEST_CASE("what matter has not as its mesh has it is told to the one who asks") {
    const double h = 0.1;
    TriMesh mesh = box_mesh(Vec3::Zero(), h * Vec3(8, 2, 2));
    MoldSettings settings;
    settings.spacing = h;
    std::vector<std::string> told;
    mold(mesh, Material{}, settings, {}, &told);
    CHECK(told.empty());
    mesh = together(mesh, box_mesh(h * Vec3(8.2, 0, 0), h * Vec3(12, 2, 2)));
    mold(mesh, Material{}, settings, {}, &told);
    REQUIRE(told.size() == 1);
    CHECK(told[0].find("2 separate bodies became 1") == 0);
}

TEST_CASE("what of a mesh is lost, or filled less than nothing, is told with how much") {
    MoldSettings settings;
    settings.spacing = 1;
    const TriMesh box = box_mesh({0, 0, 0}, {4, 2, 2});
    const auto told_of = [&](const TriMesh& beside) {
        std::vector<std::string> told;
        mold(together(box, beside), Material{}, settings, {}, &told);
        std::string all;
        for (const std::string& one : told) all += one + "\n";
        return all;
    };
    const TriMesh grain = box_mesh({7.4, 0.4, 0.4}, {7.45, 0.45, 0.45});
    CHECK(told_of(grain).find("125 cm3 is lost in pieces too small for cells of 1 m\n") !=
          std::string::npos);
    const TriMesh hollow = turned_inside_out(box_mesh({6, 0, 0}, {7, 1, 1}));
    CHECK(told_of(hollow).find("0 m3 beyond full cells and 1 m3 filled negatively are left out") !=
          std::string::npos);
    CHECK(told_of(box_mesh({0, 0, 0}, {1, 2, 2}))
              .find("4 m3 beyond full cells and 0 m3 filled negatively are left out") !=
          std::string::npos);
}

TEST_CASE("what would take more memory than there is is refused before it takes any") {
    if (whole_memory() > 1e11) return;
    MoldSettings settings;
    settings.cell_limit = 1'000'000'000;
    settings.spacing = 0.00189;  // 888 million cells
    std::string sentence;
    CHECK(refusal(
              [&] {
                  refuse_too_many_cells(box_mesh({0, 0, 0}, {3, 1, 2}), settings);
              },
              &sentence) == ExitCode::resources);
    CHECK(sentence.find("of memory that there is: use a larger spacing") != std::string::npos);
}

TEST_CASE("each material has the mass that it is given, and its density where it has none") {
    const TriMesh bar = box_mesh({0, 0, 0}, {4, 2, 2});
    Material light, heavy;
    light.density = 700, heavy.density = 5000;
    const std::vector<Inset> insets = {{box_mesh({0, 0, 0}, {1.3, 2, 2}), heavy}};
    MoldSettings settings;
    settings.spacing = 0.5;
    const std::vector<double> masses = {3, 50};
    const Aggregate weighed = mold(bar, light, settings, insets, nullptr, &masses);
    CHECK(weighed.mass() == Approx(53).epsilon(1e-6));
    CHECK(material_masses(weighed)[0] == Approx(3).epsilon(1e-6));
    CHECK(material_masses(weighed)[1] == Approx(50).epsilon(1e-6));
    CHECK(weighed.inset[0].density == Approx(50 / (1.3 * 4)).epsilon(1e-6));
    const std::vector<double> of_one = {3, 0};
    const Aggregate other = mold(bar, light, settings, insets, nullptr, &of_one);
    CHECK(other.material.density == Approx(3 / (2.7 * 4)).epsilon(1e-6));
    CHECK(other.inset[0].density == 5000);
}

TEST_CASE("bodies become one where they stand less than two cells apart, which is told") {
    const double h = 0.1;
    MoldSettings settings;
    settings.spacing = h;
    int joined = 0;
    for (double gap : {1.6, 2.001}) {
        for (double length : {3.1, 3.3, 3.5, 3.7, 3.9}) {
            const TriMesh mesh =
                together(box_mesh(Vec3::Zero(), h * Vec3(4.3, 2, 2)),
                         box_mesh(h * Vec3(4.3 + gap, 0, 0), h * Vec3(4.3 + gap + length, 2, 2)));
            std::vector<std::string> told;
            const Aggregate matter = mold(mesh, Material{}, settings, {}, &told);
            const bool is_one = find_pieces(matter).count == 1;
            CHECK((gap < 2 || !is_one));
            CHECK(told.size() == (is_one ? 1 : 0));
            joined += is_one;
            if (!is_one) continue;
            CHECK(told[0] ==
                  "2 separate bodies became 1: they share the corners of cells of 10 cm, as those "
                  "less than two cells (20 cm) apart may, or are too small for these; a smaller "
                  "spacing keeps them apart");
        }
    }
    CHECK(joined > 0);
}

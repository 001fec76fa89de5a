// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/mold.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/parallel.h"
#include "mold/shares.h"
#include "mold/topology.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;
using namespace swage::fixtures;

namespace {

Aggregate mold_across(const TriMesh& mesh, int across) {
    MoldSettings settings;
    settings.across = across;
    return mold(mesh, {}, settings);
}

Pose some_turn() {
    return {
        Quat(Eigen::AngleAxisd(0.5236, Vec3::UnitZ()) * Eigen::AngleAxisd(0.349, Vec3::UnitY())),
        {0.3, -0.2, 0.71}};
}

// First moments of the mesh's inside over its volume.
Vec3 mesh_centroid(const TriMesh& mesh) {
    const Vec3 about = box_of(mesh.position).center();
    double volume = 0;
    Vec3 moment = Vec3::Zero();
    for (const Corners& t : mesh.triangle) {
        const Vec3 a = mesh.position[t[0]] - about, b = mesh.position[t[1]] - about,
                   c = mesh.position[t[2]] - about;
        const double v = a.dot(b.cross(c)) / 6;
        volume += v;
        moment += v / 4 * (a + b + c);
    }
    return about + moment / volume;
}

Vec3 matter_centroid(const Aggregate& matter) {
    const Lattice& lattice = matter.lattice;
    double fill = 0;
    Vec3 moment = Vec3::Zero();
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        const Vec3 site = lattice.cell_site(static_cast<CellId>(c)).cast<double>();
        const Vec3 centroid = matter.cell_centroid[c].cast<double>();
        fill += matter.cell_fill[c];
        moment += matter.cell_fill[c] * (site.array() + 0.5 + centroid.array()).matrix();
    }
    return lattice.origin + lattice.spacing * moment / fill;
}

// Volume, mass, surface and centroid are the mesh's; shares lie where they must.
void check_matter(const TriMesh& mesh, const Aggregate& matter) {
    const double volume = signed_volume(mesh);
    CHECK(matter.volume() == Approx(volume).epsilon(1e-6));
    CHECK(matter.mass() == Approx(volume * matter.material.density).epsilon(1e-6));
    double area = 0;
    Vec3 closed = Vec3::Zero();
    double farthest = 0;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        area += matter.surface.area[p];
        closed += matter.surface.area[p] * matter.surface.reference_normal[p];
        farthest = std::max(
            farthest, (matter.surface_position(p) - matter.surface.reference_position[p]).norm());
    }
    CHECK(area == Approx(surface_area(mesh)).epsilon(1e-9));
    CHECK(farthest < 1e-6 * (matter.lattice.spacing + box_of(mesh.position).high.norm()));
    CHECK((matter_centroid(matter) - mesh_centroid(mesh)).norm() < 1e-4 * matter.lattice.spacing);
    float least = 1, most = 0, off_center = 0;
    for (std::size_t c = 0; c < matter.cell_fill.size(); ++c) {
        least = std::min(least, matter.cell_fill[c]);
        most = std::max(most, matter.cell_fill[c]);
        off_center = std::max(off_center, matter.cell_centroid[c].cwiseAbs().maxCoeff());
    }
    CHECK(least >= 0.999f * static_cast<float>(kLeastFill));
    CHECK(most <= 1.0 + 6 * kLeastFill);
    CHECK(off_center <= 0.5f);
    double lightest = 1;
    for (double m : matter.particle_mass) lightest = std::min(lightest, m);
    CHECK(lightest > 0);
}

// Positions and faces only.
TriMesh read_obj(const std::filesystem::path& file) {
    TriMesh mesh;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            Vec3 p;
            words >> p.x() >> p.y() >> p.z();
            mesh.position.push_back(p);
        } else if (kind == "f") {
            Corners t;
            for (int& c : t) {
                std::string corner;
                words >> corner;
                c = std::stoi(corner) - 1;
            }
            mesh.triangle.push_back(t);
        }
    }
    return mesh;
}

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
        CHECK(matter.surface.area[p] == Approx(h * h / 4));
        const Vec3 u = (matter.surface.reference_position[p] - at) / h;
        int on_face = 0;
        for (int d = 0; d < 3; ++d) {
            const double side = d == 0 ? 16 : 2;
            on_face += std::abs(u[d]) < 1e-9 || std::abs(u[d] - side) < 1e-9;
        }
        CHECK(on_face == 1);
        CHECK(matter.surface.reference_normal[p].cwiseAbs().maxCoeff() == Approx(1));
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

TEST_CASE("volume, mass, surface and centroid are the mesh's at any spacing") {
    const std::vector<std::pair<const char*, TriMesh>> meshes = {
        {"sphere", sphere_mesh(0.7, 3)},
        {"torus", torus_mesh(1, 0.3, 40, 20)},
        {"turned box", moved(box_mesh({-2, -0.5, -0.5}, {2, 0.5, 0.5}), some_turn())},
        {"turned torus", moved(torus_mesh(1, 0.3, 40, 20), some_turn())},
        {"bumpy knot", knot_mesh(300, 24)},
        {"turned bar of odd size",
         moved(box_mesh({0, 0, 0}, {3.3, 0.11, 0.17}), {Quat::Identity(), {5, 5, 5}})},
    };
    for (const auto& [name, mesh] : meshes) {
        for (int across : {1, 2, 3, 4, 5, 7, 11, 16, 20}) {
            INFO(name << ", " << across << " cells across");
            check_matter(mesh, mold_across(mesh, across));
        }
    }
}

TEST_CASE("the animal of the common data keeps its volume") {
    const std::filesystem::path file =
        SWAGE_SOURCE_DIR "/../shared/data/meshes/spot_triangulated.obj";
    if (!std::filesystem::exists(file)) {
        std::puts("skipped: no mesh data beside the sources");
        return;
    }
    const TriMesh mesh = read_obj(file);
    for (int across : {1, 3, 6, 12, 20}) {
        INFO(across << " cells across");
        check_matter(mesh, mold_across(mesh, across));
    }
}

TEST_CASE("shares and first moments are exact in double precision") {
    const TriMesh mesh = moved(knot_mesh(120, 16), some_turn());
    const MoldFrame frame = frame_over(box_of(mesh.position), 0.21);
    double volume = 0;
    Vec3 moment = Vec3::Zero();
    const std::vector<CellLayer> layers = share_cells(mesh, frame);
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const CellShare& s : layers[k].share) {
            const Vec3 center(s.i + 0.5, s.j + 0.5, static_cast<double>(k) + 0.5);
            volume += s.fill;
            moment += s.fill * center + s.moment;
        }
    }
    CHECK(volume * frame.cell_volume() == Approx(signed_volume(mesh)).epsilon(1e-12));
    CHECK((frame.origin + 0.21 * moment / volume - mesh_centroid(mesh)).norm() < 1e-12);
}

TEST_CASE("each cell's share is the part of the mesh inside that cell") {
    // A tetrahedron x + y + z < 3 in the first octant: the cell at (i, j, k) holds a polynomial.
    TriMesh mesh;
    mesh.position = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
    mesh.triangle = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const auto layers = share_cells(mesh, frame_over(box_of(mesh.position), 1));
    int cells = 0;
    for (int k = 0; k < 3; ++k) {
        for (const CellShare& s : layers[k].share) {
            ++cells;
            // Volume and centroid of the unit cube below x + y + z = rest.
            const int rest = 3 - s.i - s.j - k;
            const double fill = rest == 3 ? 1 : rest == 2 ? 5.0 / 6 : 1.0 / 6;
            const double center = rest == 3 ? 0 : rest == 2 ? -0.05 : -0.25;
            CHECK(s.fill == Approx(fill).epsilon(1e-14));
            for (int d = 0; d < 3; ++d) CHECK(s.moment[d] == Approx(fill * center).margin(1e-14));
        }
    }
    CHECK(cells == 10);
}

TEST_CASE("a cavity stays empty, and matter inside it stays apart") {
    const TriMesh shell = together(box_mesh(Vec3::Constant(-3), Vec3::Constant(3)),
                                   turned_inside_out(sphere_mesh(2.2, 3)));
    const Aggregate hollow = mold_across(shell, 20);
    check_matter(shell, hollow);
    CHECK(find_pieces(hollow).count == 1);
    CHECK(hollow.lattice.cell_at(10, 10, 10) == -1);
    const TriMesh kernel = together(shell, sphere_mesh(1, 3));
    const Aggregate both = mold_across(kernel, 20);
    check_matter(kernel, both);
    CHECK(find_pieces(both).count == 2);
    CHECK(both.lattice.cell_at(10, 10, 10) >= 0);
}

TEST_CASE("a moved mesh gives the same shares") {
    const TriMesh mesh = knot_mesh(120, 16);
    const Aggregate here = mold_across(mesh, 6);
    const Aggregate there = mold_across(moved(mesh, {Quat::Identity(), {1.25, -2.5, 0.125}}), 6);
    REQUIRE(here.cell_fill.size() == there.cell_fill.size());
    float most = 0;
    for (std::size_t c = 0; c < here.cell_fill.size(); ++c) {
        most = std::max(most, std::abs(here.cell_fill[c] - there.cell_fill[c]));
    }
    CHECK(most < 1e-6f);
}

TEST_CASE("sides known only to single precision still hold whole cells") {
    const Aggregate matter =
        mold_across(box_mesh({0, 0, 0}, {double(0.7f), double(0.1f), double(0.3f)}), 1);
    CHECK(matter.lattice.cell_count == Vec3i(7, 1, 3));
    for (float fill : matter.cell_fill) CHECK(fill == 1.0f);
}

TEST_CASE("slivers go to a neighbour and take nothing with them") {
    // 4.0005 cells long: the end cells of five would hold a quarter of a thousandth more each.
    const TriMesh bar = box_mesh({0, 0, 0}, {4.0005, 1, 1});
    MoldSettings settings;
    settings.spacing = 1;
    const Aggregate matter = mold(bar, {}, settings);
    check_matter(bar, matter);
    const TriMesh tip =
        together(box_mesh({0, 0, 0}, {4, 1, 1}), box_mesh({4, 0.49, 0.49}, {4.9, 0.51, 0.51}));
    const Aggregate needle = mold(tip, {}, settings);
    check_matter(tip, needle);
    for (float fill : needle.cell_fill) CHECK(fill > 0.9 * kLeastFill);
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
        CHECK(more.surface.weight == one.surface.weight);
        CHECK(more.surface.area == one.surface.area);
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
        const Vec3 expected = pose * (strain * matter.surface.reference_position[p]);
        farthest = std::max(farthest, (matter.surface_position(p) - expected).norm());
        float sum = 0;
        for (float w : matter.surface.weight[p]) sum += w;
        CHECK(sum == Approx(1).epsilon(1e-6));
    }
    CHECK(farthest < 1e-6);
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

TEST_CASE("an open surface is filled to about its rim") {
    TriMesh pot = box_mesh({0, 0, 0}, {4, 4, 4});
    for (int missing : {2, 8, 10}) {  // half of the face towards +x, +z or -z
        TriMesh open = pot;
        open.triangle.erase(open.triangle.begin() + missing);
        const Aggregate matter = mold_across(open, 4);
        CHECK(matter.volume() == Approx(64).epsilon(0.1));
        CHECK(matter.cell_fill.size() <= 64);
    }
}

TEST_CASE("parts that overlap are filled once") {
    const TriMesh mesh = together(box_mesh({0, 0, 0}, {4, 2, 2}), box_mesh({2, 0, 0}, {6, 2, 2}));
    const Aggregate matter = mold_across(mesh, 2);
    CHECK(matter.volume() == Approx(24));
    CHECK(find_pieces(matter).count == 1);
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
        settings.across = 8;
        const MoldEstimate estimate = estimate_mold(mesh, settings);
        const Aggregate matter = mold(mesh, {}, settings);
        CHECK(estimate.spacing == matter.lattice.spacing);
        CHECK(estimate.cell_count == matter.lattice.cell_count);
        CHECK(estimate.active_cells == Approx(matter.cell_fill.size()).epsilon(0.1));
        CHECK(estimate.particles == Approx(matter.particle_count()).epsilon(0.1));
        CHECK(estimate.connections == Approx(matter.connection_count()).epsilon(0.12));
        CHECK(estimate.bytes > matter.bytes());
        CHECK(estimate.bytes < 4 * matter.bytes());
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
    settings.across.reset();
    settings.spacing = 1.5;
    CHECK(code(box) == ExitCode::mesh);
    CHECK(sentence.find("\"1 m\" or less") != std::string::npos);
    settings.spacing = 1e-4;
    CHECK(code(box) == ExitCode::resources);
    CHECK(sentence.find("30000 x 10000 x 20000 = 6e+12 cells") != std::string::npos);
    CHECK(sentence.find("5e+07") != std::string::npos);
    settings.spacing = 1e-300;
    CHECK(code(box) == ExitCode::resources);
    settings.spacing = 1.0 / 32;
    settings.cell_limit = 1000;
    CHECK(code(box) == ExitCode::resources);
    settings.cell_limit = 10'000'000;
    CHECK(code(box) == ExitCode::done);
    // A film so thin that no cell holds a thousandth of it.
    settings.spacing = 0.25;
    CHECK(code(moved(box_mesh({0, 0, 0}, {3, 1, 1e-4}), some_turn())) == ExitCode::mesh);
    CHECK(sentence.find("\"0.0001 m\" or less") != std::string::npos);
    // Dust.
    settings.spacing = 1.0;
    const TriMesh grain = box_mesh(Vec3::Constant(0.4), Vec3::Constant(0.45));
    CHECK(code(together(grain, moved(grain, {Quat::Identity(), {3, 3, 3}}))) == ExitCode::mesh);
}

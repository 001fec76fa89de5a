// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/shares.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "mold/caps.h"
#include "tests/mold/checks.h"

using namespace swage;
using namespace swage::test;

namespace {

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
            std::vector<int> corner;
            for (std::string text; words >> text;) corner.push_back(std::stoi(text) - 1);
            for (std::size_t n = 2; n < corner.size(); ++n)
                mesh.triangle.push_back({corner[0], corner[n - 1], corner[n]});
        }
    }
    return mesh;
}

}  // namespace

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

TEST_CASE("meshes of the project and of the common data keep their volume", "[stress]") {
    int read = 0;
    for (const char* folder : {"/assets/meshes", "/../shared/data/meshes"}) {
        const std::filesystem::path path = std::string(SWAGE_SOURCE_DIR) + folder;
        if (!std::filesystem::exists(path)) continue;
        for (const auto& entry : std::filesystem::directory_iterator(path)) {
            if (entry.path().extension() != ".obj") continue;
            const TriMesh mesh = read_obj(entry.path());
            for (int across : {1, 2, 5, 12}) {
                INFO(entry.path().filename() << ", " << across << " cells across");
                check_matter(mesh, mold_across(mesh, across));
            }
            ++read;
        }
    }
    if (read == 0) std::puts("skipped: no mesh files beside the sources");
}

TEST_CASE("shares and first moments are exact in double precision") {
    const TriMesh mesh = moved(knot_mesh(120, 16), some_turn());
    const MoldFrame frame = frame_over(box_of(mesh.position), 0.21);
    double volume = 0;
    Vec3 moment = Vec3::Zero();
    const std::vector<CellLayer> layers = share_cells(mesh, frame);
    for (std::size_t k = 0; k < layers.size(); ++k) {
        for (const CellFill& s : layers[k].share) {
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
        for (const CellFill& s : layers[k].share) {
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

TEST_CASE("slivers go to a neighbour and take nothing with them") {
    MoldSettings settings;
    settings.spacing = 1;
    // A film half a thousandth of a cell thick on a bar with a tower.
    const TriMesh film =
        together(together(box_mesh({0, 0, 0}, {5, 1, 1}), box_mesh({4, 0, 1}, {5, 1, 2})),
                 box_mesh({1, 0, 1}, {3, 1, 1.0005}));
    const Aggregate bar = mold(film, {}, settings);
    check_matter(film, bar);
    REQUIRE(bar.cell_fill.size() == 6);
    for (int c = 0; c < 6; ++c) {
        const bool under_film = c == 1 || c == 2;
        CHECK(bar.cell_fill[c] == (under_film ? 1.0005f : 1.0f));
    }
    const TriMesh tip =
        together(box_mesh({0, 0, 0}, {4, 1, 1}), box_mesh({4, 0.49, 0.49}, {4.9, 0.51, 0.51}));
    const Aggregate needle = mold(tip, {}, settings);
    check_matter(tip, needle);
    for (float fill : needle.cell_fill) CHECK(fill > 0.9 * kLeastFill);
}

namespace {

// Layers of cells in one row along x, with what fills them about their middles.
std::vector<CellLayer> row_of(const std::vector<double>& fill) {
    std::vector<CellLayer> layers(1);
    for (int i = 0; i < static_cast<int>(fill.size()); ++i) {
        layers[0].share.push_back({i, 0, fill[i], Vec3::Zero()});
    }
    return layers;
}

std::vector<double> fills_of(const std::vector<CellLayer>& layers) {
    std::vector<double> fill;
    for (const CellLayer& layer : layers) {
        for (const CellFill& s : layer.share) fill.push_back(s.fill);
    }
    return fill;
}

}  // namespace

TEST_CASE("no sliver is left, and what no neighbour takes is told as lost") {
    // The first goes to the second, which is a sliver still and has none to go to.
    std::vector<CellLayer> layers = row_of({1e-4, 3e-4});
    CHECK(drop_slivers(layers) == Approx(4e-4));
    CHECK(fills_of(layers).empty());
    // Both are a cell.
    layers = row_of({6e-4, 7e-4});
    CHECK(drop_slivers(layers) == 0);
    REQUIRE(fills_of(layers).size() == 1);
    CHECK(fills_of(layers)[0] == Approx(1.3e-3));
    CHECK(layers[0].share[0].i == 1);
    CHECK(layers[0].share[0].moment.x() == Approx(-6e-4));
}

TEST_CASE("what is filled less than nothing is taken from a neighbour that has twice as much") {
    const auto left = [](const std::vector<double>& fill) {
        std::vector<CellLayer> layers = row_of(fill);
        CHECK(drop_slivers(layers) == 0);
        return std::pair(fills_of(layers), layers[0].deficit);
    };
    CHECK(left({0.05, -0.02}) == std::pair(std::vector{0.05 - 0.02}, 0.0));
    CHECK(left({0.03, -0.02}) == std::pair(std::vector{0.03}, 0.02));
    CHECK(left({-0.02}) == std::pair(std::vector<double>(), 0.02));
}

TEST_CASE("slivers of a part go where those of its body did, also where it had nothing") {
    std::vector<CellLayer> layers(2);
    layers[0].share = {{2, 1, 0.5, Vec3::Zero()}, {4, 3, 0.5, Vec3::Zero()}};
    layers[1].share = {{2, 1, 2e-4, Vec3(0, 0, -1e-4)}, {5, 2, 4e-4, Vec3::Zero()}};
    move_slivers({{{2, 1, 1}, {2, 1, 0}}, {{5, 2, 1}, {5, 2, 0}}, {{9, 9, 1}, {9, 9, 0}}}, layers);
    const std::vector<CellFill>& low = layers[0].share;
    REQUIRE(low.size() == 3);  // in the order of their rows
    CHECK((low[1].i == 5 && low[1].j == 2));
    CHECK(low[0].fill == Approx(0.5002).epsilon(1e-12));
    CHECK(low[0].moment.z() == Approx(1e-4));  // in the upper half of the cell above
    CHECK(low[1].fill == 4e-4);
    CHECK(low[1].moment.z() == 4e-4);
    CHECK(fills_of({layers[1]}) == std::vector{0.0, 0.0});
}

TEST_CASE("flat holes are closed exactly") {
    const TriMesh box = moved(box_mesh({0, 0, 0}, {4, 4, 4}), some_turn());
    for (int missing = 0; missing < 12; ++missing) {  // half a face
        TriMesh open = box;
        open.triangle.erase(open.triangle.begin() + missing);
        check_matter(box, mold_across(open, 4));
    }
    for (int axis = 0; axis < 3; ++axis) {  // a tube without its ends
        TriMesh tube = box;
        tube.triangle.erase(tube.triangle.begin() + 4 * axis, tube.triangle.begin() + 4 * axis + 4);
        check_matter(box, mold_across(tube, 4));
    }
}

TEST_CASE("the middle of a hole does not go by how finely its rim is divided") {
    TriMesh open = box_mesh({0, 0, 0}, {2, 2, 2});
    const auto is_top = [&](const Corners& t) {
        return std::ranges::all_of(t, [&](int i) { return open.position[i].z() == 2; });
    };
    std::erase_if(open.triangle, is_top);
    CHECK((caps_over_holes(open).apex.at(0) - Vec3(1, 1, 2)).norm() < 1e-12);
    // Halves of the rim's first edge, and one of these again.
    for (int n = 0; n < 2; ++n) {
        const Corners t = caps_over_holes(open).triangle.at(0);
        const int middle = static_cast<int>(open.position.size());
        open.position.push_back(0.5 * (open.position[t[0]] + open.position[t[1]]));
        for (std::size_t k = 0; k < open.triangle.size(); ++k) {
            for (int c = 0; c < 3; ++c) {
                const Corners old = open.triangle[k];
                if (old[c] != t[1] || old[(c + 1) % 3] != t[0]) continue;
                open.triangle[k] = {old[c], middle, old[(c + 2) % 3]};
                open.triangle.push_back({middle, old[(c + 1) % 3], old[(c + 2) % 3]});
                k = open.triangle.size();
                break;
            }
        }
        CHECK(caps_over_holes(open).triangle.size() == std::size_t(5 + n));
        CHECK((caps_over_holes(open).apex.at(0) - Vec3(1, 1, 2)).norm() < 1e-12);
    }
}

TEST_CASE("a small hole changes little") {
    const TriMesh mesh = moved(torus_mesh(1, 0.3, 40, 20), some_turn());
    TriMesh open = mesh;
    for (int first : {902, 411, 3}) open.triangle.erase(open.triangle.begin() + first);
    CHECK(mold_across(open, 8).volume() == Approx(signed_volume(mesh)).epsilon(1e-6));
    open = mesh;
    open.triangle.erase(open.triangle.begin() + 200, open.triangle.begin() + 206);
    CHECK(mold_across(open, 8).volume() == Approx(signed_volume(mesh)).epsilon(1e-2));
    // One triangle the wrong way round.
    open = mesh;
    std::swap(open.triangle[77][0], open.triangle[77][1]);
    CHECK(mold_across(open, 8).volume() == Approx(signed_volume(mesh)).epsilon(1e-6));
}

TEST_CASE("no axis is special") {
    // Turned by a third about the diagonal, x, y, z become y, z, x.
    const TriMesh mesh = moved(knot_mesh(120, 16), some_turn());
    TriMesh turned = mesh;
    for (Vec3& p : turned.position) p = Vec3(p.z(), p.x(), p.y());
    const Aggregate a = mold_across(mesh, 5), b = mold_across(turned, 5);
    REQUIRE(a.cell_fill.size() == b.cell_fill.size());
    float most = 0;
    for (std::size_t c = 0; c < a.cell_fill.size(); ++c) {
        const Vec3i s = a.lattice.cell_site(static_cast<CellId>(c));
        const CellId same = b.lattice.cell_at(s.z(), s.x(), s.y());
        REQUIRE(same >= 0);
        const Eigen::Vector3f& from = a.cell_centroid[c];
        most = std::max(most, std::abs(a.cell_fill[c] - b.cell_fill[same]));
        most =
            std::max(most, (b.cell_centroid[same] - Eigen::Vector3f(from.z(), from.x(), from.y()))
                                   .cwiseAbs()
                                   .maxCoeff() *
                               a.cell_fill[c]);
    }
    CHECK(most < 1e-6f);
}

TEST_CASE("parts that overlap are filled once") {
    const TriMesh mesh = together(box_mesh({0, 0, 0}, {4, 2, 2}), box_mesh({2, 0, 0}, {6, 2, 2}));
    const Aggregate matter = mold_across(mesh, 2);
    CHECK(matter.volume() == Approx(24));
    CHECK(find_pieces(matter).count == 1);
}

TEST_CASE("a little self-crossing does not cost volume") {
    // One dent reaches out of the box, one bump into it; a shelf makes room around them.
    TriMesh mesh = box_mesh({0, 0, 0}, {4, 4, 4});
    mesh = together(mesh, turned_inside_out(box_mesh({4, 1.2, 1.2}, {4.1, 1.7, 1.7})));
    mesh = together(mesh, box_mesh({3.8, 2.2, 2.2}, {4, 2.4, 2.4}));
    mesh = together(mesh, box_mesh({0, 4, 0}, {5, 5, 4}));
    MoldSettings settings;
    settings.spacing = 1;
    check_matter(mesh, mold(mesh, {}, settings));
}

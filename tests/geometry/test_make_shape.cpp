// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "geometry/make_shape.h"
#include "geometry/triangle_tree.h"
#include "tests/catch.h"
#include "tests/shared/meshes.h"

using namespace swage;

namespace {

MadeShape make_small(const std::string& name, std::map<std::string, double> values = {}) {
    if (name == "calf") values.try_emplace("texture", 64);
    return make_shape(name, values);
}

int handles(const TriMesh& mesh) {  // genus of a closed connected surface
    const int euler =
        static_cast<int>(mesh.position.size()) - static_cast<int>(mesh.triangle.size()) / 2;
    return (2 - euler) / 2;
}

// Smallest angle of each triangle [deg].
std::vector<double> least_angles(const TriMesh& mesh) {
    std::vector<double> angles;
    for (const Corners& t : mesh.triangle) {
        double least = 180;
        for (int k = 0; k < 3; ++k) {
            const Vec3 a = mesh.position[t[(k + 1) % 3]] - mesh.position[t[k]];
            const Vec3 b = mesh.position[t[(k + 2) % 3]] - mesh.position[t[k]];
            least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / kPi);
        }
        angles.push_back(least);
    }
    return angles;
}

double uv_area(const TriMesh& mesh) {
    double area = 0;
    for (const Corners& t : mesh.triangle_uv) {
        const Vec2 a = mesh.uv[t[1]] - mesh.uv[t[0]], b = mesh.uv[t[2]] - mesh.uv[t[0]];
        area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
    }
    return area;
}

}  // namespace

TEST_CASE("every shape is one closed outward surface with even triangles") {
    for (const ShapeInfo& info : shape_catalogue()) {
        INFO(info.name);
        const MadeShape made = make_small(info.name);
        const TriMesh& mesh = made.mesh;
        CHECK(test::is_closed(mesh));
        CHECK(surface_components(mesh).count == 1);
        CHECK(signed_volume(mesh) > 0);
        CHECK(mesh.triangle.size() > 1500);
        CHECK(mesh.triangle.size() < 7000);
        const std::vector<double> angles = least_angles(mesh);
        double mean = 0;
        for (double a : angles) mean += a / static_cast<double>(angles.size());
        CHECK(*std::min_element(angles.begin(), angles.end()) > 15);
        CHECK(mean > 35);
        CHECK(mesh.triangle_uv.size() == mesh.triangle.size());
        CHECK(mesh.triangle_smooth.size() == mesh.triangle.size());
        CHECK(mesh.triangle_material.size() == mesh.triangle.size());
        REQUIRE(mesh.material.size() == 1);
        CHECK_FALSE(mesh.material[0].name.empty());
        CHECK(uv_area(mesh) > 0.1);
    }
}

TEST_CASE("a gear of any width and bore crosses itself nowhere", "[stress]") {
    for (const double width : {0.001, 0.01, 0.03, 0.06, 0.1, 0.4}) {
        for (const double bore : {0.006, 0.02, 0.05}) {
            INFO("width " << width << ", bore " << bore);
            const TriMesh gear = make_small("gear", {{"width", width}, {"bore", bore}}).mesh;
            CHECK(test::is_closed(gear));
            CHECK(handles(gear) == 1);
            CHECK(signed_volume(gear) > 0);
            // Each place is inside once or not at all.
            const TriangleTree tree(gear);
            double off = 0;
            for (int r = 0; r < 40; ++r)
                for (int y = -32; y <= 32; ++y) {
                    const double radius = 0.0013 * r, turn = 0.7 * r;
                    const Vec3 point(radius * std::cos(turn), 0.5 * width * (y + 0.3) / 30,
                                     radius * std::sin(turn));
                    const double winding = tree.winding_number(point);
                    off = std::max(off, std::min(std::abs(winding), std::abs(winding - 1)));
                }
            CHECK(off < 0.4);
        }
    }
}

TEST_CASE("shapes have the handles that their names promise") {
    CHECK(handles(make_small("bar").mesh) == 0);
    CHECK(handles(make_small("tube").mesh) == 1);
    CHECK(handles(make_small("gear").mesh) == 1);
    CHECK(handles(make_small("wrench").mesh) == 1);
    CHECK(handles(make_small("plate-with-handles").mesh) == 2);
    CHECK(handles(make_small("calf").mesh) == 0);
}

TEST_CASE("shapes have the size asked for and the volume that follows") {
    const TriMesh bar =
        make_shape("bar", {{"length", 0.3}, {"height", 0.02}, {"width", 0.04}, {"rounding", 0}})
            .mesh;
    CHECK(signed_volume(bar) == Approx(0.3 * 0.02 * 0.04));
    CHECK((box_of(bar.position).size() - Vec3(0.3, 0.02, 0.04)).norm() < 1e-12);
    const TriMesh rod =
        make_shape("rod", {{"length", 0.1}, {"diameter", 0.02}, {"division", 200}}).mesh;
    CHECK(signed_volume(rod) == Approx(kPi * 1e-4 * 0.1).epsilon(2e-3));
    const TriMesh tube = make_shape("tube", {{"wall", 0.005}, {"division", 200}}).mesh;
    CHECK(signed_volume(tube) == Approx(kPi * (0.015 * 0.015 - 0.01 * 0.01) * 0.2).epsilon(2e-3));
    const TriMesh sphere = make_shape("sphere", {{"diameter", 0.2}, {"division", 80}}).mesh;
    CHECK(signed_volume(sphere) == Approx(4 * kPi / 3 * 1e-3).epsilon(2e-3));
    const TriMesh hollow = make_small("sphere", {{"wall", 0.01}}).mesh;
    CHECK(signed_volume(hollow) ==
          Approx(4 * kPi / 3 * (0.05 * 0.05 * 0.05 - 0.04 * 0.04 * 0.04)).epsilon(0.02));
    CHECK(test::is_closed(hollow));
    CHECK(surface_components(hollow).count == 2);
    CHECK_THROWS_AS(make_small("sphere", {{"wall", 0.05}}), Error);
    for (const char* name : {"calf", "wrench", "plate-with-handles"})
        CHECK(box_of(make_small(name, {{"length", 0.4}}).mesh.position).size().x() == Approx(0.4));
    const Box calf = box_of(make_small("calf").mesh.position);
    CHECK(calf.low.y() == Approx(0).margin(1e-12));
    CHECK(calf.size().x() > calf.size().y());
    CHECK(calf.size().y() > calf.size().z());
}

TEST_CASE("more divisions make more triangles of the same body") {
    for (const ShapeInfo& info : shape_catalogue()) {
        INFO(info.name);
        double division = 0;
        for (const ShapeParameter& p : info.parameters)
            if (p.name == "division") division = p.value;
        REQUIRE(division > 0);
        const auto divided = [&](double share) {
            return make_small(info.name, {{"division", std::round(share * division)}}).mesh;
        };
        const TriMesh coarse = divided(0.6), fine = divided(0.9);
        CHECK(fine.triangle.size() > 1.5 * coarse.triangle.size());
        CHECK(signed_volume(fine) == Approx(signed_volume(coarse)).epsilon(0.1));
    }
}

TEST_CASE("no two charts of the calf's texture overlap") {
    const TriMesh mesh = make_small("calf").mesh;
    constexpr int kSize = 1024;
    std::vector<int> owner(kSize * kSize, -1);
    int twice = 0;
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        std::array<Vec2, 3> p;
        for (int k = 0; k < 3; ++k) p[k] = kSize * mesh.uv[mesh.triangle_uv[t][k]];
        const auto turn = [](const Vec2& a, const Vec2& b) {
            return a.x() * b.y() - a.y() * b.x();
        };
        CHECK(turn(p[1] - p[0], p[2] - p[0]) > 0);  // none is mirrored
        const Vec2 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
        const Vec2 high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
        REQUIRE(low.minCoeff() > 2);
        REQUIRE(high.maxCoeff() < kSize - 2);
        for (int y = static_cast<int>(low.y()); y <= high.y(); ++y)
            for (int x = static_cast<int>(low.x()); x <= high.x(); ++x) {
                const Vec2 at(x + 0.5, y + 0.5);
                bool inside = true;
                for (int k = 0; k < 3; ++k)
                    inside = inside && turn(p[(k + 1) % 3] - p[k], at - p[k]) > 1e-9;
                if (!inside) continue;
                twice += owner[y * kSize + x] >= 0;
                owner[y * kSize + x] = static_cast<int>(t);
            }
    }
    CHECK(twice == 0);
}

TEST_CASE("a shape comes out the same at any thread count") {
    const auto hash = [](int threads) {
        set_thread_count(threads);
        const MadeShape made = make_small("calf", {{"division", 20}, {"texture", 128}});
        Hasher hasher;
        for (const Vec3& p : made.mesh.position) hasher.add(std::span<const double>(p.data(), 3));
        hasher.add(std::span<const std::uint8_t>(made.texture->rgb));
        set_thread_count(0);
        return hasher.value();
    };
    const std::uint64_t one = hash(1);
    CHECK(hash(2) == one);
    CHECK(hash(3) == one);
}

TEST_CASE("a sheet is as thin as it is asked to be") {
    for (const double thickness : {1e-6, 1.5e-6, 0.123e-3}) {
        const TriMesh sheet =
            make_shape("sheet",
                       {{"length", 100}, {"width", 50}, {"thickness", thickness}, {"division", 4}})
                .mesh;
        CHECK(signed_volume(sheet) == Approx(100 * 50 * thickness).epsilon(1e-3));
    }
}

TEST_CASE("what cannot be made is refused by name") {
    const auto message = [](const std::string& name, const std::map<std::string, double>& values) {
        try {
            make_shape(name, values);
        } catch (const Error& error) {
            CHECK(error.code() == ExitCode::command_line);
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(message("spooon", {}).find("plate-with-handles") != std::string::npos);
    CHECK(message("bar", {{"lenght", 1}}).find("length") != std::string::npos);
    CHECK(message("bar", {{"length", -1}}).find("length") != std::string::npos);
    CHECK(message("bar", {{"length", std::nan("")}}).find("length") != std::string::npos);
    CHECK(message("bar", {{"division", 10.5}}).find("whole") != std::string::npos);
    CHECK(message("bar", {{"rounding", 0.5}}).find("rounding") != std::string::npos);
    CHECK(message("tube", {{"wall", 0.5}}).find("wall") != std::string::npos);
    CHECK(message("gear", {{"bore", 0.09}}).find("bore") != std::string::npos);
}

TEST_CASE("the committed meshes are those that the project makes") {
    const std::filesystem::path folder =
        std::filesystem::path(SWAGE_SOURCE_DIR) / "assets" / "meshes";
    for (const char* name :
         {"bar", "rod", "tube", "sheet", "wrench", "gear", "plate-with-handles", "calf"}) {
        INFO(name);
        std::ifstream file(folder / (std::string(name) + ".obj"));
        REQUIRE(file);
        std::vector<Vec3> position;
        std::vector<std::vector<int>> face;
        for (std::string line; std::getline(file, line);) {
            std::istringstream words(line);
            std::string kind;
            words >> kind;
            if (kind == "v") {
                Vec3 p;
                words >> p.x() >> p.y() >> p.z();
                position.push_back(p);
            } else if (kind == "f") {
                face.emplace_back();
                for (std::string corner; words >> corner;)
                    face.back().push_back(std::stoi(corner) - 1);
            }
        }
        const TriMesh mesh = make_small(name).mesh;
        REQUIRE(position.size() == mesh.position.size());
        double apart = 0;
        for (std::size_t i = 0; i < position.size(); ++i)
            apart = std::max(apart, (position[i] - mesh.position[i]).norm());
        CHECK(apart < 1e-6);
        // The file holds polygons: each must be the outline of its triangles.
        std::vector<Corners> triangles;
        std::size_t next = 0;
        bool same = true;
        for (const std::vector<int>& corners : face) {
            const std::size_t count = corners.size() - 2;
            REQUIRE(next + count <= mesh.triangle.size());
            for (std::size_t t = next; t < next + count; ++t)
                for (int p : mesh.triangle[t])
                    same = same && std::find(corners.begin(), corners.end(), p) != corners.end();
            next += count;
        }
        CHECK(same);
        CHECK(next == mesh.triangle.size());
        CHECK(std::filesystem::exists(folder / (std::string(name) + ".mtl")));
    }
    CHECK(std::filesystem::exists(folder / "calf.png"));
}

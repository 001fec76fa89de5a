// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/usd_text.h"

#include "geometry/box_mesh.h"
#include "geometry/usd_mesh.h"
#include "geometry/usd_time.h"
#include "tests/catch.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

template <typename Write>
std::string written(const Write& write) {
    const Scratch scratch;
    UsdText out(scratch / "a.usda");
    write(out);
    out.finish();
    return test::bytes_of(scratch / "a.usda");
}

}  // namespace

TEST_CASE("a path in USD may hold any number of @") {
    CHECK(usd_asset("./a.png") == "@./a.png@");
    CHECK(usd_asset("./a@b.png") == "@@@./a@b.png@@@");
    CHECK(usd_asset("./a@@@b.png") == "@@@./a\\@@@b.png@@@");
    CHECK(usd_asset("./@@@@@@@.png") == "@@@./\\@@@\\@@@@.png@@@");
}

TEST_CASE("a turn in USD goes on the shorter way, beyond half a turn too") {
    std::vector<Pose> poses;
    for (int n = 0; n <= 24; ++n) {
        Quat turn = turn_about(Vec3::UnitZ(), n * kPi / 12);
        if (n % 3 == 0) turn.coeffs() = Eigen::Vector4d(-turn.coeffs());  // the same turn
        poses.push_back({turn, Vec3(n, 0, 0)});
    }
    const std::string text = written([&](UsdText& out) { write_usd_poses(out, 1, poses); });
    const std::size_t begin = text.find("xformOp:orient");
    std::vector<Eigen::Vector4d> sample;
    for (std::size_t at = text.find('(', begin); at < text.find("xformOp:translate");
         at = text.find('(', at + 1)) {
        Eigen::Vector4d q;
        REQUIRE(std::sscanf(text.c_str() + at, "(%lf, %lf, %lf, %lf)", &q[0], &q[1], &q[2],
                            &q[3]) == 4);
        sample.push_back(q);
    }
    REQUIRE(sample.size() == poses.size());
    for (std::size_t n = 0; n < sample.size(); ++n) {
        const Quat& q = poses[n].rotation;
        CHECK(std::abs(sample[n].dot(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()))) > 1 - 1e-6);
        if (n > 0) CHECK(sample[n].dot(sample[n - 1]) > 0.9);
    }
}

TEST_CASE("a surface in USD has two sides where it is open, and one where it is closed") {
    TriMesh box = box_mesh({Vec3::Zero(), Vec3::Ones()});
    const auto text_of = [&] {
        return written([&](UsdText& out) { write_usd_surface(out, box, Vec3::Ones()); });
    };
    CHECK(text_of().find("doubleSided") == std::string::npos);
    box.triangle.pop_back();
    CHECK(text_of().find("uniform bool doubleSided = 1") != std::string::npos);
}

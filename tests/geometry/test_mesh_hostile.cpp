// SPDX-License-Identifier: GPL-3.0-or-later
// What a broken or hostile file costs: one error, soon.
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_write.h"
#include "tests/catch.h"
#include "tests/geometry/mesh_fixtures.h"

using namespace swage;
using test::Folder;

namespace {

// The sentence that refuses the file; empty when it was read.
std::string refusal(const std::filesystem::path& file, const ReadLimits& limits = {}) {
    try {
        std::vector<std::string> finding;
        read_mesh(file, limits, &finding);
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::mesh);
        const std::string text = error.what();
        CHECK(text.find('\n') == std::string::npos);
        CHECK(text.starts_with(file.string()));
        return text;
    }
    return {};
}

bool says(const std::string& text, const std::string& what) {
    CAPTURE(text, what);
    const bool found = text.find(what) != std::string::npos;
    CHECK(found);
    return found;
}

}  // namespace

TEST_CASE("what is no mesh file is refused at once") {
    const Folder folder;
    const auto started = std::chrono::steady_clock::now();
    says(refusal(folder / "missing.obj"), "No such file");
    std::filesystem::create_directory(folder / "folder.obj");
    says(refusal(folder / "folder.obj"), "a directory");
    REQUIRE(::mkfifo((folder / "pipe.obj").c_str(), 0600) == 0);
    says(refusal(folder / "pipe.obj"), "a pipe");
    std::filesystem::create_symlink("/dev/zero", folder / "zero.obj");
    says(refusal(folder / "zero.obj"), "a device");
    says(refusal(folder.write("empty.obj", "")), "empty");
    says(refusal(folder.write("cube.fbx", "x")), ".fbx");
    says(refusal(folder.write("cube", test::cube_obj())), "not a mesh format");
    ReadLimits small;
    small.file_bytes = 10;
    says(refusal(folder.write("large.obj", test::cube_obj()), small), "limit");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started;
    CHECK(took.count() < 2);
}

TEST_CASE("a broken OBJ is refused with its line") {
    const Folder folder;
    const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    says(refusal(folder.write("a.obj", v + "f 1 2 4\n")), "line 4: vertex 4 is used");
    says(refusal(folder.write("b.obj", v + "f 1/1 2/1 3/1\n")), "texture coordinate 1");
    says(refusal(folder.write("c.obj", v + "f 0 1 2\n")), "line 4: '0' is not an index");
    says(refusal(folder.write("d.obj", v + "f -4 -1 -2\n")), "line 4");
    says(refusal(folder.write("e.obj", "v 1,0 0 0\n")), "write decimals with a point");
    says(refusal(folder.write("f.obj", "v nan 0 0\n" + v + "f 1 2 3\n")), "line 1");
    says(refusal(folder.write("g.obj", "v 1e999 0 0\n" + v + "f 1 2 3\n")), "not finite");
    says(refusal(folder.write("h.obj", "v -1.#IND 0 0\n" + v + "f 1 2 3\n")), "not a number");
    says(refusal(folder.write("i.obj", v + std::string(1, '\0') + "f 1 2 3\n")), "zero");
    says(refusal(folder.write("j.obj", v)), "no faces");
    says(refusal(folder.write("k.obj", v + "f 1 2\n")), "no triangles");
    says(refusal(folder.write("l.obj", "v 1e30 0 0\n" + v + "f 1 2 3\n")), "unreasonably large");
    says(refusal(folder.write("m.obj", "v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n")), "in size");
    says(refusal(folder.write("n.obj", v + "f 1 2 99999999999999999999\n")), "not an index");
    says(refusal(folder.write("p.obj", "v 1e-400x 0 0\n" + v + "f 1 2 3\n")), "not a number");
    // A good mesh whose material library is a folder is still a good mesh.
    std::filesystem::create_directory(folder / "dir.mtl");
    CHECK(refusal(folder.write("o.obj", "mtllib dir.mtl\n" + v + "f 1 2 3\n")).empty());
}

TEST_CASE("a broken PLY is refused with the reason") {
    const Folder folder;
    const std::string vertex = "property float x\nproperty float y\nproperty float z\n";
    const std::string face = "property list uchar int vertex_indices\n";
    const std::string start = "ply\nformat ascii 1.0\n";
    const auto file = [&](const char* name, const std::string& text) {
        return refusal(folder.write(name, text));
    };
    says(file("a.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\n") + vertex),
         "end_header");
    says(file("b.ply", start + "element vertex 3\n" + vertex + "element face 1\n" + face +
                           "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
         "vertex 7 of 3 does not exist");
    says(file("c.ply", start + "element vertex 3\n" + vertex + "element face 1\n" + face +
                           "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"),
         "ends early");
    says(file("d.ply", start + "element vertex 2000000000\n" + vertex + "end_header\n0 0 0\n"),
         "too short");
    says(file("e.ply", start + "element vertex 3\n" + vertex + "end_header\n0 0 0\n1 0 0\n0 1 0\n"),
         "no faces");
    says(file("f.ply", start + "element vertex 3\n" + vertex + "element face 1\n" + face +
                           "end_header\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"),
         "not finite");
    says(file("g.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 0\n" + vertex +
                           "element face 1\nproperty list uint int vertex_indices\nend_header\n" +
                           "\xff\xff\xff\x7f"),
         "does not fit");
    const auto triangle = [&](const char* name, const std::string& corners) {
        return file(name, start + "element vertex 3\n" + vertex + "element face 1\n" + face +
                              "end_header\n0 0 0\n1 0 0\n0 1 0\n" + corners + "\n");
    };
    says(triangle("h.ply", "3 0 1.2 2"), "face 0: 1.2 is not a whole number");
    says(triangle("i.ply", "3.9 0 1 2"), "face 0: 3.9 is not a whole number");
    CHECK(triangle("j.ply", "3 0 1.0 2").empty());
}

TEST_CASE("an OFF that counts below nothing is refused for that") {
    const Folder folder;
    const std::string rest = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    says(refusal(folder.write("a.off", "OFF\n-1 1 0\n" + rest)),
         "its header gives -1 vertices and 1 faces");
    says(refusal(folder.write("b.off", "OFF\n3 -6 0\n" + rest)),
         "its header gives 3 vertices and -6 faces");
}

TEST_CASE("faces that the header of an OFF or PLY does not count are told of") {
    const Folder folder;
    const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    const std::string faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n\n3 2 0 3\n";
    const std::string header =
        "element vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n";
    std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
    for (int i = 0; i < 12; ++i) binary += test::raw(i % 4 == 3 ? 1.f : 0.f);
    for (int i = 0; i < 2; ++i)
        binary += '\3' + test::raw(0) + test::raw(1 + i) + test::raw(3 - 2 * i);
    std::vector<std::string> finding;
    read_mesh(folder.write("a.off", "OFF\n4 2 0\n" + vertices + faces + "# the end\n"), {},
              &finding);
    read_mesh(folder.write("a.ply", "ply\nformat ascii 1.0\n" + header + vertices + faces), {},
              &finding);
    read_mesh(folder.write("b.ply", binary + "extra"), {}, &finding);
    CHECK(finding == std::vector<std::string>{"2 lines beyond the count in its header left out",
                                              "2 lines beyond the count in its header left out",
                                              "5 bytes beyond the count in its header left out"});
    finding.clear();
    read_mesh(folder.write("b.ply", binary + "\r\n"), {}, &finding);
    CHECK(finding.empty());
}

TEST_CASE("lying glTF, GLB, STL, DAE, 3DS and 3MF files are refused") {
    const Folder folder;
    CHECK(!refusal(folder.write("a.glb", "glTF\x02")).empty());
    CHECK(!refusal(folder.write("b.gltf", "{\"asset\":{\"version\":\"2.0\"}}")).empty());
    CHECK(!refusal(folder.write("c.gltf", "{\"asset\"")).empty());
    says(
        refusal(folder.write("d.stl",
                             "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                             "vertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n")),
        "4 vertices");
    CHECK(!refusal(folder.write("e.stl", std::string(80, ' ') + "\xff\xff\xff\x7f")).empty());
    CHECK(!refusal(folder.write("f.dae", "<COLLADA>")).empty());
    CHECK(!refusal(folder.write("g.3ds", "MM")).empty());
    CHECK(!refusal(folder.write("h.3mf", "PK\x03\x04")).empty());
    CHECK(!refusal(folder.write("i.stl", test::cube_obj())).empty());
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they run without the limit
TEST_CASE("a reader out of memory is stopped, and said so, however its end is listened for") {
    const auto before = std::signal(SIGCHLD, GENERATE(false, true) ? SIG_IGN : SIG_DFL);
    const Folder folder;
    std::string text;
    for (int i = 0; i < 400000; ++i) text += "v 0.123 0.234 0.345\n";
    text += "f 1 2 3\n";
    const auto file = folder.write("large.obj", text);
    ReadLimits limits;
    limits.memory_bytes = 8 << 20;
    says(refusal(file, limits), "GiB");
    std::signal(SIGCHLD, before);
}
#endif

TEST_CASE("a material file that cannot be read is told, not taken for an empty one") {
    const Folder folder;
    std::filesystem::create_symlink("/proc/self/mem", folder / "m.mtl");
    std::vector<std::string> finding;
    read_mesh(folder.write("a.obj", "mtllib m.mtl\nusemtl steel\n" + test::cube_obj()), {},
              &finding);
    const std::string wanted = "the material file 'm.mtl' cannot be read";
    CHECK(std::find(finding.begin(), finding.end(), wanted) != finding.end());
}

TEST_CASE("nodes that name a child twice, forty deep, are refused before they become trees") {
    const Folder folder;
    const auto gltf = [&](int levels, const std::string& last) {
        std::string nodes;
        for (int n = 1; n < levels; ++n) nodes += fmt::format(R"({{"children":[{0},{0}]}},)", n);
        return refusal(folder.write("a.gltf", fmt::format(R"({{"asset":{{"version":"2.0"}},
"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{}{}],"accessors":[{{"componentType":5126,"count":3,
"type":"VEC3"}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]}})",
                                                          nodes, last)));
    };
    const std::string too_much = "reading it takes more than the 8 GiB allowed";
    says(gltf(40, R"({"mesh":0})"), too_much);
    // What is wrong otherwise is told as before, also a node that is below itself.
    for (const std::string& text : {gltf(3, R"({"mesh":9})"), gltf(3, R"({"children":[0]})")})
        CHECK(text.find(too_much) == std::string::npos);
}

TEST_CASE("random damage to good files never harms the reader's parent") {
    const Folder folder;
    TriMesh ball = test::ball_mesh(6, 0.5);
    smooth_by_crease_angle(ball, 0.7);
    write_obj(folder / "ball.obj", ball);
    write_ply(folder / "ball.ply", ball);
    std::string stl(80, ' ');
    const auto put = [&](auto value) { stl.append(reinterpret_cast<char*>(&value), sizeof value); };
    put(static_cast<std::uint32_t>(ball.triangle.size()));
    for (const Corners& t : ball.triangle) {
        for (int k = 0; k < 3; ++k) put(0.f);
        for (const int i : t)
            for (int k = 0; k < 3; ++k) put(static_cast<float>(ball.position[i][k]));
        put(static_cast<std::uint16_t>(0));
    }
    folder.write("ball.stl", stl);
    std::mt19937 random(20240229);
    ReadLimits limits;
    limits.cpu_seconds = 5;
    limits.wall_seconds = 10;
    int read = 0, refused = 0;
    for (const char* name : {"ball.obj", "ball.ply", "ball.stl"}) {
        const std::string good = test::bytes_of(folder / name);
        for (int round = 0; round < 40; ++round) {
            std::string bad = good;
            // Flip a few bytes, mostly near the start where the structure is; sometimes cut.
            for (unsigned i = 0; i < 1 + random() % 8; ++i) {
                const std::size_t reach =
                    random() % 2 ? bad.size() : std::min<std::size_t>(400, bad.size());
                bad[random() % reach] = static_cast<char>(random());
            }
            if (random() % 4 == 0) bad.resize(random() % bad.size() + 1);
            const auto file = folder.write(std::string("bad_") + name, bad);
            try {
                std::vector<std::string> finding;
                const TriMesh mesh = read_mesh(file, limits, &finding);
                for (const Vec3& p : mesh.position) REQUIRE(p.allFinite());
                for (const Corners& t : mesh.triangle)
                    for (const int i : t)
                        REQUIRE((i >= 0 && i < static_cast<int>(mesh.position.size())));
                check_mesh(mesh);
                ++read;
            } catch (const Error& error) {
                // The project's own readers refuse; only assimp may crash.
                if (std::string(name) != "ball.stl")
                    CHECK(std::string(error.what()).find("crashed") == std::string::npos);
                ++refused;
            }
        }
    }
    CHECK(read + refused == 120);
    CHECK(refused > 20);
}

TEST_CASE("meshes are read from several threads at once") {
    const Folder folder;
    const auto file = folder.write("cube.obj", test::cube_obj());
    std::vector<std::thread> threads;
    std::vector<double> volume(8, 0);
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&, i] {
            std::vector<std::string> finding;
            for (int k = 0; k < 5; ++k) volume[i] = signed_volume(read_mesh(file, {}, &finding));
        });
    for (std::thread& t : threads) t.join();
    for (const double v : volume) CHECK(v == Approx(1));
}

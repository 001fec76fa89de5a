// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <fstream>

#include "pipeline/run_record.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("what lies beside a glTF file that a scene reads belongs to what a run was made of") {
    const Scratch scratch;
    const auto put = [&](const char* name, const std::string& bytes) {
        std::ofstream(scratch.path() / name, std::ios::binary) << bytes;
        return scratch.path() / name;
    };
    const auto put_corners = [&](float far) {
        const float corner[] = {0, 0, 0, far, 0, 0, 0, far, 0};
        put("corners.bin", std::string(reinterpret_cast<const char*>(corner), sizeof corner));
    };
    SceneSpec scene;
    scene.body.emplace_back();
    const std::string name = GENERATE("core.gltf", "core.glTF");
    const auto file = put(name.c_str(),
                          R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [0, 0, 0], "max": [2, 2, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"uri": "corners.bin", "byteLength": 36}]})");
    scene.inputs = {file};
    const auto hashes = [&] {
        std::vector<std::string> hash;
        for (const RunInput& input : identity_of(scene, {}, {}).input) hash.push_back(input.hash);
        return hash;
    };
    put_corners(1);
    const std::vector<std::string> one = hashes();
    CHECK(hashes() == one);
    put_corners(2);
    CHECK(hashes() != one);
    // What cannot be read is refused where it is used, which knows its place.
    put(name.c_str(), "no glTF");
    CHECK_NOTHROW(hashes());
}

TEST_CASE("what is no plain file, or far too long, is no record, and says so at once") {
    const Scratch scratch;
    const std::filesystem::path file = scratch.path() / "run.json";
    CHECK_FALSE(read_record(file));
    const auto refusal = [&] {
        try {
            read_record(file);
        } catch (const Error& error) {
            CHECK(error.code() == ExitCode::output);
            std::filesystem::remove(file);
            return std::string(error.what());
        }
        return std::string("none");
    };
    REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
    CHECK(refusal().find("run.json: is not a regular file; swage run --fresh") !=
          std::string::npos);
    std::filesystem::create_symlink("/dev/zero", file);
    CHECK(refusal().find("is not a regular file") != std::string::npos);
    std::ofstream(file) << "{";
    CHECK_FALSE(read_record(file));
    std::filesystem::resize_file(file, 1 << 30);  // with a hole
    CHECK(refusal().find("is too long") != std::string::npos);
}

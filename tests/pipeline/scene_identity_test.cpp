// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/scene_identity.h"

#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("what lies beside a glTF file that a scene reads belongs to what a run was made of") {
    const Scratch scratch;
    const auto put_corners = [&](float far) {
        const float corner[] = {0, 0, 0, far, 0, 0, 0, far, 0};
        scratch.write("corners.bin",
                      std::string(reinterpret_cast<const char*>(corner), sizeof corner));
    };
    SceneSpec scene;
    scene.body.emplace_back();
    const std::string name = GENERATE("core.gltf", "core.glTF");
    const auto file =
        scratch.write(name,
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
    scratch.write(name, "no glTF");
    CHECK_NOTHROW(hashes());
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/scene_identity.h"

#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("what stages were run without the surfaces of insets is not gone on from with them") {
    SceneSpec scene;
    scene.body.emplace_back().inset.emplace_back();
    scene.stage.resize(3);
    const StageKeys before = identity_of(scene, {}, {}).stage_key;
    scene.stage[1].remold = true;
    const StageKeys after = identity_of(scene, {}, {}).stage_key;
    CHECK(after.at(1) != before.at(1));
    CHECK(after.at(2) == before.at(2));  // which what the stage itself says tells
    scene.body[0].inset.clear();
    CHECK(identity_of(scene, {}, {}).stage_key == before);
}

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

// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "render/renderer.h"
#include "render/shaders.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

TEST_CASE("every shader is built in", "[shaders]") {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(SWAGE_SOURCE_DIR "/shaders")) {
        std::vector<std::string> files;
        CHECK_FALSE(shader_text(entry.path().filename().string(), files).empty());
        ++count;
    }
    CHECK(count == static_cast<int>(embedded_shaders().size()));
}

TEST_CASE("a driver's complaint names the file it is about", "[shaders]") {
    std::vector<std::string> files;
    shader_text("surface.frag", files);
    REQUIRE(files.size() > 2);
    CHECK(files[0] == "surface.frag");
    CHECK(with_file_names("0:12(3): error: a\n2:7(1): error: b", files) ==
          "surface.frag:12:3: error: a\n" + files[2] + ":7:1: error: b");
    CHECK(with_file_names("9:1(1): x", files) == "9:1(1): x");
}

TEST_CASE("a user's own shader is taken, and its mistake reported by file and line", "[shaders]") {
    const Scratch scratch;
    scratch.write("film.glsl", "// one\n// two\nthis is no shader\n");
    ::setenv("SWAGE_SHADERS", scratch.path().c_str(), 1);
    std::string message;
    try {
        Renderer renderer(RenderSettings{}, Box{}, 0);
    } catch (const Error& error) {
        message = error.what();
    }
    ::unsetenv("SWAGE_SHADERS");
    INFO(message);
    CHECK((message.find("film.glsl:3:") != std::string::npos ||
           message.find("no OpenGL") != std::string::npos));
}

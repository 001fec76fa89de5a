// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/document.h"
#include "tests/catch.h"
#include "tests/scene/scratch.h"

using namespace swage;

namespace {

std::string told_of(const std::string& text) {
    const test::Scratch scratch;
    const std::filesystem::path file = scratch.write("scene.toml", text);
    MistakeList mistakes;
    const std::optional<Document> document = read_document(file, file, mistakes);
    REQUIRE(document);
    return told(document->root);
}

}  // namespace

TEST_CASE(
    "what a file says is told alike however it is written, and otherwise where it says else") {
    const std::string one = told_of("[a]\nx = 0.1\ny = [1, \"2\"]\nz = true\n[[s]]\nn = 1\n");
    CHECK(told_of("a = { x = 1e-1, y = [ 1, '2' ], z = true } # so\ns = [{n = 1}]\n") == one);
    for (const char* other : {
             "[a]\nx = 0.10000000000000002\ny = [1, \"2\"]\nz = true\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, 2]\nz = true\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2\"]\nz = false\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2\"]\nz = true\n[[s]]\n[[s]]\nn = 1\n",
             "[a]\nx = 0.1\ny = [1, \"2;z\"]\nz = true\n[[s]]\nn = 1\n",
         }) {
        CHECK(told_of(other) != one);
    }
}

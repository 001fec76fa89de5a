// SPDX-License-Identifier: GPL-3.0-or-later
// What the program says where it is given too little, or what nobody can use.
#include <sys/resource.h>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/pipeline/scratch.h"

namespace fs = std::filesystem;

namespace {

bool says(const Outcome& outcome, const std::string& words) {
    INFO(outcome.err);
    return outcome.err.find(words) != std::string::npos;
}

}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they run without the limit
TEST_CASE("where there is no room for threads a run is refused with 7, and nothing is unexpected") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path());
    rlimit before = {};
    ::getrlimit(RLIMIT_AS, &before);
    for (rlim_t mebibytes : {200, 250, 300, 350, 400}) {
        const rlimit limit = {mebibytes << 20, before.rlim_max};
        REQUIRE(::setrlimit(RLIMIT_AS, &limit) == 0);
        const Outcome outcome = run_swage({"check", scene.string(), "--threads", "16"});
        ::setrlimit(RLIMIT_AS, &before);
        INFO(mebibytes << " MiB: " << outcome.err);
        CHECK(outcome.code == 7);
        CHECK_FALSE(says(outcome, "unexpected"));
    }
}
#endif

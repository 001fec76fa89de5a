// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <fstream>

#include "pipeline/run_record.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

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

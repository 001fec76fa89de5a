// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <fstream>

#include "pipeline/run_record.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
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

TEST_CASE("what a record tells of pieces is read, also where it names one shell of each") {
    Json record = parse_json(
        R"({"scene": "a.toml", "bodies": [{"name": "a"}, {"name": "b"}, {"name": "c"}],
            "stages": [{"name": "1-cut", "frames": [2, 9],
                        "skin_pieces": {"a": [[5, 7], [0]], "b": [5, 0]}}]})");
    const std::vector<NamedPieces> piece = run_names_of(record).piece;
    REQUIRE(piece.size() == 3);
    for (const NamedPieces& one : piece) CHECK(one.frame == 9);
    CHECK(piece[0].triangle == std::vector<std::vector<int>>{{5, 7}, {0}});
    CHECK(piece[1].triangle == std::vector<std::vector<int>>{{5}, {0}});
    CHECK(piece[2].triangle.empty());
    record["stages"][0].erase("skin_pieces");
    CHECK(run_names_of(record).piece.empty());
}

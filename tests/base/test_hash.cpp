// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <fstream>

#include "base/error.h"
#include "base/file_contents.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("a file's hash is that of its bytes, and what cannot be read has none") {
    CHECK(hash_of_file("/proc/self/comm") == hash_of(*file_contents("/proc/self/comm")));
    CHECK_THROWS_AS(hash_of_file("/no/such/file"), Error);
    CHECK_THROWS_AS(hash_of_file("/"), Error);  // opens, and fails at the first read
}

TEST_CASE("a file's hash goes by its last byte, however long it is") {
    const Scratch scratch;
    const std::filesystem::path file = scratch.path() / "long";
    for (const std::size_t size : {1, 65535, 65536, 65537, 131072, 300000}) {
        std::string bytes(size, 'x');
        bytes.back() = 'y';
        std::ofstream(file, std::ios::binary) << bytes;
        CAPTURE(size);
        CHECK(hash_of_file(file) == hash_of(bytes));
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include "base/error.h"
#include "base/file_contents.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("a file's hash is that of its bytes, and what cannot be read has none") {
    CHECK(hash_of_file("/proc/self/comm") == hash_of(*file_contents("/proc/self/comm")));
    CHECK_THROWS_AS(hash_of_file("/no/such/file"), Error);
    CHECK_THROWS_AS(hash_of_file("/"), Error);  // opens, and fails at the first read
}

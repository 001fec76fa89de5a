// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Core>

#include "tests/catch.h"

#ifdef __x86_64__  // elsewhere Eigen has other sizes, but does not ask for them either
TEST_CASE("sums of products are cut the same on every machine") {
    CHECK(Eigen::l1CacheSize() == 32 << 10);
    CHECK(Eigen::l2CacheSize() == 256 << 10);
    CHECK(Eigen::l3CacheSize() == 2 << 20);
}
#endif

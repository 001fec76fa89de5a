// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sparse_array.h"

#include <random>

#include "tests/catch.h"

using namespace swage;

TEST_CASE("a sparse array reads as the vector that it was made and changed like") {
    std::mt19937 engine(3);
    std::vector<float> wanted(203, 1.0f);
    for (int n = 0; n < 9; ++n) wanted[engine() % wanted.size()] = static_cast<float>(n);
    SparseArray<float> sparse(wanted, 1.0f);
    for (int n = 0; n < 40; ++n) {
        const std::size_t at = engine() % wanted.size();
        wanted[at] = n % 3 == 0 ? 1.0f : static_cast<float>(n);
        sparse.set(at, wanted[at]);
        CHECK(sparse.all() == wanted);
        for (std::size_t p = 0; p < wanted.size(); ++p) CHECK(sparse[p] == wanted[p]);
        const std::size_t first = engine() % 190, count = engine() % 14;
        std::vector<float> some(count);
        sparse.copy(first, count, some.data());
        CHECK(std::equal(some.begin(), some.end(), wanted.begin() + std::ptrdiff_t(first)));
    }
}

TEST_CASE("what is usual takes no room") {
    const SparseArray<float> even(std::vector<float>(100000, 1.0f), 1.0f);
    CHECK(even.bytes() < 60000);
    SparseArray<float> one(100000, 0.0f);
    one.set(77777, 2.0f);
    CHECK(one[77777] == 2.0f);
    CHECK(one[77778] == 0.0f);
    CHECK(one.bytes() < 60000);
}

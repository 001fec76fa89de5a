// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "geometry/near_boxes.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("boxes near each other are those that trying all pairs finds, of any sizes") {
    const double size = GENERATE(0., 0.02, 0.3, 1.5), gap = GENERATE(0., 0.03, 0.5);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    for (int count : {0, 1, 2, 17, 60, 400}) {
        CAPTURE(count, size, gap);
        std::vector<Box> box;
        for (int n = 0; n < count; ++n) {
            Box& one = box.emplace_back();
            if (n % 29 == 7) continue;  // empty
            const double scale = n % 13 == 0 ? 20 : 1;
            one.grow(Vec3(any(random), any(random), any(random)));
            one.grow(Vec3(one.low + scale * size * Vec3(any(random), any(random), any(random))));
            if (n % 5 == 3) one = box[std::size_t(n) / 2];
        }
        std::vector<std::pair<int, int>> all;
        for (int a = 0; a < count; ++a) {
            for (int b = a + 1; b < count; ++b) {
                if (gap_between(box[std::size_t(a)], box[std::size_t(b)]) <= gap) {
                    all.emplace_back(a, b);
                }
            }
        }
        CHECK((near_boxes(box, gap) == all));
    }
}

TEST_CASE("boxes in a row that touch are near at a gap of nothing, and near the next but one") {
    std::vector<Box> row;
    for (int n = 0; n < 100; ++n) row.push_back({Vec3(n, 0, 0), Vec3(n + 1, 1, 1)});
    CHECK(near_boxes(row, 0).size() == 99);
    CHECK(near_boxes(row, 1).size() == 99 + 98);
}

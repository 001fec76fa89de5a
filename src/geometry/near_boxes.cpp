// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/near_boxes.h"

#include <algorithm>

namespace swage {

namespace {

constexpr std::size_t kFew = 16;  // boxes that are compared with each other

struct Search {
    const std::vector<Box>& box;
    double gap;
    std::vector<std::pair<int, int>> found{};

    void compare(const std::vector<int>& some) {
        for (std::size_t n = 0; n < some.size(); ++n) {
            for (std::size_t m = 0; m < n; ++m) {
                const auto [low, high] = std::minmax(some[n], some[m]);
                if (gap_between(box[std::size_t(low)], box[std::size_t(high)]) <= gap) {
                    found.emplace_back(low, high);
                }
            }
        }
    }

    // Those that are near each other reach a middle from one side, or both do: they are in one half
    // at least.
    void split(const std::vector<int>& some) {
        if (some.size() <= kFew) return compare(some);
        std::vector<int> best_low, best_high;
        std::size_t least = some.size();
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> middle;
            for (int n : some) middle.push_back(box[std::size_t(n)].center()[axis]);
            const auto half = middle.begin() + std::ptrdiff_t(middle.size() / 2);
            std::nth_element(middle.begin(), half, middle.end());
            std::vector<int> low, high;
            for (int n : some) {
                if (box[std::size_t(n)].low[axis] - gap <= *half) low.push_back(n);
                if (box[std::size_t(n)].high[axis] + gap >= *half) high.push_back(n);
            }
            if (std::max(low.size(), high.size()) >= least) continue;
            least = std::max(low.size(), high.size());
            best_low = std::move(low);
            best_high = std::move(high);
        }
        // Where most reach over every middle they are compared as they are.
        if (least > some.size() - some.size() / 8) return compare(some);
        split(best_low);
        split(best_high);
    }
};

}  // namespace

std::vector<std::pair<int, int>> near_boxes(const std::vector<Box>& box, double gap) {
    std::vector<int> all;
    for (std::size_t n = 0; n < box.size(); ++n) {
        if (!box[n].empty()) all.push_back(static_cast<int>(n));
    }
    Search search{box, gap};
    search.split(all);
    std::sort(search.found.begin(), search.found.end());
    search.found.erase(std::unique(search.found.begin(), search.found.end()), search.found.end());
    return std::move(search.found);
}

}  // namespace swage

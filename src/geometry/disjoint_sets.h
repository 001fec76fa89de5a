// SPDX-License-Identifier: GPL-3.0-or-later
// Union-find over 0 .. n-1. The root of a set is its smallest member, so results do not depend on
// the order of the unions.
#pragma once

#include <numeric>
#include <utility>
#include <vector>

namespace swage {

class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int root(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(int a, int b) {
        a = root(a);
        b = root(b);
        if (a > b) std::swap(a, b);
        parent_[b] = a;
    }
    // Numbers the sets 0, 1, ... in the order of their smallest members; returns how many.
    int number_sets(std::vector<int>& set_of) {
        int count = 0;
        set_of.resize(parent_.size());
        for (std::size_t i = 0; i < parent_.size(); ++i) {
            const int r = root(static_cast<int>(i));
            set_of[i] = r == static_cast<int>(i) ? count++ : set_of[r];
        }
        return count;
    }

  private:
    std::vector<int> parent_;
};

}  // namespace swage

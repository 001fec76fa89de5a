// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "base/math.h"

namespace swage {

struct Vec3Array {
    std::vector<double> x, y, z;

    std::size_t size() const { return x.size(); }
    void resize(std::size_t count) { x.resize(count), y.resize(count), z.resize(count); }
    Vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const Vec3& v) { x[i] = v[0], y[i] = v[1], z[i] = v[2]; }
    void add(std::size_t i, const Vec3& v) { x[i] += v[0], y[i] += v[1], z[i] += v[2]; }

    template <typename Io>
    void visit(Io& io) {  // as SparseArray has it
        io(x, y, z);
    }
};

}  // namespace swage

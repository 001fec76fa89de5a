// SPDX-License-Identifier: GPL-3.0-or-later
// Loops and sums over all particles in fixed chunks: the same bits at any number of threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "base/parallel.h"
#include "geometry/box.h"
#include "matter/aggregate.h"

namespace swage {

// Particles of a chunk, and of what a thread takes at least: 20 us or so.
inline constexpr std::size_t kVectorChunk = 2048, kVectorShare = 4096;

inline std::size_t vector_chunks(std::size_t count) {
    return (count + kVectorChunk - 1) / kVectorChunk;
}

// Calls act(begin, end) for each chunk.
template <typename Act>
void for_each_chunk(std::size_t count, const Act& act) {
    parallel_for(vector_chunks(count), count / kVectorShare, [&](std::size_t chunk) {
        act(chunk * kVectorChunk, std::min(count, (chunk + 1) * kVectorChunk));
    });
}

// What of(begin, end) gives for each chunk.
template <typename Of>
auto of_each_chunk(std::size_t count, const Of& of) {
    using Part = decltype(of(count, count));
    static_assert(!std::is_same_v<Part, bool>, "threads may not share a vector<bool>");
    std::vector<Part> part(vector_chunks(count));
    for_each_chunk(count, [&](std::size_t begin, std::size_t end) {
        part[begin / kVectorChunk] = of(begin, end);
    });
    return part;
}

// Sums of one chunk in four lanes: the order is fixed and the loop still vectorises.
template <typename Term>
double lane_sum(std::size_t begin, std::size_t end, const Term& term) {
    double lane[4] = {0, 0, 0, 0};
    std::size_t i = begin;
    for (; i + 4 <= end; i += 4) {
        for (int l = 0; l < 4; ++l) lane[l] += term(i + l);
    }
    for (; i < end; ++i) lane[0] += term(i);
    return (lane[0] + lane[1]) + (lane[2] + lane[3]);
}

template <typename Term>
double chunked_sum(std::size_t count, const Term& term) {
    return ordered_sum(vector_chunks(count), count / kVectorShare, [&](std::size_t chunk) {
        return lane_sum(chunk * kVectorChunk, std::min(count, (chunk + 1) * kVectorChunk), term);
    });
}

inline double dot(const Vec3Array& a, const Vec3Array& b) {
    return chunked_sum(a.size(), [&](std::size_t p) {
        return a.x[p] * b.x[p] + a.y[p] * b.y[p] + a.z[p] * b.z[p];
    });
}

// Of any component; infinite when there is nothing to compare with.
inline double farthest_move(const Vec3Array& from, const Vec3Array& to) {
    if (from.size() != to.size()) return std::numeric_limits<double>::infinity();
    double farthest = 0;
    for (std::size_t p = 0; p < to.size(); ++p) {
        farthest = std::max({farthest, std::abs(to.x[p] - from.x[p]), std::abs(to.y[p] - from.y[p]),
                             std::abs(to.z[p] - from.z[p])});
    }
    return farthest;
}

inline Box box_of(const Vec3Array& position) {
    Box box;
    for (std::size_t p = 0; p < position.size(); ++p) box.grow(position.at(p));
    return box;
}

inline double longest_of(const Vec3Array& ways) {
    double longest = 0;
    for (std::size_t p = 0; p < ways.size(); ++p) longest = std::max(longest, ways.at(p).norm());
    return longest;
}

inline void set_zero(std::size_t count, Vec3Array& v) {
    for (auto* x : {&v.x, &v.y, &v.z}) x->assign(count, 0.0);
}

// y = keep y + s x
inline void combine(double keep, double s, const Vec3Array& x, Vec3Array& y) {
    for_each_chunk(x.size(), [&](std::size_t begin, std::size_t end) {
        const auto of = [&](const std::vector<double>& from, std::vector<double>& to) {
            for (std::size_t p = begin; p < end; ++p) to[p] = keep * to[p] + s * from[p];
        };
        of(x.x, y.x);
        of(x.y, y.y);
        of(x.z, y.z);
    });
}

}  // namespace swage

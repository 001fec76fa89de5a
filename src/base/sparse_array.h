// SPDX-License-Identifier: GPL-3.0-or-later
// An array most of whose values are the same: only blocks of eight in which some differ are stored.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace swage {

template <typename T>
class SparseArray {
  public:
    static constexpr std::size_t kBlock = 8;

    SparseArray() = default;
    SparseArray(std::size_t size, const T& usual) : usual_(usual), size_(size) {
        block_.assign((size + kBlock - 1) / kBlock, -1);
    }
    SparseArray(const std::vector<T>& values, const T& usual) : SparseArray(values.size(), usual) {
        for (std::size_t n = 0; n < size_; ++n) set(n, values[n]);
        stored_.shrink_to_fit();
    }

    std::size_t size() const { return size_; }
    std::size_t bytes() const {
        return block_.capacity() * sizeof(std::int32_t) + stored_.capacity() * sizeof(T);
    }
    const T& operator[](std::size_t n) const {
        const std::int32_t at = block_[n / kBlock];
        return at < 0 ? usual_ : stored_[static_cast<std::size_t>(at) + n % kBlock];
    }
    void set(std::size_t n, const T& value) {
        std::int32_t& at = block_[n / kBlock];
        if (at < 0) {
            if (value == usual_) return;
            at = static_cast<std::int32_t>(stored_.size());
            stored_.resize(stored_.size() + kBlock, usual_);
        }
        stored_[static_cast<std::size_t>(at) + n % kBlock] = value;
    }
    // Of consecutive ones.
    void copy(std::size_t first, std::size_t count, T* to) const {
        for (std::size_t n = first; n < first + count;) {
            const std::size_t stop = std::min(first + count, (n / kBlock + 1) * kBlock);
            const std::int32_t at = block_[n / kBlock];
            for (; n < stop; ++n) {
                *to++ = at < 0 ? usual_ : stored_[static_cast<std::size_t>(at) + n % kBlock];
            }
        }
    }
    std::vector<T> all() const {
        std::vector<T> values(size_);
        copy(0, size_, values.data());
        return values;
    }

    // Gives `io` everything that it holds, to be written or read.
    template <typename Io>
    void visit(Io& io) {
        auto& [usual, size, block, stored] = *this;
        io(usual, size, block, stored);
    }

  private:
    T usual_{};
    std::size_t size_ = 0;
    std::vector<std::int32_t> block_;  // where it is stored; -1: all usual
    std::vector<T> stored_;
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
// 64-bit hashes (XXH3) of arrays and files, for determinism tests and run records.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace swage {

class Hasher {
  public:
    Hasher();
    ~Hasher();
    Hasher(const Hasher&) = delete;
    Hasher& operator=(const Hasher&) = delete;

    void add_bytes(const void* data, std::size_t size);
    template <typename T>
    void add(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes(values.data(), values.size_bytes());
    }
    void add(std::string_view text) { add_bytes(text.data(), text.size()); }
    std::uint64_t value() const;

  private:
    void* state_;
};

std::uint64_t hash_of(std::string_view bytes);
// Throws Error(mesh) when the file cannot be read.
std::uint64_t hash_of_file(const std::filesystem::path& file);
std::string hash_text(std::uint64_t hash);  // 16 hexadecimal digits

}  // namespace swage

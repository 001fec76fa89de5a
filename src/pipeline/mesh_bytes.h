// SPDX-License-Identifier: GPL-3.0-or-later
// Plain values and meshes as bytes of this machine's order, for the motion file and for hashes.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "geometry/trimesh.h"

namespace swage {

class ByteWriter {
  public:
    template <typename T>
    void put(const T& value) {
        put_raw(&value, sizeof(T));
    }
    template <typename T>
    void put_array(const std::vector<T>& values) {
        put<std::uint64_t>(values.size());
        put_raw(values.data(), values.size() * sizeof(T));
    }
    void put_text(const std::string& text) {
        put<std::uint64_t>(text.size());
        put_raw(text.data(), text.size());
    }
    const std::string& bytes() const { return bytes_; }

  private:
    void put_raw(const void* data, std::size_t size) {
        if (size > 0) bytes_.append(static_cast<const char*>(data), size);
    }
    std::string bytes_;
};

// Throws Error(output) rather than read past the end.
class ByteReader {
  public:
    explicit ByteReader(std::span<const char> bytes) : bytes_(bytes) {}

    template <typename T>
    T get() {
        T value;
        get_raw(&value, sizeof(T));
        return value;
    }
    template <typename T>
    std::vector<T> get_array() {
        const std::uint64_t count = get<std::uint64_t>();
        if (count > left() / sizeof(T)) ends_early();
        std::vector<T> values(count);
        get_raw(values.data(), count * sizeof(T));
        return values;
    }
    std::string get_text() {
        const std::uint64_t count = get<std::uint64_t>();
        if (count > left()) ends_early();
        std::string text(count, '\0');
        get_raw(text.data(), count);
        return text;
    }
    std::size_t left() const { return bytes_.size() - at_; }

  private:
    [[noreturn]] static void ends_early() {
        fail(ExitCode::output, "the motion file ends early or is damaged");
    }
    void get_raw(void* data, std::size_t size) {
        if (size > left()) ends_early();
        if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
        at_ += size;
    }
    std::span<const char> bytes_;
    std::size_t at_ = 0;
};

// Images within it are told by their hash alone.
void put_mesh(ByteWriter& out, const TriMesh& mesh);
using FindImage = std::function<std::shared_ptr<const std::string>(std::uint64_t hash)>;
TriMesh get_mesh(ByteReader& in, const FindImage& find_image);

}  // namespace swage

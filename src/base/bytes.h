// SPDX-License-Identifier: GPL-3.0-or-later
// Values as bytes of this machine's order (base/byte_rules.h), for files and for hashes.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/byte_rules.h"
#include "base/error.h"
#include "base/hash.h"

namespace swage {

using EmbeddedImage = std::shared_ptr<const std::string>;  // a picture's file, in memory

class ByteWriter {
  public:
    static constexpr bool kReads = false;
    using Sink = std::function<void(std::string_view)>;

    // `with_images`: the bytes of each image behind its first mention, else its hash alone.
    explicit ByteWriter(bool with_images = false) : with_images_(with_images) {}
    // `sink` takes the bytes piece by piece, the last at flush().
    ByteWriter(bool with_images, Sink sink) : with_images_(with_images), sink_(std::move(sink)) {}

    template <typename... T>
    void operator()(const T&... values) {
        // Nothing of it is changed: a visit is written once for both ways.
        (pass(*this, const_cast<T&>(values)), ...);
    }
    void raw(const void* data, std::size_t size) {
        if (size == 0) return;
        const std::string_view all(static_cast<const char*>(data), size);
        if (!sink_ || bytes_.size() + size <= kPiece) {
            bytes_.append(all);
            return;
        }
        flush();
        sink_(all);
    }
    void flush() {
        if (!bytes_.empty()) sink_(bytes_);
        bytes_.clear();
    }
    std::size_t count(std::size_t size, std::size_t) {
        (*this)(std::uint64_t(size));
        return size;
    }
    void image(const EmbeddedImage& image) {
        (*this)(image != nullptr);
        if (!image) return;
        const std::uint64_t hash = hash_of(*image);
        (*this)(hash);
        if (with_images_ && image_.insert(hash).second) (*this)(*image);
    }
    const std::string& bytes() const { return bytes_; }  // that no sink has taken
    std::string take() { return std::exchange(bytes_, {}); }

  private:
    static constexpr std::size_t kPiece = 1 << 16;
    bool with_images_;
    Sink sink_;
    std::set<std::uint64_t> image_;  // that were mentioned
    std::string bytes_;
};

// Throws Error(output) rather than read past the end.
class ByteReader {
  public:
    static constexpr bool kReads = true;
    using FindImage = std::function<EmbeddedImage(std::uint64_t hash)>;

    // `find_image`: of images that are told by their hash alone.
    explicit ByteReader(std::span<const char> bytes, FindImage find_image = {})
        : bytes_(bytes), find_image_(std::move(find_image)) {}

    template <typename... T>
    void operator()(T&... values) {
        (pass(*this, values), ...);
    }
    template <typename T>
    T get() {
        T value{};
        (*this)(value);
        return value;
    }
    void raw(void* data, std::size_t size) {
        if (size > left()) ends_early();
        if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
        at_ += size;
    }
    // Of things that take so many bytes each, or more.
    std::size_t count(std::size_t, std::size_t least) {
        const auto size = get<std::uint64_t>();
        if (size > left() / least) ends_early();
        return size;
    }
    void image(EmbeddedImage& image) {
        if (!get<bool>()) return;
        const auto hash = get<std::uint64_t>();
        EmbeddedImage& known = image_[hash];
        if (!known) {
            known = find_image_ ? find_image_(hash)
                                : std::make_shared<const std::string>(get<std::string>());
        }
        image = known;
    }
    std::size_t left() const { return bytes_.size() - at_; }

  private:
    [[noreturn]] static void ends_early() {
        fail(ExitCode::output, "the file ends early or is damaged");
    }
    std::span<const char> bytes_;
    std::size_t at_ = 0;
    FindImage find_image_;
    std::map<std::uint64_t, EmbeddedImage> image_;
};

}  // namespace swage

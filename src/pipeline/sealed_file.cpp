// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/sealed_file.h"

#include <cstring>

#include "base/atomic_file.h"
#include "base/file_contents.h"
#include "base/hash.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// However long what is none may be.
bool has_magic(const FileHandle& handle, std::uint64_t magic) {
    std::uint64_t word = 0;
    return read_up_to(handle.id(), &word, sizeof word) == sizeof word && word == magic;
}

}  // namespace

std::size_t write_sealed(const fs::path& file, std::uint64_t magic,
                         const std::function<void(ByteWriter&)>& write) {
    const auto as_text = [](const std::uint64_t& word) {
        return std::string_view(reinterpret_cast<const char*>(&word), sizeof word);
    };
    WholeFile whole(file);
    Hasher hasher;
    std::size_t size = 0;
    ByteWriter out(true, [&](std::string_view bytes) {
        hasher.add(bytes);
        whole.put(bytes);
        size += bytes.size();
    });
    whole.put(as_text(magic));
    write(out);
    out.flush();
    whole.put(as_text(hasher.value()));
    whole.finish();
    return size;
}

std::string start_of_sealed(const fs::path& file, std::uint64_t magic, std::size_t most) {
    std::string why;
    const FileHandle handle = open_plain_file(file, why);
    if (!handle.is_open() || !has_magic(handle, magic)) return {};
    std::string bytes(most, '\0');
    bytes.resize(read_up_to(handle.id(), bytes.data(), bytes.size()).value_or(0));
    return bytes;
}

std::optional<std::string> read_sealed(const fs::path& file, std::uint64_t magic,
                                       std::string& why) {
    why.clear();
    std::error_code unknown;
    if (!fs::exists(file, unknown)) return std::nullopt;
    const FileHandle handle = open_plain_file(file, why);
    if (!handle.is_open()) return std::nullopt;
    if (!has_magic(handle, magic)) {
        why = "is damaged";
        return std::nullopt;
    }
    std::optional<std::string> bytes = rest_of_file(handle.id(), kAnyLength, why);
    if (!bytes) return std::nullopt;
    std::uint64_t hash = 0;
    why = "is damaged";
    if (bytes->size() < sizeof hash) return std::nullopt;
    std::memcpy(&hash, bytes->data() + bytes->size() - sizeof hash, sizeof hash);
    bytes->resize(bytes->size() - sizeof hash);
    if (hash != hash_of(*bytes)) return std::nullopt;
    why.clear();
    return bytes;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <xxhash.h>

#include <array>
#include <optional>

#include "base/error.h"
#include "base/file_contents.h"

namespace swage {

Hasher::Hasher() : state_(XXH3_createState()) {
    XXH3_64bits_reset(static_cast<XXH3_state_t*>(state_));
}
Hasher::~Hasher() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

void Hasher::add_bytes(const void* data, std::size_t size) {
    if (size > 0) XXH3_64bits_update(static_cast<XXH3_state_t*>(state_), data, size);
}

std::uint64_t Hasher::value() const {
    return XXH3_64bits_digest(static_cast<const XXH3_state_t*>(state_));
}

std::uint64_t hash_of(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::uint64_t hash_of_file(const std::filesystem::path& file) {
    std::string why;
    const FileHandle in = open_plain_file(file, why);
    if (!in.is_open()) fail(ExitCode::mesh, "{}: {}", file.string(), why);
    Hasher hasher;
    std::array<char, 1 << 16> block;
    for (std::size_t got = block.size(); got == block.size();) {
        const std::optional<std::size_t> next = read_up_to(in.id(), block.data(), block.size());
        if (!next) fail(ExitCode::mesh, "{}: cannot be read to the end", file.string());
        got = *next;
        hasher.add_bytes(block.data(), got);
    }
    return hasher.value();
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace swage

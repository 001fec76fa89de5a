// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <xxhash.h>

#include <array>
#include <fstream>

#include "base/error.h"

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
    std::ifstream in(file, std::ios::binary);
    if (!in) fail(ExitCode::mesh, "{}: cannot be read", file.string());
    Hasher hasher;
    std::array<char, 1 << 16> block;
    while (in) {
        in.read(block.data(), block.size());
        hasher.add_bytes(block.data(), static_cast<std::size_t>(in.gcount()));
    }
    if (in.bad()) fail(ExitCode::mesh, "{}: cannot be read to its end", file.string());
    return hasher.value();
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace swage

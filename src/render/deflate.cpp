// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/deflate.h"

#include <libdeflate.h>

#include <memory>
#include <new>

namespace swage {

namespace {

constexpr int kPackLevel = 1;

}  // namespace

std::string zlib_packed(std::string_view bytes) {
    const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> packer(
        libdeflate_alloc_compressor(kPackLevel), libdeflate_free_compressor);
    if (!packer) throw std::bad_alloc();
    std::string packed(libdeflate_zlib_compress_bound(packer.get(), bytes.size()), '\0');
    packed.resize(libdeflate_zlib_compress(packer.get(), bytes.data(), bytes.size(), packed.data(),
                                           packed.size()));
    return packed;
}

std::uint32_t crc32_of(std::string_view bytes) {
    return libdeflate_crc32(0, bytes.data(), bytes.size());
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/gltf_bytes.h"

#include <cstdint>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace swage {

namespace {

const char kBase64[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, 4);
    return number;
}

}  // namespace

std::string to_base64(const std::string& bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three =
                three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : kBase64[three >> (18 - 6 * k) & 63];
    }
    return text;
}

std::string from_base64(std::string_view text) {
    std::string bytes;
    std::uint32_t held = 0;
    int bits = 0;
    for (const char c : text) {
        const char* digit = c == '\0' ? nullptr : std::strchr(kBase64, c);
        if (digit == nullptr) continue;  // "=" at the end
        held = held << 6 | static_cast<std::uint32_t>(digit - kBase64);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += static_cast<char>(held >> bits & 255);
    }
    return bytes;
}

bool take_apart(const MeshSource& source, GltfParts& parts) {
    const std::string& bytes = source.bytes;
    if (source.format == MeshFormat::gltf && !bytes.starts_with("glTF")) {
        parts.json = bytes;
        return true;
    }
    if (bytes.size() < 20 || !bytes.starts_with("glTF") || number_at(bytes, 4) != 2) return false;
    const std::size_t size = number_at(bytes, 12);
    if (size > bytes.size() - 20) return false;
    parts.json = bytes.substr(20, size);
    parts.rest = bytes.substr(20 + size);
    return true;
}

std::string first_chunk(const std::string& rest) { return rest.substr(8, number_at(rest, 0)); }

void put_together(GltfParts parts, MeshSource& source) {
    if (!source.bytes.starts_with("glTF")) {
        source.bytes = std::move(parts.json);
        return;
    }
    while (parts.json.size() % 4 != 0) parts.json += ' ';
    const auto number = [](std::size_t value) {
        std::string bytes(4, '\0');
        const auto n = static_cast<std::uint32_t>(value);
        std::memcpy(bytes.data(), &n, 4);
        return bytes;
    };
    const std::size_t size = 20 + parts.json.size() + parts.rest.size();
    if (size > 0xffffffff) fail(ExitCode::mesh, "more bytes than a GLB file can hold");
    source.bytes = "glTF" + number(2) + number(size) + number(parts.json.size()) + "JSON" +
                   parts.json + parts.rest;
}

}  // namespace swage

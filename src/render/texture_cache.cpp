// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/texture_cache.h"

#include <cstring>

#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"
#include "render/contact_sheet.h"
#include "render/image_read.h"

namespace swage {

namespace {

GlHandle uploaded(const Gl& gl, const Image& image) {
    // A texture's first row is the lowest.
    const std::size_t stride = 3 * static_cast<std::size_t>(image.width);
    std::vector<std::uint8_t> rows(image.rgb.size());
    for (int y = 0; y < image.height; ++y) {
        std::memcpy(&rows[static_cast<std::size_t>(image.height - 1 - y) * stride],
                    image.pixel(0, y), stride);
    }
    GlHandle texture = make_texture(gl);
    gl.BindTexture(GL_TEXTURE_2D, texture.id());
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, image.width, image.height, 0, GL_RGB,
                  GL_UNSIGNED_BYTE, rows.data());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    gl.GenerateMipmap(GL_TEXTURE_2D);
    return texture;
}

}  // namespace

GLuint TextureCache::texture(const SurfaceMaterial& material) {
    const bool inside = material.embedded_texture != nullptr;
    if (!inside && material.texture.empty()) return 0;
    // A mesh read again has its picture again.
    const std::string name =
        inside ? hash_text(hash_of(*material.embedded_texture)) : material.texture.string();
    const auto [entry, is_new] = by_name_.try_emplace(name);
    if (is_new) entry->second = loaded(material);
    return entry->second.id();
}

GlHandle TextureCache::loaded(const SurfaceMaterial& material) const {
    try {
        const Image image =
            material.embedded_texture != nullptr
                ? decode_image(*material.embedded_texture,
                               "the picture inside material \"" + material.name + "\"")
                : read_image(material.texture);
        return uploaded(*gl_, thumbnail(image, kLargestTextureSide, kLargestTextureSide));
    } catch (const Error& error) {
        log_warning("{}; the surface is drawn in its plain colour", error.what());
        return {};
    }
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture_bytes.h"

#include <algorithm>

#include "render/targets.h"
#include "render/texture_cache.h"

namespace swage {

namespace {

// Of a pixel.
constexpr double kByteColor = 4, kHalfColor = 8, kFloatColor = 16, kDepth = 4;
// In half the width and height (render/visibility_pass.h): normals and depths; blockers, visibility
// and what is blurred of it.
constexpr double kHalfSize = (kFloatColor + kDepth + 3 * kHalfColor) / 4;
// Of one picture's layers: how far, normal and whose; which triangle.
constexpr double kLayers = 4 + 12 + 4, kTriangle = 4;

// Samples with the mean of them, or what is smoothed afterwards.
double targets(double color, bool multisampled) {
    const double plain = color + kDepth;
    return plain + (multisampled ? kSamples * plain : color);
}

}  // namespace

double picture_bytes(const RenderSettings& settings, bool multisampled) {
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const bool samples = multisampled && pixels <= double(kMostMultisampledPixels);
    const bool is_clear = settings.background == Background::transparent;
    const double image = is_clear ? 4 : 3;
    double each = kHalfSize + targets(kByteColor, samples);
    // Read back; while the one before is filtered and packed.
    each += kByteColor + image + 3 * image + (is_clear ? image : 0);
    if (settings.passes.empty()) return each * pixels;
    const auto has = [&](PicturePass pass) { return settings.has(pass); };
    const bool asks_triangles = has(PicturePass::motion) || has(PicturePass::piece);
    double held = kLayers + (asks_triangles ? kTriangle : 0);
    if (has(PicturePass::motion)) held += kFloatColor;
    if (has(PicturePass::beauty)) held += kFloatColor;
    // Channels as they are packed: all of them once more, halves beside floats.
    double packed = 0;
    for (const PicturePass pass : settings.passes) {
        const double channels = pass == PicturePass::depth    ? 8
                                : pass == PicturePass::normal ? 12
                                : pass == PicturePass::motion ? 16
                                : pass == PicturePass::beauty ? 24
                                                              : 6;
        packed = std::max(packed, channels);
    }
    each += kFloatColor + kDepth + (has(PicturePass::beauty) ? targets(kHalfColor, samples) : 0);
    return (each + 2 * held + kFloatColor + packed) * pixels;
}

TextureBytes texture_bytes(int width, int height) {
    constexpr double kMipmaps = 4. / 3;
    constexpr double kRead = 3 + 3, kSent = 3 + 3;  // unpacked, an image; shrunk, turned over
    const double shrunk =
        std::min(1.0, kLargestTextureSide / static_cast<double>(std::max({width, height, 1})));
    const double pixels = static_cast<double>(width) * height, drawn = pixels * shrunk * shrunk;
    return {drawn * kByteColor * kMipmaps, pixels * kRead + drawn * kSent};
}

}  // namespace swage

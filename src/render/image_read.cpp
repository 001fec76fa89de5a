// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that sees stb: pictures in, and the letters of pictures.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "base/file_contents.h"
#include "render/image_read.h"
#include "render/letters.h"

namespace {

// What a PNG unpacks to grows in its block, whatever its header says: none may become larger than
// a few times what the picture takes.
constexpr std::size_t kLargestPixel = 8;              // 16 bits of four channels
constexpr std::size_t kRoom = 4;                      // stb doubles its blocks
constexpr std::size_t kLeastRoom = 65536;             // of tiny pictures, with their rows' filters
thread_local std::size_t largest_block = kLeastRoom;  // 0 once a larger one was refused

void* grown(void* block, std::size_t size) {
    if (size <= largest_block) return std::realloc(block, size);
    largest_block = 0;
    return nullptr;
}

}  // namespace

#define STBI_MALLOC(size) std::malloc(size)
#define STBI_REALLOC(block, size) grown(block, size)
#define STBI_FREE(block) std::free(block)
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_HDR
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_FAILURE_USERMSG
#define STBI_MAX_DIMENSIONS 16384
#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb_image.h>
#include <stb_truetype.h>

namespace swage {

namespace {

constexpr std::size_t kLargestFile = std::numeric_limits<int>::max();  // as stb counts

// Whether no Huffman table of a JPEG has more codes than there are bytes for them to stand for.
// NOTE: stb_image 2.27 writes them all, past the end of its table.
bool has_sound_tables(std::string_view jpeg) {
    const auto byte = [&](std::size_t at) {
        return at < jpeg.size() ? static_cast<unsigned char>(jpeg[at]) : 0u;
    };
    if (!jpeg.starts_with("\xff\xd8")) return true;
    for (std::size_t at = 2; at + 3 < jpeg.size();) {
        const unsigned marker = byte(at) == 0xff ? byte(at + 1) : 0;
        const bool is_alone = marker == 1 || (marker >= 0xd0 && marker <= 0xd8);
        if (marker == 0 || marker == 0xff || is_alone) {
            ++at;  // of an image's bits, or what fills up
            continue;
        }
        const std::size_t end = at + 2 + 256 * byte(at + 2) + byte(at + 3);
        for (std::size_t table = at + 4; marker == 0xc4 && table < end;) {
            std::size_t codes = 0;
            for (std::size_t length = 1; length <= 16; ++length) codes += byte(table + length);
            if (codes > 256) return false;
            table += 17 + codes;
        }
        at = end;
    }
    return true;
}

// The size stands in the header: what is too large is refused before it is unpacked, and what
// unpacks to more than that has it asks for is refused before it takes more.
template <typename Info, typename Load>
Image unpacked(const std::string& name, int largest_side, const Info& info, const Load& load) {
    int width = 0, height = 0, channels = 0;
    if (info(&width, &height, &channels) == 0) {
        fail(ExitCode::output, "{}: not a PNG, JPEG, BMP or TGA picture ({})", name,
             stbi_failure_reason());
    }
    if (width < 1 || height < 1) fail(ExitCode::output, "{}: has no pixels", name);
    if (width > largest_side || height > largest_side) {
        fail(ExitCode::output, "{}: {} x {} pixels is more than {} on a side", name, width, height,
             largest_side);
    }
    largest_block = kLeastRoom + kRoom * kLargestPixel * (static_cast<std::size_t>(width) + 1) *
                                     static_cast<std::size_t>(height);
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(load(&width, &height, &channels),
                                                           stbi_image_free);
    if (!pixels && largest_block == 0) {
        fail(ExitCode::output, "{}: contains far more than its {} x {} pixels", name, width,
             height);
    }
    if (!pixels) fail(ExitCode::output, "{}: {}", name, stbi_failure_reason());
    Image image{width, height, {}};
    image.rgb.assign(pixels.get(), pixels.get() + 3 * static_cast<std::size_t>(width) *
                                                      static_cast<std::size_t>(height));
    return image;
}

}  // namespace

Image read_image(const std::filesystem::path& path, int largest_side) {
    const std::string name = path.string();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
        fail(ExitCode::output, "{}: there is no such picture", name);
    }
    const std::optional<std::string> bytes = file_contents(path, kLargestFile);
    if (!bytes) fail(ExitCode::output, "{}: cannot be read, or is more than 2 GiB", name);
    return decode_image(*bytes, name, largest_side);
}

Image decode_image(const std::string& bytes, const std::string& name, int largest_side) {
    if (bytes.size() > kLargestFile) fail(ExitCode::output, "{}: more than 2 GiB", name);
    if (!has_sound_tables(bytes)) fail(ExitCode::output, "{}: not a valid JPEG picture", name);
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    return unpacked(
        name, largest_side,
        [&](int* w, int* h, int* n) { return stbi_info_from_memory(data, size, w, h, n); },
        [&](int* w, int* h, int* n) { return stbi_load_from_memory(data, size, w, h, n, 3); });
}

std::optional<std::array<int, 2>> picture_size(const std::filesystem::path& file) {
    const std::optional<std::string> bytes = file_contents(file, kLargestFile);
    return bytes ? picture_size(*bytes) : std::nullopt;
}

std::optional<std::array<int, 2>> picture_size(const std::string& bytes) {
    if (bytes.size() > kLargestFile) return std::nullopt;
    std::array<int, 2> size{};
    int channels = 0;
    const int known = stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                            static_cast<int>(bytes.size()), size.data(),
                                            size.data() + 1, &channels);
    return known == 0 ? std::nullopt : std::optional(size);
}

namespace {

const stbtt_fontinfo& font() {
    static const stbtt_fontinfo info = [] {
        stbtt_fontinfo made;
        if (stbtt_InitFont(&made, embedded_font().data(), 0) == 0) {
            fail(ExitCode::output, "the built-in font cannot be read");
        }
        return made;
    }();
    return info;
}

int glyph_of(char c) { return stbtt_FindGlyphIndex(&font(), c < ' ' || c > '~' ? '?' : c); }

// To where the next one begins [pixel].
double advance_of(int glyph, double size) {
    int advance = 0, bearing = 0;
    stbtt_GetGlyphHMetrics(&font(), glyph, &advance, &bearing);
    return advance * double(stbtt_ScaleForMappingEmToPixels(&font(), float(size)));
}

}  // namespace

std::vector<LetterPixels> letters_of(const std::string& text, double x, double y, double size) {
    const float scale = stbtt_ScaleForMappingEmToPixels(&font(), float(size));
    std::vector<LetterPixels> letters;
    for (const char c : text) {
        const int glyph = glyph_of(c);
        const double left = std::floor(x), top = std::floor(y);
        const float right_by = float(x - left), down_by = float(y - top);
        int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        stbtt_GetGlyphBitmapBoxSubpixel(&font(), glyph, scale, scale, right_by, down_by, &x0, &y0,
                                        &x1, &y1);
        x += advance_of(glyph, size);
        if (x1 <= x0 || y1 <= y0) continue;  // a blank
        LetterPixels one{int(left) + x0, int(top) + y0, x1 - x0, y1 - y0, {}};
        one.cover.resize(std::size_t(one.width) * std::size_t(one.height));
        stbtt_MakeGlyphBitmapSubpixel(&font(), one.cover.data(), one.width, one.height, one.width,
                                      scale, scale, right_by, down_by, glyph);
        letters.push_back(std::move(one));
    }
    return letters;
}

double letters_width(const std::string& text, double size) {
    double width = 0;
    for (const char c : text) width += advance_of(glyph_of(c), size);
    return width;
}

}  // namespace swage

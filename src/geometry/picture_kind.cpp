// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/picture_kind.h"

#include <string>

#include "base/file_contents.h"

namespace swage {

namespace {

using namespace std::string_view_literals;

struct Mark {
    std::size_t at;
    std::string_view bytes;
    PictureKind kind;
};

constexpr Mark kMarks[] = {
    {0, "\x89PNG"sv, {"PNG", ".png", true}},
    {0, "\xff\xd8\xff"sv, {"JPEG", ".jpg", true}},
    {0, "BM"sv, {"BMP", ".bmp", true}},
    {0, "GIF8"sv, {"GIF", ".gif", false}},
    {8, "WEBP"sv, {"WebP", ".webp", false}},
    {0, "II*\0"sv, {"TIFF", ".tif", false}},
    {0, "MM\0*"sv, {"TIFF", ".tif", false}},
    {0, "\x76\x2f\x31\x01"sv, {"OpenEXR", ".exr", false}},
    {0, "#?RADIANCE"sv, {"Radiance", ".hdr", false}},
    {0, "DDS "sv, {"DDS", ".dds", false}},
    {0, "8BPS"sv, {"Photoshop", ".psd", false}},
    {0, "\xabKTX"sv, {"KTX", ".ktx", false}},
    {4, "ftypavif"sv, {"AVIF", ".avif", false}},
    {4, "ftyphei"sv, {"HEIF", ".heic", false}},
    {0, "\0\0\0\x0cjP  "sv, {"JPEG 2000", ".jp2", false}},
};

}  // namespace

std::optional<PictureKind> picture_kind(std::string_view bytes) {
    for (const Mark& mark : kMarks)
        if (bytes.size() > mark.at && bytes.substr(mark.at).starts_with(mark.bytes))
            return mark.kind;
    return std::nullopt;
}

std::optional<PictureKind> picture_kind_of(const std::filesystem::path& file) {
    std::string head(16, '\0'), why;
    const FileHandle opened = open_plain_file(file, why);
    if (!opened.is_open()) return std::nullopt;
    head.resize(read_up_to(opened.id(), head.data(), head.size()).value_or(0));
    return picture_kind(head);
}

}  // namespace swage

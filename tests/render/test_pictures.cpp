// SPDX-License-Identifier: GPL-3.0-or-later
// Picture files, sheets and films.
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/log.h"
#include "base/process.h"
#include "base/srgb.h"
#include "render/contact_sheet.h"
#include "render/film.h"
#include "render/image_read.h"
#include "render/png.h"
#include "tests/catch.h"
#include "tests/shared/bytes_of.h"
#include "tests/shared/scratch.h"

using namespace swage;
using test::bytes_of;
namespace fs = std::filesystem;

namespace {

Image pattern(int width, int height, unsigned seed = 1) {
    Image image{width, height, {}};
    for (int i = 0; i < 3 * width * height; ++i) {
        seed = seed * 1664525u + 1013904223u;
        image.rgb.push_back(static_cast<std::uint8_t>(seed >> 24));
    }
    return image;
}

Image plain(int width, int height, std::uint8_t value) {
    return {width, height,
            std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), value)};
}

}  // namespace

TEST_CASE("a PNG read again has the same pixels", "[png]") {
    const Scratch folder;
    for (const auto& [width, height] : {std::pair(1, 1), {7, 3}, {640, 361}}) {
        const Image image = pattern(width, height);
        write_png(folder / "a.png", image);
        const Image again = read_image(folder / "a.png");
        CHECK(again.width == width);
        CHECK(again.height == height);
        CHECK((again.rgb == image.rgb));
        CHECK(encode_png(image) == encode_png(image));
    }
    CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);  // no temporary is left
}

TEST_CASE("a picture that cannot be read says why", "[png]") {
    const Scratch folder;
    CHECK_THROWS_AS(read_image(folder / "none.png"), Error);
    CHECK_THROWS_AS(read_image(folder.path()), Error);
    std::ofstream(folder / "text.png") << "this is no picture";
    CHECK_THROWS_AS(read_image(folder / "text.png"), Error);
    const std::string whole = encode_png(pattern(64, 64));
    std::ofstream(folder / "half.png", std::ios::binary) << whole.substr(0, whole.size() / 2);
    CHECK_THROWS_AS(read_image(folder / "half.png"), Error);
    std::ofstream(folder / "whole.png", std::ios::binary) << whole;
    CHECK_THROWS_AS(read_image(folder / "whole.png", 63), Error);
    CHECK_THROWS_AS(encode_png(Image{}), Error);
    std::string bitmap = "BM";  // of a header of 40 bytes, and of no pixel
    for (const std::uint32_t word :
         {54u, 0u, 54u, 40u, 0u, 0u, 24u << 16 | 1u, 0u, 0u, 0u, 0u, 0u, 0u}) {
        for (int byte = 0; byte < 4; ++byte) bitmap += static_cast<char>(word >> 8 * byte);
    }
    std::ofstream(folder / "none.bmp", std::ios::binary) << bitmap;
    CHECK_THROWS_WITH(read_image(folder / "none.bmp"), Catch::Contains("has no pixels"));
}

TEST_CASE("a file larger than any picture is refused unread") {
    const Scratch folder;
    const fs::path file = folder / "huge.png";
    std::ofstream(file) << "x";
    fs::resize_file(file, std::uintmax_t{3} << 30);  // a hole
    try {
        read_image(file);
        FAIL("it was read");
    } catch (const Error& error) {
        const std::string what = error.what();
        CHECK(what.find("huge.png: cannot be read, or is more than 2 GiB") != std::string::npos);
    }
}

TEST_CASE("a JPEG with more codes than bytes is refused before it is decoded") {
    // One Huffman table of 16 * 17 codes, before anything else.
    std::string jpeg = std::string("\xff\xd8\xff\xc4\x01\x23", 6) + '\0' + std::string(16, 17);
    for (const std::size_t shown : {jpeg.size() + 272, jpeg.size()}) {
        jpeg.resize(shown, 'x');
        try {
            decode_image(jpeg, "codes.jpg");
            FAIL("it was decoded");
        } catch (const Error& error) {
            CHECK(std::string(error.what()) == "codes.jpg: not a valid JPEG picture");
        }
    }
}

TEST_CASE("a picture that unpacks to far more than its size asks for is refused", "[png]") {
    std::string bomb = encode_png(pattern(1024, 1024));
    const std::string sixteen = {0, 0, 0, 16};
    for (const std::size_t side : {16, 20}) bomb.replace(side, 4, sixteen);  // where they stand
    try {
        decode_image(bomb, "bomb.png");
        FAIL("it was unpacked");
    } catch (const Error& error) {
        CHECK(std::string(error.what()) == "bomb.png: contains far more than its 16 x 16 pixels");
    }
    CHECK(decode_image(encode_png(pattern(64, 64)), "whole.png").width == 64);
}

TEST_CASE("light and bytes turn into each other", "[srgb]") {
    for (int i = 0; i < 256; ++i) {
        CHECK(std::lround(255 * srgb_from_linear(linear_from_srgb(i / 255.0))) == i);
    }
    CHECK(linear_from_srgb(0.5) == Approx(0.21404).epsilon(1e-4));
}

TEST_CASE("a plain picture scales to the same colour, the own size to itself", "[scale]") {
    for (int value = 0; value < 256; ++value) {
        const Image small = scaled(plain(9, 7, static_cast<std::uint8_t>(value)), 4, 2);
        CHECK((small.rgb == plain(4, 2, static_cast<std::uint8_t>(value)).rgb));
    }
    const Image image = pattern(31, 17);
    CHECK((scaled(image, 31, 17).rgb == image.rgb));
}

TEST_CASE("scaling keeps the mean light", "[scale]") {
    // Black and white stripes give the byte of half the light, not half the byte.
    Image stripes = plain(64, 64, 0);
    for (std::size_t i = 0; i < stripes.rgb.size(); ++i) {
        if (i / 3 % 2 == 0) stripes.rgb[i] = 255;
    }
    CHECK((scaled(stripes, 16, 16).rgb == plain(16, 16, 188).rgb));
    // Also where new pixels straddle old ones.
    const Image image = pattern(100, 80), small = scaled(image, 37, 23);
    const auto mean = [](const Image& m) {
        double sum = 0;
        for (const auto v : m.rgb) sum += linear_from_srgb(v / 255.0);
        return sum / static_cast<double>(m.rgb.size());
    };
    CHECK(mean(small) == Approx(mean(image)).epsilon(2e-3));
}

TEST_CASE("a thumbnail keeps its proportions and is never enlarged", "[scale]") {
    CHECK(thumbnail(pattern(1280, 720), 320, 320).width == 320);
    CHECK(thumbnail(pattern(1280, 720), 320, 320).height == 180);
    CHECK(thumbnail(pattern(10, 300), 100, 100).height == 100);
    CHECK(thumbnail(pattern(10, 5), 100, 100).width == 10);
}

TEST_CASE("a contact sheet shows each picture once in its place", "[sheet]") {
    std::vector<Image> pictures;
    for (int i = 0; i < 5; ++i) pictures.push_back(plain(8, 6, static_cast<std::uint8_t>(50 * i)));
    SheetStyle style;
    style.gap = 2;
    const Image sheet = contact_sheet(pictures, 3, style);
    CHECK(sheet.width == 3 * 10 + 2);
    CHECK(sheet.height == 2 * 8 + 2);
    CHECK(sheet.pixel(0, 0)[0] == style.paper[0]);
    for (int i = 0; i < 5; ++i) {
        const int left = 2 + i % 3 * 10, top = 2 + i / 3 * 8;
        CHECK(sheet.pixel(left, top)[0] == 50 * i);
        CHECK(sheet.pixel(left + 7, top + 5)[2] == 50 * i);
        CHECK(sheet.pixel(left + 8, top)[0] == style.paper[0]);
    }
    CHECK(contact_sheet(pictures, 100, style).height == 10);  // no empty columns
    CHECK(contact_sheet(pictures, 0, style).width == 12);
    CHECK_THROWS_AS(contact_sheet({}, 3), Error);
}

TEST_CASE("a film appears under its name when whole, with the same bytes each time", "[film]") {
    if (!program_exists("ffmpeg")) {
        WARN("skipped: ffmpeg is not in PATH");
        return;
    }
    const Scratch folder;
    const auto make = [&](const fs::path& file, int width, int height) {
        Film film(file, width, height, FrameRate{});
        for (unsigned i = 0; i < 12; ++i) film.add(pattern(width, height, i));
        CHECK_FALSE(fs::exists(file));
        return film.finish();
    };
    CHECK(make(folder / "a.mp4", 64, 48));
    CHECK(make(folder / "b.mp4", 64, 48));
    CHECK(bytes_of(folder / "a.mp4") == bytes_of(folder / "b.mp4"));
    CHECK(bytes_of(folder / "a.mp4").size() > 1000);
    CHECK(make(folder / "odd.mp4", 33, 17));
    CHECK(make(folder / "dot.mp4", 1, 1));
    CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 4);
}

TEST_CASE("a film that cannot be made is a warning and leaves nothing behind", "[film]") {
    const Scratch folder;
    {
        Film film(folder / "no_such_folder/a.mp4", 64, 48, FrameRate{});
        for (unsigned i = 0; i < 200; ++i) film.add(pattern(64, 48, i));
        CHECK_FALSE(film.finish());
    }
    {
        Film unfinished(folder / "b.mp4", 64, 48, FrameRate{});
        unfinished.add(pattern(64, 48));
    }
    {
        Film empty(folder / "c.mp4", 64, 48, FrameRate{});
        CHECK_FALSE(empty.finish());
    }
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", folder.path().c_str(), 1);
    {
        Film film(folder / "d.mp4", 64, 48, FrameRate{});
        film.add(pattern(64, 48));
        CHECK_FALSE(film.finish());
    }
    ::setenv("PATH", path.c_str(), 1);
    CHECK(fs::is_empty(folder.path()));
    {  // one that says that all is well, and is not
        const Scratch other;
        other.write("ffmpeg", "#!/bin/sh\ncat > /dev/null\n");
        fs::permissions(other / "ffmpeg", fs::perms::owner_all);
        ::setenv("PATH", (other.path().string() + ":" + path).c_str(), 1);
        Film film(folder / "f.mp4", 64, 48, FrameRate{});
        film.add(pattern(64, 48));
        bool is_made = true;
        CHECK_NOTHROW(is_made = film.finish());
        CHECK_FALSE(is_made);
        CHECK(film.warning().find("no film") != std::string::npos);
        ::setenv("PATH", path.c_str(), 1);
    }
    CHECK(fs::is_empty(folder.path()));
    Film film(folder / "e.mp4", 64, 48, FrameRate{});
    CHECK_THROWS_AS(film.add(pattern(48, 64)), Error);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture_bytes.h"

#include "render/image_read.h"
#include "render/png.h"
#include "tests/catch.h"

using namespace swage;

namespace {

RenderSettings picture(int width, int height, std::vector<PicturePass> passes = {}) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.passes = std::move(passes);
    return settings;
}

// Of each pixel.
double each(const std::vector<PicturePass>& passes, bool multisampled = true) {
    return picture_bytes(picture(1000, 500, passes), multisampled) / 500e3;
}

}  // namespace

TEST_CASE("what a picture takes is told by its targets and its way to a file") {
    // In half the size colours of 16 bytes, depth and three of 8; colour and depth, and four
    // samples of these; read back with alpha, without, filtered and packed beside the one before.
    const double half = (16 + 4 + 3 * 8) / 4., way = 4 + 3 + 3 * 3;
    CHECK(each({}) == Approx(half + 8 + 4 * 8 + way));
    CHECK(each({}, false) == Approx(half + 8 + 4 + way));
    CHECK(picture_bytes(picture(2000, 1000), true) ==
          Approx(4 * picture_bytes(picture(1000, 500), true)));
    // So large ones are not sampled.
    CHECK(picture_bytes(picture(5000, 5000), true) == picture_bytes(picture(5000, 5000), false));
    RenderSettings clear = picture(1000, 500);
    clear.background = Background::transparent;
    CHECK(picture_bytes(clear, true) / 500e3 == Approx(each({}) + 8));
}

TEST_CASE("passes take their layers of two pictures, and what they are drawn in and packed from") {
    using enum PicturePass;
    const double layered = 16 + 4, read = 16, layers = 2 * 20;
    CHECK(each({depth}) - each({}) == Approx(layered + read + layers + 8));
    CHECK(each({normal}) - each({depth}) == Approx(12 - 8));
    CHECK(each({motion}) - each({depth}) == Approx(2 * (4 + 16) + 16 - 8));
    CHECK(each({beauty}) - each({depth}) == Approx(5 * (8 + 4) + 2 * 16 + 24 - 8));
    CHECK(each({beauty}, false) - each({depth}, false) == Approx(8 + 4 + 8 + 2 * 16 + 24 - 8));
    // Each of them more, all less than one after another.
    double alone = 0;
    for (const PicturePass one : {depth, matte, normal, motion, beauty, piece}) {
        CHECK(each({one}) > each({}));
        alone += each({one}) - each({});
    }
    const double all = each({depth, matte, normal, motion, beauty, piece}) - each({});
    CHECK(all < alone);
    CHECK(all >= each({motion, beauty}) - each({}));
}

TEST_CASE("a texture is told by its pixels, as it is shrunk") {
    CHECK(texture_bytes(300, 200).kept == Approx(300 * 200 * 16. / 3));
    CHECK(texture_bytes(8192, 8192).kept == Approx(texture_bytes(4096, 4096).kept));
    CHECK(texture_bytes(8192, 8192).reading > 2 * texture_bytes(4096, 4096).reading);
    CHECK(texture_bytes(0, 0).kept == 0);
}

TEST_CASE("a picture's size is read from its header") {
    const std::string png = encode_png({7, 5, std::vector<std::uint8_t>(3 * 7 * 5)});
    REQUIRE(picture_size(png));
    CHECK(*picture_size(png) == std::array{7, 5});
    CHECK(*picture_size(png.substr(0, png.size() / 2)) == std::array{7, 5});
    CHECK(!picture_size(std::string("no picture")));
    CHECK(!picture_size(std::string()));
    CHECK(!picture_size(std::filesystem::path("not-there.png")));
}

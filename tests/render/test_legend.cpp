// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/legend.h"

#include <cmath>
#include <set>

#include "render/color_map.h"
#include "render/letters.h"
#include "tests/catch.h"

using namespace swage;

namespace {

Image grey(int width, int height) {
    return {width, height, std::vector<std::uint8_t>(std::size_t(3) * width * height, 128)};
}

double brightness(const std::array<double, 3>& srgb) {
    double sum = 0;
    const double share[] = {0.2126, 0.7152, 0.0722};
    for (int c = 0; c < 3; ++c) sum += share[c] * std::pow(srgb[c] / 255, 2.2);
    return std::cbrt(sum);
}

}  // namespace

TEST_CASE("the colour map grows brighter in even steps") {
    constexpr int kSteps = 20;
    const double all = brightness(mapped_color({}, 1)) - brightness(mapped_color({}, 0));
    for (int n = 0; n < kSteps; ++n) {
        const double step = brightness(mapped_color({}, (n + 1.0) / kSteps)) -
                            brightness(mapped_color({}, double(n) / kSteps));
        CHECK(step == Approx(all / kSteps).epsilon(0.4));
    }
    CHECK(mapped_color({}, -1) == mapped_color({}, 0));
    CHECK(mapped_color({}, 2) == mapped_color({}, 1));
}

TEST_CASE("of what may be less than nothing, nothing is the palest, and both sides go on alike") {
    const ColorScale scale = color_scale(-1, 3, true);
    const auto color_at = [&](double value) { return mapped_color(scale, (value + 1) / 4); };
    const auto nothing = color_at(0);
    CHECK(nothing == std::array<double, 3>{0xf7, 0xf7, 0xf7});
    for (const double size : {0.25, 0.5, 1.0}) {
        const auto less = color_at(-size), more = color_at(size);
        CHECK(less[2] > less[0]);
        CHECK(more[0] > more[2]);
        CHECK(brightness(less) < brightness(nothing));
        CHECK(brightness(less) == Approx(brightness(more)).epsilon(0.1));
    }
    // Where all is on one side, or nothing is less than nothing, even steps show more.
    CHECK_FALSE(color_scale(1, 3, true).diverges);
    CHECK_FALSE(color_scale(-1, 3, false).diverges);
}

TEST_CASE("a scale has round numbers, the ends of its range and the unit that suits it") {
    const Legend stress = make_legend("stress", "Pa", 0, 223.07e6);
    CHECK(stress.title == "stress [MPa]");
    std::vector<std::string> text;
    for (const Legend::Tick& tick : stress.tick) {
        text.push_back(tick.text);
        CHECK(tick.share == Approx(std::stod(tick.text) / 223.07).margin(1e-3));
    }
    CHECK(text == std::vector<std::string>{"0", "50", "100", "150", "200", "223"});

    const Legend strain = make_legend("plastic strain", "", 0, 0.31);
    CHECK(strain.title == "plastic strain");
    CHECK(strain.tick[1].text == "0.05");
    CHECK(strain.tick.back().text == "0.310");

    const Legend pressure = make_legend("pressure", "Pa", -1500, 2000);
    CHECK(pressure.title == "pressure [kPa]");
    CHECK(pressure.tick.front().text == "-1.5");
    CHECK(pressure.tick.back().text == "2.0");
    CHECK(make_legend("stress", "Pa", 0, 1.2e9).title == "stress [GPa]");
}

TEST_CASE("a legend changes nothing above it, and nothing of a picture too small for it") {
    const Legend legend = make_legend("von Mises stress", "Pa", 0, 2e8);
    Image image = grey(640, 360);
    CHECK(draw_legend(legend, image));
    int changed = 0;
    for (int y = 0; y < 360; ++y) {
        for (int x = 0; x < 640; ++x) {
            if (image.pixel(x, y)[0] == 128 && image.pixel(x, y)[1] == 128) continue;
            ++changed;
            REQUIRE(y > 300);
        }
    }
    CHECK(changed > 5000);
    Image small = grey(60, 40);
    CHECK_FALSE(draw_legend(legend, small));
    CHECK(small.rgb == grey(60, 40).rgb);
}

TEST_CASE("over a picture that lets through a legend stands as over what is behind it") {
    const Legend legend = make_legend("von Mises stress", "Pa", 0, 2e8);
    Image solid = grey(640, 360), clear = grey(640, 360);
    for (std::uint8_t& value : clear.rgb) value = 7;  // of what is not there
    clear.alpha.assign(std::size_t(640) * 360, 0);
    draw_legend(legend, solid);
    draw_legend(legend, clear);
    for (std::size_t n = 0; n < solid.rgb.size(); ++n) {
        const double alpha = clear.alpha[n / 3] / 255.0,
                     over = alpha * clear.rgb[n] + (1 - alpha) * 128;
        REQUIRE(std::abs(over - solid.rgb[n]) < 2);
    }
}

TEST_CASE("a narrow scale has the numbers of both its ends") {
    Legend legend = make_legend("pressure", "Pa", -2e8, 2e8);
    const auto drawn = [](const Legend& of) {
        Image image = grey(1080, 1920);
        draw_legend(of, image);
        return image.rgb;
    };
    const auto all = drawn(legend);
    Legend without = legend;
    without.tick.back().text = "";
    CHECK(drawn(without) != all);
    without = legend;
    without.tick.front().text = "";
    CHECK(drawn(without) != all);
}

TEST_CASE("letters are of one shape at any size, as fine as the pixels are") {
    for (const double size : {12.0, 30.0, 65.0, 200.0}) {
        INFO(size);
        // A slanted stroke begins elsewhere in nearly every row: nothing is built of larger blocks.
        const LetterPixels slash = letters_of("/", 0.25, 100, size).at(0);
        std::set<int> begins;
        for (int y = 0; y < slash.height; ++y) {
            int shade = 0;  // in 255 parts of a pixel
            for (int x = 0; x < slash.width; ++x) {
                const int cover = slash.cover[std::size_t(y) * slash.width + x];
                shade = 255 * x + 255 - cover;
                if (cover > 0) break;
            }
            begins.insert(shade);
        }
        CHECK(double(begins.size()) > 0.8 * slash.height);
        for (const char* text : {"O", "3", "M"}) {
            const auto area = [&](double of) {
                double sum = 0;
                const LetterPixels letter = letters_of(text, 0, 100, of).at(0);
                for (const std::uint8_t c : letter.cover) sum += c;
                return sum / (255 * of * of);
            };
            CHECK(area(size) == Approx(area(500)).epsilon(0.05));
        }
        const LetterPixels eight = letters_of("8", 0, 100, size).at(0);
        CHECK(eight.height == Approx(kLetterHeight * size).margin(2 + 0.03 * size));
        CHECK(letters_width("0.25", size) == Approx(size / 12 * letters_width("0.25", 12)));
    }
    CHECK(letters_of("", 0, 0, 10).empty());
    CHECK(letters_width("\xc3\xa4", 10) == letters_width("??", 10));
}

TEST_CASE("letters stand where they are put, to less than a pixel") {
    const auto middle = [](double x, double y) {
        double sum = 0, at_x = 0, at_y = 0;
        const LetterPixels o = letters_of("o", x, y, 20).at(0);
        for (int row = 0; row < o.height; ++row) {
            for (int column = 0; column < o.width; ++column) {
                const double share = o.cover[std::size_t(row) * o.width + column];
                sum += share;
                at_x += share * (o.left + column);
                at_y += share * (o.top + row);
            }
        }
        return std::array<double, 2>{at_x / sum, at_y / sum};
    };
    const auto from = middle(5, 50), to = middle(7.3, 49.6);
    CHECK(to[0] - from[0] == Approx(2.3).margin(0.02));
    CHECK(to[1] - from[1] == Approx(-0.4).margin(0.02));
}

TEST_CASE("a scale ends in an arrow where anything lies beyond it, and nowhere else") {
    Legend legend = make_legend("von Mises stress", "Pa", 0, 2e8);
    const auto drawn = [&](bool below, bool above) {
        Image image = grey(1280, 720);
        legend.below = below;
        legend.above = above;
        draw_legend(legend, image);
        return image;
    };
    const auto has = [](const Image& image, double share) {
        std::array<int, 2> count = {};  // left of the bar, right of it
        const auto color = mapped_color({}, share);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                if (x >= image.width * 3 / 10 && x < image.width * 7 / 10) continue;
                bool same = true;
                for (int c = 0; c < 3; ++c) {
                    same = same && std::abs(image.pixel(x, y)[c] - color[std::size_t(c)]) < 1;
                }
                if (same) ++count[x > image.width / 2];
            }
        }
        return count;
    };
    for (const bool below : {false, true}) {
        for (const bool above : {false, true}) {
            const Image image = drawn(below, above);
            CHECK((has(image, 0)[0] > 50) == below);
            CHECK((has(image, 1)[1] > 50) == above);
            CHECK(has(image, 0)[1] == 0);
            CHECK(has(image, 1)[0] == 0);
        }
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What is loaded from within, and what gauges on it show.
#include "base/math.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

TEST_CASE("a hollow ball swells under pressure within, and bears what Lame has, as gauges show") {
    const Scratch scratch;
    const std::filesystem::path folder = scratch.path();
    constexpr double kInner = 0.5, kOuter = 1, kPressure = 1e3, kYoung = 1e6, kNu = 0.3;
    REQUIRE(run_swage({"make", "sphere", "--diameter", "2", "--wall", "0.5", "--division", "48",
                       "--out", "ball.obj"},
                      folder)
                .code == 0);
    put_text(folder / "scene.toml",
             fmt::format("[mesh]\nfile = \"ball.obj\"\n"
                         "[material]\nyoung_modulus = {}\npoisson_ratio = {}\ndensity = 1000\n"
                         "[mold]\nspacing = 0.08\n"
                         "[[probe]]\nname = \"top\"\nat = [0.5, 1, 0.5]\n"
                         "fields = [\"principal_stress\"]\n"
                         "[[probe]]\nname = \"side\"\nat = [1, 0.5, 0.5]\n"
                         "[[stage]]\nmachine = \"hold\"\ngrip_length = 0.01\nframes = 1\n"
                         "[[stage.load]]\non = \"inside\"\npressure = {}\n",
                         kYoung, kNu, kPressure));
    const Outcome outcome =
        run_swage({"run", "scene.toml", "--no-render", "--out", "out", "-q"}, folder);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const std::map<std::string, double> end = last_row(folder / "out/curves/1-hold.csv");
    const double a3 = kInner * kInner * kInner, b3 = kOuter * kOuter * kOuter;
    const double hoop = 1.5 * kPressure * a3 / (b3 - a3);
    const double swelling = kOuter * (1 - kNu) * hoop / kYoung;
    CHECK(end.at("top principal_stress [Pa]") == Approx(hoop).epsilon(0.06));
    // It is held at its left.
    CHECK(end.at("side x [m]") - kOuter == Approx(2 * swelling).epsilon(0.06));
}

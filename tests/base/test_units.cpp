// SPDX-License-Identifier: GPL-3.0-or-later
#include <clocale>
#include <limits>
#include <map>
#include <sstream>

#include "base/math.h"
#include "base/suggest.h"
#include "base/units.h"
#include "tests/catch.h"

using namespace swage;

namespace {

std::string mistake_of(const std::string& text, Quantity wanted) {
    try {
        parse_quantity(text, wanted);
    } catch (const TextError& error) {
        return fmt::format("{}: {}", error.at(), error.what());
    }
    return "none";
}

}  // namespace

TEST_CASE("a quantity has the value of its unit, however it is spelled") {
    struct Good {
        const char* text;
        Quantity quantity;
        double value;
    };
    const Good good[] = {
        {"18 cm", Quantity::length, 0.18},
        {"18cm", Quantity::length, 0.18},
        {"2 inches", Quantity::length, 0.0508},
        {"90 degrees", Quantity::angle, kPi / 2},
        {"1 sec", Quantity::time, 1},
        {"  -18\tcm ", Quantity::length, -0.18},
        {"+2 m", Quantity::length, 2},
        {".5 mm", Quantity::length, 0.0005},
        {"2.5e1 \u00b5m", Quantity::length, 25e-6},
        {"3 \u00b5s", Quantity::time, 3e-6},
        {"3 \u03bcs", Quantity::time, 3e-6},
        {"3 \u00b5m/s", Quantity::speed, 3e-6},
        {"3 \u03bcm/s", Quantity::speed, 3e-6},
        {"0.25", Quantity::length, 0.25},
        {"010", Quantity::number, 10},
        {"-0", Quantity::number, 0},
        {"1e-999", Quantity::number, 0},
        {"30 %", Quantity::number, 0.3},
        {"210 GPa", Quantity::stress, 210e9},
        {"210 N/mm^2", Quantity::stress, 210e6},
        {"60 deg", Quantity::angle, kPi / 3},
        {"30 rpm", Quantity::spin, kPi},
        {"90 deg/s", Quantity::spin, kPi / 2},
        {"60\u00b0", Quantity::angle, kPi / 3},
        {"0.5 turn", Quantity::angle, kPi},
        {"0.5 mm/s", Quantity::speed, 0.0005},
        {"36 km/h", Quantity::speed, 10},
        {"1.5 s", Quantity::time, 1.5},
        {"2 min", Quantity::time, 120},
        {"7.8 g/cm3", Quantity::density, 7800},
        {"7.8 g/cm\u00b3", Quantity::density, 7800},
        {"9.81 m/s2", Quantity::acceleration, 9.81},
        {"9.81 m/s^2", Quantity::acceleration, 9.81},
        {"100 J/m2", Quantity::toughness, 100},
        {"3 kN", Quantity::force, 3000},
        {"3 g", Quantity::mass, 0.003},
        {"2 lb", Quantity::mass, 0.90718474},
        {"10 lbf", Quantity::force, 44.482216152605},
        {"1 lbf ft", Quantity::torque, 1.3558179483314004},
        {"1 ft lbf", Quantity::torque, 1.3558179483314004},
        {"1 ft-lb", Quantity::torque, 1.3558179483314004},
        {"1 ft-lbf", Quantity::torque, 1.3558179483314004},
        {"1 lb-ft", Quantity::torque, 1.3558179483314004},
        {"12 in-lbf", Quantity::torque, 1.3558179483314004},
        {"12 in-lb", Quantity::torque, 1.3558179483314004},
        {"12 lb in", Quantity::torque, 1.3558179483314004},
        {"5 N-m", Quantity::torque, 5},
        {"2 lbm", Quantity::mass, 0.90718474},
        {"250 g", Quantity::mass, 0.25},
        {"1 slug", Quantity::mass, 14.593902937206364},
        {"1 slug/ft3", Quantity::density, 515.3788183931961},
        {"144 psf", Quantity::stress, 6894.757293168361},
        {"1 kip", Quantity::force, 4448.2216152605},
        {"2 kip ft", Quantity::torque, 2711.6358966628008},
        {"12 kip in", Quantity::torque, 1355.8179483314004},
        {"2 yd", Quantity::length, 1.8288},
        {"10 mil", Quantity::length, 2.54e-4},
        {"60 mph", Quantity::speed, 26.8224},
        {"16 oz", Quantity::mass, 0.45359237},
        {"1000 lbf/in2", Quantity::stress, 6894757.293168361},
        {"144 lbf/ft^2", Quantity::stress, 6894.757293168361},
        {"3 N\u00b7m", Quantity::torque, 3},
        {"3 kN\u22c5m", Quantity::torque, 3000},
        {"3 lbf\u00b7ft", Quantity::torque, 4.067453844994201},
        {"3 Pa\u00b7s/m", Quantity::drag, 3},
        {"32 ft/s2", Quantity::acceleration, 9.7536},
        {"1000 psi", Quantity::stress, 6894757.293168361},
        {"36 ksi", Quantity::stress, 36 * 6894757.293168361},
        {"36 kip/in2", Quantity::stress, 36 * 6894757.293168361},
        {"144 kip/ft2", Quantity::stress, 6894757.293168361},
        {"490 lbm/ft3", Quantity::density, 7849.0470532404715},
        {"0.284 lbm/in^3", Quantity::density, 7861.092937697686},
        {"16 oz/in3", Quantity::density, 27679.904710203125},
        {"12 ft-lb/in2", Quantity::toughness, 144 * 175.12683524647636},
        {"1 ft lbf/in2", Quantity::toughness, 12 * 175.12683524647636},
        {"1 in lb/in^2", Quantity::toughness, 175.12683524647636},
        {"1 in-lbf/in2", Quantity::toughness, 175.12683524647636},
        {"1 ft lbf/ft2", Quantity::toughness, 175.12683524647636 / 12},
        {"16 oz in", Quantity::torque, 0.1129848290276167},
        {"16 ozf-in", Quantity::torque, 0.1129848290276167},
        {"16 ozf", Quantity::force, 4.4482216152605},
    };
    for (const Good& one : good) {
        INFO(one.text);
        CHECK(parse_quantity(one.text, one.quantity) == Approx(one.value).epsilon(1e-15));
    }
    CHECK_FALSE(std::signbit(parse_quantity("-0", Quantity::number)));
}

TEST_CASE("what is no quantity is refused with place and reason") {
    struct Bad {
        const char* text;
        Quantity wanted;
        const char* mistake;  // how it begins
    };
    const Bad bad[] = {
        {"", Quantity::length, "0: the text is empty; expected a length (m, cm, mm, um, ...)"},
        {"long", Quantity::length, "0: \"long\" is not a number; expected a length"},
        {"1,5 cm", Quantity::length, "1: \"1,5 cm\" has a decimal comma; write \"1.5 cm\""},
        {"10 apples", Quantity::length, "3: unknown unit \"apples\"; expected a length"},
        {"2*60 deg", Quantity::angle,
         "1: \"2*60 deg\" is an expression, which only machine files allow;"},
        {"1/5", Quantity::length, "1: \"1/5\" is an expression, which only machine files allow;"},
        {"1e5x", Quantity::number, "3: unknown unit \"x\"; expected a plain number"},
        {"18 cm long", Quantity::length, "3: unknown unit \"cm long\"; expected a length"},
        {"1.2.3", Quantity::number, "3: unknown unit \".3\""},
        {"3 mpa", Quantity::stress,
         "2: unknown unit \"mpa\", did you mean \"MPa\"? Expected a stress (GPa, MPa, "},
        {"3 N\u00b7", Quantity::force, "2: unknown unit "},
        {"3 kg", Quantity::length, "2: \"3 kg\" is a mass; expected a length"},
        {"3 m", Quantity::number, "2: \"3 m\" is a length; expected a plain number"},
        {"0x10", Quantity::number, "0: \"0x10\" is hexadecimal"},
        {"nan", Quantity::number, "0: \"nan\" is not a finite number"},
        {"-Inf m", Quantity::length, "0: \"Inf\" is not a finite number"},
        {"1e999", Quantity::number, "0: \"1e999\" is too large"},
        {"1e308 km", Quantity::length, "0: \"1e308 km\" is too large"},
        {"- 3", Quantity::number, "0: \"- 3\" is not a number"},
    };
    for (const Bad& one : bad) {
        INFO(one.text);
        const std::string mistake = mistake_of(one.text, one.wanted);
        INFO(mistake);
        CHECK(mistake.rfind(one.mistake, 0) == 0);
    }
}

TEST_CASE("every unit's own name reads back as its quantity") {
    for (const std::string& name : quantity_names()) {
        const Quantity quantity = *quantity_named(name);
        CHECK(quantity_name(quantity) == name);
        for (const std::string& unit : unit_names(quantity)) {
            INFO(unit);
            CHECK(parse_quantity("2 " + unit, quantity) > 0);
            CHECK(parse_quantity("2" + unit, quantity) == parse_quantity("2 " + unit, quantity));
        }
    }
}

namespace {

// Of a unit as its name says: parts by blanks and behind a stroke, each with a power at its end.
double by_its_parts(std::string name, Quantity quantity) {
    constexpr double kInch = 0.0254, kPound = 0.45359237, kPoundForce = kPound * 9.80665;
    static const std::map<std::string, double> kPart = {{"m", 1},
                                                        {"s", 1},
                                                        {"g", 0.001},
                                                        {"N", 1},
                                                        {"Pa", 1},
                                                        {"J", 1},
                                                        {"rad", 1},
                                                        {"l", 0.001},
                                                        {"t", 1000},
                                                        {"bar", 1e5},
                                                        {"sec", 1},
                                                        {"min", 60},
                                                        {"h", 3600},
                                                        {"deg", kPi / 180},
                                                        {"in", kInch},
                                                        {"inch", kInch},
                                                        {"ft", 12 * kInch},
                                                        {"yd", 36 * kInch},
                                                        {"mile", 63360 * kInch},
                                                        {"mil", kInch / 1000},
                                                        {"lb", kPound},
                                                        {"lbm", kPound},
                                                        {"oz", kPound / 16},
                                                        {"lbf", kPoundForce},
                                                        {"ozf", kPoundForce / 16},
                                                        {"kip", 1000 * kPoundForce},
                                                        {"kgf", 9.80665},
                                                        {"slug", kPoundForce / (12 * kInch)},
                                                        {"turn", 2 * kPi}};
    static const std::map<char, double> kTimes = {{'n', 1e-9}, {'u', 1e-6}, {'m', 1e-3},
                                                  {'c', 1e-2}, {'d', 1e-1}, {'k', 1e3},
                                                  {'M', 1e6},  {'G', 1e9}};
    static const std::map<std::string, std::string> kOtherName = {
        {"inches", "in"},      {"feet", "ft"},        {"degrees", "deg"},  {"\u00b0", "deg"},
        {"\u00b5m", "um"},     {"\u03bcm", "um"},     {"\u00b5s", "us"},   {"\u03bcs", "us"},
        {"\u00b5m/s", "um/s"}, {"\u03bcm/s", "um/s"}, {"psi", "lbf/in2"},  {"ksi", "kip/in2"},
        {"psf", "lbf/ft2"},    {"mph", "mile/h"},     {"rpm", "turn/min"}, {"Nm", "N m"},
        {"kNm", "kN m"},       {"Nmm", "N mm"},       {"turns", "turn"},   {"turns/s", "turn/s"}};
    const auto value_of = [](const std::string& part) {
        const auto known = kPart.find(part);
        return known != kPart.end() ? known->second : kTimes.at(part[0]) * kPart.at(part.substr(1));
    };
    if (kOtherName.contains(name)) name = kOtherName.at(name);
    const bool is_weight = quantity == Quantity::torque || quantity == Quantity::toughness;
    const std::size_t stroke = std::min(name.find('/'), name.size());
    std::istringstream above(name.substr(0, stroke)),
        below(stroke < name.size() ? name.substr(stroke + 1) : "");
    double value = 1;
    for (std::istringstream* parts : {&above, &below}) {
        for (std::string part; *parts >> part;) {
            int power = 1;
            if (part.back() == '2' || part.back() == '3')
                power = part.back() - '0', part.pop_back();
            if (is_weight && (part == "lb" || part == "oz")) part += 'f';
            for (; power > 0; --power) {
                value = parts == &above ? value * value_of(part) : value / value_of(part);
            }
        }
    }
    return value;
}

}  // namespace

TEST_CASE("a unit is what the parts of its name make together") {
    for (const std::string& name : quantity_names()) {
        const Quantity quantity = *quantity_named(name);
        for (const std::string& unit : unit_names(quantity)) {
            CAPTURE(unit);
            CHECK(parse_quantity("1 " + unit, quantity) ==
                  Approx(by_its_parts(unit, quantity)).epsilon(1e-14));
        }
    }
}

TEST_CASE("shown quantities use a unit that reads well, and read back") {
    CHECK(quantity_text(0.18, Quantity::length) == "18 cm");
    CHECK(quantity_text(0.005, Quantity::length) == "5 mm");
    CHECK(quantity_text(0.01, Quantity::length) == "1 cm");
    CHECK(quantity_text(0.06 - 0.05, Quantity::length) == "1 cm");  // less, by rounding
    CHECK(quantity_text(0, Quantity::length) == "0 m");
    CHECK(quantity_text(-0.3, Quantity::length) == "-30 cm");
    CHECK(quantity_text(210e9, Quantity::stress) == "210 GPa");
    CHECK(quantity_text(kPi / 3, Quantity::angle) == "60 deg");
    CHECK(quantity_text(0, Quantity::angle) == "0 deg");
    CHECK(quantity_text(0.3, Quantity::number) == "0.3");
    CHECK(quantity_text(7800, Quantity::density) == "7800 kg/m3");
    CHECK(quantity_text(std::numeric_limits<double>::infinity(), Quantity::stress) == "infinite");
    for (const std::string& name : quantity_names()) {
        const Quantity quantity = *quantity_named(name);
        for (double value : {3.25e-8, 1.5e-3, 0.75, 12.5, 4.5e7}) {
            const std::string text = quantity_text(value, quantity);
            INFO(text);
            CHECK(parse_quantity(text, quantity) == Approx(value).epsilon(1e-5));
        }
    }
}

TEST_CASE("what rounding alone puts beyond the end of a range is nearly in it") {
    const Range range{0.1, 3 * 0.1};
    CHECK_FALSE(range.holds(std::nextafter(0.1, 0)));
    CHECK(range.nearly_holds(std::nextafter(0.1, 0)));
    CHECK(range.nearly_holds(3 * 0.1 + 1e-16));
    CHECK_FALSE(range.nearly_holds(0.0999));
    CHECK_FALSE(range.nearly_holds(0.3001));
    const Range from_none{0, 1};
    CHECK(from_none.nearly_holds(-1e-16));
    CHECK_FALSE(from_none.nearly_holds(-1e-12));
}

TEST_CASE("no locale changes how numbers are read or shown") {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) std::setlocale(LC_ALL, "C.UTF-8");
    CHECK(parse_quantity("1.5 mm", Quantity::length) == Approx(0.0015));
    CHECK(quantity_text(0.0015, Quantity::length) == "1.5 mm");
    std::setlocale(LC_ALL, before.c_str());
}

TEST_CASE("a mistyped word finds what it was meant to be") {
    const std::vector<std::string> known = {"young_modulus", "poisson_ratio", "density",
                                            "yield_stress",  "damping_ratio", "friction"};
    CHECK(nearest_word("yeild", known) == "yield_stress");
    CHECK(nearest_word("yield", known) == "yield_stress");
    CHECK(nearest_word("yungs_modulus", known) == "young_modulus");
    CHECK(nearest_word("Density", known) == "density");
    CHECK(nearest_word("frictoin", known) == "friction");
    CHECK(nearest_word("colour", known).empty());
    CHECK(nearest_word("x", {"y", "z"}).empty());
    CHECK(nearest_word("", known).empty());
    CHECK(nearest_word(std::string(100000, 'a'), known).empty());
    CHECK(did_you_mean("densty", known) == ", did you mean \"density\"?");
    CHECK(hint_and(", did you mean \"density\"?", "expected one") ==
          ", did you mean \"density\"? Expected one");
    CHECK(hint_and("", "expected one") == "; expected one");
    CHECK(hint_and("", "") == "; ");
    CHECK(edit_distance("abcd", "abdc") == 1);
    CHECK(edit_distance("", "abc") == 3);
}

TEST_CASE("what no scene can mean is told with the range, and what the extremes take is not") {
    CHECK(why_not_meant(1e300, Quantity::length) ==
          "1e+300 m is out of range: it must be -1e+07 m to 1e+07 m");
    CHECK(why_not_meant(1e-320, Quantity::length, true).find("it must be 1 nm to 1e+07 m") !=
          std::string::npos);
    CHECK(why_not_meant(1e-320, Quantity::length).empty());  // 0 but for rounding
    CHECK(why_not_meant(-1e-6, Quantity::length, true).find("-1 um is out of range") == 0);
    CHECK_FALSE(why_not_meant(NAN, Quantity::angle).empty());
    for (const std::string& name : quantity_names()) {
        INFO(name);
        const Quantity quantity = *quantity_named(name);
        CHECK_FALSE(why_not_meant(1e160, quantity).empty());
        CHECK_FALSE(why_not_meant(-1e160, quantity).empty());
        for (const double value : {-1e6, 0.0, 1e-6, 1e6})
            CHECK(why_not_meant(value, quantity).empty());
        CHECK(why_not_meant(1e-6, quantity, true).empty());
    }
    CHECK(why_not_meant(1e13, Quantity::stress, true).empty());
}

TEST_CASE("one quantity is one number, in whatever decimal unit it is written") {
    for (int n = 1; n < 10000; n += 7) {
        const double m = parse_quantity(fmt::format("{}e-4 m", n), Quantity::length);
        CAPTURE(n);
        CHECK(m == std::stod(fmt::format("{}e-4", n)));
        CHECK(parse_quantity(fmt::format("{}.{:02d} cm", n / 100, n % 100), Quantity::length) == m);
        CHECK(parse_quantity(fmt::format("{}.{} mm", n / 10, n % 10), Quantity::length) == m);
        CHECK(parse_quantity(fmt::format("-{}E+2 um", n), Quantity::length) == -m);
        CHECK(parse_quantity(fmt::format("{}e-7 km", n), Quantity::length) == m);
        CHECK(parse_quantity(fmt::format("{}.{:02d} GPa", n / 100, n % 100), Quantity::stress) ==
              parse_quantity(fmt::format("{}0 MPa", n), Quantity::stress));
    }
    CHECK(parse_quantity("0 mm", Quantity::length) == 0);
    CHECK(parse_quantity("5. mm", Quantity::length) == 0.005);
    CHECK(parse_quantity(".5 mm", Quantity::length) == 0.0005);
    CHECK(mistake_of("1e308 km", Quantity::length) == "0: \"1e308 km\" is too large");
    CHECK(parse_quantity("1e-320 mm", Quantity::length) < 1e-320);
}

TEST_CASE(
    "an inch, a foot, a pound and a minute are the decimal numbers that they are defined as") {
    const auto same = [](const std::string& left, const std::string& right, Quantity quantity) {
        CAPTURE(left, right);
        CHECK(parse_quantity(left, quantity) == parse_quantity(right, quantity));
    };
    for (long n = 1; n < 3000; n += 7) {
        const auto tenths = [n](long times) {  // n / 10 of so many
            return fmt::format("{}.{}", n * times / 10, n * times % 10);
        };
        same(tenths(1) + " in", tenths(254) + "e-1 mm", Quantity::length);
        same(tenths(1) + " ft", tenths(3048) + "e-4 m", Quantity::length);
        same("-" + tenths(1) + " ft", "-" + tenths(12) + " in", Quantity::length);
        same(tenths(1) + " yd", tenths(3) + " ft", Quantity::length);
        same(fmt::format("{} mil", n), fmt::format("{}e-3 in", n), Quantity::length);
        same(tenths(1) + " mph", tenths(44704) + "e-5 m/s", Quantity::speed);
        same(tenths(18) + " km/h", tenths(5) + " m/s", Quantity::speed);
        same(tenths(1) + " ft/s2", tenths(3048) + "e-4 m/s2", Quantity::acceleration);
        same(tenths(1) + " min", tenths(60) + " s", Quantity::time);
        same(tenths(1) + " lb", fmt::format("{}e-9 kg", 45359237 * n), Quantity::mass);
        same(tenths(1) + " lb", tenths(16) + " oz", Quantity::mass);
        same(tenths(1) + " kgf", fmt::format("{}e-6 N", 980665 * n), Quantity::force);
        same(tenths(1) + " kip", fmt::format("{}00 lbf", n), Quantity::force);
        same(tenths(1) + " lbf ft", tenths(192) + " ozf in", Quantity::torque);
        same(tenths(1) + " ksi", fmt::format("{}e2 psi", n), Quantity::stress);
        same(tenths(1) + " psi", tenths(144) + " psf", Quantity::stress);
        same(tenths(1728) + " lb/ft3", fmt::format("{}e-1 lb/in3", n), Quantity::density);
        same(tenths(1) + " lbf/in", tenths(12) + " ft lb/ft2", Quantity::toughness);
    }
    CHECK(parse_quantity("3 in", Quantity::length) == 0.0762);
    CHECK(parse_quantity("1 ft", Quantity::length) == 0.3048);
    CHECK(parse_quantity("0 ft", Quantity::length) == 0);
    CHECK(mistake_of("1e308 mph", Quantity::speed) == "none");
    CHECK(mistake_of("1e308 yd", Quantity::length) == "none");
    CHECK(mistake_of("1e308 min", Quantity::time) == "0: \"1e308 min\" is too large");
    CHECK(parse_quantity("1e-320 ft", Quantity::length) < 1e-320);
}

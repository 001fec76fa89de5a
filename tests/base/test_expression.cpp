// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "base/expression.h"
#include "base/math.h"
#include "tests/catch.h"

using namespace swage;

namespace {

std::string mistake_of(const std::string& text, const std::vector<std::string>& variables = {}) {
    try {
        const Formula formula(text, variables);
        formula.evaluate(std::vector<double>(variables.size(), 0.0));
    } catch (const TextError& error) {
        return fmt::format("{}: {}", error.at(), error.what());
    }
    return "none";
}

double value_of(const std::string& text) { return evaluate_text(text, {}); }

}  // namespace

TEST_CASE("an expression computes as mathematics does") {
    CHECK(value_of("1 + 2*3") == 7);
    CHECK(value_of("(1 + 2)*3") == 9);
    CHECK(value_of("-2^2") == -4);
    CHECK(value_of("2^3^2") == 512);
    CHECK(value_of("10 - 4 - 3") == 3);
    CHECK(value_of("10/4/5") == 0.5);
    CHECK(value_of("1e-3 + .5") == 0.501);
    CHECK(value_of("3 > 2 && 1 <= 1 ? 5 : 6") == 5);
    CHECK(value_of("(2 > 3)*7") == 0);
    CHECK(value_of("min(3, 1, 2) + max(4, 6)") == 7);
    CHECK(value_of("clamp(5, 0, 1) + clamp(-5, 0, 1) + abs(-2)") == 3);
    CHECK(value_of("sin(pi/2) + atan2(0, 1)") == 1);
    CHECK(value_of("hypot(3, 4) + mod(7, 4) + pow(2, 3)") == 16);
    CHECK_FALSE(std::signbit(value_of("-0")));
}

TEST_CASE("only two values can be compared, but in brackets or beside others") {
    const char* one = "only two values can be compared: write a < b && b < c, or use brackets";
    CHECK(mistake_of("1 < 2 < 3") == fmt::format("6: {}", one));
    CHECK(mistake_of("0 <= t && t <= 1 == 1", {"t"}) == fmt::format("17: {}", one));
    CHECK(mistake_of("min(1, 0 < 2 > 1)") == fmt::format("13: {}", one));
    CHECK(value_of("1 < 2 && 2 < 3 || 4 < 3") == 1);
    CHECK(value_of("(1 < 2) == (2 < 3)") == 1);
    CHECK(value_of("1 < 2 ? 3 > 4 : 5 > 6") == 0);
    CHECK(value_of("max(1 < 2, 2 < 3)") == 1);
}

TEST_CASE("a power is to the last bit the same in both ways to write it") {
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> draw(0, 4);
    for (int n = 0; n < 2000; ++n) {
        const double x = draw(engine), y = draw(engine);
        CHECK(evaluate_text("x ^ y", {{"x", x}, {"y", y}}) ==
              evaluate_text("pow(x, y)", {{"x", x}, {"y", y}}));
        CHECK(evaluate_text("x^2", {{"x", x}}) == x * x);
    }
}

TEST_CASE("a number in an expression may carry a unit") {
    CHECK(evaluate_text("2*radius + 3 mm", {{"radius", 0.1}}) == Approx(0.203).epsilon(1e-15));
    CHECK(value_of("60 deg") == Approx(kPi / 3).epsilon(1e-15));
    CHECK(value_of("-60deg") == Approx(-kPi / 3).epsilon(1e-15));
    CHECK(value_of("2*(3 cm)^2") == Approx(2 * 9e-4).epsilon(1e-15));
    CHECK(value_of("5 m/s^2 + 1 kg/m^3") == 6);
    CHECK(value_of("5 mm/s") == 0.005);
    CHECK(value_of("50 %") == 0.5);
    // After a number without a unit, a variable is never taken for one.
    CHECK(evaluate_text("3*t", {{"t", 2}}) == 6);
}

TEST_CASE("a variable named as a unit is refused after a number, not read as that unit") {
    const std::vector<std::string> variables = {"t", "min", "in"};
    CHECK(mistake_of("2 t", variables) ==
          "2: an operator is missing before \"t\"; to multiply write 2*t");
    CHECK(mistake_of("1 - 2 t", variables) ==
          "6: an operator is missing before \"t\"; to multiply write 2*t");
    CHECK(mistake_of("7 t/m3", variables) ==
          "2: an operator is missing before \"t\"; to multiply write 7*t");
    CHECK(mistake_of("3in", variables) ==
          "1: an operator is missing before \"in\"; to multiply write 3*in");
    CHECK(value_of("2 t") == 2000);   // where no variable has the name
    CHECK(value_of("5 min") == 300);  // nor is the unit taken for the function
}

TEST_CASE("a power of a number with a unit is refused, as it may be read in two ways") {
    const char* either = "this could raise 3 cm or only the unit: write (3 cm)^... or 3*(1 cm)^...";
    CHECK(mistake_of("3 cm^2") == fmt::format("4: {}", either));
    CHECK(mistake_of("1 + 3cm ^ 2") == fmt::format("8: {}", either));
    CHECK(value_of("(3 cm)^2") == Approx(9e-4).epsilon(1e-15));
    CHECK(value_of("3*(1 cm)^2") == Approx(3e-4).epsilon(1e-15));
}

TEST_CASE("a ramp rises smoothly from 0 to 1 and never leaves them") {
    const Formula ramp("ramp(t, 0.2, 0.7)", {"t"});
    const auto at = [&](double t) { return ramp.evaluate(std::vector<double>{t}); };
    CHECK(at(0) == 0);
    CHECK(at(0.2) == 0);
    CHECK(at(0.45) == Approx(0.5));
    CHECK(at(0.7) == 1);
    CHECK(at(1) == 1);
    const double slope = (at(0.45 + 1e-6) - at(0.45 - 1e-6)) / 2e-6;
    CHECK(slope == Approx(1.5 / 0.5).epsilon(1e-6));
    CHECK((at(0.2 + 1e-5) - at(0.2)) / 1e-5 < 1e-3);
    CHECK((at(0.7) - at(0.7 - 1e-5)) / 1e-5 < 1e-3);
    for (double t = 0, last = 0; t <= 1; t += 0.01) {
        CHECK(at(t) >= last);
        last = at(t);
    }
    // Without width it is a step, never 0/0.
    CHECK(value_of("ramp(0.3, 0.3, 0.3)") == 1);
    CHECK(value_of("ramp(0.2, 0.3, 0.3)") == 0);
    CHECK(value_of("ramp(0.4, 0.3, 0.3)") == 1);
    CHECK(value_of("ramp(0.4, 0.5, 0.3)") == 0);
    CHECK(value_of("line(0.3, 0.2, 0.6)") == Approx(0.25));
    CHECK(value_of("step(0.3, 0.3) - step(0.2, 0.3)") == 1);
}

TEST_CASE("a mistake in an expression is named at its place") {
    struct Bad {
        const char* text;
        const char* mistake;  // how it begins
    };
    const Bad bad[] = {
        {"", "0: the expression is empty"},
        {"  ", "0: the expression is empty"},
        {"2*radus", "2: unknown name \"radus\", did you mean \"radius\"?"},
        {"2*q", "2: unknown name \"q\""},
        {"rmap(t, 0, 1)", "0: unknown function \"rmap\", did you mean \"ramp\"?"},
        {"1 + min", "4: the function min needs brackets: min(a, b, ...)"},
        {"radius(2)", "0: \"radius\" is not a function; to multiply write radius*(...)"},
        {"2 radius", "2: an operator is missing before \"radius\"; to multiply write 2*radius"},
        {"2 parsec", "2: unknown unit \"parsec\""},
        {"1,5*radius",
         "1: a comma can only separate the arguments of a function; the decimal sign is a point"},
        {"(1,5)",
         "2: a comma can only separate the arguments of a function; the decimal sign is a point"},
        {"min(1,(2,3))",
         "8: a comma can only separate the arguments of a function; the decimal sign is a point"},
        {"radius = 3", "7: a single = has no meaning here; to compare write =="},
        {"(1 + 2", "0: this bracket is not closed"},
        {"1 + 2)", "5: this bracket was never opened"},
        {"1 +", "3: the expression ends too early"},
        {"-", "1: the expression ends too early"},
        {"1 - -", "5: the expression ends too early"},
        {"max(-, 1)", "4: the operator \"-\" lacks an operand"},
        {"t ? + : 2", "4: the operator \"+\" lacks an operand"},
        {"1 + * 2", "4: the operator \"*\" lacks an operand"},
        {"radius t", "7: an operator is missing before this"},
        {"1 2", "2: an operator is missing before this"},
        {"radius 2", "7: an operator is missing before this"},
        {"3 mm 2 cm", "5: an operator is missing before this"},
        {"1 cm 5", "5: an operator is missing before this"},
        {"1 cm (5)", "5: an operator is missing before this"},
        {"(1)(2)", "3: an operator is missing before this"},
        {"2*(t + )", "7: a bracket does not belong here"},
        {"2*() + 1", "3: a bracket does not belong here"},
        {"ramp(t, 1)", "9: too few arguments: ramp(t, a, b)"},
        {"sin(t, 1)", "8: too many arguments: sin(x)"},
        {"max()", "5: too few"},
        {"t ? 1", "5: a ? needs a : after it"},
        {"1 : 2", "3: this : has no ?"},
        {"\"a\"", "0: \"\"\" does not belong"},
        {"1 & 2", "2: \"&\" does not belong"},
        {"1e999", "0: \"1e999\" is too large"},
        {"t + 0x1F", "4: \"0x1F\" is hexadecimal"},
        {"nan", "0: unknown name \"nan\""},
        {"1/t", "0: the expression does not give a finite number"},
        {"sqrt(t - 1)", "0: the expression does not give a finite number"},
        {"l\u00e4nge", "0: unknown name"},
    };
    for (const Bad& one : bad) {
        INFO(one.text);
        const std::string mistake = mistake_of(one.text, {"radius", "t"});
        INFO(mistake);
        CHECK(mistake.rfind(one.mistake, 0) == 0);
    }
    CHECK(mistake_of(std::string(5000, '1')).find("too long") != std::string::npos);
    for (const std::string open : {"(", "abs("}) {
        std::string deep;
        for (int n = 0; n < 400; ++n) deep += open;
        CHECK(mistake_of(deep + "1" + std::string(400, ')')).find("nested too deeply") !=
              std::string::npos);
    }
}

TEST_CASE("a formula tells which variables it uses") {
    const Formula formula("a + 2*c", {"a", "b", "c"});
    CHECK(formula.used() == std::vector<std::string>{"a", "c"});
    CHECK_FALSE(formula.is_constant());
    CHECK(Formula("60 deg", {"deg_offset"}).is_constant());
    CHECK(formula.evaluate(std::vector<double>{1, NAN, 3}) == 7);  // b has no say
    CHECK_THROWS_AS(formula.evaluate(std::vector<double>{1, 2}), TextError);
}

TEST_CASE("a formula evaluates the same from many threads at once") {
    const Formula formula("a*ramp(t, 0, 1) + sin(t)", {"a", "t"});
    std::vector<int> wrong(4, 0);
    std::vector<std::thread> thread;
    for (std::size_t n = 0; n < wrong.size(); ++n) {
        thread.emplace_back([&, n] {
            for (int i = 0; i < 5000; ++i) {
                const double t = i / 5000.0, a = static_cast<double>(n);
                const double s = t * t * (3 - 2 * t);
                const double value = formula.evaluate(std::vector<double>{a, t});
                if (std::abs(value - (a * s + std::sin(t))) > 1e-12) ++wrong[n];
            }
        });
    }
    for (std::thread& one : thread) one.join();
    CHECK(wrong == std::vector<int>(4, 0));
}

TEST_CASE("names of functions, constants and units are not for variables") {
    CHECK(is_reserved_name("ramp"));
    CHECK(is_reserved_name("pi"));
    CHECK(is_reserved_name("mm"));
    CHECK_FALSE(is_reserved_name("radius"));
    CHECK_FALSE(is_reserved_name("hold"));
}

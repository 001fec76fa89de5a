// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "base/ascii.h"
#include "base/math.h"
#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

// times / over, the point moved by `power`: what most units are of SI, and no double is.
struct Ratio {
    std::uint64_t times, over = 1;
    int power = 0;

    friend constexpr Ratio operator*(std::uint64_t n, Ratio a) { return a * Ratio{n}; }
    friend constexpr Ratio operator*(Ratio a, Ratio b) {
        const std::uint64_t left = std::gcd(a.times, b.over), right = std::gcd(b.times, a.over);
        Ratio c{product(a.times / left, b.times / right), product(a.over / right, b.over / left),
                a.power + b.power};
        for (; c.times % 10 == 0; c.times /= 10) ++c.power;
        return c;
    }
    friend constexpr Ratio operator/(Ratio a, Ratio b) {
        return a * Ratio{b.over, b.times, -b.power};
    }
    friend constexpr Ratio operator/(Ratio a, std::uint64_t n) { return a / Ratio{n}; }

    // So small that ten times it can be counted; else this is no constant, and does not compile.
    static constexpr std::uint64_t product(std::uint64_t a, std::uint64_t b) {
        return a <= 1'000'000'000'000'000'000 / b ? a * b : throw std::overflow_error("a unit");
    }

    constexpr double value() const {
        double ten = 1;
        for (int n = 0; n < (power < 0 ? -power : power); ++n) ten *= 10;
        const double top = static_cast<double>(times), bottom = static_cast<double>(over);
        return power < 0 ? top / (bottom * ten) : top * ten / bottom;
    }
};

struct Unit {
    const char* name;
    Quantity quantity;
    double factor;       // to SI
    bool shown = false;  // used to show values; those of one quantity stand from large to small
    Ratio exact = {0};   // the factor, where it is neither a power of ten nor one of angles

    constexpr Unit(const char* n, Quantity q, double f, bool s = false)
        : name(n), quantity(q), factor(f), shown(s) {}
    constexpr Unit(const char* n, Quantity q, Ratio r)
        : name(n), quantity(q), factor(r.value()), exact(r) {}
};

constexpr Ratio kInch{254, 1, -4};
constexpr Ratio kPound{45359237, 1, -8};                      // [kg]
constexpr Ratio kPoundForce = Ratio{980665, 1, -5} * kPound;  // [N]
constexpr Ratio kSlug = kPoundForce / (12 * kInch);           // [kg], of 1 ft/s2 by 1 lbf
constexpr double kDegree = kPi / 180;

constexpr Unit kUnits[] = {
    {"m", Quantity::length, 1, true},
    {"cm", Quantity::length, 1e-2, true},
    {"mm", Quantity::length, 1e-3, true},
    {"um", Quantity::length, 1e-6, true},
    {"nm", Quantity::length, 1e-9, true},
    {"km", Quantity::length, 1e3},
    {"dm", Quantity::length, 1e-1},
    {"\u00b5m", Quantity::length, 1e-6},
    {"\u03bcm", Quantity::length, 1e-6},
    {"in", Quantity::length, kInch},
    {"inch", Quantity::length, kInch},
    {"inches", Quantity::length, kInch},
    {"ft", Quantity::length, 12 * kInch},
    {"feet", Quantity::length, 12 * kInch},
    {"yd", Quantity::length, 36 * kInch},
    {"mil", Quantity::length, kInch / 1000},
    {"deg", Quantity::angle, kDegree, true},
    {"rad", Quantity::angle, 1},
    {"mrad", Quantity::angle, 1e-3},
    {"turn", Quantity::angle, 2 * kPi},
    {"turns", Quantity::angle, 2 * kPi},
    {"\u00b0", Quantity::angle, kDegree},
    {"degrees", Quantity::angle, kDegree},
    {"s", Quantity::time, 1, true},
    {"ms", Quantity::time, 1e-3, true},
    {"us", Quantity::time, 1e-6, true},
    {"\u00b5s", Quantity::time, 1e-6},
    {"\u03bcs", Quantity::time, 1e-6},
    {"sec", Quantity::time, 1},
    {"min", Quantity::time, Ratio{60}},
    {"h", Quantity::time, Ratio{3600}},
    {"m/s", Quantity::speed, 1, true},
    {"mm/s", Quantity::speed, 1e-3, true},
    {"um/s", Quantity::speed, 1e-6, true},
    {"\u00b5m/s", Quantity::speed, 1e-6},
    {"\u03bcm/s", Quantity::speed, 1e-6},
    {"cm/s", Quantity::speed, 1e-2},
    {"km/h", Quantity::speed, Ratio{10, 36}},
    {"in/s", Quantity::speed, kInch},
    {"ft/s", Quantity::speed, 12 * kInch},
    {"mph", Quantity::speed, 63360 * kInch / 3600},
    {"GPa", Quantity::stress, 1e9, true},
    {"MPa", Quantity::stress, 1e6, true},
    {"kPa", Quantity::stress, 1e3, true},
    {"Pa", Quantity::stress, 1, true},
    {"N/m2", Quantity::stress, 1},
    {"N/mm2", Quantity::stress, 1e6},
    {"bar", Quantity::stress, 1e5},
    {"psi", Quantity::stress, kPoundForce / (kInch * kInch)},
    {"ksi", Quantity::stress, 1000 * kPoundForce / (kInch * kInch)},
    {"lbf/in2", Quantity::stress, kPoundForce / (kInch * kInch)},
    {"lbf/ft2", Quantity::stress, kPoundForce / (144 * kInch * kInch)},
    {"kip/in2", Quantity::stress, 1000 * kPoundForce / (kInch * kInch)},
    {"kip/ft2", Quantity::stress, 1000 * kPoundForce / (144 * kInch * kInch)},
    {"psf", Quantity::stress, kPoundForce / (144 * kInch * kInch)},
    {"kg/m3", Quantity::density, 1, true},
    {"g/cm3", Quantity::density, 1e3},
    {"kg/dm3", Quantity::density, 1e3},
    {"kg/l", Quantity::density, 1e3},
    {"t/m3", Quantity::density, 1e3},
    {"lb/in3", Quantity::density, kPound / (kInch * kInch * kInch)},
    {"lb/ft3", Quantity::density, kPound / (1728 * kInch * kInch * kInch)},
    {"lbm/in3", Quantity::density, kPound / (kInch * kInch * kInch)},
    {"lbm/ft3", Quantity::density, kPound / (1728 * kInch * kInch * kInch)},
    {"oz/in3", Quantity::density, kPound / 16 / (kInch * kInch * kInch)},
    {"slug/ft3", Quantity::density, kSlug / (1728 * kInch * kInch * kInch)},
    {"kg", Quantity::mass, 1, true},
    {"g", Quantity::mass, 1e-3, true},
    {"mg", Quantity::mass, 1e-6, true},
    {"t", Quantity::mass, 1e3},
    {"lb", Quantity::mass, kPound},
    {"lbm", Quantity::mass, kPound},
    {"slug", Quantity::mass, kSlug},
    {"oz", Quantity::mass, kPound / 16},
    {"MN", Quantity::force, 1e6, true},
    {"kN", Quantity::force, 1e3, true},
    {"N", Quantity::force, 1, true},
    {"mN", Quantity::force, 1e-3, true},
    {"kgf", Quantity::force, Ratio{980665, 1, -5}},
    {"lbf", Quantity::force, kPoundForce},
    {"ozf", Quantity::force, kPoundForce / 16},
    {"kip", Quantity::force, 1000 * kPoundForce},
    {"kN m", Quantity::torque, 1e3, true},
    {"N m", Quantity::torque, 1, true},
    {"N mm", Quantity::torque, 1e-3, true},
    {"kNm", Quantity::torque, 1e3},
    {"Nm", Quantity::torque, 1},
    {"Nmm", Quantity::torque, 1e-3},
    {"lbf in", Quantity::torque, kInch * kPoundForce},
    {"lbf ft", Quantity::torque, 12 * kInch * kPoundForce},
    {"in lbf", Quantity::torque, kInch * kPoundForce},
    {"ft lbf", Quantity::torque, 12 * kInch * kPoundForce},
    {"in lb", Quantity::torque, kInch * kPoundForce},
    {"ft lb", Quantity::torque, 12 * kInch * kPoundForce},
    {"lb in", Quantity::torque, kInch * kPoundForce},
    {"lb ft", Quantity::torque, 12 * kInch * kPoundForce},
    {"oz in", Quantity::torque, kInch * kPoundForce / 16},
    {"ozf in", Quantity::torque, kInch * kPoundForce / 16},
    {"kip in", Quantity::torque, 1000 * kInch * kPoundForce},
    {"kip ft", Quantity::torque, 12000 * kInch * kPoundForce},
    {"m/s2", Quantity::acceleration, 1, true},
    {"mm/s2", Quantity::acceleration, 1e-3},
    {"in/s2", Quantity::acceleration, kInch},
    {"ft/s2", Quantity::acceleration, 12 * kInch},
    {"kJ/m2", Quantity::toughness, 1e3, true},
    {"J/m2", Quantity::toughness, 1, true},
    {"N/m", Quantity::toughness, 1},
    {"N/mm", Quantity::toughness, 1e3},
    {"lbf/in", Quantity::toughness, kPoundForce / kInch},
    {"in lb/in2", Quantity::toughness, kPoundForce / kInch},
    {"in lbf/in2", Quantity::toughness, kPoundForce / kInch},
    {"ft lb/in2", Quantity::toughness, 12 * kPoundForce / kInch},
    {"ft lbf/in2", Quantity::toughness, 12 * kPoundForce / kInch},
    {"ft lb/ft2", Quantity::toughness, kPoundForce / (12 * kInch)},
    {"ft lbf/ft2", Quantity::toughness, kPoundForce / (12 * kInch)},
    {"kPa s/m", Quantity::drag, 1e3, true},
    {"Pa s/m", Quantity::drag, 1, true},
    {"mPa s/m", Quantity::drag, 1e-3, true},
    {"N s/m3", Quantity::drag, 1},
    {"rad/s", Quantity::spin, 1, true},
    {"deg/s", Quantity::spin, kDegree},
    {"rpm", Quantity::spin, 2 * kPi / 60},
    {"turns/s", Quantity::spin, 2 * kPi},
    {"%", Quantity::number, 1e-2},
};

struct QuantityName {
    Quantity quantity;
    const char* name;
    const char* si;
    const char* with_article;
    double least, most;  // that can be meant: of what has to be more than 0, of any size
};

// Far beyond all scenes, and as far from where numbers, or what is computed of them, end.
constexpr QuantityName kQuantities[] = {
    {Quantity::number, "number", "", "a plain number", 0, 1e15},
    {Quantity::length, "length", "m", "a length", 1e-9, 1e7},
    {Quantity::angle, "angle", "rad", "an angle", 0, 2e6 * kPi},
    {Quantity::time, "time", "s", "a time", 1e-12, 1e9},
    {Quantity::speed, "speed", "m/s", "a speed", 0, 1e9},
    {Quantity::stress, "stress", "Pa", "a stress", 1e-9, 1e15},
    {Quantity::density, "density", "kg/m3", "a density", 1e-6, 1e9},
    {Quantity::mass, "mass", "kg", "a mass", 1e-18, 1e15},
    {Quantity::force, "force", "N", "a force", 0, 1e15},
    {Quantity::acceleration, "acceleration", "m/s2", "an acceleration", 0, 1e9},
    {Quantity::toughness, "toughness", "J/m2", "a toughness", 1e-12, 1e12},
    {Quantity::drag, "drag", "Pa s/m", "a drag", 0, 1e15},
    {Quantity::spin, "spin", "rad/s", "a spin", 0, 1e9},
    {Quantity::torque, "torque", "N m", "a torque", 0, 1e15},
};

const QuantityName& about(Quantity quantity) {
    return *std::find_if(std::begin(kQuantities), std::end(kQuantities),
                         [&](const QuantityName& one) { return one.quantity == quantity; });
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

// Bytes of `text` that spell `unit`, where the text may write m2 as m^2 or with a raised digit, and
// N m with a dot or a hyphen.
std::size_t spelled(std::string_view text, std::string_view unit) {
    std::size_t at = 0;
    for (char letter : unit) {
        const std::string_view rest = text.substr(at);
        if (letter == '2' && rest.starts_with("\u00b2")) {
            at += 2;
        } else if (letter == '3' && rest.starts_with("\u00b3")) {
            at += 2;
        } else if (letter == ' ' && rest.starts_with("\u00b7")) {
            at += 2;
        } else if (letter == ' ' && rest.starts_with("\u22c5")) {
            at += 3;
        } else if (letter == ' ' && rest.starts_with('-')) {
            at += 1;
        } else if (is_digit(letter) && rest.size() > 1 && rest[0] == '^' && rest[1] == letter) {
            at += 2;
        } else if (!rest.empty() && rest[0] == letter) {
            at += 1;
        } else {
            return 0;
        }
    }
    return at;
}

// "m (also cm, mm, um, nm, ...)"
std::string wanted_text(Quantity wanted) {
    if (wanted == Quantity::number) return "expected a plain number";
    std::vector<std::string> names = unit_names(wanted);
    if (names.size() > 4) {
        names.resize(4);
        names.push_back("...");
    }
    return fmt::format("expected {} ({})", about(wanted).with_article, joined(names, ", "));
}

// The decimal number `digits` * times / over, its point moved by `power`.
std::string scaled(std::string digits, const Ratio& by, int power) {
    std::uint64_t carry = 0;
    for (std::size_t n = digits.size(); n-- > 0; carry /= 10) {
        carry += static_cast<std::uint64_t>(digits[n] - '0') * by.times;
        digits[n] = static_cast<char>('0' + carry % 10);
    }
    if (carry > 0) digits.insert(0, fmt::format("{}", carry));
    if (by.over > 1) {
        constexpr int kMore = 60;  // more than make out to which double it is next
        digits.append(kMore, '0');
        power -= kMore;
        std::uint64_t rest = 0;
        for (char& digit : digits) {
            rest = 10 * rest + static_cast<std::uint64_t>(digit - '0');
            digit = static_cast<char>('0' + rest / by.over);
            rest %= by.over;
        }
        if (rest > 0) digits.back() = std::max(digits.back(), '1');  // nor a tie, if it goes on
    }
    return fmt::format("{}e{}", digits, power);
}

[[noreturn]] void refuse(std::size_t at, const std::string& sentence) {
    throw TextError(at, sentence);
}

// "1,5 cm": says so when `text`, whose number ends at `comma`, goes on as a decimal comma does.
void refuse_decimal_comma(std::string_view text, std::size_t comma) {
    if (comma + 1 >= text.size() || text[comma] != ',' || !is_digit(text[comma + 1])) return;
    std::string meant(text);
    meant[comma] = '.';
    refuse(comma, fmt::format("\"{}\" has a decimal comma; write \"{}\"", text, meant));
}

}  // namespace

std::string quantity_name(Quantity quantity) { return about(quantity).name; }

std::string quantity_with_article(Quantity quantity) { return about(quantity).with_article; }

std::optional<Quantity> quantity_named(std::string_view name) {
    for (const QuantityName& one : kQuantities) {
        if (name == one.name) return one.quantity;
    }
    return std::nullopt;
}

std::vector<std::string> quantity_names() {
    std::vector<std::string> names;
    for (const QuantityName& one : kQuantities) names.emplace_back(one.name);
    return names;
}

std::string why_not_meant(double value, Quantity quantity, bool is_positive) {
    const double high = about(quantity).most, low = is_positive ? about(quantity).least : -high;
    if (value >= low && value <= high) return {};
    return fmt::format("{} is out of range: it must be {} to {}", quantity_text(value, quantity),
                       quantity_text(low, quantity), quantity_text(high, quantity));
}

std::string si_unit(Quantity quantity) { return about(quantity).si; }

std::vector<std::string> unit_names(Quantity quantity) {
    std::vector<std::string> names;
    for (const Unit& unit : kUnits) {
        if (unit.quantity == quantity && quantity != Quantity::number) {
            names.emplace_back(unit.name);
        }
    }
    return names;
}

std::optional<LeadingNumber> leading_number(std::string_view text) {
    const std::size_t sign = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
    const std::string_view digits = text.substr(sign);
    const bool begins =
        !digits.empty() &&
        (is_digit(digits[0]) || (digits.size() > 1 && digits[0] == '.' && is_digit(digits[1])));
    if (!begins) {
        // from_chars would also read these words; a unit or variable may begin with them.
        const std::size_t end = static_cast<std::size_t>(
            std::find_if_not(digits.begin(), digits.end(), goes_on_word) - digits.begin());
        const std::string_view word = digits.substr(0, end);
        if (edit_distance(word, "nan") == 0 || edit_distance(word, "inf") == 0 ||
            edit_distance(word, "infinity") == 0) {
            refuse(0, fmt::format("\"{}\" is not a finite number", word));
        }
        return std::nullopt;
    }
    if (digits.size() > 1 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')) {
        refuse(0, fmt::format("\"{}\" is hexadecimal; write a decimal number", text));
    }
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const std::size_t size = static_cast<std::size_t>(end - digits.data());
    if (error == std::errc::result_out_of_range) {
        // Either way out of range: what is too small is 0 for every purpose here.
        const std::string_view number = digits.substr(0, size);
        const std::size_t exponent = number.find_first_of("eE");
        const bool tiny = (exponent != std::string_view::npos && number[exponent + 1] == '-') ||
                          (exponent == std::string_view::npos && number[0] == '0');
        if (!tiny) refuse(0, fmt::format("\"{}\" is too large for a number", number));
        value = 0;
    }
    if (sign == 1 && text[0] == '-') value = -value;
    return LeadingNumber{value + 0.0, sign + size};  // + 0.0: -0 is 0
}

std::optional<LeadingUnit> leading_unit(std::string_view text) {
    std::optional<LeadingUnit> best;
    for (const Unit& unit : kUnits) {
        const std::size_t size = spelled(text, unit.name);
        if (size == 0 || (best && size <= best->size)) continue;
        if (size < text.size() && goes_on_word(text[size]) && unit.name[0] != '%') continue;
        best = LeadingUnit{unit.quantity, unit.factor, size};
    }
    return best;
}

double in_si(std::string_view number, const LeadingUnit& unit) {
    constexpr double kTenTo[] = {1e-9, 1e-6, 1e-3, 1e-2, 1e-1, 1e3, 1e5, 1e6, 1e9};
    constexpr int kPower[] = {-9, -6, -3, -2, -1, 3, 5, 6, 9};
    const double value = leading_number(number)->value;
    const double product = value * unit.factor;
    if (value == 0 || !std::isfinite(product)) return product;
    Ratio exact{1};
    const auto* const ten = std::find(std::begin(kTenTo), std::end(kTenTo), unit.factor);
    if (ten != std::end(kTenTo)) {
        exact.power = kPower[ten - std::begin(kTenTo)];
    } else {
        const Unit* const own = std::find_if(
            std::begin(kUnits), std::end(kUnits), [&](const Unit& one) {
                return one.quantity == unit.quantity && one.factor == unit.factor;
            });
        if (own == std::end(kUnits) || own->exact.times == 0) return product;
        exact = own->exact;
    }
    // By the digits, not by a product, which is rounded once more.
    const std::size_t e = std::min(number.find_first_of("eE"), number.size());
    std::string_view exponent = number.substr(std::min(e + 1, number.size()));
    if (exponent.starts_with('+')) exponent.remove_prefix(1);
    int power = 0;
    std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
    std::string digits;
    for (const char c : number.substr(0, e)) {
        if (is_digit(c)) digits += c;
    }
    const std::size_t point = number.substr(0, e).find('.');
    if (point != std::string_view::npos) power -= static_cast<int>(e - point - 1);
    power += exact.power;
    return leading_number(
               fmt::format("{}{}", value < 0 ? "-" : "", scaled(digits, exact, power)))->value;
}

double parse_quantity(std::string_view text, Quantity wanted) {
    std::size_t begin = 0, end = text.size();
    while (begin < end && is_blank(text[begin])) ++begin;
    while (end > begin && is_blank(text[end - 1])) --end;
    if (begin == end) refuse(0, "the text is empty; " + wanted_text(wanted));
    const std::string_view inner = text.substr(begin, end - begin);

    const std::optional<LeadingNumber> number = leading_number(inner);
    if (!number)
        refuse(begin, fmt::format("\"{}\" is not a number; {}", inner, wanted_text(wanted)));
    refuse_decimal_comma(inner, number->size);
    std::size_t at = number->size;
    while (at < inner.size() && is_blank(inner[at])) ++at;
    const std::string_view rest = inner.substr(at);
    if (rest.empty()) return number->value;

    if (std::string_view("+-*/^(").find(rest.front()) != std::string_view::npos) {
        refuse(begin + at,
               fmt::format("\"{}\" is an expression, which only machine files allow; {}", inner,
                           wanted_text(wanted)));
    }
    const std::optional<LeadingUnit> unit = leading_unit(rest);
    if (!unit || unit->size != rest.size()) {
        refuse(begin + at,
               fmt::format("unknown unit \"{}\"{}", rest,
                           hint_and(did_you_mean(rest, unit_names(wanted)), wanted_text(wanted))));
    }
    if (unit->quantity != wanted) {
        refuse(begin + at, fmt::format("\"{}\" is {}; {}", inner,
                                       about(unit->quantity).with_article, wanted_text(wanted)));
    }
    const double value = in_si(inner.substr(0, number->size), *unit);
    if (!std::isfinite(value)) refuse(begin, fmt::format("\"{}\" is too large", inner));
    return value;
}

std::string quantity_text(double value, Quantity quantity) {
    const std::string si = si_unit(quantity);
    const auto text = [](double number, const std::string& unit) {
        return fmt::format("{:.6g}{}{}", number + 0.0, unit.empty() ? "" : " ", unit);
    };
    if (!std::isfinite(value)) {
        return std::isnan(value) ? "not a number" : value > 0 ? "infinite" : "-infinite";
    }
    const Unit* smallest = nullptr;
    for (const Unit& unit : kUnits) {
        if (unit.quantity != quantity || !unit.shown) continue;
        smallest = &unit;
        if (std::abs(value) >= unit.factor * (1 - 1e-9)) break;
    }
    if (smallest == nullptr || (value == 0 && quantity != Quantity::angle)) return text(value, si);
    return text(value / smallest->factor, smallest->name);
}

bool Range::holds(double value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

bool Range::nearly_holds(double value) const {
    const double slack = 1e-9 * std::max(1e-6, std::abs(value));
    return Range{low - slack, high + slack, low_open, high_open}.holds(value);
}

std::string Range::text(Quantity quantity) const {
    const std::string from = quantity_text(low, quantity), to = quantity_text(high, quantity);
    if (std::isinf(high)) return (low_open ? "more than " : "at least ") + from;
    if (std::isinf(low)) return (high_open ? "less than " : "at most ") + to;
    if (low_open && high_open) return "between " + from + " and " + to + ", exclusive";
    if (low_open) return "more than " + from + ", at most " + to;
    if (high_open) return "at least " + from + ", less than " + to;
    return from + " to " + to;
}

}  // namespace swage

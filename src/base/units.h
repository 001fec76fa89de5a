// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities with units, as users write them: "18 cm", "210 GPa", "60 deg", "7.8 g/cm3". A bare
// number is SI. No locale has a say, ever: the decimal sign is a point.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text_error.h"

namespace swage {

enum class Quantity {
    number,
    length,        // [m]
    angle,         // [rad]
    time,          // [s]
    speed,         // [m/s]
    stress,        // [Pa]
    density,       // [kg/m3]
    mass,          // [kg]
    force,         // [N]
    acceleration,  // [m/s2]
    toughness,     // [J/m2]
    drag,          // of a surface [Pa s/m]
    spin,          // [rad/s]
    torque,        // [N m]
};

std::string quantity_name(Quantity quantity);          // "length"
std::string quantity_with_article(Quantity quantity);  // "a length"
std::optional<Quantity> quantity_named(std::string_view name);
std::vector<std::string> quantity_names();
std::string si_unit(Quantity quantity);  // "m"; a number's is empty
// The usual one first; none of a plain number.
std::vector<std::string> unit_names(Quantity quantity);

// Why the SI value is none that can be meant, as it is larger than that of any scene, or smaller
// where it has to be more than 0: "1e+300 m is out of range: it has to be -1e+07 m to 1e+07 m";
// empty: it can be.
std::string why_not_meant(double value, Quantity quantity, bool is_positive = false);

// The SI value of a text. Throws TextError: what is wrong, where, what is wanted.
double parse_quantity(std::string_view text, Quantity wanted);

// A number alone at the beginning of `text`: its value and how many bytes it takes. Nothing when
// there is none. Throws TextError for hexadecimal, nan, inf and what is too large.
struct LeadingNumber {
    double value;
    std::size_t size;
};
std::optional<LeadingNumber> leading_number(std::string_view text);

// The longest unit at the beginning of `text` ("mm/s" of "mm/s + 3"), which must not go on with a
// letter or digit.
struct LeadingUnit {
    Quantity quantity;
    double factor;  // to SI
    std::size_t size;
};
std::optional<LeadingUnit> leading_unit(std::string_view text);

// The SI value of a number as it is written, in this unit: 2.2 cm and 22 mm are the same double.
double in_si(std::string_view number, const LeadingUnit& unit);

// For people: 0.18 m is "18 cm", 2.1e11 Pa "210 GPa", angles are in degrees. Six digits.
std::string quantity_text(double value, Quantity quantity);

// Allowed values. An open end is itself not allowed.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;

    bool holds(double value) const;
    // A value computed to lie at an end may miss it by the last bits.
    bool nearly_holds(double value) const;
    // "more than 0 m", "1 mm to 2 cm", ...; `quantity` shows the ends.
    std::string text(Quantity quantity) const;
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/parameters.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/units.h"

namespace swage {

namespace {

// A value computed to lie at its limit may miss it by the last bits.
constexpr double kRangeSlack = 1e-9;

void check_range(const std::string& machine, const ParameterSpec& parameter, double value,
                 bool is_given, const Variables& known) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double low = parameter.low.empty() ? -kInfinity : evaluate(parameter.low, known);
    const double high = parameter.high.empty() ? kInfinity : evaluate(parameter.high, known);
    const double slack = kRangeSlack * std::max(1e-6, std::abs(value));
    if (value >= low - slack && value <= high + slack) return;
    const auto shown = [&](double v) { return quantity_text(v, parameter.quantity); };
    const std::string range = low == -kInfinity   ? "at most " + shown(high)
                              : high == kInfinity ? "at least " + shown(low)
                                                  : shown(low) + " to " + shown(high);
    throw ParameterError(
        parameter.name,
        fmt::format("machine {}: {}{} = {} is out of range: it may be {}", machine,
                    is_given ? "" : "the default of ", parameter.name, shown(value), range));
}

}  // namespace

Variables resolve_parameters(const MachineSpec& spec, const Variables& given,
                             const Variables& known) {
    for (const auto& [name, value] : given) {
        const bool exists = std::any_of(spec.parameter.begin(), spec.parameter.end(),
                                        [&](const auto& one) { return one.name == name; });
        if (!exists) {
            throw ParameterError(
                name, fmt::format("machine {}: it has no parameter {}", spec.name, name));
        }
    }
    Variables seen = known, resolved;
    for (const ParameterSpec& parameter : spec.parameter) {
        const auto found = given.find(parameter.name);
        const bool is_given = found != given.end();
        const double value = is_given ? found->second : evaluate(parameter.default_value, seen);
        check_range(spec.name, parameter, value, is_given, seen);
        seen[parameter.name] = value;
        resolved[parameter.name] = value;
    }
    return resolved;
}

}  // namespace swage

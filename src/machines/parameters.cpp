// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/units.h"

namespace swage {

namespace {

// A value computed to lie at its limit may miss it by the last bits.
constexpr double kRangeSlack = 1e-9;

struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();

    bool holds(double value) const {
        const double slack = kRangeSlack * std::max(1e-6, std::abs(value));
        return value >= low - slack && value <= high + slack;
    }
};

Range range_of(const ParameterSpec& parameter, const Variables& known) {
    Range range;
    if (!parameter.low.empty()) range.low = evaluate(parameter.low, known);
    if (!parameter.high.empty()) range.high = evaluate(parameter.high, known);
    return range;
}

ParameterMistake out_of_range(const std::string& machine, const ParameterSpec& parameter,
                              double value, const Range& range, bool is_given) {
    const auto shown = [&](double v) { return quantity_text(v, parameter.quantity); };
    const std::string allowed = std::isinf(range.low) ? "at most " + shown(range.high)
                                : std::isinf(range.high)
                                    ? "at least " + shown(range.low)
                                    : shown(range.low) + " to " + shown(range.high);
    return {parameter.name,
            fmt::format("machine {}: {}{} = {} is out of range: it may be {}", machine,
                        is_given ? "" : "the default of ", parameter.name, shown(value), allowed)};
}

}  // namespace

Variables resolve_parameters(const MachineSpec& spec, const Variables& given,
                             const Variables& known) {
    std::vector<ParameterMistake> mistakes;
    for (const auto& [name, value] : given) {
        const bool exists = std::any_of(spec.parameter.begin(), spec.parameter.end(),
                                        [&](const auto& one) { return one.name == name; });
        if (exists) continue;
        mistakes.push_back(
            {name, fmt::format("machine {}: it has no parameter {}", spec.name, name)});
    }
    Variables seen = known, resolved;
    for (const ParameterSpec& parameter : spec.parameter) {
        const auto found = given.find(parameter.name);
        const bool is_given = found != given.end();
        double value =
            is_given ? found->second : evaluate(parameter.default_value, seen, parameter.quantity);
        const Range range = range_of(parameter, seen);
        if (!range.holds(value)) {
            // What is wrong with a default after a mistake may only be that.
            if (is_given || mistakes.empty()) {
                mistakes.push_back(out_of_range(spec.name, parameter, value, range, is_given));
            }
            value = std::max(range.low, std::min(range.high, value));
        }
        seen[parameter.name] = value;
        resolved[parameter.name] = value;
    }
    if (!mistakes.empty()) throw ParameterError(std::move(mistakes));
    return resolved;
}

}  // namespace swage

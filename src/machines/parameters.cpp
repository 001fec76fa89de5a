// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/parameters.h"

#include <algorithm>

#include "base/error.h"
#include "base/units.h"

namespace swage {

namespace {

Range range_of(const ParameterSpec& parameter, const Variables& known) {
    Range range;
    if (!parameter.low.empty()) range.low = evaluate(parameter.low, known);
    if (!parameter.high.empty()) range.high = evaluate(parameter.high, known);
    return range;
}

ParameterMistake out_of_range(const std::string& machine, const ParameterSpec& parameter,
                              double value, const Range& range, bool is_given) {
    return {parameter.name,
            fmt::format("machine {}: {}{} = {} is out of range: it must be {}", machine,
                        is_given ? "" : "the default of ", parameter.name,
                        quantity_text(value, parameter.quantity), range.text(parameter.quantity)),
            is_given ? TextPlace() : parameter.default_value.place};
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
        if (!range.nearly_holds(value)) {
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

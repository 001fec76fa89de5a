// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/parameter_ranges.h"

#include <algorithm>

#include "scene/expressions.h"

namespace swage {

ParameterRanges::ParameterRanges(const MachineSpec& machine)
    : name_(work_piece_names()), first_parameter_(name_.size()) {
    for (const ParameterSpec& parameter : machine.parameter) {
        default_.push_back(bound(parameter.default_value));
        low_.push_back(bound(parameter.low));
        high_.push_back(bound(parameter.high));
        name_.push_back(parameter.name);
    }
}

ParameterRanges::Bound ParameterRanges::bound(const Expression& text) const {
    if (text.empty()) return {};
    Bound bound{std::make_shared<const Formula>(text.text, name_), {}};
    for (const std::string& name : bound.formula->used()) {
        bound.needs.push_back(
            static_cast<std::size_t>(std::find(name_.begin(), name_.end(), name) - name_.begin()));
    }
    return bound;
}

std::optional<double> ParameterRanges::value(const Bound& bound,
                                             const std::vector<std::optional<double>>& known) {
    if (bound.formula == nullptr) return std::nullopt;
    std::vector<double> values(bound.formula->variables().size(), 0.0);
    for (std::size_t n : bound.needs) {
        if (!known[n]) return std::nullopt;
        values[n] = *known[n];
    }
    try {
        return bound.formula->evaluate(values);
    } catch (const TextError&) {
        return std::nullopt;  // told when the machine is set up, with all values
    }
}

std::vector<std::optional<double>> ParameterRanges::known(
    const std::map<std::string, double>& given) const {
    std::vector<std::optional<double>> known(name_.size());
    for (std::size_t n = 0; n < default_.size(); ++n) {
        const auto found = given.find(name_[first_parameter_ + n]);
        known[first_parameter_ + n] =
            found != given.end() ? found->second : value(default_[n], known);
    }
    return known;
}

// A range uses no parameter below its own.
std::vector<Range> ParameterRanges::ranges(const std::map<std::string, double>& given) const {
    const std::vector<std::optional<double>> all = known(given);
    std::vector<Range> ranges(default_.size());
    for (std::size_t n = 0; n < ranges.size(); ++n) {
        ranges[n].low = value(low_[n], all).value_or(ranges[n].low);
        ranges[n].high = value(high_[n], all).value_or(ranges[n].high);
    }
    return ranges;
}

std::map<std::string, double> ParameterRanges::values(
    const std::map<std::string, double>& given) const {
    const std::vector<std::optional<double>> all = known(given);
    std::map<std::string, double> values;
    for (std::size_t n = first_parameter_; n < all.size(); ++n) {
        if (all[n]) values[name_[n]] = *all[n];
    }
    return values;
}

}  // namespace swage

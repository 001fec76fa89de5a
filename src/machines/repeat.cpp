// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/repeat.h"

#include <cmath>

#include "machines/parameters.h"

namespace swage {

namespace {

constexpr double kOff = 1e-9;  // a quotient may be off a whole number by so much

int count_of(const Repetition& repeat, const std::string& whose, const Variables& known) {
    std::string why = fmt::format("(\"{}\"): it must be a whole number from 0 to {}",
                                  repeat.count.text, kMostRepeats);
    try {
        const double count = evaluate(repeat.count, known);
        if (count >= 0 && count <= kMostRepeats && std::abs(count - std::round(count)) < kOff) {
            return static_cast<int>(std::round(count));
        }
        why = fmt::format("is repeated {:.6g} times {}", count, why);
    } catch (const PlacedError& error) {
        why = fmt::format("is repeated an unknown number of times: {}", error.what());
    }
    std::vector<std::string> names;
    for (const auto& [name, value] : known) names.push_back(name);
    const std::vector<std::string> used = Formula(repeat.count.text, names).used();
    throw ParameterError(
        {{used.empty() ? "" : used.front(), whose + " " + why, repeat.count.place}});
}

template <typename Part>
std::vector<Part> single(const std::vector<Part>& parts, const std::string& machine,
                         const Variables& known) {
    std::vector<Part> all;
    for (const Part& part : parts) {
        if (!part.repeat.is_open()) {
            all.push_back(part);
            continue;
        }
        const std::string whose = fmt::format("machine {}: {}", machine, part.name);
        const int count = count_of(part.repeat, whose, known);
        for (int number = 1; number <= count; ++number) {
            Part& one = all.emplace_back(part);
            one.name = fmt::format("{}_{}", part.name, number);
            one.repeat = {{}, part.name, number};
        }
    }
    return all;
}

}  // namespace

MachineSpec with_single_parts(MachineSpec machine, const Variables& known) {
    machine.tool = single(machine.tool, machine.name, known);
    machine.grip = single(machine.grip, machine.name, known);
    machine.blade = single(machine.blade, machine.name, known);
    return machine;
}

bool is_numbered(std::string_view part, std::string_view repeated) {
    if (!part.starts_with(repeated)) return false;
    part.remove_prefix(repeated.size());
    return part.size() > 1 && part.front() == '_' &&
           part.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

bool is_called(std::string_view part, std::string_view name) {
    return part == name || is_numbered(part, name);
}

}  // namespace swage

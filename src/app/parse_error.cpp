// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/parse_error.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::string parse_error_text(const CLI::App& app, const CLI::ParseError& error,
                             const std::vector<std::string>& arguments) {
    const CLI::App* command = &app;
    for (const std::string& argument : arguments) {
        const bool is_option = argument.rfind("--", 0) == 0;
        std::vector<std::string> commands;
        for (const CLI::App* one : command->get_subcommands({}))
            commands.push_back(one->get_name());
        if (!is_option && !commands.empty()) {
            if (!holds(commands, argument)) {
                const std::string meant = did_you_mean(argument, commands);
                const std::string kind =
                    CLI::detail::to_lower(command->get_formatter()->get_label("COMMAND"));
                return fmt::format("there is no {} \"{}\"{}", kind, argument,
                                   meant.empty() ? ": " + joined(commands, ", ") : meant);
            }
            command = command->get_subcommand(argument);
        } else if (is_option) {
            const std::vector<std::string> options = option_names(*command);
            const std::string name = argument.substr(0, argument.find('='));
            if (!holds(options, name)) {
                return fmt::format("there is no option {}{}", name, did_you_mean(name, options));
            }
        }
    }
    if (error.get_name() == "RequiredError") {
        for (const CLI::Option* option : command->get_options()) {
            if (!option->get_positional() || !option->get_required() || option->count() > 0)
                continue;
            return fmt::format("{0} is required: swage {1} {0}", option->get_type_name(),
                               command->get_name());
        }
    }
    return error.what();
}

}  // namespace swage

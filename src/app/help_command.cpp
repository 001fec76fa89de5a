// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "app/command.h"
#include "base/error.h"
#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

int help(const CLI::App& app, const std::string& of) {
    if (of.empty()) {
        // help() of what was parsed would be that of this command.
        put_out(app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal));
        return 0;
    }
    std::vector<std::string> known;
    for (const CLI::App* one : app.get_subcommands({})) {
        known.push_back(one->get_name());
        if (known.back() != of) continue;
        put_out(one->help(app.get_name()));
        return 0;
    }
    const std::string meant = did_you_mean(of, known);
    fail(ExitCode::command_line, "there is no command \"{}\"{}", of,
         meant.empty() ? ": " + joined(known, ", ") : meant);
}

}  // namespace

void add_help_command(CLI::App& app, Action& chosen) {
    static std::string of;
    CLI::App* command = add_command(app, "help", "List the commands, or explain one of them",
                                    "  swage help\n"
                                    "  swage help run\n",
                                    chosen, [&app] { return help(app, of); });
    command->add_option("command", of, "the command to explain")->type_name("COMMAND");
}

}  // namespace swage

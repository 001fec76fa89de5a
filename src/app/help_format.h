// SPDX-License-Identifier: GPL-3.0-or-later
// How --help looks: an option's values and range as one would write them, text in lines that fit,
// and the options of every command last.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace swage {

constexpr const char* kCommonOptions = "Options of every command";

// What a command's own commands are called is said by the labels COMMAND and Commands.
class HelpFormat : public CLI::Formatter {
  public:
    HelpFormat() { label("Positionals", "Arguments"); }
    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override;
    std::string make_usage(const CLI::App* app, std::string name) const override;
    std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override;
    std::string make_option(const CLI::Option* option, bool is_positional) const override;
    std::string make_option_usage(const CLI::Option* option) const override;
};

}  // namespace swage

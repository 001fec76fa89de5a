// SPDX-License-Identifier: GPL-3.0-or-later
// The command line: every command adds itself to the parser and leaves what is to be done.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include "pipeline/json.h"
#include "pipeline/run_options.h"
#include "render/frame_rate.h"

namespace swage {

// What the chosen command does after all of the command line was read; returns the exit code.
using Action = std::function<int()>;

// Options of every command.
struct CommonOptions {
    int threads = 0;  // 0: as many as there are cores
    bool quiet = false;
    bool verbose = false;
};

// Makes a command with the common options, the examples at the end of its help, and `act` as
// its action.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& examples, Action& chosen, Action act);
void apply_common_options();

void add_run_command(CLI::App& app, Action& chosen);
void add_check_command(CLI::App& app, Action& chosen);
void add_info_command(CLI::App& app, Action& chosen);
void add_machines_command(CLI::App& app, Action& chosen);
void add_materials_command(CLI::App& app, Action& chosen);
void add_keys_command(CLI::App& app, Action& chosen);
void add_render_command(CLI::App& app, Action& chosen);
void add_export_command(CLI::App& app, Action& chosen);
void add_make_command(CLI::App& app, Action& chosen);
void add_verify_command(CLI::App& app, Action& chosen);
// After all others, whose help it tells.
void add_help_command(CLI::App& app, Action& chosen);

// Of all commands, once they are added: what is named, of a file or of anything else, has a name;
// nobody means "".
void ask_for_names(CLI::App& app);

// Data for stdout; a reader that has gone away is no error, a full disk is.
void put_out(std::string_view text);
void put_json(const Json& json);

// Reads "7", "3-9", or "3-", which ends at the last of the run's frames. `first_frame`: what the
// first is called there; those that are returned count from 1. Throws CLI::ValidationError without
// the name of its option.
FrameRange parse_frame_range(const std::string& text,
                             int frame_count = std::numeric_limits<int>::max(),
                             int first_frame = 1);
// Reads "24", "23.976" or "24000/1001". Likewise.
FrameRate parse_frame_rate(const std::string& text);
// Reads "1280x720". Throws CLI::ValidationError.
std::pair<int, int> parse_size(const std::string& text);

}  // namespace swage

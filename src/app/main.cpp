// SPDX-License-Identifier: GPL-3.0-or-later
// The front door: reads the command line, runs one command, and turns every failure into one
// sentence and an exit code.
#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <optional>
#include <sstream>

#include "app/command.h"
#include "app/help_format.h"
#include "app/parse_error.h"
#include "base/failure.h"
#include "base/log.h"
#include "base/text.h"
#include "pipeline/run_directory.h"
#include "pipeline/signals.h"

namespace swage {

namespace {

constexpr int kUnexpected = 70;  // a mistake in swage itself

int exit_code(ExitCode code) { return static_cast<int>(code); }

// The help of what was given without one of its commands, "swage" or "swage make"; else empty.
std::string commands_left_out(const CLI::App& app) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const CLI::App& given = chosen.empty() ? app : *chosen.front();
    if (given.get_subcommands({}).empty() || !given.get_subcommands().empty()) return "";
    return given.help(chosen.empty() ? "" : app.get_name());
}

int run_command_line(int argc, char** argv) {
    CLI::App app(
        "swage: a machine shop for meshes. A mesh goes in, is molded into matter, is "
        "bent,\ntwisted and cut by machines, and comes out as meshes, stills and force curves.");
    app.name("swage");
    app.set_version_flag("-V,--version", fmt::format("swage {} (build {})", kVersion, kBuildName));
    app.formatter(std::make_shared<HelpFormat>());
    app.require_subcommand(1);
    app.footer(
        "\nExamples:\n"
        "  swage run assets/scenes/calf-line.toml\n"
        "  swage check assets/scenes/calf-line.toml\n"
        "  swage machines bend\n"
        "  swage keys stage\n\n"
        "Exit codes: 0 done, 2 command line (also an unknown machine, material or key), 3 "
        "scene\nor machine file, 4 mesh, 5 a run's folder, output or drawing, 6 "
        "simulation\nstopped, 7 refused for resources, 8 output directory belongs to another "
        "run, 128+n by\nsignal n");
    Action chosen;
    add_run_command(app, chosen);
    add_check_command(app, chosen);
    add_info_command(app, chosen);
    add_machines_command(app, chosen);
    add_materials_command(app, chosen);
    add_keys_command(app, chosen);
    add_render_command(app, chosen);
    add_export_command(app, chosen);
    add_make_command(app, chosen);
    add_verify_command(app, chosen);
    add_help_command(app, chosen);
    ask_for_names(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) {  // help, version
            std::ostringstream text;
            app.exit(error, text);
            put_out(text.str());
            return exit_code(ExitCode::done);
        }
        if (error.get_name() == "RequiredError" && app.remaining_size(true) == 0) {
            if (const std::string commands = commands_left_out(app); !commands.empty()) {
                put_out(commands);
                return exit_code(ExitCode::command_line);
            }
        }
        log_error_text(parse_error_text(app, error, {argv + 1, argv + argc}));
        log_text("see swage --help or swage COMMAND --help");
        return exit_code(ExitCode::command_line);
    }
    apply_common_options();
    return chosen();
}

// What is missing must not become the first file that is opened for data. What then goes to stdout
// fails, as it does on a full disk.
void open_standard_streams() {
    for (int stream = 0; stream <= 2; ++stream) {
        if (::fcntl(stream, F_GETFD) == -1) {
            [[maybe_unused]] const int opened =
                ::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
        }
    }
}

// Of what is being handled; returns the exit code.
int tell_failure() {
    try {
        throw;
    } catch (const Interrupted& interrupted) {
        log_text(interrupted.what());
        return 128 + interrupted.signal();
    } catch (const std::exception& error) {
        if (const std::optional<Error> failure = failure_of(error)) {
            // A line for each mistake.
            for (const std::string& line : lines_of(failure->what())) log_error_text(line);
            return exit_code(failure->code());
        }
        log_error_text(std::string("unexpected error, please report it: ") + error.what());
        return kUnexpected;
    }
}

// TBB's threads start each other, where nobody can catch what that throws.
[[noreturn]] void end_uncaught() {
    std::set_terminate(std::abort);
    if (!std::current_exception()) std::abort();
    leave_at_once(tell_failure());
}

int run_guarded(int argc, char** argv) {
    try {
        watch_for_interrupts();
        return run_command_line(argc, argv);
    } catch (...) {
        return tell_failure();
    }
}

}  // namespace

}  // namespace swage

int main(int argc, char** argv) {
    std::set_terminate(swage::end_uncaught);
    swage::open_standard_streams();
    return swage::run_guarded(argc, argv);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>

#include "app/help_format.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/text.h"
#include "pipeline/free_room.h"

namespace swage {

namespace {

CommonOptions common;

int parse_whole(const std::string& text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < 1) {
        throw CLI::ValidationError(fmt::format("\"{}\" is not a whole number of at least 1", text));
    }
    return value;
}

void write_out(std::string_view text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if ((!written || std::fflush(stdout) != 0) && errno != EPIPE) {
        fail(ExitCode::output, "standard output: cannot be written: {}", std::strerror(errno));
    }
}

}  // namespace

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& examples, Action& chosen, Action act) {
    CLI::App* command = app.add_subcommand(name, description);
    command
        ->add_option("--threads", common.threads,
                     "number of threads (default: one per core; more than 16 only if there are as "
                     "many cores)")
        ->check(CLI::Range(1, 4096))
        ->type_name("N")
        ->group(kCommonOptions);
    auto* quiet = command->add_flag("-q,--quiet", common.quiet, "report only what is wrong")
                      ->group(kCommonOptions);
    command
        ->add_flag("-v,--verbose", common.verbose,
                   "report more, as what each frame took the solver")
        ->excludes(quiet)
        ->group(kCommonOptions);
    command->footer("\nExamples:\n" + examples);
    command->callback([&chosen, act = std::move(act)] { chosen = act; });
    return command;
}

void ask_for_names(CLI::App& app) {
    const CLI::Validator is_name(
        [](const std::string& text) { return text.empty() ? "\"\" is not a name" : std::string(); },
        "");
    for (CLI::Option* option : app.get_options()) {
        const std::string type = option->get_type_name();
        const bool is_path = type == "DIR" || type == "FILE";
        if (option->get_positional() || is_path) option->check(is_name);
    }
    for (CLI::App* command : app.get_subcommands({})) ask_for_names(*command);
}

void apply_common_options() {
    set_log_level(common.quiet     ? LogLevel::quiet
                  : common.verbose ? LogLevel::verbose
                                   : LogLevel::normal);
    set_thread_count(common.threads);
    refuse_threads(thread_count());
}

void put_out(std::string_view text) { write_out(printable(text)); }

void put_json(const Json& json) { write_out(json_text(json)); }

FrameRange parse_frame_range(const std::string& text, int frame_count, int first_frame) {
    const std::size_t dash = text.find('-');
    const std::string first = text.substr(0, dash), last = text.substr(std::min(dash, text.size()));
    const long last_frame = long(frame_count) + first_frame - 1;
    FrameRange range;
    try {
        range.first = parse_whole(first);
        range.last = last.empty()  ? range.first
                     : last == "-" ? static_cast<int>(std::clamp<long>(
                                         last_frame, range.first, std::numeric_limits<int>::max()))
                                   : parse_whole(last.substr(1));
    } catch (const CLI::ValidationError&) {
        throw CLI::ValidationError(
            fmt::format("\"{}\" is not a frame or a range of frames such as 7, 3-9 or 3-", text));
    }
    if (range.last < range.first) {
        throw CLI::ValidationError(fmt::format("\"{}\" ends before it begins", text));
    }
    const int later = first_frame - 1;
    return {range.first - later, range.last - later};
}

FrameRate parse_frame_rate(const std::string& text) {
    const std::optional<FrameRate> rate = frame_rate_named(text);
    if (rate) return *rate;
    throw CLI::ValidationError(
        fmt::format("\"{}\" is no rate of films: it has to be a {}", text, kFrameRateForm));
}

std::pair<int, int> parse_size(const std::string& text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string::npos) {
        throw CLI::ValidationError(fmt::format("\"{}\" is not a size such as 1280x720", text));
    }
    const std::pair size{parse_whole(text.substr(0, cross)), parse_whole(text.substr(cross + 1))};
    if (size.first > 16384 || size.second > 16384) {
        throw CLI::ValidationError(fmt::format("\"{}\" is larger than 16384x16384", text));
    }
    return size;
}

}  // namespace swage

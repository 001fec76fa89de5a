// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/help_format.h"

#include "app/word_wrap.h"

namespace swage {

namespace {

constexpr std::size_t kColumn = 26;  // where what an option does begins

// What an option takes: "N", and what of that is allowed, " (1 to 4096)".
struct Taken {
    std::string value, range;
};

// CLI11 has a type and its checks in one: "N:INT in [1 - 4096]", "TEXT:{x,y,z}".
Taken taken_by(const CLI::Option& option) {
    const std::string all = option.get_type_size() == 0 ? "" : option.get_type_name();
    const std::size_t colon = all.find(':');
    Taken taken{all.substr(0, colon), ""};
    const std::string check = colon == std::string::npos ? "" : all.substr(colon + 1);
    if (check.size() > 1 && check.front() == '{' && taken.value == "TEXT") {
        taken.value = check.substr(1, check.size() - 2);
        for (char& c : taken.value) c = c == ',' ? '|' : c;
    }
    const std::size_t low = check.find(" in ["), middle = check.find(" - "), end = check.find(']');
    if (low != std::string::npos && middle != std::string::npos && end != std::string::npos) {
        taken.range = " (" + check.substr(low + 5, middle - low - 5) + " to " +
                      check.substr(middle + 3, end - middle - 3) + ")";
    }
    if (taken.value == "INT") taken.value = "N";
    if (taken.value == "FLOAT") taken.value = "X";
    return taken;
}

// A name, and beside or below it what it is.
std::string entry(const std::string& name, const std::string& text) {
    std::string line = "  " + name;
    if (text.empty()) return line + "\n";
    if (line.size() + 2 > kColumn) {
        line += "\n" + std::string(kColumn, ' ');
    } else {
        line.resize(kColumn, ' ');
    }
    return line + wrapped(text, kColumn, kColumn) + "\n";
}

}  // namespace

std::string HelpFormat::make_option(const CLI::Option* option, bool is_positional) const {
    const Taken taken = taken_by(*option);
    std::string name = is_positional ? taken.value : option->get_name(false, true);
    if (!is_positional && !taken.value.empty()) name += " " + taken.value;
    return entry(name, option->get_description() + taken.range);
}

std::string HelpFormat::make_option_usage(const CLI::Option* option) const {
    const std::string name =
        taken_by(*option).value + (option->get_expected_max() > 1 ? " ..." : "");
    return option->get_required() ? name : "[" + name + "]";
}

std::string HelpFormat::make_subcommands(const CLI::App* app, CLI::AppFormatMode) const {
    std::string text;
    for (const CLI::App* command : app->get_subcommands({})) {
        text += entry(command->get_name(), command->get_description());
    }
    return text.empty() ? "" : "\n" + get_label("Commands") + ":\n" + text;
}

std::string HelpFormat::make_usage(const CLI::App* app, std::string name) const {
    std::string text = "\nUsage: " + name;
    if (!app->get_subcommands({}).empty()) {
        return text + " " + get_label("COMMAND") + " [OPTIONS]\n";
    }
    text += " [OPTIONS]";
    for (const CLI::Option* one :
         app->get_options([](const CLI::Option* o) { return o->get_positional(); })) {
        text += " " + make_option_usage(one);
    }
    return text + "\n";
}

std::string HelpFormat::make_help(const CLI::App* app, std::string name,
                                  CLI::AppFormatMode mode) const {
    // What has commands of its own takes none but --help.
    const auto is_common = [&](const CLI::Option* option) {
        return app->get_subcommands({}).empty() &&
               (option == app->get_help_ptr() || option->get_group() == kCommonOptions);
    };
    std::string text = wrapped(app->get_description(), 0, 0) + "\n" + make_usage(app, name);
    text += make_subcommands(app, mode) + make_positionals(app);
    std::vector<const CLI::Option*> own, common;
    for (const CLI::Option* one :
         app->get_options([](const CLI::Option* o) { return o->nonpositional(); })) {
        (is_common(one) ? common : own).push_back(one);
    }
    if (!own.empty()) text += make_group("Options", false, own);
    if (!common.empty()) text += make_group(kCommonOptions, false, common);
    return text + make_footer(app);
}

}  // namespace swage

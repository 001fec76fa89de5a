// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "app/command.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/suggest.h"
#include "pipeline/run_directory.h"
#include "pipeline/signals.h"
#include "verify/table.h"

namespace swage {

namespace {

struct VerifyArguments {
    std::vector<std::string> cases;
    std::string out;
    bool json = false, markdown = false, brief = false;
};

std::vector<Case> chosen_cases(const VerifyArguments& given) {
    std::vector<Case> all = verification_cases(), chosen;
    std::vector<std::string> names;
    for (const Case& c : all) names.push_back(c.name);
    for (const std::string& name : given.cases) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            fail(ExitCode::command_line, "there is no case \"{}\"{}", name,
                 did_you_mean(name, names));
        }
    }
    for (Case& c : all) {
        const bool named =
            std::find(given.cases.begin(), given.cases.end(), c.name) != given.cases.end();
        if (given.cases.empty() ? c.quick || !given.brief : named) chosen.push_back(std::move(c));
    }
    return chosen;
}

Json number_json(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json verified_json(const std::vector<Verified>& all) {
    Json list = Json::array();
    for (const auto& [verification, result] : all) {
        Json values = Json::array(), series = Json::array();
        for (const Value& v : result.value) {
            values.push_back({{"what", v.what},
                              {"across", v.across},
                              {"expected", number_json(v.expected)},
                              {"got", number_json(v.got)},
                              {"error", number_json(v.error)},
                              {"bound", number_json(v.bound)},
                              {"missed", v.missed()},
                              {"seconds", v.seconds}});
        }
        for (const Series& s : result.series) {
            series.push_back({{"what", s.what}, {"order", number_json(s.order)}});
        }
        list.push_back({{"case", verification.name},
                        {"help", verification.help},
                        {"source", verification.source},
                        {"least_order", verification.least_order},
                        {"missed", result.missed},
                        {"failure", result.failure},
                        {"seconds", result.seconds},
                        {"values", values},
                        {"series", series}});
    }
    return {{"version", SWAGE_VERSION}, {"build", kBuildName}, {"cases", list}};
}

int verify(const VerifyArguments& given) {
    if (!given.out.empty()) make_folder(given.out);
    std::vector<Verified> all;
    bool missed = false;
    std::optional<Interrupted> interrupted;  // what was verified before stays
    try {
        for (const Case& c : chosen_cases(given)) {
            throw_if_interrupted();
            log_info("{}: {}", c.name, c.help);
            all.push_back({c, run_case(c, given.brief)});
            missed = missed || all.back().result.missed;
        }
    } catch (const Interrupted& early) {
        interrupted = early;
        if (all.empty()) throw;
    }
    if (!given.out.empty()) {
        const std::filesystem::path out = given.out;
        write_file_whole(out / "verify.json", json_text(verified_json(all)));
        write_file_whole(out / "verify.html", verified_page(all));
    }
    if (given.json) {
        put_json(verified_json(all));
    } else if (given.markdown) {
        put_out(verified_markdown(all));
    } else {
        put_out(verified_text(all));
    }
    if (interrupted) throw *interrupted;
    return static_cast<int>(missed ? ExitCode::stopped : ExitCode::done);
}

}  // namespace

void add_verify_command(CLI::App& app, Action& chosen) {
    static VerifyArguments given;
    std::string names;
    for (const Case& c : verification_cases()) names += (names.empty() ? "" : ", ") + c.name;
    CLI::App* command =
        add_command(app, "verify",
                    "Run mechanics cases with known answers; exit code 6 if any misses its bound",
                    "  swage verify\n"
                    "  swage verify --short\n"
                    "  swage verify cantilever torsion --out verified\n"
                    "  swage verify stretch --json\n",
                    chosen, [] { return verify(given); });
    command->add_option("cases", given.cases, "cases to run (default: all): " + names)
        ->type_name("CASE");
    command->add_option("--out", given.out, "write verify.json and verify.html there")
        ->type_name("DIR");
    CLI::Option* json = command->add_flag("--json", given.json, "print JSON");
    command->add_flag("--markdown", given.markdown, "print the README's table")->excludes(json);
    command->add_flag("--short", given.brief,
                      "run only the quick cases, without their finest bodies");
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <sstream>

#include "base/text.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

namespace {

const std::vector<std::string> kCommands = {"run",    "check",  "info", "machines", "keys",
                                            "render", "export", "make", "verify",   "help"};

// The words of a shell line that uses double quotes at most.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false;
    for (char c : line + " ") {
        if (c == '"') {
            quoted = !quoted;
        } else if (c == ' ' && !quoted) {
            if (!word.empty()) words.push_back(word);
            word.clear();
        } else {
            word += c;
        }
    }
    return words;
}

// The examples at the end of a command's help, each as the words after "swage".
std::vector<std::vector<std::string>> examples_of(const std::string& help) {
    std::vector<std::vector<std::string>> examples;
    std::istringstream in(help.substr(std::min(help.find("Examples:"), help.size())));
    for (std::string line; std::getline(in, line);) {
        if (line.rfind("  swage ", 0) == 0) examples.push_back(words_of(line.substr(8)));
    }
    return examples;
}

}  // namespace

TEST_CASE("the version and every help come on stdout with code 0") {
    const Outcome version = run_swage({"--version"});
    CHECK(version.code == 0);
    CHECK(version.out.rfind("swage ", 0) == 0);
    CHECK(version.err.empty());
    CHECK(run_swage({"--help"}).code == 0);
    const Outcome bare = run_swage({});  // a script that forgot its command has to notice
    CHECK(bare.code == 2);
    CHECK(bare.out == run_swage({"--help"}).out);
    CHECK(run_swage({"make"}).code == 2);
    CHECK(run_swage({"make"}).out == run_swage({"make", "--help"}).out);
    for (const std::string& command : kCommands) {
        const Outcome help = run_swage({command, "--help"});
        CHECK(help.code == 0);
        CHECK(help.err.empty());
        for (const std::string& line : swage::lines_of(help.out)) {
            CHECK(line.size() <= 100);
            CHECK(line.find(" in [") == std::string::npos);  // as the parser has ranges
        }
        CHECK(examples_of(help.out).size() >= 2);
    }
}

TEST_CASE("the examples of every help work as they stand") {
    const Scratch scratch;
    std::vector<std::vector<std::string>> examples = examples_of(run_swage({"--help"}).out);
    for (const std::string& command : kCommands) {
        for (auto& example : examples_of(run_swage({command, "--help"}).out)) {
            examples.push_back(example);
        }
    }
    for (std::vector<std::string>& example : examples) {
        std::string line = "swage";
        for (const std::string& word : example) line += " " + word;
        INFO(line);
        // A scene of a run is only checked and a finished run only named here: others run them.
        if (example[0] == "render" || example[0] == "export") continue;
        if (example[0] == "verify") {  // takes minutes: its cases need only be some
            const std::string help = run_swage({"verify", "--help"}).out;
            for (std::size_t n = 1; n < example.size() && example[n][0] != '-'; ++n) {
                CHECK(help.find(example[n] + (n > 0 ? "," : "")) != std::string::npos);
            }
            continue;
        }
        if (example[0] == "run") {
            std::vector<std::string> check = {"check", example.at(1)};
            for (std::size_t n = 2; n + 1 < example.size(); ++n) {
                if (example[n] == "--set") check.insert(check.end(), {"--set", example[n + 1]});
            }
            CHECK(run_swage(check, SWAGE_SOURCE_DIR).code == 0);
            continue;
        }
        for (std::string& word : example) {
            if (word.rfind("/tmp/", 0) == 0) word = (scratch.path() / word.substr(5)).string();
        }
        const Outcome outcome = run_swage(example);
        INFO(outcome.err);
        CHECK(outcome.code == 0);
    }
}

TEST_CASE("help is told where it is asked for by that word, of one command too") {
    CHECK(run_swage({"help"}).out == run_swage({"--help"}).out);
    for (const char* command : {"run", "check", "keys", "machines", "help"}) {
        const Outcome told = run_swage({"help", command});
        CHECK(told.code == 0);
        CHECK(told.out == run_swage({command, "--help"}).out);
    }
    const Outcome wrong = run_swage({"help", "chek"});
    CHECK(wrong.code == 2);
    CHECK(wrong.out.empty());
    CHECK(wrong.err.find("no command \"chek\", did you mean \"check\"?") != std::string::npos);
}

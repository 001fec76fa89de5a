// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <cstdlib>

#include "base/error.h"
#include "base/process.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("a program is found in PATH or by its path, and nothing else is", "[process]") {
    CHECK(program_exists("sh"));
    CHECK(program_exists("/bin/sh"));
    CHECK_FALSE(program_exists("/bin"));
    CHECK_FALSE(program_exists("/etc/passwd"));
    CHECK_FALSE(program_exists("no-such-program-here"));
    CHECK_FALSE(program_exists(""));
}

TEST_CASE("a program's exit status comes back", "[process]") {
    PipedProgram five({"sh", "-c", "cat >/dev/null; exit 5"});
    CHECK(five.write("hello"));
    CHECK(five.finish() == 5);
    PipedProgram killed({"sh", "-c", "cat >/dev/null; kill -9 $$"});
    CHECK(killed.finish() == 128 + SIGKILL);
}

TEST_CASE("what is written arrives whole", "[process]") {
    PipedProgram count({"sh", "-c", "wc -c >&2"});
    const std::string block(1 << 20, 'x');
    for (int i = 0; i < 3; ++i) CHECK(count.write(block));
    CHECK(count.finish() == 0);
    CHECK(std::stol(count.last_error_line()) == 3l << 20);
}

TEST_CASE("writing to a program that ended returns false and raises no signal", "[process]") {
    PipedProgram deaf({"true"});
    const std::string block(1 << 20, 'x');
    bool listening = true;
    for (int i = 0; i < 8 && listening; ++i) listening = deaf.write(block);
    CHECK_FALSE(listening);
    CHECK(deaf.finish() == 0);
    CHECK_FALSE(deaf.write("more"));
}

TEST_CASE("a talkative program does not block, and its last line is kept", "[process]") {
    PipedProgram talker({"sh", "-c", "seq 1 200000 >&2; cat >/dev/null; echo the end >&2"});
    CHECK(talker.write("x"));
    CHECK(talker.finish() == 0);
    CHECK(talker.last_error_line() == "the end");
    CHECK(talker.error_tail().size() <= 4096);
}

TEST_CASE("a program that cannot be started is an error that names it", "[process]") {
    try {
        PipedProgram nothing({"no-such-program-here"});
        FAIL("it started");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::output);
        CHECK(std::string(error.what()).find("no-such-program-here") != std::string::npos);
    }
}

TEST_CASE("a program left behind is ended", "[process]") {
    // Would take an hour to pass otherwise.
    PipedProgram sleeper({"sleep", "3600"});
}

TEST_CASE("no shell reads the arguments", "[process]") {
    PipedProgram echo({"sh", "-c", "printf '%s\\n' \"$1\" >&2", "sh", "a b; $(c) *"});
    CHECK(echo.finish() == 0);
    CHECK(echo.last_error_line() == "a b; $(c) *");
}

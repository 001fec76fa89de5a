// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/process.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>

#include "base/error.h"
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

TEST_CASE("a program that reads nothing any more is given up, one that reads slowly is not") {
    const std::string block(1 << 19, 'x');
    PipedProgram deaf({"sh", "-c", "exec sleep 60"}, 0.3);
    CHECK_FALSE(deaf.write(block));
    CHECK(deaf.has_taken_nothing());
    CHECK(deaf.finish() == 128 + SIGKILL);
    PipedProgram slow({"sh", "-c",
                       "for n in 1 2 3 4 5 6 7 8; do dd bs=65536 count=1 iflag=fullblock "
                       "of=/dev/null; sleep 0.2; done; cat > /dev/null"},
                      1);
    CHECK(slow.write(block));
    CHECK_FALSE(slow.has_taken_nothing());
    CHECK(slow.finish() == 0);
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
    const auto begin = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    pid_t process = 0;
    {
        PipedProgram sleeper({"sh", "-c", "echo $$ >&2; exec sleep 300"});
        while (sleeper.last_error_line().empty() && seconds() < 60) ::usleep(1000);
        REQUIRE_FALSE(sleeper.last_error_line().empty());
        process = static_cast<pid_t>(std::stol(sleeper.last_error_line()));
        CHECK(::kill(process, 0) == 0);
    }
    const bool lives = ::kill(process, 0) == 0;
    CHECK_FALSE(lives);
    CHECK(seconds() < 200);
}

TEST_CASE("a program that does not end in its time is ended", "[process]") {
    PipedProgram sleeper({"sleep", "20"});
    CHECK(sleeper.finish_within(0.05) == 128 + SIGKILL);
    PipedProgram quick({"sh", "-c", "cat >/dev/null; exit 3"});
    CHECK(quick.finish_within(100) == 3);
}

TEST_CASE("all programs that run are ended at once, however many came before", "[process]") {
    for (int n = 0; n < 20; ++n) {
        PipedProgram before({"true"});
        CHECK(before.finish() == 0);
    }
    PipedProgram one({"sleep", "20"}), other({"sleep", "20"});
    kill_programs();
    CHECK(one.finish() == 128 + SIGKILL);
    CHECK(other.finish() == 128 + SIGKILL);
}

TEST_CASE("a failure comes back also where the end of children is ignored", "[process]") {
    const auto before = std::signal(SIGCHLD, SIG_IGN);
    PipedProgram five({"sh", "-c", "cat >/dev/null; exit 5"});
    CHECK(five.finish() == 5);
    // What is ignored from here on nobody can wait for: it is no success.
    PipedProgram lost({"sh", "-c", "cat >/dev/null"});
    std::signal(SIGCHLD, SIG_IGN);
    CHECK(lost.finish() == -1);
    std::signal(SIGCHLD, before);
    CHECK_FALSE(wait_for(::getppid()));
}

TEST_CASE("no shell reads the arguments", "[process]") {
    PipedProgram echo({"sh", "-c", "printf '%s\\n' \"$1\" >&2", "sh", "a b; $(c) *"});
    CHECK(echo.finish() == 0);
    CHECK(echo.last_error_line() == "a b; $(c) *");
}

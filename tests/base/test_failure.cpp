// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/failure.h"

#include <filesystem>
#include <new>
#include <system_error>

#include "base/interrupt.h"
#include "tests/catch.h"

using namespace swage;

TEST_CASE("want of memory, threads and files is told as such, and nothing else is made of it") {
    const auto code_of = [](const std::exception& error) {
        const std::optional<Error> failure = failure_of(error);
        return failure ? static_cast<int>(failure->code()) : -1;
    };
    CHECK(code_of(Error(ExitCode::mesh, "torn")) == 4);
    CHECK(code_of(std::bad_alloc()) == 7);
    CHECK(code_of(std::bad_array_new_length()) == 7);
    CHECK(code_of(std::system_error(
              std::make_error_code(std::errc::resource_unavailable_try_again))) == 7);
    const std::filesystem::filesystem_error gone("cannot read", "/somewhere/a.obj",
                                                 std::make_error_code(std::errc::io_error));
    CHECK(code_of(gone) == 5);
    CHECK(failure_of(gone)->what() == "/somewhere/a.obj: " + gone.code().message());
    CHECK(code_of(Interrupted(2)) == -1);
    CHECK(code_of(std::logic_error("a mistake")) == -1);
}

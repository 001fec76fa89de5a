// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/file_contents.h"

#include <fcntl.h>
#include <fstream>

#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

}  // namespace

TEST_CASE("a plain file comes whole, also one whose length the system does not say") {
    const Scratch scratch;
    const std::filesystem::path file = scratch.path() / "a.txt";
    for (const std::size_t size : {0, 1, 4095, 4096, 4097, 300000}) {
        const std::string text(size, 'x');
        write_text(file, text);
        CHECK(file_contents(file) == text);
        CHECK(file_contents(file, size) == text);
    }
    std::string name;
    std::ifstream comm("/proc/self/comm");
    std::getline(comm, name);
    CHECK_FALSE(name.empty());
    CHECK(file_contents("/proc/self/comm") == name + '\n');
}

TEST_CASE("a file without contents has a reason") {
    const Scratch scratch;
    const auto reason = [](const std::filesystem::path& file, std::uint64_t limit = kAnyLength) {
        std::string why;
        CHECK_FALSE(file_contents(file, limit, &why));
        CHECK_FALSE(file_contents(file, limit));
        return why;
    };
    CHECK(reason(scratch.path() / "nothing") == "does not exist");
    CHECK(reason(scratch.path()) == "is a folder, not a file");
    CHECK(reason("/dev/null") == "is not a regular file");
    write_text(scratch.path() / "long", std::string(3 << 20, 'x'));
    CHECK(reason(scratch.path() / "long", 2 << 20) == "is larger than 2 MiB");
    CHECK(reason("/proc/self/maps", 0) == "is larger than 0 MiB");
    CHECK(reason("/proc/self/comm", 0) == "is larger than 0 MiB");  // which comes in one piece
}

TEST_CASE("what cannot be read is not taken for the end of a file") {
    std::string why;
    CHECK_FALSE(file_contents("/proc/self/mem", kAnyLength, &why));  // nothing lies at address 0
    CHECK(why.starts_with("cannot be read: "));
    CHECK_FALSE(rest_of_file(-1, kAnyLength, why));
}

TEST_CASE("a file handle closes what it holds, once") {
    FileHandle first(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    REQUIRE(first.is_open());
    const int id = first.id();
    const auto is_in_use = [&] { return ::fcntl(id, F_GETFD) != -1; };
    {
        const FileHandle second = std::move(first);
        CHECK(second.id() == id);
        CHECK(is_in_use());
    }
    CHECK_FALSE(is_in_use());
}

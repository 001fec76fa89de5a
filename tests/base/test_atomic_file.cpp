// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/atomic_file.h"

#include <unistd.h>

#include <fstream>
#include <string>

#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

TEST_CASE("what is left of files that were never whole goes, and nothing else") {
    const Scratch scratch;
    const fs::path& folder = scratch.path();
    fs::create_directories(folder / "frames");
    const fs::path own = temporary_for(folder / "frames/frame_0001.png");
    const fs::path alive = folder / (".film.part" + std::to_string(::getppid()) + ".mp4");
    const fs::path gone = folder / ".film.part4194305.mp4";  // more than any process has
    const fs::path others[] = {folder / "film.part1.mp4", folder / ".film.partial.mp4",
                               folder / ".film.part1x.mp4", folder / "film.mp4"};
    const auto put = [](const fs::path& file) { std::ofstream(file) << "half"; };
    for (const fs::path& file : {own, alive, gone}) put(file);
    for (const fs::path& file : others) put(file);
    remove_temporaries(folder, 4194306);
    CHECK(fs::exists(own));
    remove_temporaries(folder, 0);
    CHECK_FALSE(fs::exists(own));
    CHECK_FALSE(fs::exists(gone));
    CHECK(fs::exists(alive));
    for (const fs::path& file : others) CHECK(fs::exists(file));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_directory.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "base/error.h"
#include "pipeline/render_directory.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

RunIdentity identity_of(const std::string& scene_hash) {
    return {kVersion, {{"machine bend", "a.toml", scene_hash}, {"mesh", "a.obj", "0123"}}};
}

ExitCode code_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& error) {
        return error.code();
    }
    return ExitCode::done;
}

void begin_run(const fs::path& root, const std::string& scene_hash) {
    RunDirectory run(root, identity_of(scene_hash));
    run.begin();
}

void put_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

}  // namespace

TEST_CASE("a run enters its own directory again") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "today" / "run";  // neither is there yet
    begin_run(root, "1");
    CHECK(fs::exists(root / ".swage-run"));
    CHECK_FALSE(fs::exists(root / ".swage-lock"));
    CHECK(code_of([&] { const RunDirectory again(root, identity_of("1")); }) == ExitCode::done);
}

TEST_CASE("of a run that does not begin nothing is left but what was there") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "today" / "run";
    for (const EarlierRun earlier : {EarlierRun::finish, EarlierRun::replace}) {
        { const RunDirectory run(root, identity_of("1"), earlier); }
        CHECK(fs::is_empty(scratch.path()));
    }
    fs::create_directory(scratch.path() / "today");
    { const RunDirectory run(root / "", identity_of("1")); }
    CHECK(fs::is_empty(scratch.path() / "today"));
    fs::create_directory(root);
    { const RunDirectory run(root, identity_of("1")); }
    CHECK(fs::is_empty(root));
    begin_run(root, "1");
    { const RunDirectory run(root, identity_of("1")); }
    CHECK(fs::exists(root));
}

TEST_CASE("another run's directory is refused and left as it is") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    begin_run(root, "1");
    put_text(root / "run.json", "{}");
    // A fresh run that comes to nothing leaves it, too.
    { const RunDirectory fresh(root, identity_of("2"), EarlierRun::replace); }
    CHECK(fs::exists(root / "run.json"));
    std::string told;
    try {
        const RunDirectory other(root, identity_of("2"));
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::foreign);
        told = error.what();
    }
    CHECK(told.find("machine bend differs") != std::string::npos);
    CHECK(told.find("mesh") == std::string::npos);
    CHECK(fs::exists(root / "run.json"));
    CHECK_FALSE(fs::exists(root / ".swage-lock"));

    {
        RunDirectory fresh(root, identity_of("2"), EarlierRun::replace);
        fresh.begin();
    }
    CHECK_FALSE(fs::exists(root / "run.json"));
    put_text(root / "run.json", "{}");
    CHECK(code_of([&] { const RunDirectory then(root, identity_of("1")); }) == ExitCode::foreign);
    CHECK(code_of([&] { const RunDirectory now(root, identity_of("2")); }) == ExitCode::done);
}

TEST_CASE("a directory of something else is refused, even when all is to be made fresh") {
    const Scratch scratch;
    put_text(scratch.path() / "thesis.txt", "dear");
    for (const EarlierRun earlier : {EarlierRun::finish, EarlierRun::replace}) {
        CHECK(code_of([&] { const RunDirectory run(scratch.path(), identity_of("1"), earlier); }) ==
              ExitCode::foreign);
    }
    CHECK(fs::exists(scratch.path() / "thesis.txt"));
}

TEST_CASE("what nobody can read whose run it is is refused at once, and made fresh") {
    const Scratch scratch;
    put_text(scratch.path() / "run.json", "{}");
    REQUIRE(::mkfifo((scratch.path() / ".swage-run").c_str(), 0600) == 0);
    CHECK(code_of([&] { const RunDirectory run(scratch.path(), identity_of("1")); }) ==
          ExitCode::foreign);
    {
        RunDirectory fresh(scratch.path(), identity_of("1"), EarlierRun::replace);
        fresh.begin();
    }
    CHECK(fs::is_regular_file(scratch.path() / ".swage-run"));
}

TEST_CASE("a directory that cannot be made is an output error") {
    const Scratch scratch;
    put_text(scratch.path() / "file", "");
    const auto enter = [&](const fs::path& root) {
        return code_of([&] { const RunDirectory run(root, identity_of("1")); });
    };
    CHECK(enter(scratch.path() / "file") == ExitCode::output);
    CHECK(enter(scratch.path() / "file" / "below") == ExitCode::output);
    CHECK(enter(scratch.path() / "with-slash/") == ExitCode::done);
}

TEST_CASE("two runs at once in one directory: the second is refused and told who is first") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    const RunDirectory first(root, identity_of("1"));
    try {
        const RunDirectory second(root, identity_of("1"));
        FAIL("both got in");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::foreign);
        CHECK(std::string(error.what()).find(fmt::format("{}", ::getpid())) != std::string::npos);
    }
    CHECK(fs::exists(root / ".swage-lock"));
}

TEST_CASE("two drawings at once into one folder: the second is refused and told who is first") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "pictures";
    {
        const RenderDirectory first(root, false, 1);
        CHECK_THROWS_WITH(
            RenderDirectory(root, false, 1),
            Catch::Contains(std::to_string(::getpid())) && Catch::Contains("is writing there"));
    }
    CHECK(!fs::exists(root));
}

TEST_CASE("a run is not made anew while it is drawn") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    begin_run(root, "1");
    put_text(root / "motion.bin", "frames");
    const RenderDirectory drawing(RunDirectory::drawn_again(root), true, 1);
    RunDirectory anew(root, identity_of("2"), EarlierRun::replace);
    CHECK_THROWS_WITH(anew.begin(), Catch::Contains("is writing there"));
    CHECK(fs::exists(root / "motion.bin"));
}

TEST_CASE("of folders that could not all be made none stays") {
    const Scratch scratch;
    const fs::path outer = scratch.path() / "a";
    CHECK(code_of([&] { RenderDirectory(outer / "b" / std::string(300, 'c'), false, 1); }) ==
          ExitCode::output);
    CHECK(!fs::exists(outer));
}

TEST_CASE("stills of another naming are nobody's to remove") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "pictures", frames = root / "frames";
    fs::create_directories(frames);
    for (const char* name :
         {"frame_7.png", "frame_0007.png", "frame_0001.png", "frame_07000.png"}) {
        put_text(frames / name, "");
    }
    const RenderDirectory drawing(root, true, 1);
    CHECK(drawing.remove_others({1, 1}, true) == 1);
    CHECK(!fs::exists(frames / "frame_0007.png"));
    for (const char* name : {"frame_7.png", "frame_0001.png", "frame_07000.png"}) {
        CHECK(fs::exists(frames / name));
    }
}

TEST_CASE("a run that is only being made is not taken for files of somebody else") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    fs::create_directories(root / "meshes");
    const FolderLock first(root);
    CHECK_THROWS_WITH(RunDirectory(root, identity_of("1")), Catch::Contains("is writing there"));
    put_text(root / ".swage-lock", "");  // as long as it has not said who it is
    CHECK_THROWS_WITH(RunDirectory(root, identity_of("1")),
                      Catch::Contains("another process is writing there"));
}

TEST_CASE("the lock of a process that died here is taken over, that of another host is not") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    begin_run(root, "1");
    char host[256] = {};
    REQUIRE(::gethostname(host, sizeof host - 1) == 0);
    put_text(root / ".swage-lock", fmt::format("4194303 {}\n", host));
    put_text(root / ".frame_0007.part4194303.png", "half a pic");
    CHECK(code_of([&] { const RunDirectory run(root, identity_of("1")); }) == ExitCode::done);
    CHECK_FALSE(fs::exists(root / ".frame_0007.part4194303.png"));

    put_text(root / ".swage-lock", "12 elsewhere.example\n");
    CHECK(code_of([&] { const RunDirectory run(root, identity_of("1")); }) == ExitCode::foreign);
}

TEST_CASE("what a run that was killed at its start has left is no other's") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    put_text(root / "..swage-run.part4194303", "{");
    { const RunDirectory run(root, identity_of("1")); }
    CHECK_FALSE(fs::exists(root / "..swage-run.part4194303"));
}

TEST_CASE("what differs between two runs is told item by item") {
    RunIdentity there = identity_of("1"), here = identity_of("1");
    CHECK(differences(there, here).empty());
    here.input[1].file = "moved/a.obj";
    CHECK(differences(there, here).empty());
    here.input[1].hash = std::string("9");
    here.input.push_back({"machine cut", "cut.toml", "5"});
    there.input.push_back({"texture", "a.png", "5"});
    there.version = "0.0.1";
    CHECK(differences(there, here).size() == 4);
    there = here = identity_of("1");
    there.build = "0123";
    REQUIRE(differences(there, here).size() == 1);
    CHECK(differences(there, here)[0].find("another build of swage") == 0);
    // What comes of something else that differs is not told beside it.
    there = here = identity_of("1");
    there.input.push_back({"what the mesh was read as", "a.obj", "5"});
    here.input.push_back({"what the mesh was read as", "a.obj", "6"});
    CHECK(differences(there, here).size() == 1);
    here.input[1].hash = "9";
    REQUIRE(differences(there, here).size() == 1);
    CHECK(differences(there, here)[0].find("what the") == std::string::npos);
}

TEST_CASE("of a machine that was edited it is told what it says now and what it said then") {
    const Scratch scratch;
    const auto with = [](const std::string& text) {
        RunIdentity identity = identity_of(text);
        identity.input[0].text = text;
        return identity;
    };
    const fs::path root = scratch.path() / "run";
    {
        RunDirectory run(root, with("# one\nangle = 1\nframes = 3\nframes = 3\n"));
        run.begin();
        put_text(root / "run.json", "{}");
    }
    const auto refusal = [&](const RunIdentity& identity) {
        try {
            const RunDirectory other(root, identity);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    CHECK(refusal(with("# two\n  angle = 2\nframes = 3\nframes = 3\n"))
              .find("machine bend differs: the content of a.toml has changed (now angle = 2; then "
                    "angle = "
                    "1);") != std::string::npos);
    CHECK(refusal(with("angle = 1\nframes = 3\n")).find("(now nothing more; then frames = 3);") !=
          std::string::npos);
    CHECK(refusal(with("a = 1\nb = 2\nc = 3\nd = 4\ne = 5\n"))
              .find("(now a = 1, b = 2, c = 3 and 2 more; then ") != std::string::npos);
    CHECK(refusal(identity_of("2"))
              .find("machine bend differs: the content of a.toml has changed;") !=
          std::string::npos);
}

TEST_CASE("of a scene it is told which keys say something else now") {
    RunIdentity there = identity_of("1"), here = identity_of("1");
    there.input.push_back({"scene", "a.toml", "5"});
    here.input.push_back({"scene", "b.toml", "6"});
    there.input.push_back({"--set", "a=1", "7"});
    there.said = {{"a", "1", "one"}, {"b", "2", "2 cm"}, {"output.keep_stages", "true", "true"}};
    here.said = {{"a", "1", "1"}, {"b", "2", "20 mm"}};
    CHECK(differences(there, here).empty());
    here.said = {{"b", "3", "3 cm"}, {"c", "4", "4"}};
    CHECK(differences(there, here) == std::vector<std::string>{"a is not there now, one then",
                                                               "b is 3 cm now, 2 cm then",
                                                               "c is 4 now, not there then"});
    const Scratch scratch;
    {
        RunDirectory run(scratch.path() / "run", there);
        run.begin();
        put_text(scratch.path() / "run/run.json", "{}");
    }
    CHECK_THROWS_WITH(RunDirectory(scratch.path() / "run", here),
                      Catch::Contains("another run: a is not there now, one then; b is 3 cm now"));
    for (int n = 0; n < 9; ++n) here.said.push_back({fmt::format("d.{}", n), "", "d"});
    CHECK(differences(there, here).back() == "and 7 keys more");
}

TEST_CASE("a directory in which nothing was recorded belongs to nobody") {
    const Scratch scratch;
    const fs::path root = scratch.path() / "run";
    const auto enter = [&](const char* scene) { return code_of([&] { begin_run(root, scene); }); };
    CHECK(enter("1") == ExitCode::done);
    fs::create_directories(root / "meshes" / "1-bend");
    CHECK(enter("2") == ExitCode::done);
    put_text(root / "meshes" / "1-bend.obj", "");
    CHECK(enter("2") == ExitCode::done);
    CHECK(enter("1") == ExitCode::foreign);
}

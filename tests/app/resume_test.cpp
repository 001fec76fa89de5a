// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that ended early and go on from the last stage that they finished.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/app/resumed_run.h"
#include "tests/app/small_disk.h"
#include "tests/catch.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;
using namespace resumed;

namespace {

// However slow it is.
const std::vector<std::string> kAtStagesAlone = {"--keep-every", "1 h"};

// Two stages; what the second is at shows.
const std::string kTwo = kOutput +
                         "[[stage]]\nmachine = \"bend\"\nangle = \"10 deg\"\nframes = 2\n"
                         "[[stage]]\nmachine = \"bend\"\nangle = \"20 deg\"\nframes = 40\n";

// Ends a run of these by a signal in the middle of the second.
Outcome end_in_second_stage(int signal, const fs::path& scene, const fs::path& out) {
    fs::remove_all(out / "meshes/2-bend");
    std::vector<std::string> words = {"run", scene.string(), "--no-render", "--out", out.string()};
    words.insert(words.end(), kAtStagesAlone.begin(), kAtStagesAlone.end());
    RunningSwage running(words, scene.parent_path());
    while (!fs::exists(out / "meshes/2-bend/frame_0006.obj") && running.is_running()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    running.signal(signal);
    Outcome outcome = running.wait();
    CHECK(outcome.code == 128 + signal);
    REQUIRE(fs::exists(out / "resume/after-1.bin"));
    return outcome;
}

}  // namespace

TEST_CASE(
    "a run that ended early and goes on leaves what one leaves that went through, to the byte",
    "[stress]") {
    const auto& [name, text] = GENERATE(table<std::string, std::string>({
        {"flows, is cut", kMesh + metal("") + worked()},
        {"springs", kMesh + metal("mechanics = \"springs\"\n") + worked()},
        {"boundary", kMesh + metal("") + kBoundary + worked()},
        {"molded anew", kMesh + metal("") + kBoundary + worked("remold = true\n")},
        {"two materials, is cut and molded anew",
         kMesh + metal("") +
             "[[inset]]\nname = \"tin\"\nfrom = [0.2, 0.3, 0.3]\nto = [1, 0.8, 0.7]\n" + worked() +
             "remold = true\n"},
        {"stops at a limit",
         kMesh + metal("") +
             "[[stage]]\nmachine = \"press\"\ndepth = 0.2\nframes = 2\n[[stage.limit]]\n"
             "part = \"plate\"\nforce = \"20 kN\"\n" +
             worked() + "[[stage.limit]]\npart = \"draw\"\nforce = \"1 kN\"\n"},
        {"meshes of every frame", kMesh + metal("") + kOutput + worked()},
        {"breaks in motion, boundary",
         kMesh + falls(8) + kBrittle + kMold + kBoundary + floor(12) + floor(12) + floor(12)},
        {"breaks in motion, two bodies of two materials, is cut",
         kBox + falls(4) + kBrittle + kMold +
             "[[body]]\nname = \"other\"\nfile = \"box.obj\"\nat = [0, \"8 cm\", 0]\n"
             "velocity = [0, \"-8 m/s\", 0]\nacross = 2\n"
             "[[inset]]\nname = \"lead\"\nfrom = [0.3, 0.2, 0.2]\nto = [0.55, 0.7, 0.7]\n" +
             floor(3) + "[[stage]]\nmachine = \"cut\"\nframes = 4\nduration = \"4 ms\"\n" +
             floor(3)},
        {"breaks in motion and lies on itself",
         kMesh + falls(8) + kBrittle + "[mold]\nacross = 3\n" + floor(6) + "self_contact = true\n" +
             floor(6) + "self_contact = true\n" + floor(6) + "self_contact = true\n"},
        {"strike each other", kBox + kBrittle + kMold +
                                  "[[body]]\nname = \"other\"\nfile = \"box.obj\"\n"
                                  "at = [0, \"2.05 cm\", 0]\n"
                                  "velocity = [0, \"-2 m/s\", 0]\nacross = 2\n" +
                                  "[[stage]]\nmachine = \"floor\"\nframes = 4\n"
                                  "duration = \"0.5 ms\"\n" +
                                  floor(8)},
    }));
    INFO(name);
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), text), whole = scratch.path() / "whole",
                   out = scratch.path() / "run";
    const Outcome at_once = run(scene, whole);
    INFO(at_once.err);
    REQUIRE(at_once.code == 0);
    const std::uintmax_t size = fs::file_size(whole / "motion.bin");
    // It ends early, goes on, ends early again, and goes on from there.
    for (const double share : {0.5, 0.95}) {
        const SmallDisk disk(static_cast<std::uintmax_t>(share * double(size)));
        const Outcome outcome = run(scene, out, kAtStagesAlone);
        INFO(outcome.err);
        CHECK(outcome.code == 5);
        const Json record = parse_json(bytes_of(out / "run.json"));
        CHECK(record.contains("went_on_from") == (share > 0.5));
    }
    check_goes_through(scene, whole, out, "goes on after stage ");
}

TEST_CASE("a run that was killed or interrupted within a stage goes on from the one before") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh + metal("") + kTwo),
                   whole = scratch.path() / "whole", out = scratch.path() / "run";
    REQUIRE(run(scene, whole).code == 0);
    // Again and again, in whatever order.
    for (const int signal : {SIGKILL, SIGINT, SIGKILL, SIGKILL, SIGINT}) {
        const Outcome ended = end_in_second_stage(signal, scene, out);
        INFO(ended.err);
        if (signal == SIGINT) {
            CHECK(parse_json(bytes_of(out / "run.json")).at("state") == "interrupted");
            CHECK(ended.err.find("swage run goes on after stage 1 of 2") != std::string::npos);
            CHECK_FALSE(fs::exists(out / "resume/motion.bin"));
        }
    }
    check_goes_through(scene, whole, out, "goes on after stage 1 of 2, frame 3");
}

TEST_CASE("a run that is to be fresh begins anew, and so does one whose checkpoint is damaged",
          "[stress]") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh + metal("") + kTwo),
                   whole = scratch.path() / "whole", out = scratch.path() / "run";
    REQUIRE(run(scene, whole).code == 0);
    const fs::path checkpoint = out / "resume/after-1.bin";
    const auto anew = [&](const std::string& told, std::vector<std::string> more = {}) {
        const Outcome outcome = run(scene, out, std::move(more));
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(outcome.err.find("goes on after") == std::string::npos);
        CHECK(outcome.err.find(told) != std::string::npos);
        check_same(whole, out);
        fs::remove_all(out);
    };
    end_in_second_stage(SIGKILL, scene, out);
    anew("molded", {"--fresh"});

    end_in_second_stage(SIGINT, scene, out);
    std::string bytes = bytes_of(checkpoint);
    bytes[bytes.size() / 2] ^= 1;
    put_text(checkpoint, bytes);
    anew("after-1.bin: is damaged, so stage 1 begins anew");

    end_in_second_stage(SIGKILL, scene, out);
    bytes = bytes_of(out / "resume/motion.bin");
    bytes[1000] ^= 1;
    put_text(out / "resume/motion.bin", bytes);
    anew("goes with a motion file that is damaged, so stage 1 begins anew");

    // Of another run, in the place of this one's.
    const fs::path other = scratch.path() / "other";
    end_in_second_stage(SIGINT, scene, out);
    put_text(scratch.path() / "softer.toml", kMesh + "[material]\nname = \"tin\"\n" + kMold + kTwo);
    end_in_second_stage(SIGINT, scratch.path() / "softer.toml", other);
    fs::copy_file(other / "resume/after-1.bin", checkpoint, fs::copy_options::overwrite_existing);
    anew("belongs to another run or another build of swage, so stage 1 begins anew");
}

TEST_CASE("a fresh run that cannot start leaves what another may go on from") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh + metal("") + kTwo),
                   out = scratch.path() / "run";
    end_in_second_stage(SIGINT, scene, out);
    const auto before = files_below(out);
    CHECK(run(scene, out, {"--fresh", "--set", "stage.1.radius=1 um"}).code == 3);
    CHECK(run(scene, out, {"--set", "stage.2.frames=3"}).code == 8);
    CHECK(files_below(out) == before);
}

TEST_CASE("a run goes on where its checkpoint finds no room") {
    const Scratch scratch;
    // Of so much matter, in so few frames, that nothing else is as large.
    const std::string stage = "[[stage]]\nmachine = \"bend\"\nangle = \"2 deg\"\nframes = 1\n";
    const fs::path scene = put_scene(scratch.path(), kMesh +
                                                         "[material]\nname = \"rubber\"\n"
                                                         "[mold]\nacross = 9\n" +
                                                         stage + stage);
    const fs::path whole = scratch.path() / "whole", out = scratch.path() / "run";
    REQUIRE(run(scene, whole).code == 0);
    std::uintmax_t largest = 0;
    for (const auto& [name, bytes] : products(whole)) {
        largest = std::max<std::uintmax_t>(largest, bytes.size());
    }
    const SmallDisk disk(largest);
    const Outcome outcome = run(scene, out);
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.find("no run can go on from here") != std::string::npos);
    check_same_but_for({"after-1.bin: cannot be written", "after-2.bin: cannot be written"}, whole,
                       out);
}

TEST_CASE(
    "where later stages were changed a run goes on from those before them when it is asked to",
    "[stress]") {
    const Scratch scratch;
    const std::string head = kMesh + metal("") + "[output]\nmeshes_per_frame = true\n",
                      first = "[[stage]]\nmachine = \"bend\"\nangle = \"10 deg\"\nframes = 2\n",
                      second = "[[stage]]\nmachine = \"bend\"\nangle = \"20 deg\"\nframes = 40\n",
                      twist = "[[stage]]\nmachine = \"twist\"\nangle = \"9 deg\"\nframes = 3\n";
    const fs::path scene = put_scene(scratch.path(), head + first + second),
                   whole = scratch.path() / "whole", out = scratch.path() / "run";
    const auto as = [&](const std::string& text) { put_text(scene, text); };
    // But for what a killed run did not clear away, and what of its motion file is not whole.
    const auto kept = [&] {
        auto files = files_below(out);
        std::erase_if(files, [](const auto& file) {
            return file.first[0] == '.' || file.first.find("/.") != std::string::npos;
        });
        files.erase("resume/motion.bin");
        return files;
    };
    std::map<std::string, std::string> before;
    const auto end_by = [&](int signal) {
        end_in_second_stage(signal, scene, out);
        before = kept();
    };
    const auto is_refused = [&](const std::vector<std::string>& more, const std::string& told) {
        const Outcome outcome = run(scene, out, more);
        INFO(outcome.err);
        CHECK(outcome.code == 8);
        CHECK(outcome.err.find(told) != std::string::npos);
        CHECK((kept() == before));
    };
    SECTION("another machine, and one more") {
        end_by(SIGKILL);
        as(head + first + twist + second);
        is_refused({}, "choose another --out, or --go-on to keep its first stage, or --fresh");
    }
    SECTION("a remark and a parameter") {
        end_by(SIGINT);
        as("# Softly.\n" + head + first + "\n\n" + second + "radius = \"4 cm\"\n");
    }
    SECTION("fewer") {
        end_by(SIGKILL);
        as(head + first);
    }
    SECTION("another first stage") {
        end_by(SIGINT);
        as(head + twist + second);
        is_refused({}, "choose another --out, or --fresh");
        is_refused({"--go-on"}, "has kept no stage to go on from that is the same");
        return;
    }
    SECTION("another material") {
        end_by(SIGKILL);
        as(kMesh + metal("friction = 0.5\n") + "[output]\nmeshes_per_frame = true\n" + first +
           twist);
        is_refused({"--go-on"}, "has kept no stage to go on from that is the same");
        return;
    }
    SECTION("a stage that cannot be set up leaves what was there") {
        end_by(SIGINT);
        as(head + first + twist + "[[stage]]\nmachine = \"bend\"\n");
        CHECK(run(scene, out,
                  {"--go-on", "--set", "stage.2.machine=bend", "--set", "stage.2.radius=1 um"})
                  .code == 3);
        CHECK((kept() == before));
    }
    const Outcome outcome = run(scene, out, {"--go-on"});
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.find("goes on after stage 1 of ") != std::string::npos);
    REQUIRE(run(scene, whole).code == 0);
    check_same(whole, out);
    CHECK(run(scene, out, {"--go-on", "--fresh"}).code == 2);
}

TEST_CASE("a machine's file that was changed is told from one that only later stages use") {
    const Scratch scratch;
    const fs::path scene =
        put_scene(scratch.path(), kMesh + metal("") +
                                      "[[stage]]\nmachine = \"./one.toml\"\nframes = 2\n"
                                      "[[stage]]\nmachine = \"./two.toml\"\nframes = 40\n");
    const fs::path out = scratch.path() / "run";
    const auto machine = [&](const char* name, const char* turn) {
        put_text(scratch.path() / name,
                 fmt::format("[[grip]]\nname = \"left\"\nfrom = [\"-length\", \"-height\", "
                             "\"-width\"]\nto = [\"-length/3\", \"height\", \"width\"]\n"
                             "[[grip]]\nname = \"right\"\nfrom = [\"length/3\", \"-height\", "
                             "\"-width\"]\nto = [\"length\", \"height\", \"width\"]\n"
                             "[grip.motion]\nturn = \"{}*t\"\naxis = [1, 0, 0]\n",
                             turn));
    };
    machine("one.toml", "0.1"), machine("two.toml", "0.2");
    {
        RunningSwage running({"run", scene.string(), "--no-render", "--out", out.string()},
                             scratch.path());
        while (!fs::exists(out / "resume/after-1.bin") && running.is_running()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        running.signal(SIGKILL);
        const Outcome outcome = running.wait();
        INFO(outcome.err);
        REQUIRE(fs::exists(out / "resume/after-1.bin"));
    }
    machine("one.toml", "0.11");
    CHECK(run(scene, out, {"--go-on"}).code == 8);
    machine("one.toml", "0.1"), machine("two.toml", "0.3");
    CHECK(run(scene, out).code == 8);
    CHECK(run(scene, out, {"--go-on"}).code == 0);
    const fs::path whole = scratch.path() / "whole";
    REQUIRE(run(scene, whole).code == 0);
    check_same(whole, out);
}

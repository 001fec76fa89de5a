// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that ended early and go on from within the stage that they were at.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "tests/app/resumed_run.h"
#include "tests/app/small_disk.h"
#include "tests/shared/scratch.h"

using namespace resumed;

namespace {

const std::vector<std::string> kEachFrame = {"--keep-every", "0 s"};

std::string stage(const std::string& machine, const std::string& more) {
    return "[[stage]]\nmachine = \"" + machine + "\"\n" + more + "\n";
}

// Of what such a run leaves, a mesh of this frame.
std::string mesh_of_frame(const fs::path& whole, int frame) {
    const std::string ending = fmt::format("/frame_{:04d}.obj", frame);
    for (const auto& [name, bytes] : files_below(whole)) {
        if (name.ends_with(ending)) return name;
    }
    FAIL("no mesh of frame " << frame);
    return {};
}

// Runs until it comes to that frame, whose mesh cannot be written.
Outcome run_up_to(int frame, const fs::path& scene, const fs::path& whole, const fs::path& out) {
    const fs::path barrier = out / mesh_of_frame(whole, frame);
    fs::create_directories(barrier);
    if (!fs::exists(out / ".swage-run")) fs::copy_file(whole / ".swage-run", out / ".swage-run");
    Outcome outcome = run(scene, out, kEachFrame);
    fs::remove(barrier);
    return outcome;
}

// It is ended at these frames, one after the other, and at last goes through.
void check_goes_on(const std::string& text, const std::vector<int>& frames) {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), text), whole = scratch.path() / "whole",
                   out = scratch.path() / "run";
    const Outcome at_once = run(scene, whole);
    INFO(at_once.err);
    REQUIRE(at_once.code == 0);
    std::optional<int> last;
    const auto check_told = [&](const Outcome& outcome) {
        if (!last) return;
        CHECK(outcome.err.find(fmt::format("goes on from frame {}, in stage ", *last)) !=
              std::string::npos);
    };
    for (const int frame : frames) {
        const Outcome outcome = run_up_to(frame, scene, whole, out);
        INFO(outcome.err);
        CHECK(outcome.code == 5);
        check_told(outcome);
        last = frame - 1;
        CHECK(fs::exists(out / "resume/stage.bin"));
        const Json record = parse_json(bytes_of(out / "run.json"));
        CHECK(record.at("goes_on_from").at("frame") == *last);
        CHECK(outcome.err.find(fmt::format("swage run goes on from frame {}, in stage ", *last)) !=
              std::string::npos);
    }
    const Outcome outcome = run(scene, out, kEachFrame);
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    check_told(outcome);
    check_same(whole, out);
}

// Goes to pieces over several frames, which meet.
const std::string kFiner = "[mold]\nacross = 3\n";

const std::string kBends = stage("bend", "angle = \"40 deg\"\nframes = 10");

}  // namespace

TEST_CASE("what is at rest goes on from within a stage, to the byte", "[stress]") {
    const std::string lead = kMesh + metal("") + kOutput,
                      ice = kMesh + "[material]\nname = \"ice\"\n" + kFiner + kOutput;
    const auto& [name, text] = GENERATE_COPY(table<std::string, std::string>({
        {"flows", lead + kBends},
        {"is smooth", kMesh + "[material]\nname = \"rubber\"\n[mold]\nacross = 6\n" + kOutput +
                          stage("twist", "angle = \"150 deg\"\nframes = 10")},
        {"breaks and meets itself",
         ice + stage("bend", "angle = \"3 deg\"\nframes = 10\nself_contact = true")},
        {"slides on tools", kMesh + "[material]\nname = \"rubber\"\nfriction = 0.4\n" + kMold +
                                kOutput + stage("press", "depth = 0.3\nframes = 10")},
        {"is pressed a little", kMesh + "[material]\nname = \"rubber\"\nfriction = 0.4\n" + kMold +
                                    kOutput + stage("press", "depth = 0.03\nframes = 10")},
        {"springs that yield", kMesh + metal("mechanics = \"springs\"\n") + kOutput + kBends},
        {"is cut", lead + stage("cut", "tilt = \"20 deg\"\nframes = 10")},
        {"is cut, boundary", lead + kBoundary + stage("cut", "tilt = \"20 deg\"\nframes = 10")},
        {"stops at a limit", lead + stage("press", "depth = 0.2\nframes = 10") +
                                 "[[stage.limit]]\npart = \"plate\"\nforce = \"20 kN\"\n"},
        {"breaks", ice + kBoundary + stage("bend", "angle = \"3 deg\"\nframes = 10")},
        {"of two materials",
         lead + "[[inset]]\nname = \"tin\"\nfrom = [0.3, 0.2, 0.2]\nto = [0.55, 0.7, 0.7]\n" +
             stage("stretch", "strain = 0.1\nframes = 10")},
        {"hangs and is loaded", lead + stage("hold", "gravity = \"9.81 m/s2\"\nframes = 10") +
                                    "[[stage.load]]\nname = \"wind\"\npressure = \"20 kPa\"\n"},
    }));
    INFO(name);
    check_goes_on(text, {3, 5, 9});
}

TEST_CASE("what is in motion goes on from within a stage, to the byte") {
    const std::string rubber = "[material]\nname = \"rubber\"\nfriction = 0.5\n",
                      other =
                          "[[body]]\nname = \"other\"\nfile = \"box.obj\"\n"
                          "at = [0, \"3.2 cm\", 0]\nacross = 2\n";
    const auto fall = [](const std::string& more) {
        return stage("floor", "drop = \"2 mm\"\ngravity = \"9.81 m/s2\"\nframes = 10\n" + more);
    };
    const std::string quick = "duration = \"20 ms\"";
    const auto& [name, text] = GENERATE_COPY(table<std::string, std::string>({
        {"bounces and slides",
         kMesh + falls(1) + rubber + kMold + kOutput + fall("duration = \"8 ms\"")},
        {"flows", kMesh + falls(8) + metal("damping_ratio = 0.02\n") + kOutput + floor(10)},
        {"springs that yield", kMesh + falls(8) +
                                   metal("mechanics = \"springs\"\ndamping_ratio = 0.02\n") +
                                   kOutput + floor(10)},
        {"breaks, boundary", kMesh + falls(8) + kBrittle + kMold + kBoundary + kOutput + floor(10)},
        {"two bodies of two materials, is cut",
         kBox + falls(4) + kBrittle + kMold + other +
             "[[inset]]\nname = \"lead\"\nfrom = [0.3, 0.2, 0.2]\nto = [0.55, 0.7, 0.7]\n" +
             kOutput + stage("cut", "frames = 10\nduration = \"4 ms\"")},
        {"a body strikes another", kBox + rubber + kMold + other +
                                       "velocity = [0, \"-1 m/s\", 0]\n" + kOutput +
                                       fall("duration = \"6 ms\"")},
        {"breaks and meets itself", kMesh + falls(8) + kBrittle + kFiner + kOutput +
                                        stage("floor",
                                              "drop = \"2 mm\"\nframes = 10\nduration = \"4 ms\"\n"
                                              "self_contact = true")},
        {"falls asleep", "[mesh]\nfile = \"cube.obj\"\n" + rubber +
                             "damping_ratio = 0.3\nyoung_modulus = \"100 kPa\"\n" + kMold +
                             "[[body]]\nname = \"other\"\nfile = \"cube.obj\"\n" +
                             "at = [0, \"2.5 cm\", 0]\nacross = 2\n" + kOutput +
                             stage("floor",
                                   "drop = \"1 mm\"\ngravity = \"9.81 m/s2\"\nframes = 10\n"
                                   "duration = \"1.6 s\"\ncontact_stiffness = 0.1")},
        {"breaks in a medium", kMesh + falls(8) + kBrittle + kMold + kOutput +
                                   stage("floor",
                                         "drop = \"2 mm\"\nframes = 10\nduration = \"4 ms\"\n"
                                         "medium_density = \"1000 kg/m3\"")},
        {"implicit", kMesh + falls(1) + rubber + kMold + kOutput +
                         fall(quick + std::string("\nsolver = \"implicit\""))},
        {"by energy", kMesh + falls(1) + rubber + kMold + kOutput +
                          fall("duration = \"2 ms\"\nsolver = \"energy-stepped\"")},
        {"euler", kMesh + falls(1) + rubber + kMold + kOutput +
                      fall("duration = \"2 ms\"\nsolver = \"euler\"")},
    }));
    INFO(name);
    check_goes_on(text, {3, 5, 9});
}

TEST_CASE("a run goes on within whichever stage it was at") {
    check_goes_on(kMesh + metal("") + kBoundary + kOutput + kBends +
                      stage("cut", "tilt = \"20 deg\"\nframes = 5\nremold = true") +
                      stage("stretch", "strain = 0.05\nframes = 5"),
                  {6, 14, 15, 19});
}

TEST_CASE("what broke and met itself in the stage before goes on within the next", "[stress]") {
    const std::string falls_on = floor(8) + "self_contact = true\n";
    check_goes_on(kMesh + falls(8) + kBrittle + kFiner + kOutput + falls_on + falls_on,
                  {5, 11, 14});
}

TEST_CASE("a body of two materials that is cut and molded anew goes on within any stage") {
    check_goes_on(kMesh + metal("") +
                      "[[inset]]\nname = \"tin\"\nfrom = [0.2, 0.3, 0.3]\nto = [1, 0.8, 0.7]\n" +
                      kOutput + stage("cut", "tilt = \"20 deg\"\nframes = 5") +
                      stage("stretch", "strain = 0.05\nframes = 5\nremold = true") +
                      stage("twist", "angle = \"9 deg\"\nframes = 3\nremold = true"),
                  {3, 8, 13});
}

TEST_CASE("a run that ends again before any more of it is kept loses nothing that was") {
    const std::string text = kMesh + metal("") + kOutput;
    check_goes_on(text + kBends, {5, 5, 9});
    check_goes_on(text + stage("twist", "angle = \"9 deg\"\nframes = 3") + kBends, {8, 8, 12});
}

TEST_CASE("where later stages were changed, a run goes on within the one that it was at") {
    const Scratch scratch;
    const auto text = [](const char* strain) {
        return kMesh + metal("") + kOutput + stage("twist", "angle = \"9 deg\"\nframes = 3") +
               kBends + stage("stretch", std::string("frames = 3\nstrain = ") + strain);
    };
    const fs::path scene = put_scene(scratch.path(), text("0.05")),
                   whole = scratch.path() / "whole", out = scratch.path() / "run",
                   other = scratch.path() / "other";
    REQUIRE(run(scene, whole).code == 0);
    run_up_to(9, scene, whole, out);
    put_scene(scratch.path(), text("0.03"));
    REQUIRE(run(scene, other).code == 0);
    check_goes_through(scene, other, out, "goes on from frame 8, in stage 2 of 3", {"--go-on"});
}

TEST_CASE("what is kept of a stage that is damaged is told, and the stage begins anew") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh + metal("") + kOutput + kBends),
                   whole = scratch.path() / "whole", out = scratch.path() / "run",
                   mark = out / "resume/stage.bin";
    REQUIRE(run(scene, whole).code == 0);
    const auto anew = [&](const std::string& told) {
        const Outcome outcome = run(scene, out, kEachFrame);
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(outcome.err.find(told) != std::string::npos);
        CHECK(outcome.err.find("goes on from") == std::string::npos);
        check_same(whole, out);
        fs::remove_all(out);
    };
    run_up_to(6, scene, whole, out);
    const std::string bytes = bytes_of(mark);
    for (const std::size_t at : {std::size_t(0), bytes.size() / 2, bytes.size() - 1}) {
        std::string damaged = bytes;
        damaged[at] ^= 1;
        put_text(mark, damaged);
        anew("stage.bin: is damaged, so stage 1 begins anew");
        run_up_to(6, scene, whole, out);
    }
    put_text(mark, bytes.substr(0, bytes.size() / 3));
    anew("stage.bin: is damaged, so stage 1 begins anew");

    run_up_to(6, scene, whole, out);
    std::string motion = bytes_of(out / "motion.bin");
    motion[1000] ^= 1;
    put_text(out / "motion.bin", motion);
    anew("stage.bin: goes with a motion file that is damaged, so stage 1 begins anew");
}

TEST_CASE("a run that was killed goes on from the last frame that was kept") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh + metal("") + kOutput +
                                                         stage("bend",
                                                               "angle = \"20 deg\"\nframes = "
                                                               "30")),
                   whole = scratch.path() / "whole", out = scratch.path() / "run";
    REQUIRE(run(scene, whole).code == 0);
    for (const auto& [signal, frame] : {std::pair(SIGKILL, 6), {SIGINT, 12}, {SIGKILL, 18}}) {
        std::vector<std::string> all = {"run", scene.string(), "--no-render", "--out",
                                        out.string()};
        all.insert(all.end(), kEachFrame.begin(), kEachFrame.end());
        RunningSwage running(all, scratch.path());
        const fs::path seen = out / fmt::format("meshes/1-bend/frame_{:04d}.obj", frame);
        while (!fs::exists(seen) && running.is_running()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        running.signal(signal);
        const Outcome ended = running.wait();
        INFO(ended.err);
        CHECK(ended.code == 128 + signal);
        CHECK(fs::exists(out / "resume/stage.bin"));
        CHECK((frame == 6 || ended.err.find("goes on from frame ") != std::string::npos));
        const Json record = parse_json(bytes_of(out / "run.json"));
        CHECK(record.at("state") == (signal == SIGKILL ? "begun" : "interrupted"));
        CHECK(record.at("goes_on_from").at("stage") == 1);
        CHECK(record.at("goes_on_from").at("frame") >= frame - 1);
        CHECK(record.contains("went_on_from") == (frame > 6));
    }
    check_goes_through(scene, whole, out, "goes on from frame ");
}

TEST_CASE("a stage goes on where what is kept of it finds no room") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh +
                                                         "[material]\nname = \"rubber\"\n"
                                                         "[mold]\nacross = 9\n" +
                                                         stage("bend",
                                                               "angle = \"2 deg\"\n"
                                                               "frames = 2"));
    const fs::path whole = scratch.path() / "whole", out = scratch.path() / "run";
    REQUIRE(run(scene, whole).code == 0);
    std::uintmax_t largest = 0;
    for (const auto& [name, bytes] : products(whole)) {
        largest = std::max<std::uintmax_t>(largest, bytes.size());
    }
    const SmallDisk disk(largest);
    const Outcome outcome = run(scene, out, kEachFrame);
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.find("what comes of this stage is not kept") != std::string::npos);
    check_same_but_for({"stage.bin: cannot be written", "after-1.bin: cannot be written"}, whole,
                       out);
}

TEST_CASE("how often a run is to be kept is a time") {
    const Scratch scratch;
    const fs::path scene = put_scene(scratch.path(), kMesh + metal("") + kBends);
    for (const char* wrong : {"-1 s", "5 cm", "often"}) {
        const Outcome outcome = run(scene, scratch.path() / "run", {"--keep-every", wrong});
        INFO(outcome.err);
        CHECK(outcome.code == 2);
        CHECK(outcome.err.find("--keep-every") != std::string::npos);
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that are done, of which stages are changed: those before them are not worked again.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "tests/app/resumed_run.h"
#include "tests/shared/scratch.h"

using namespace resumed;

namespace {

std::string stage(const std::string& machine, const std::string& more) {
    return "[[stage]]\nmachine = \"" + machine + "\"\n" + more + "\n";
}

using Stages = std::vector<std::string>;
std::string text_of(const std::string& head, const Stages& stages) {
    std::string text = head;
    for (const std::string& one : stages) text += one;
    return text;
}

// A line of three and what others make of each, of the machines that a scene can have.
struct Line {
    std::string head;
    Stages stages, others;
};

const std::string kFrames = "frames = 3\n";
const Stages kAtRest = {stage("bend", "angle = \"40 deg\"\n" + kFrames),
                        stage("cut", "tilt = \"20 deg\"\n" + kFrames),
                        stage("stretch", "strain = 0.05\n" + kFrames)},
             kAtRestToo = {stage("bend", "angle = \"30 deg\"\n" + kFrames),
                           stage("twist", "angle = \"40 deg\"\n" + kFrames),
                           stage("press", "depth = 0.1\n" + kFrames)};
Stages molded_anew(Stages stages) {
    for (std::string& one : stages) one += "remold = true\n";
    stages.front() = kAtRest.front();
    return stages;
}

void check_as_from_nothing(const fs::path& scene, const fs::path& out, const fs::path& scratch) {
    const fs::path whole = scratch / "whole";
    fs::remove_all(whole);
    const Outcome outcome = run(scene, whole);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    check_same(whole, out);
}

// One run of these, in its folder `run`.
struct DoneRun {
    Scratch scratch;
    std::string head;
    fs::path scene, out = scratch.path() / "run";

    DoneRun(const std::string& head_, const Stages& stages)
        : head(head_), scene(put_scene(scratch.path(), text_of(head_, stages))) {
        const Outcome outcome = run(scene, out);
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
    }
    void put(const Stages& stages) const { put_text(scene, text_of(head, stages)); }
    void check() const { check_as_from_nothing(scene, out, scratch.path()); }
    Outcome go_on(const std::vector<std::string>& more = {"--go-on"}) const {
        return run(scene, out, more);
    }
};

// Ends a run of it by a signal as soon as anything of the stage that it is within is kept.
Outcome end_once_kept(int signal, const fs::path& scene, const fs::path& out,
                      const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"run",        scene.string(), "--no-render", "--out",
                                      out.string(), "--keep-every", "0 s"};
    words.insert(words.end(), more.begin(), more.end());
    RunningSwage running(words, scene.parent_path());
    while (!fs::exists(out / "resume/stage.bin") && running.is_running()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    running.signal(signal);
    const Outcome outcome = running.wait();
    INFO(outcome.err);
    REQUIRE(outcome.code == 128 + signal);
    return outcome;
}

}  // namespace

TEST_CASE("of a run that is done only what was changed is worked, to the same bytes", "[stress]") {
    const std::string lead = kMesh + metal("") + kOutput;
    const auto& [name, line] = GENERATE_COPY(table<std::string, Line>({
        {"mounted, fields, meshes of frames", {lead, kAtRest, kAtRestToo}},
        {"springs",
         {kMesh + metal("mechanics = \"springs\"\n"),
          kAtRest,
          {"", stage("twist", "angle = \"5 deg\"\n" + kFrames),
           stage("stretch", "strain = 0.02\n" + kFrames)}}},
        {"boundary, molded anew",
         {kMesh + metal("") + kBoundary, molded_anew(kAtRest), molded_anew(kAtRestToo)}},
        {"bodies in motion that break",
         {kBox + falls(4) + kBrittle + kMold +
              "[[body]]\nname = \"other\"\nfile = \"box.obj\"\nat = [0, \"8 cm\", 0]\n"
              "velocity = [0, \"-8 m/s\", 0]\nacross = 2\n",
          {floor(3), stage("cut", "frames = 4\nduration = \"4 ms\""), floor(3)},
          {floor(4), floor(2), floor(5)}}},
    }));
    INFO(name);
    const DoneRun done(line.head, line.stages);
    const auto goes_on = [&](const Stages& stages, int kept) {
        done.put(stages);
        CHECK(done.go_on({}).code == 8);
        const Outcome outcome = done.go_on();
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(says(outcome.err,
                   fmt::format("goes on after stage {} of {}, frame ", kept, stages.size())));
        done.check();
        CHECK_FALSE(fs::exists(done.out / "replaced"));
        CHECK(parse_json(bytes_of(done.out / "run.json")).at("went_on_from").at("stage") ==
              std::min(kept + 1, int(stages.size())));
    };
    const Stages &a = line.stages, &b = line.others;
    goes_on({a[0], a[1], b[2]}, 2);
    goes_on({a[0], a[1], b[2], a[2]}, 3);
    // Another before that, fewer and as many again: of files, whatever the matter.
    if (name != "mounted, fields, meshes of frames") return;
    goes_on({a[0], b[1], b[2]}, 1);
    goes_on({a[0], b[1]}, 2);
    goes_on({a[0], b[1], a[2]}, 2);
}

TEST_CASE("what is drawn may be another with no stage worked, what frames hold may not") {
    const DoneRun done(kMesh + metal(""), {kAtRest[0], kAtRest[2]});
    const auto before = products(done.out);
    const auto with = [&](const std::string& more) {
        put_text(done.scene, text_of(done.head + more, {kAtRest[0], kAtRest[2]}));
    };
    with("[render]\nsize = [64, 64]\nground = false\n");
    CHECK(says(done.go_on({}).err, "render.ground is false now, not there then"));
    CHECK(says(done.go_on().err, "goes on after stage 2 of 2, frame 7: render.ground is false"));
    done.check();
    for (const char* more :
         {"[output]\nmeshes_per_frame = true\n", "[output]\nfields = [\"stress\"]\n",
          "[render]\ncolor = \"stress\"\n", "[render]\nfps = 12\n"}) {
        with(more);
        const auto files = files_below(done.out);
        const Outcome outcome = done.go_on();
        INFO(more << outcome.err);
        CHECK(outcome.code == 8);
        CHECK(says(outcome.err, "has kept no stage to go on from that is the same"));
        CHECK(files_below(done.out) == files);
    }
}

TEST_CASE("meshes of every frame are named as a new first frame asks") {
    const DoneRun done(kMesh + metal("") + "[output]\nmeshes_per_frame = true\n",
                       {kAtRest[0], kAtRest[2]});
    put_text(done.scene,
             text_of(done.head + "[render]\nfirst_frame = 1001\n", {kAtRest[0], kAtRest[2]}));
    const Outcome outcome = done.go_on();
    INFO(outcome.err);
    CHECK(outcome.code == 8);
}

TEST_CASE("where a run cannot be set aside it is not touched") {
    const DoneRun done(kMesh + metal(""), {kAtRest[0], kAtRest[2]});
    const bool is_folder = GENERATE(true, false);
    if (is_folder) fs::create_directory(done.out / "replaced");
    put_text(is_folder ? done.out / "replaced/mine.txt" : done.out / "replaced", "mine");
    const auto before = files_below(done.out);
    done.put({kAtRest[0], kAtRestToo[1]});
    const Outcome outcome = done.go_on();
    INFO(outcome.err);
    CHECK(outcome.code == 8);
    CHECK(says(outcome.err, "replaced: is where the run that is there would be set aside"));
    CHECK(files_below(done.out) == before);
}

TEST_CASE("a run that ended within its first stage is gone on with after a later one is changed") {
    const Scratch scratch;
    const fs::path out = scratch.path() / "run";
    const std::string head = kMesh + metal(""),
                      first = stage("bend", "angle = \"40 deg\"\nframes = 40");
    const fs::path scene = put_scene(scratch.path(), head + first + kAtRest[2]);
    end_once_kept(SIGINT, scene, out);
    put_text(scene, head + first + kAtRestToo[1]);
    const Outcome outcome = run(scene, out, {"--go-on"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(says(outcome.err, "in stage 1 of 2"));
    check_as_from_nothing(scene, out, scratch.path());
}

TEST_CASE("a run that is replaced stays whole until the new one is", "[stress]") {
    const DoneRun done(kMesh + metal("") + kOutput, kAtRest);
    const auto before = files_below(done.out);
    const fs::path replaced = done.out / "replaced";
    // It cannot be set up: nothing is touched, which is told, and run.json tells of what is there.
    done.put({kAtRest[0], stage("bend", "radius = \"1 um\"\n")});
    const Outcome in_vain = done.go_on();
    INFO(in_vain.err);
    CHECK(in_vain.code == 3);
    CHECK(says(in_vain.err, done.out.string() + ": the run that was there stays as it was"));
    CHECK(files_below(done.out) == before);
    // It ends early, in a stage and after one.
    const Stages longer = {kAtRest[0], stage("twist", "angle = \"40 deg\"\nframes = 40"),
                           kAtRest[2]};
    done.put(longer);
    const int signal = GENERATE(SIGKILL, SIGINT);
    const std::vector<std::string> words = {
        "run",     done.scene.string(), "--no-render", "--out", done.out.string(),
        "--go-on", "--keep-every",      "0 s"};
    {
        RunningSwage running(words, done.scratch.path());
        while (!fs::exists(done.out / "meshes/2-twist/frame_0012.obj") && running.is_running()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        running.signal(signal);
        const Outcome outcome = running.wait();
        INFO(outcome.err);
        CHECK(outcome.code == 128 + signal);
        CHECK(says(outcome.err, "the run that was there stands in " + replaced.string()));
    }
    CHECK(files_below(replaced) == before);
    const Json record = parse_json(bytes_of(done.out / "run.json"));
    CHECK(record.at("state") == (signal == SIGINT ? "interrupted" : "begun"));
    CHECK(record.at("went_on_from") == Json({{"stage", 2}, {"frame", 4}}));
    CHECK(record.at("goes_on_from").at("stage") == 2);
    CHECK(record.at("goes_on_from").at("frame") > 4);
    // Changed once more, it is of one that is not done: what was done stays all the same.
    done.put({kAtRest[0], kAtRestToo[1], stage("bend", "radius = \"1 um\"\n")});
    CHECK(done.go_on().code == 3);
    CHECK(files_below(replaced) == before);
    done.put(longer);
    CHECK(done.go_on().code == 0);
    done.check();
    CHECK_FALSE(fs::exists(replaced));
}

TEST_CASE("what a changed run that ended early foresees of its stages is told, and no more") {
    // Before the bar is stretched, each bend wants more of it than there is.
    const auto bend = [](const char* overhang) {
        return stage("bend", std::string("angle = \"20 deg\"\nframes = 2\noverhang = \"") +
                                 overhang + "\"\n");
    };
    const std::string stretched = stage("stretch", "strain = 1.5\n" + kFrames);
    const DoneRun done(kMesh + "[material]\nname = \"rubber\"\n" + kMold,
                       {stretched, bend("10.5 cm")});
    const std::string of_new = "overhang = 10.6 cm is out of range";
    done.put({stretched, stage("twist", "angle = \"40 deg\"\nframes = 1600"), bend("10.6 cm")});
    CHECK(says(end_once_kept(SIGKILL, done.scene, done.out, {"--go-on"}).err, of_new));
    const Outcome outcome = done.go_on({});
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(says(outcome.err, "in stage 2 of 3"));
    CHECK(says(outcome.err, of_new));
    CHECK(bytes_of(done.out / "run.json").find("is out of range") == std::string::npos);
    done.check();
}

TEST_CASE("meshes of stages that are kept have their materials, however they are called") {
    const auto called = [](const char* name, const std::string& of) {
        std::string text = of;
        return text.insert(text.find('\n') + 1, std::string("name = \"") + name + "\"\n");
    };
    const Stages stages = {called("my first", kAtRest[0]), called("my # cut", kAtRest[1]),
                           kAtRest[2]};
    const DoneRun done(kMesh + metal(""), stages);
    CHECK(fs::exists(done.out / "meshes/my_first.mtl"));
    done.put({stages[0], stages[1], kAtRestToo[2]});
    CHECK(done.go_on().code == 0);
    done.check();
}

TEST_CASE("a stage that ended early leaves no materials beside those of its end", "[stress]") {
    const Scratch scratch;
    const fs::path out = scratch.path() / "run", meshes = out / "meshes";
    const fs::path scene = put_scene(
        scratch.path(), kMesh + metal("") + stage("cut", "name = \"my cut\"\nframes = 1600"));
    end_once_kept(SIGINT, scene, out);
    // Nothing is cut yet, and so nothing has a colour of its own inside.
    REQUIRE(bytes_of(meshes / "my_cut.mtl").find("cut") == std::string::npos);
    const Outcome outcome = run(scene, out);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    check_as_from_nothing(scene, out, scratch.path());
}

TEST_CASE("a run that is asked to be fresh throws away what it replaced, too") {
    const DoneRun done(kMesh + metal(""), {kAtRest[0], kAtRest[2]});
    done.put({kAtRest[0], stage("bend", "radius = \"1 um\"\n")});
    fs::create_directory(done.out / "replaced");
    fs::copy_file(done.out / ".swage-run", done.out / "replaced/.swage-run");
    done.put({kAtRest[2]});
    CHECK(done.go_on({"--fresh"}).code == 0);
    done.check();
}

TEST_CASE("what was kept of a stage and is damaged is told, and an earlier one serves",
          "[stress]") {
    const DoneRun done(kMesh + metal("") + kOutput, kAtRest);
    const fs::path copy = done.scratch.path() / "copy";
    fs::copy(done.out, copy, fs::copy_options::recursive);
    const auto as_it_was = [&] {
        fs::remove_all(done.out);
        fs::copy(copy, done.out, fs::copy_options::recursive);
    };
    done.put({kAtRest[0], kAtRest[1], kAtRestToo[2]});
    const auto serves = [&](int kept, const std::string& told) {
        const Outcome outcome = done.go_on();
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(says(outcome.err, told));
        CHECK(says(outcome.err, fmt::format("goes on after stage {} of 3", kept)));
        done.check();
        as_it_was();
    };
    const fs::path second = done.out / "resume/after-2.bin";
    const std::string whole = bytes_of(second);
    for (const std::size_t at : {whole.size() / 2, whole.size() - 1}) {
        std::string damaged = whole;
        damaged[at] ^= 1;
        put_text(second, damaged);
        serves(1, "after-2.bin: is damaged, so stage 2 begins anew");
    }
    put_text(second, whole.substr(0, whole.size() / 3));
    serves(1, "after-2.bin: is damaged, so stage 2 begins anew");
    fs::remove(second);
    serves(1, "after-2.bin: is gone, so stage 2 begins anew");
    for (const char* other : {"", "of some other time"}) {
        put_text(second, other);
        serves(1, "after-2.bin: is damaged, so stage 2 begins anew");
    }
    fs::copy_file(done.out / "resume/after-1.bin", second, fs::copy_options::overwrite_existing);
    serves(1, "after-2.bin: is damaged, so stage 2 begins anew");
    fs::remove(done.out / "meshes/2-cut.obj");
    serves(1, "2-cut.obj, which is gone, so stage 2 begins anew");

    // The motion of the second stage ends early, then that of the first is damaged.
    std::string motion = bytes_of(done.out / "motion.bin");
    put_text(done.out / "motion.bin", motion.substr(0, motion.size() / 2));
    serves(1, "after-2.bin: goes with a motion file that is damaged, so stage 2 begins anew");
    motion[100] ^= 1;
    put_text(done.out / "motion.bin", motion);
    const auto files = files_below(done.out);
    const Outcome none = done.go_on();
    INFO(none.err);
    CHECK(none.code == 8);
    CHECK(says(none.err, "of what it has kept nothing is whole; choose another --out, or --fresh"));
    CHECK(files_below(done.out) == files);

    as_it_was();
    for (const int n : {1, 2}) put_text(done.out / fmt::format("resume/after-{}.bin", n), "");
    CHECK(says(done.go_on().err,
               "and what it kept of its first 2 stages is gone or damaged; choose"));
    // Of what was changed nothing is missed.
    fs::remove_all(done.out / "resume");
    done.put({kAtRestToo[0], kAtRest[1], kAtRest[2]});
    CHECK(says(done.go_on().err, "it has kept no stage to go on from that is the same; choose"));
}

TEST_CASE("that the run which is replaced has kept more that serves is told") {
    const DoneRun done(kMesh + metal(""), kAtRest);
    fs::create_directory(done.out / "replaced");
    for (const char* name : {".swage-run", "resume"}) {
        fs::copy(done.out / name, done.out / "replaced" / name, fs::copy_options::recursive);
    }
    const auto ends_after = [&](int stages) {
        for (int n = stages + 1; n <= 3; ++n) {
            fs::remove(done.out / fmt::format("resume/after-{}.bin", n));
        }
        Json record = parse_json(bytes_of(done.out / "run.json"));
        record["state"] = "interrupted";
        record["stages"].erase(record["stages"].begin() + stages, record["stages"].end());
        put_text(done.out / "run.json", json_text(record));
    };
    const std::string told =
        "replaced has kept more stages that are the same ({} instead of {}): "
        "to go on from there, move it to a place of its own";
    done.put({kAtRest[0], kAtRest[1], kAtRestToo[2]});
    ends_after(1);
    const Outcome outcome = done.go_on();
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(says(outcome.err, fmt::format(fmt::runtime(told), 2, 1)));
    CHECK_FALSE(says(outcome.err, "bin: is gone"));
    done.check();
}

TEST_CASE("a run that has nothing to do leaves what it kept") {
    const DoneRun done(kMesh + metal(""), {kAtRest[0], kAtRest[2]});
    const auto before = files_below(done.out);
    const Outcome outcome = done.go_on({"--set", "output.keep_stages=false"});
    CHECK(says(outcome.err, "already complete"));
    CHECK(files_below(done.out) == before);
}

TEST_CASE("a run of which no stage is to be kept leaves none, and is the same run") {
    const DoneRun done(kMesh + metal("") + "[output]\nkeep_stages = false\n", kAtRest);
    CHECK_FALSE(fs::exists(done.out / "resume"));
    CHECK(says(done.go_on({"--set", "output.keep_stages=true"}).err, "already complete"));
    done.put({kAtRest[0], kAtRest[1]});
    CHECK(done.go_on().code == 8);
}

TEST_CASE("a scene that says the same in other words is the same run, and what differs is told") {
    const DoneRun done(kMesh + metal(""), {kAtRest[0], kAtRest[2]});
    const auto is_done = [&](const std::vector<std::string>& more) {
        const Outcome outcome = done.go_on(more);
        INFO(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(says(outcome.err, "already complete"));
    };
    const std::string kSet = "--set";
    is_done({kSet, "stage.1.angle=40 degrees"});
    is_done({kSet, "stage.bend.frames=3", kSet, "stage.2.strain=0.5e-1"});
    is_done({kSet, "stage.2.strain=0.05", kSet, "stage.1.angle='40 deg'"});
    put_text(done.scene, "# Of lead.\n[mold]\nacross = 2\n" + kMesh +
                             "[material]\nname = 'lead'\n[[stage]]\nframes = 3 # few\n"
                             "angle = \"40 deg\"\nmachine = \"bend\"\n" +
                             kAtRest[2]);
    is_done({});
    const auto differs = [&](const std::vector<std::string>& more, const std::string& told) {
        const Outcome outcome = done.go_on(more);
        INFO(outcome.err);
        CHECK(outcome.code == 8);
        CHECK(says(outcome.err, "belongs to another run: " + told));
    };
    differs({kSet, "stage.2.strain=0.06", kSet, "mold.across=4"},
            "mold.across is 4 now, 2 then; stage.2.strain is 0.06 now, 0.05 then; choose");
    differs({kSet, "stage.1.angle=2 rad"},
            "stage.1.angle is 2 rad now, 40 deg then; choose another --out, or --fresh");
    differs({kSet, "material.friction=0.3"},
            "material.friction is 0.3 now, not there then; choose");
}

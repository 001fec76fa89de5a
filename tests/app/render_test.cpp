// SPDX-License-Identifier: GPL-3.0-or-later
// Where a run that is drawn once more goes, and where it does not.
#include <set>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// A run of four frames that can be drawn.
class DrawableRun {
  public:
    explicit DrawableRun(const std::string& render = "", const std::string& machine = "bend") {
        const fs::path scene = put_small_scene(scratch_.path(), 3, render);
        if (machine != "bend") {
            std::string text = bytes_of(scene);
            const std::string stage = "machine = \"bend\"\nangle = \"10 deg\"\n";
            text.replace(text.find(stage), stage.size(), "machine = \"" + machine + "\"\n");
            put_text(scene, text);
        }
        REQUIRE(run_swage({"run", scene.string(), "--out", run().string(), "--no-render"}).code ==
                0);
    }
    fs::path run() const { return scratch_.path() / "run"; }
    fs::path out() const { return scratch_.path() / "out"; }
    Outcome draw(const fs::path& out, std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {"render", run().string(), "--no-film", "--out", out.string()});
        return run_swage(more);
    }

  private:
    Scratch scratch_;
};

}  // namespace

TEST_CASE("a run is not drawn over files that are no drawing of swage's") {
    const DrawableRun drawable;
    const fs::path out = drawable.out();
    fs::create_directories(out / "frames");
    put_text(out / "film.mp4", "my holiday");
    put_text(out / "frames/frame_0001.png", "my cat");
    const auto before = files_below(out);
    const Outcome outcome = drawable.draw(out);
    INFO(outcome.err);
    CHECK(outcome.code == 8);
    CHECK(outcome.err.find("contains files that swage render did not draw") != std::string::npos);
    CHECK(files_below(out) == before);
    CHECK(drawable.draw(drawable.run() / "meshes").code == 8);
}

TEST_CASE("a drawing that is refused leaves no folder behind, and none that was there goes") {
    const DrawableRun drawable;
    CHECK(drawable.draw(drawable.out() / "today", {"--frames", "12-99"}).code == 2);
    CHECK_FALSE(fs::exists(drawable.out()));
    fs::create_directory(drawable.out());
    CHECK(drawable.draw(drawable.out() / "", {"--frames", "12-99"}).code == 2);
    REQUIRE(fs::exists(drawable.out()));
    CHECK(fs::is_empty(drawable.out()));
    CHECK(drawable.draw(drawable.out(), {"--frames", "1"}).code == 0);
    CHECK(drawable.draw(drawable.out(), {"--frames", "12-99"}).code == 2);
    CHECK(fs::exists(drawable.out() / "frames/frame_0001.png"));
}

TEST_CASE(
    "drawn into one folder twice, a run leaves the pictures of the second time, and says so") {
    const DrawableRun drawable;
    const Outcome first = drawable.draw(drawable.out());
    CHECK(first.code == 0);
    CHECK(first.err.find("removed") == std::string::npos);
    REQUIRE(fs::exists(drawable.out() / "frames/frame_0004.png"));
    put_text(drawable.out() / "frames/notes.png", "mine");
    put_text(drawable.out() / "frames/frame_0077.png", "of a longer run");
    put_text(drawable.out() / "film.mp4", "of that time");
    const Outcome second =
        drawable.draw(drawable.out(), {"--frames", "1-2", "--camera-azimuth", "120"});
    INFO(second.err);
    CHECK(second.code == 0);
    CHECK(second.err.find("removed 4 pictures of an earlier drawing") != std::string::npos);
    CHECK(fs::exists(drawable.out() / "frames/frame_0002.png"));
    CHECK(fs::exists(drawable.out() / "frames/notes.png"));
    for (const char* name :
         {"frames/frame_0003.png", "frames/frame_0004.png", "frames/frame_0077.png", "film.mp4"}) {
        CHECK_FALSE(fs::exists(drawable.out() / name));
    }
}

TEST_CASE("stills can be asked for from one on to the end") {
    const DrawableRun drawable;
    CHECK(drawable.draw(drawable.out(), {"--frames", "3-"}).code == 0);
    CHECK_FALSE(fs::exists(drawable.out() / "frames/frame_0002.png"));
    CHECK(fs::exists(drawable.out() / "frames/frame_0003.png"));
    CHECK(fs::exists(drawable.out() / "frames/frame_0004.png"));
    CHECK(drawable.draw(drawable.out(), {"--frames", "5-"}).code == 2);
    const Outcome list = drawable.draw(drawable.out(), {"--frames", "1,3"});
    CHECK(list.code == 2);
    CHECK(list.err.find("such as 7, 3-9 or 3-") != std::string::npos);
}

TEST_CASE("a film can be made of a run whose scene wants none") {
    const DrawableRun drawable("film = false\n");
    const fs::path out = drawable.out();
    const auto draw = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", drawable.run().string(), "--out", out.string()});
        return run_swage(more);
    };
    CHECK(draw({}).code == 0);
    CHECK_FALSE(fs::exists(out / "film.mp4"));
    const Outcome filmed = draw({"--film"});
    CHECK(filmed.code == 0);
    CHECK(fs::exists(out / "film.mp4") != (filmed.err.find("no film") != std::string::npos));
    CHECK(draw({"--film", "--no-film"}).code == 2);
}

TEST_CASE("without the ground, a floor that stands for it is not drawn either") {
    const DrawableRun drawable("", "floor");
    const auto still = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--frames", "2"});
        REQUIRE(drawable.draw(drawable.out(), more).code == 0);
        return bytes_of(drawable.out() / "frames/frame_0002.png");
    };
    const std::string bare = still({"--no-ground"});
    CHECK(bare == still({"--no-ground", "--no-tools"}));
    CHECK(bare != still({}));
}

TEST_CASE(
    "tools are hidden by name, in a scene and in a drawing, and the mattes know none of them") {
    const DrawableRun drawable("hide = [\"left\"]\n");
    const auto tools = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--frames", "2", "--passes", "matte"});
        REQUIRE(drawable.draw(drawable.out(), more).code == 0);
        std::set<std::string> names;
        const Json table = parse_json(bytes_of(drawable.out() / "frames/mattes.json"));
        for (const Json& one : table.at("mattes")) {
            if (one.at("is") == "tool") names.insert(one.at("name"));
        }
        return names;
    };
    using Names = std::set<std::string>;
    CHECK(tools({}) == Names{"right", "support"});
    CHECK(tools({"--hide", "none"}) == Names{"left", "right", "support"});
    CHECK(tools({"--hide", "support,right"}) == Names{"left"});
    CHECK(tools({"--hide", "left", "--no-tools"}).empty());
    const Outcome refused = drawable.draw(drawable.out(), {"--hide", "suport"});
    CHECK(refused.code == 2);
    CHECK(refused.err ==
          "error: \"suport\" is no tool, grip or blade of any machine of the run, did you mean "
          "\"support\"? There are support, left, right\n");
}

TEST_CASE("what a drawing that was killed left unfinished goes with the next") {
    const DrawableRun drawable;
    CHECK(drawable.draw(drawable.out(), {"--frames", "1"}).code == 0);
    put_text(drawable.out() / ".film.part4194303.mp4", "half a film");
    put_text(drawable.out() / "frames/.frame_0002.part4194303.png", "half a picture");
    CHECK(drawable.draw(drawable.out(), {"--frames", "1"}).code == 0);
    for (const auto& [name, bytes] : files_below(drawable.out())) {
        INFO(name);
        CHECK(name.find(".part") == std::string::npos);
    }
}

TEST_CASE("what is drawn anew and ends early has no film or sheet of another time") {
    const DrawableRun drawable("", "hold");
    REQUIRE(drawable.draw(drawable.out()).code == 0);
    const fs::path film = drawable.out() / "film.mp4", sheet = drawable.out() / "contact.png";
    put_text(film, "of that time");
    REQUIRE(fs::exists(sheet));
    const fs::path still = drawable.out() / "frames/frame_0002.png";
    fs::remove(still);
    fs::create_directory(still);  // where the next one cannot be put
    put_text(still / "mine", "mine");
    const Outcome outcome = drawable.draw(drawable.out(), {"--camera-azimuth", "120"});
    INFO(outcome.err);
    CHECK(outcome.code == 5);
    CHECK(fs::exists(drawable.out() / "frames/frame_0001.png"));
    CHECK_FALSE(fs::exists(film));
    CHECK_FALSE(fs::exists(sheet));
}

TEST_CASE("transparent stills have alpha and no film, and a film with them is refused") {
    const DrawableRun drawable;
    const fs::path out = drawable.out();
    const auto draw = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", drawable.run().string(), "--out", out.string(),
                                   "--frames", "2", "--background", "transparent"});
        return run_swage(more);
    };
    const Outcome refused = draw({"--film"});
    CHECK(refused.code == 2);
    CHECK(refused.err.find("a film cannot be transparent") != std::string::npos);
    const Outcome outcome = draw({"--light-azimuth", "40", "--light-elevation", "10"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK_FALSE(fs::exists(out / "film.mp4"));
    CHECK(bytes_of(out / "frames/frame_0002.png").at(25) == 6);  // RGBA
    CHECK(draw({"--light-elevation", "2"}).code == 2);
}

TEST_CASE("passes lie beside the stills of a run whose scene asks for them, and of a drawing") {
    const DrawableRun drawable("passes = [\"normal\", \"matte\"]\n");
    const auto names = [&](std::vector<std::string> more) {
        REQUIRE(drawable.draw(drawable.out(), std::move(more)).code == 0);
        std::set<std::string> found;
        for (const auto& entry : fs::directory_iterator(drawable.out() / "frames")) {
            found.insert(entry.path().filename().string());
        }
        return found;
    };
    using Names = std::set<std::string>;
    CHECK(names({"--frames", "2"}) ==
          Names{"frame_0002.png", "frame_0002.matte.png", "frame_0002.normal.exr", "mattes.json"});
    const std::string table = bytes_of(drawable.out() / "frames/mattes.json");
    CHECK(table.find("work-piece") != std::string::npos);
    CHECK(table.find("1-bend") != std::string::npos);
    CHECK(names({"--frames", "3", "--passes", "depth"}) ==
          Names{"frame_0003.png", "frame_0003.depth.exr"});
    CHECK(names({"--frames", "3", "--passes", " depth, matte"}) ==
          names({"--frames", "3", "--passes", "depth,matte"}));
    CHECK(names({"--frames", "3", "--passes", "none"}) == Names{"frame_0003.png"});
    CHECK(drawable.draw(drawable.out(), {"--passes", "depth,none"}).code == 2);
    const Outcome refused = drawable.draw(drawable.out(), {"--passes", "depth,mate"});
    CHECK(refused.code == 2);
    CHECK(refused.err.find("mate") != std::string::npos);
}

TEST_CASE("a run is not complete until its passes are there") {
    const Scratch scratch;
    const fs::path scene =
        put_small_scene(scratch.path(), 1, "passes = [\"depth\"]\nfilm = false\n");
    const fs::path run = scratch.path() / "run";
    const std::vector<std::string> arguments = {"run", scene.string(), "--out", run.string()};
    REQUIRE(run_swage(arguments).code == 0);
    const fs::path depth = run / "frames/frame_0002.depth.exr";
    REQUIRE(fs::exists(depth));
    CHECK(run_swage(arguments).err.find("already complete") != std::string::npos);
    // What check told of the disk has it.
    const auto disk = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"check", scene.string(), "--json"});
        return parse_json(run_swage(more).out).at("cost").at("disk_bytes").get<double>();
    };
    CHECK(disk({}) - disk({"--set", "render.passes=[]"}) > 2 * double(fs::file_size(depth)));
    fs::remove(depth);
    CHECK(run_swage(arguments).code == 0);
    CHECK(fs::exists(depth));
}

TEST_CASE("a drawing tells which view it chose for angles that nobody gave") {
    const DrawableRun drawable;
    const auto view = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--frames", "1", "--json"});
        const Outcome outcome = drawable.draw(drawable.out(), more);
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        return parse_json(outcome.out).value("view", Json());
    };
    const auto chosen = view({});
    CHECK(chosen.at("seen").get<double>() > 0.5);
    CHECK(view({"--size", "90x160"}) == chosen);
    CHECK(view({"--camera-azimuth", "90"}).at("azimuth").get<double>() == Approx(1.5707963));
    CHECK(view({"--camera-elevation", "50"}).at("elevation").get<double>() == Approx(0.8726646));
    CHECK(view({"--camera-azimuth", "90", "--camera-elevation", "50"}).is_null());
    CHECK(view({"--camera-eye", "1", "1", "1", "--camera-target", "0", "0", "0"}).is_null());
    // What follows frames another part of the picture, and needs no other view than it has.
    CHECK(view({"--camera-follow"}).at("seen").get<double>() > 0.5);
    CHECK(drawable.draw(drawable.out(), {"--camera-follow", "--no-camera-follow"}).code == 2);
    CHECK(
        drawable.draw(drawable.out(), {"--camera-follow", "--camera-target", "0", "0", "0"}).code ==
        2);
    // As where nobody gives them, whatever stood there before.
    CHECK(view({"--camera-azimuth", "auto", "--camera-elevation", "auto"}) == chosen);
    CHECK(view({"--camera-azimuth", "90", "--camera-elevation", "auto"}) ==
          view({"--camera-azimuth", "90"}));
    const fs::path given = drawable.out();
    const Outcome wrong = drawable.draw(given, {"--camera-elevation", "automatic"});
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find("give degrees, or auto") != std::string::npos);
    CHECK(drawable.draw(given, {"--camera-elevation", "91"}).code == 2);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that tell of their matter at the skin's vertices, and pictures of that.
#include <cstring>

#include "pipeline/frame_store.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

using namespace swage;
namespace fs = std::filesystem;

namespace {

const std::string kFields = "[output]\nfields = [\"stress\", \"pressure\"]\n";

Outcome run(const fs::path& scene, const fs::path& out, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", scene.string(), "--out", out.string()});
    return run_swage(more);
}

// Of a mesh that swage wrote: bytes of a vertex, and where a float of it begins.
struct Vertices {
    std::size_t count = 0, size = 0, data = 0;
    std::map<std::string, std::size_t> at;

    explicit Vertices(const std::string& bytes) {
        const std::map<std::string, std::size_t> sizes = {
            {"double", 8}, {"float", 4}, {"uchar", 1}};
        data = bytes.find("end_header\n") + 11;
        const std::size_t begin = bytes.find("element vertex "), end = bytes.find("element face");
        count = std::stoul(bytes.substr(begin + 15));
        for (std::size_t p = bytes.find("property ", begin); p < end;
             p = bytes.find("property ", p + 1)) {
            const std::size_t blank = bytes.find(' ', p + 9), line = bytes.find('\n', p);
            at[bytes.substr(blank + 1, line - blank - 1)] = size;
            size += sizes.at(bytes.substr(p + 9, blank - p - 9));
        }
    }
    std::vector<float> values(const std::string& bytes, const std::string& name) const {
        std::vector<float> all(count);
        for (std::size_t v = 0; v < count; ++v) {
            std::memcpy(&all[v], bytes.data() + data + v * size + at.at(name), sizeof(float));
        }
        return all;
    }
};

}  // namespace

TEST_CASE("fields that a scene asks for are in its motion file and in its PLY, which reads back") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 3, kFields);
    const fs::path out = scratch.path() / "run", plain = scratch.path() / "plain";
    REQUIRE(run(scene, out, {"--no-render"}).code == 0);
    const FrameStore store(out / "motion.bin");
    REQUIRE(store.fields() == std::vector{SkinField::stress, SkinField::pressure});
    const std::string bytes = bytes_of(out / "meshes/1-bend.ply");
    CHECK(bytes.find("comment stress: von Mises stress [Pa]\n") != std::string::npos);
    const Vertices vertices(bytes);
    const StoredFrame last = store.frame(store.frame_count() - 1);
    for (std::size_t f = 0; f < 2; ++f) {
        const std::vector<float> is = vertices.values(bytes, words_of(store.fields()[f]).name);
        CHECK(is == last.body[0].field[f]);
        CHECK(*std::max_element(is.begin(), is.end()) > 0);
    }
    const Outcome info = run_swage({"info", (out / "meshes/1-bend.ply").string()});
    INFO(info.err);
    CHECK(info.code == 0);
    CHECK(info.err.find("stress") == std::string::npos);

    // Whoever asks for none gets the same run.
    REQUIRE(run(put_small_scene(scratch.path(), 3), plain, {"--no-render"}).code == 0);
    for (const char* file : {"meshes/1-bend.obj", "curves/1-bend.csv"}) {
        CHECK((bytes_of(out / file) == bytes_of(plain / file)));
    }
    CHECK(FrameStore(plain / "motion.bin").fields().empty());
    CHECK(bytes_of(plain / "meshes/1-bend.ply").find("stress") == std::string::npos);
}

TEST_CASE("pictures are coloured by a field, afterwards too, and of what the run holds alone") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(
        scratch.path(), 2, "film = false\ncolor = \"stress\"\ncolor_range = [0, \"50 kPa\"]\n");
    const fs::path out = scratch.path() / "run", again = out / "again";
    const Outcome first = run(scene, out);
    INFO(first.err);
    REQUIRE(first.code == 0);
    const Json drawn = parse_json(bytes_of(out / "run.json"));
    CHECK(drawn.at("drawing").at("color") == "stress");
    CHECK(drawn.at("drawing").at("color_range") == Json({0.0, 50e3}));
    const std::string colored = bytes_of(out / "frames/frame_0003.png");
    CHECK(is_whole_png(colored));

    const auto draw = [&](const std::vector<std::string>& more) {
        std::vector<std::string> all = {"render", out.string(), "--no-film"};
        all.insert(all.end(), more.begin(), more.end());
        return run_swage(all);
    };
    REQUIRE(draw({}).code == 0);
    CHECK((bytes_of(again / "frames/frame_0003.png") == colored));
    REQUIRE(draw({"--color", "none"}).code == 0);
    CHECK((bytes_of(again / "frames/frame_0003.png") != colored));
    REQUIRE(draw({"--color", "stress", "--color-range", "0", "1000"}).code == 0);
    CHECK((bytes_of(again / "frames/frame_0003.png") != colored));
    CHECK(draw({"--color-range", "5", "1"}).code == 2);
    const Outcome refused = draw({"--color", "pressure"});
    CHECK(refused.code == 2);
    CHECK(refused.err.find("the run contains no pressure, only stress") != std::string::npos);
}

TEST_CASE("a field that is misspelled, and a range that is none, are told at their places") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(
        scratch.path(), 2,
        "color = \"plastic_strian\"\ncolor_range = [2, 1]\n[output]\nfields = [\"stres\", 3]\n");
    const Outcome outcome = run_swage({"check", scene.string()});
    CHECK(outcome.code == 3);
    for (const char* told :
         {"small.toml:13:9: color = \"plastic_strian\" is not one of",
          "did you mean \"plastic_strain\"?", "color_range: the first must be less",
          "small.toml:16:11: fields: \"stres\" is not one of plastic_strain, stress",
          "did you mean \"stress\"?", "fields: a whole number is not one of"}) {
        INFO(told);
        INFO(outcome.err);
        CHECK(outcome.err.find(told) != std::string::npos);
    }
}

TEST_CASE(
    "a run tells by stage what its bodies have used of what they can bear, and an idle one none") {
    const Scratch scratch;
    const fs::path scene = put_small_scene(scratch.path(), 3), out = scratch.path() / "run";
    const auto stage_of = [&](const std::string& material, const fs::path& to) {
        const Outcome done = run(scene, to, {"--no-render", "--set", "material.name=" + material});
        INFO(done.err);
        REQUIRE(done.code == 0);
        return std::pair(parse_json(bytes_of(to / "run.json")).at("stages").at(0), done.err);
    };
    const auto [rubber, of_rubber] = stage_of("rubber", out / "rubber");
    CHECK(rubber.at("use").empty());
    CHECK(of_rubber.find(": used") == std::string::npos);

    const auto [tin, of_tin] = stage_of("tin", out / "tin");
    const Json& use = tin.at("use").begin().value();
    CHECK(use.at("yield").at("share") == 1);
    CHECK(use.at("yield").at("place_m").size() == 3);
    CHECK(use.at("yield").at("frame") >= 2);
    CHECK(use.at("plastic_strain").at("most") > 0);
    CHECK_FALSE(use.contains("strength"));
    CHECK(of_tin.find("1-bend: used 100 % of its yield stress (frame ") != std::string::npos);

    const auto [iron, of_iron] = stage_of("cast_iron", out / "iron");
    CHECK(iron.at("use").begin().value().at("strength").at("share") > 0);
    CHECK(of_iron.find(" of its strength") != std::string::npos);

    const Outcome told = run_swage({"info", (out / "iron").string()});
    CHECK(told.code == 0);
    CHECK(told.out.find("1-bend: used ") != std::string::npos);
    CHECK(run_swage({"info", scratch.path().string()}).code == 5);
    Json damaged = parse_json(bytes_of(out / "iron/run.json"));
    damaged.at("stages").at(0).erase("frames");
    put_text(out / "iron/run.json", json_text(damaged));
    const Outcome refused = run_swage({"info", (out / "iron").string()});
    CHECK(refused.code == 5);
    CHECK(refused.err.find("run.json: is damaged") != std::string::npos);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that are run, ended early and gone on with, and what they leave.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "geometry/box_mesh.h"
#include "geometry/mesh_write.h"
#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"

namespace resumed {

namespace fs = std::filesystem;

inline const std::string kMesh = "[mesh]\nfile = \"bar.obj\"\n",
                         kBox = "[mesh]\nfile = \"box.obj\"\n";
inline std::string falls(int speed) {
    return fmt::format("turn = [0, \"20 deg\", \"30 deg\"]\nvelocity = [0, \"-{} m/s\", 0]\n",
                       speed);
}
inline const std::string kBrittle =
    "[material]\nyoung_modulus = \"50 MPa\"\npoisson_ratio = 0.2\ndensity = \"1200 kg/m3\"\n"
    "damping_ratio = 0.02\nstrength = \"0.5 MPa\"\ntoughness = \"50 J/m2\"\n";
inline const std::string kMold = "[mold]\nacross = 2\n";
inline const std::string kBoundary = "[skin]\nkind = \"boundary\"\n";
inline const std::string kOutput =
    "[output]\nmeshes_per_frame = true\nfields = [\"plastic_strain\", \"stress\"]\n";
inline std::string floor(int frames) {
    return fmt::format(
        "[[stage]]\nmachine = \"floor\"\ndrop = \"2 mm\"\nframes = {}\nduration = \"4 ms\"\n",
        frames);
}

inline std::string metal(const std::string& more) {
    return "[material]\nname = \"lead\"\n" + more + kMold;
}
inline std::string worked(const std::string& at_the_cut = "") {
    return "[[stage]]\nmachine = \"bend\"\nangle = \"40 deg\"\nframes = 3\n"
           "[[stage]]\nmachine = \"twist\"\nangle = \"40 deg\"\nframes = 4\n"
           "[[stage]]\nmachine = \"cut\"\ntilt = \"20 deg\"\nframes = 4\n" +
           at_the_cut + "[[stage]]\nmachine = \"stretch\"\nstrain = 0.05\nframes = 3\n";
}

inline fs::path put_scene(const fs::path& folder, const std::string& text) {
    run_swage({"make", "bar", "--length", "10 cm", "--division", "30", "--out", "bar.obj"}, folder);
    swage::write_obj(folder / "box.obj", swage::box_mesh({0, 0, 0}, {0.1, 0.02, 0.02}));
    swage::write_obj(folder / "cube.obj", swage::box_mesh({0, 0, 0}, {0.02, 0.02, 0.02}));
    put_text(folder / "scene.toml", text);
    return folder / "scene.toml";
}

inline Outcome run(const fs::path& scene, const fs::path& out, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", scene.string(), "--no-render", "--out", out.string()});
    return run_swage(more);
}

// All that a run left, but for what it took, what it went on from, and what others may. `warnings`:
// words of each that it has and others have not.
inline std::map<std::string, std::string> products(const fs::path& folder,
                                                   const std::vector<std::string>& warnings = {}) {
    std::map<std::string, std::string> files = files_below(folder);
    std::erase_if(files, [](const auto& file) { return file.first.starts_with("resume/after-"); });
    Json record = parse_json(files.at("run.json"));
    record["seconds"] = nullptr;
    record.erase("went_on_from");
    for (const std::string& warning : warnings) {
        Json& all = record.at("warnings");
        const auto is_it = [&](const Json& one) {
            return one.get<std::string>().find(warning) != std::string::npos;
        };
        const auto at = std::find_if(all.begin(), all.end(), is_it);
        REQUIRE(at != all.end());
        all.erase(at);
    }
    files["run.json"] = json_text(record);
    return files;
}

// The other's record has these warnings too.
inline void check_same_but_for(const std::vector<std::string>& warnings, const fs::path& one,
                               const fs::path& other) {
    const auto there = products(one), here = products(other, warnings);
    for (const auto& [name, bytes] : there) {
        INFO(name);
        REQUIRE(here.contains(name));
        CHECK((here.at(name) == bytes));
    }
    CHECK(here.size() == there.size());
}

inline void check_same(const fs::path& one, const fs::path& other) {
    check_same_but_for({}, one, other);
}

// Gone on with, it says so and leaves what a run that went through did.
inline void check_goes_through(const fs::path& scene, const fs::path& whole, const fs::path& out,
                               const std::string& told, const std::vector<std::string>& more = {}) {
    const Outcome outcome = run(scene, out, more);
    INFO(outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.err.find(told) != std::string::npos);
    check_same(whole, out);
}

}  // namespace resumed

// SPDX-License-Identifier: GPL-3.0-or-later
// Lines in which a bar with a core is molded anew.
#include <cmath>
#include <sstream>

#include "tests/app/resumed_run.h"
#include "tests/shared/scratch.h"

using namespace resumed;

namespace {

// Of a table: the largest number of a column.
double most_of(const fs::path& table, const std::string& column) {
    std::istringstream lines(bytes_of(table));
    std::string line, cell;
    std::getline(lines, line);
    std::istringstream head(line);
    int at = 0;
    while (std::getline(head, cell, ',') && cell != column) ++at;
    REQUIRE(cell == column);
    double most = 0;
    while (std::getline(lines, line)) {
        std::istringstream row(line);
        for (int n = 0; n <= at; ++n) std::getline(row, cell, ',');
        if (!cell.empty()) most = std::max(most, std::stod(cell));  // known
    }
    return most;
}

const std::string kAluminium = "name = \"soft_aluminium\"\n",
                  kCore = "from = [0, 0.3, 0.3]\nto = [1, 0.7, 0.7]\n";

}  // namespace

TEST_CASE("a core of the bar's own material bends on, molded anew, as if there were none") {
    const std::string head = kMesh + "[material]\n" + kAluminium + "[mold]\nacross = 4\n",
                      line =
                          "[[stage]]\nmachine = \"bend\"\nangle = \"60 deg\"\nframes = 6\n"
                          "[[stage]]\nname = \"again\"\nmachine = \"bend\"\nangle = \"20 deg\"\n"
                          "frames = 5\nremold = true\n";
    const Scratch scratch;
    double torque[2];
    for (bool has_core : {false, true}) {
        const fs::path out = scratch.path() / (has_core ? "core" : "none");
        const fs::path scene = put_scene(
            scratch.path(), head + (has_core ? "[[inset]]\n" + kAluminium + kCore : "") + line);
        const Outcome outcome = run(scene, out);
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        torque[has_core] = most_of(out / "curves/again.csv", "left torque about its axis [N m]");
    }
    CHECK(torque[1] == Approx(torque[0]).epsilon(0.03));
}

TEST_CASE("a stage that cannot mold an inset anew says which it is, and why") {
    const Scratch scratch;
    put_text(scratch.path() / "bent.toml",
             "[[grip]]\nname = \"hold\"\nfrom = [\"-length\", \"-height\", \"-width\"]\n"
             "to = [\"-0.4*length\", \"height\", \"width\"]\n"
             "[[blade]]\nname = \"blade\"\nedge = [[\"0\", \"height\", \"-2*width\"], "
             "[\"0\", \"height\", \"2*width\"]]\n[blade.motion]\n"
             "move = [\"0.3*height*t\", \"-1.2*height*(1 - abs(2*t - 1))\", \"0\"]\n");
    const fs::path scene = put_scene(
        scratch.path(),
        kMesh + metal("") + kBoundary + "[[inset]]\n" + kAluminium + kCore +
            "[[stage]]\nmachine = \"bent.toml\"\nframes = 2\n"
            "[[stage]]\nname = \"draw\"\nmachine = \"stretch\"\nremold = true\nframes = 2\n");
    const Outcome outcome = run(scene, scratch.path() / "run");
    INFO(outcome.err);
    CHECK(outcome.code == 6);
    CHECK(outcome.err.find("draw: cannot mold anew: a blade's path turns back over itself within "
                           "inset 1, which cannot be cut along it") != std::string::npos);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The shipped shelf against the beam of Euler and Bernoulli.
#include <cmath>
#include <sstream>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// Of assets/scenes/shelf.toml and its board, SI.
constexpr double kYoung = 1e9, kDensity = 955, kWidth = 0.08, kHeight = 0.01, kLength = 0.4;
constexpr double kLoaded = 0.2;  // of the books, in the middle
// Between the rows of surface points that touch the rests: each a quarter of a cell inside its
// line.
constexpr double kSpan = 0.36 - 0.5 * 0.005;

// How far the middle `kLoaded` of the beam sags below its rests, in the mean: its curvature M / E I
// integrated twice from the middle, where it is level. Rests without friction push across the
// board, so that they thrust it together where it slopes, below which its middle hangs.
double mean_sag(double weight, double books) {
    constexpr int kSteps = 20000, kRounds = 30;
    const double inertia = kWidth * std::pow(kHeight, 3) / 12, step = 0.5 * kSpan / kSteps;
    const double q = weight / kLength, p = books / kLoaded;
    double end_slope = 0, end_height = 0, sag = 0;
    for (int round = 0; round < kRounds; ++round) {
        const double thrust = 0.5 * (weight + books) * end_slope;
        double slope = 0, height = 0, sum = 0;
        int counted = 0;
        for (int n = 0; n < kSteps; ++n) {
            const double x = (n + 0.5) * step, out = std::max(0.0, 0.5 * kLoaded - x);
            const double moment = 0.5 * (weight + books) * (0.5 * kSpan - x) -
                                  0.5 * q * std::pow(0.5 * kLength - x, 2) - 0.5 * p * out * out +
                                  thrust * (end_height - height);
            slope += step * moment / (kYoung * inertia);
            height += step * slope;
            if (out > 0) sum += height, ++counted;
        }
        end_slope = slope, end_height = height, sag = height - sum / counted;
    }
    return sag;
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    return cells;
}

std::vector<std::map<std::string, double>> rows_of(const fs::path& curves) {
    std::istringstream table(bytes_of(curves));
    std::string line;
    std::getline(table, line);
    const std::vector<std::string> head = cells_of(line);
    std::vector<std::map<std::string, double>> row;
    while (std::getline(table, line)) {
        row.emplace_back();
        const std::vector<std::string> cells = cells_of(line);
        REQUIRE(cells.size() == head.size());
        for (std::size_t n = 0; n < head.size(); ++n) {
            // Empty: not known, as at the start.
            row.back()[head[n]] = cells[n].empty() ? 0 : std::stod(cells[n]);
        }
    }
    return row;
}

}  // namespace

TEST_CASE("the shipped shelf sags as a beam does, and its books are closed") {
    const Scratch scratch;
    const fs::path run = scratch.path() / "run";
    const Outcome outcome =
        run_swage({"run", "assets/scenes/shelf.toml", "--out", run.string(), "--no-render", "--set",
                   "stage.1.frames=10", "--set", "stage.1.friction=0", "--quiet"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const auto row = rows_of(run / "curves/1-shelf.csv");
    REQUIRE(row.size() == 11);
    const auto sunk = [&](int frame) {
        return row[0].at("books y [m]") - row[frame].at("books y [m]");
    };
    const double weight = kDensity * kWidth * kHeight * kLength * 9.81;
    // What is left is its two cells of a thickness, and how far the rests' contact rolls.
    CHECK(sunk(3) == Approx(mean_sag(weight, 0)).epsilon(0.05));
    CHECK(sunk(10) == Approx(mean_sag(weight, 147.15)).epsilon(0.01));
    CHECK(row[10].at("left force y [N]") == Approx(0.5 * (weight + 147.15)).epsilon(0.02));
    CHECK(row[10].at("gravity force y [N]") == Approx(-weight).epsilon(0.001));
    // By how much of what it has in full each acts.
    CHECK(row[10].at("gravity strength") == 1);
    CHECK(row[10].at("books strength") == 1);
    CHECK(row[0].at("books strength") == 0);
    for (int frame = 0; frame <= 10; ++frame) {
        CHECK(row[frame].at("books force y [N]") ==
              Approx(-147.15 * row[frame].at("books strength")).margin(1e-9));
    }
    CHECK(!row[0].contains("left strength"));
    const Json energy = parse_json(bytes_of(run / "run.json")).at("stages").at(0).at("energies_J");
    const double work =
        energy.at("load_work").get<double>() + energy.at("gravity_work").get<double>();
    CHECK(energy.at("elastic").get<double>() == Approx(work).epsilon(0.05));
    CHECK(std::abs(energy.at("remainder").get<double>()) < 0.05 * work);
}

TEST_CASE("what next to nothing pushes comes down onto its rests, however few points it meets") {
    const Scratch scratch;
    const fs::path scene = scratch.path() / "calf.toml", run = scratch.path() / "run";
    put_text(scene, "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
                    "/assets/meshes/calf.obj\"\nlength = \"20 cm\"\n"
                    "[material]\nname = \"structural_steel\"\n[mold]\nacross = 4\n"
                    "[[stage]]\nmachine = \"shelf\"\nframes = 10\n"
                    "[[stage.load]]\nforce = [\"0 N\", \"-100 N\", \"0 N\"]\n");
    const Outcome outcome =
        run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--quiet"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const auto row = rows_of(run / "curves/1-shelf.csv");
    REQUIRE(row.size() == 11);
    for (std::size_t n = 1; n < row.size(); ++n) {
        const double borne = row[n].at("left force y [N]") + row[n].at("right force y [N]");
        CHECK(borne == Approx(-row[n].at("load_1 force y [N]")).epsilon(0.01));
    }
}

TEST_CASE("what tools have let go of lies on them by its weight, hard as they pressed it",
          "[stress]") {
    const auto [machine, borne_by] = GENERATE(table<std::string, std::string>({
        {"machine = \"press\"\ndepth = 0.05\nframes = 12\n", "anvil"},
        {"machine = \"bend\"\nangle = \"20 deg\"\nframes = 20\n", "support"},
    }));
    for (const std::string material : {"structural_steel", "rubber", "nylon"}) {
        CAPTURE(machine, material);
        const Scratch scratch;
        const fs::path scene = scratch.path() / "lies.toml", run = scratch.path() / "run";
        put_text(scene, "[mesh]\nfile = \"" SWAGE_SOURCE_DIR
                        "/assets/meshes/bar.obj\"\n"
                        "[material]\nname = \"" +
                            material + "\"\n[mold]\nacross = 3\n[[stage]]\nname = \"s\"\n" +
                            machine + "gravity = 9.81\n");
        const Outcome outcome =
            run_swage({"run", scene.string(), "--out", run.string(), "--no-render", "--quiet"});
        INFO(outcome.err);
        REQUIRE(outcome.code == 0);
        const auto row = rows_of(run / "curves/s.csv");
        REQUIRE(!row.empty());
        const auto& last = row.back();
        CHECK(last.at(borne_by + " force y [N]") ==
              Approx(-last.at("gravity force y [N]")).epsilon(0.01));
    }
}

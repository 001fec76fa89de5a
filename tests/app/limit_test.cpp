// SPDX-License-Identifier: GPL-3.0-or-later
// Stages that come no farther once a part bears what it may.
#include <cmath>
#include <sstream>

#include "tests/app/program.h"
#include "tests/catch.h"
#include "tests/shared/json.h"
#include "tests/shared/scratch.h"

namespace fs = std::filesystem;

namespace {

// Columns of a table by their names.
std::map<std::string, std::vector<double>> columns_of(const fs::path& file) {
    std::istringstream lines(bytes_of(file));
    std::string line, cell;
    std::getline(lines, line);
    std::vector<std::string> name;
    for (std::istringstream head(line); std::getline(head, cell, ',');) name.push_back(cell);
    std::map<std::string, std::vector<double>> columns;
    while (std::getline(lines, line)) {
        std::size_t n = 0;
        for (std::istringstream row(line); std::getline(row, cell, ',');) {
            // Empty: not known, as at the start.
            columns[name.at(n++)].push_back(cell.empty() ? 0 : std::stod(cell));
        }
    }
    return columns;
}

std::vector<double> forces_of(std::map<std::string, std::vector<double>> column,
                              const std::string& part) {
    std::vector<double> size;
    for (std::size_t n = 0; n < column.at("frame").size(); ++n) {
        size.push_back(std::hypot(column.at(part + " force x [N]")[n],
                                  column.at(part + " force y [N]")[n],
                                  column.at(part + " force z [N]")[n]));
    }
    return size;
}

// A bar of lead, 10 cm long and 2 cm thick, 3 cells across, and the stages.
fs::path put_bar(const fs::path& folder, const std::string& stages) {
    run_swage({"make", "bar", "--length", "10 cm", "--out", "bar.obj"}, folder);
    put_text(
        folder / "scene.toml",
        "[mesh]\nfile = \"bar.obj\"\n[material]\nname = \"lead\"\n[mold]\nacross = 3\n" + stages);
    return folder / "scene.toml";
}

Outcome run(const fs::path& scene, const fs::path& out, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", scene.string(), "--no-render", "--out", out.string()});
    return run_swage(more);
}

std::string stage(const std::string& machine, const std::string& lines, const std::string& part,
                  const std::string& most) {
    return "[[stage]]\nmachine = \"" + machine + "\"\n" + lines + "[[stage.limit]]\npart = \"" +
           part + "\"\n" + most + "\n";
}

}  // namespace

TEST_CASE("a bar that is bent until a moment springs back from there, and no row goes beyond") {
    const Scratch scratch;
    const fs::path out = scratch.path() / "run",
                   scene = put_bar(scratch.path(),
                                   stage("bend", "frames = 12\n", "left", "torque = \"30 N m\""));
    const Outcome check = run_swage({"check", scene.string()});
    const std::string told = "the machine stops when left bears a torque of 30 N m";
    CHECK(check.out.find("  limit        " + told) != std::string::npos);
    const Outcome outcome = run(scene, out);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.err.find("1-bend: " + told) != std::string::npos);
    CHECK(outcome.err.find("1-bend: left reached a torque of 30 N m at ") != std::string::npos);
    CHECK(outcome.err.find(", and stops there") != std::string::npos);
    const Json record = parse_json(bytes_of(out / "run.json")).at("stages").at(0);
    const Json stopped = record.at("stopped_at");
    CHECK(record.at("limits").at(0).at("torque_N_m") == 30);
    CHECK(stopped.at("part") == "left");
    CHECK(stopped.at("torque_N_m").get<double>() <= 30);
    CHECK(stopped.at("torque_N_m").get<double>() > 30 * 0.995);
    CHECK(stopped.at("time_s").get<double>() ==
          Approx(stopped.at("share").get<double>() * record.at("duration_s").get<double>()));
    const double share = stopped.at("share").get<double>();
    const int frame = stopped.at("frame").get<int>();
    CHECK(frame == 2 + int(12 * share));

    // The moment about the support that table and poses give.
    auto column = columns_of(out / "curves/1-bend.csv");
    const auto moment = [&](std::size_t row) {
        const auto of = [&](const std::string& name) { return column.at("left " + name)[row]; };
        const double x = of("x [m]") - column.at("support x [m]")[0],
                     y = of("y [m]") - column.at("support y [m]")[0];
        return of("torque z [N m]") + x * of("force y [N]") - y * of("force x [N]");
    };
    double most = 0;
    for (std::size_t row = 0; row < column.at("frame").size(); ++row) {
        most = std::max(most, std::abs(moment(row)));
        CHECK(column.at("left torque about its axis [N m]")[row] ==
              Approx(moment(row)).margin(1e-4));
    }
    CHECK(column.count("support torque about its axis [N m]") == 0);
    CHECK(most < 30 * 1.005);
    CHECK(most > 30 * 0.99);
    // It was bent in part, has let go and stays bent.
    const std::vector<double> turn = column.at("left turn [rad]");
    const double farthest = *std::max_element(turn.begin(), turn.end());
    CHECK(farthest < 0.9 * swage::kPi / 6);
    CHECK(farthest > 0.003);
    CHECK(std::abs(turn.back()) < 1e-9);
    CHECK(forces_of(column, "left").back() == 0);
    CHECK(column.at("plastic work [J]").back() > 0);
}

TEST_CASE("presses of rising force each press farther, to the same bytes however they are run") {
    const Scratch scratch;
    std::string stages;
    for (const char* most : {"18 kN", "30 kN", "900 kN"}) {
        stages += stage("press", "frames = 8\ndepth = 0.2\n", "plate",
                        fmt::format("force = \"{}\"", most));
    }
    const fs::path scene = put_bar(scratch.path(), stages), out = scratch.path() / "run";
    const Outcome outcome = run(scene, out, {"--threads", "1"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const Json record = parse_json(bytes_of(out / "run.json"));
    double depth = 0;
    for (const auto& [name, most] : {std::pair("1-press", 18e3), std::pair("2-press", 30e3)}) {
        auto column = columns_of(out / "curves" / (std::string(name) + ".csv"));
        const std::vector<double> force = forces_of(column, "plate");
        const double peak = *std::max_element(force.begin(), force.end());
        CHECK(peak <= most * 1.005);
        CHECK(peak > most * 0.995);
        CHECK(std::count_if(force.begin(), force.end(), [&](double f) { return f > 0.99 * most; }) >
              1);
        const std::vector<double> y = column.at("plate y [m]");
        const double way = y.front() - *std::min_element(y.begin(), y.end());
        CHECK(way > 0);
        depth += way;
    }
    CHECK(record.at("stages").at(1).at("stopped_at").at("part") == "plate");
    // The third is not reached.
    CHECK(record.at("stages").at(2).at("stopped_at").is_null());
    const std::string never = "3-press: plate never reached its limit of 900 kN: the most that it";
    CHECK(outcome.err.find(never) != std::string::npos);

    const fs::path twice = scratch.path() / "twice";
    const Outcome two = run(scene, twice, {"--threads", "2"});
    CHECK(two.code == 0);
    CHECK(record.at("state_hash") == parse_json(bytes_of(twice / "run.json")).at("state_hash"));
    for (const char* name : {"1-press", "2-press", "3-press"}) {
        const fs::path table = fs::path("curves") / (std::string(name) + ".csv");
        CHECK((bytes_of(out / table) == bytes_of(twice / table)));
    }
}

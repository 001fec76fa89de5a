// SPDX-License-Identifier: GPL-3.0-or-later
// 40 bends and 20 twists of random work-pieces by the shipped machines: all must converge, and a
// work-piece that slips out of its tools must be reported as such. The seed of a case is drawn from
// its number, so every run is the same. `bench_machining CASE...` runs those frame by frame.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "geometry/make_shape.h"
#include "machines/machine.h"
#include "mold/mold.h"
#include "scene/read_machine.h"
#include "sim/advance.h"

using namespace swage;

namespace {

constexpr int kBends = 40, kTwists = 20;
constexpr double kReached = 0.8;  // share of the angle: such a bend has not slipped
constexpr double kMissed = 0.4;   // and such a one has
constexpr double kNothing = 0.1;  // share of the most that any tool has carried

// S. Vigna, "splitmix64", 2015.
class Random {
  public:
    // The number is mixed first: neighbours would otherwise draw each other's values, one later.
    explicit Random(std::uint64_t number) : state_(number) { state_ = next(); }
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
    }
    int whole(int low, int high) {  // both included
        return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
    }

  private:
    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

struct Case {
    int seed = 0;
    bool bend = true;
    std::string shape;
    std::map<std::string, double> size;
    double slender = 0;  // length over thickness
    Material material;
    MoldSettings mold;
    int frames = 0;
    bool plastic() const { return std::isfinite(material.yield_stress); }
};

Case make_case(int seed, Random& random) {
    Case c;
    c.seed = seed;
    c.bend = seed <= kBends;
    c.shape = std::vector<std::string>{"bar", "rod", "tube", "wrench"}[(seed - 1) % 4];
    const double thickness = random.between(0.01, 0.04);
    c.slender = random.between(6, 12);
    c.size["length"] = c.slender * thickness;
    if (c.shape == "bar") {
        c.size["height"] = thickness;
        c.size["width"] = thickness * random.between(0.8, 1.6);
        c.size["rounding"] = thickness * random.between(0, 0.2);
    } else if (c.shape != "wrench") {
        c.size["diameter"] = thickness;
        if (c.shape == "tube") c.size["wall"] = thickness * random.between(0.18, 0.35);
    }
    c.mold.across = random.whole(4, 7);
    c.frames = 5 * random.whole(4, 8);  // so that a frame falls on the end of the press
    if ((seed - 1) / 4 % 2 == 0) {
        c.material.name = "rubber";
        c.material.young_modulus = random.between(1e6, 2e7);
    } else {
        c.material.name = "metal";
        c.material.young_modulus = random.between(5e10, 2.2e11);
        c.material.yield_stress = c.material.young_modulus * random.between(0.003, 0.03);
        c.material.hardening = c.material.yield_stress * random.between(1, 4);
    }
    return c;
}

std::map<std::string, double> random_parameters(const Case& c, double height, Random& random) {
    constexpr double degree = kPi / 180;
    if (!c.bend) return {{"angle", random.between(45, 270) * degree}};
    return {{"radius", random.between(0.8, 3) * height},
            {"pusher_radius", random.between(0.3, 1) * height},
            {"place", random.between(-0.1, 0.1)},
            {"friction", random.between(0, 0.6)},
            {"angle", random.between(40, 100) * degree}};
}

// The made wrench is 19 thick: it is thickened to the case's own slenderness.
TriMesh make_work_piece(const Case& c) {
    TriMesh mesh = make_shape(c.shape, c.size).mesh;
    const Vec3 size = box_of(mesh.position).size();
    const double thicken = size.x() / (c.slender * size.y());
    for (Vec3& p : mesh.position) p.y() *= thicken;
    return mesh;
}

// The lengthwise direction at one end: how the outer 12 % have turned as a whole.
Vec3 end_direction(const Aggregate& matter, bool high) {
    const std::vector<double> along = matter.particle_reference.all().x;
    const auto [low_end, high_end] = std::minmax_element(along.begin(), along.end());
    const double length = *high_end - *low_end;
    std::vector<std::size_t> chosen;
    for (std::size_t p = 0; p < along.size(); ++p) {
        const double depth = high ? *high_end - along[p] : along[p] - *low_end;
        if (depth <= 0.12 * length) chosen.push_back(p);
    }
    Eigen::Matrix3Xd from(3, chosen.size()), to(3, chosen.size());
    for (std::size_t n = 0; n < chosen.size(); ++n) {
        from.col(n) = matter.particle_reference.at(chosen[n]);
        to.col(n) = matter.particle_position.at(chosen[n]);
    }
    const Vec3 from_center = from.rowwise().mean(), to_center = to.rowwise().mean();
    return nearest_rotation((to.colwise() - to_center) * (from.colwise() - from_center).transpose())
        .col(0);
}

double angle_between_ends(const Aggregate& matter) {
    const Vec3 a = end_direction(matter, false), b = end_direction(matter, true);
    return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / kPi;
}

struct Result {
    bool converged = false, slipped = false, reported = false, false_report = false;
    bool silent = false;  // slipped and not reported
    long iterations = 0;
    std::string text;
};

std::string loads_text(const FrameReport& report) {
    std::string text;
    for (const ToolLoad& load : report.load) {
        text += fmt::format("  {} {:.3g} N/{}", load.name, load.force.norm(), load.contacts);
    }
    return text;
}

Result run_case(int seed, const std::vector<MachineSpec>& machines, bool frame_by_frame) {
    Result result;
    const auto start = Stopwatch::Clock::now();
    Random random(seed);
    const Case c = make_case(seed, random);
    const TriMesh mesh = make_work_piece(c);
    Aggregate matter = mold(mesh, c.material, c.mold);
    const WorkFrame frame = place_work_frame(matter);
    const auto given = random_parameters(c, frame.size.y(), random);
    const Machine machine = build_machine(machines[c.bend ? 0 : 1], given, frame, matter);
    const double angle = given.at("angle") * 180 / kPi;

    result.text =
        fmt::format("{:2} {:5} {:6} {:5} {:4.1f} thick, across {}, {:5} cells, ", seed,
                    c.bend ? "bend" : "twist", c.shape, c.material.name,
                    frame.size.x() / frame.size.y(), *c.mold.across, matter.cell_fill.size());
    if (c.plastic()) {
        result.text += fmt::format("yield {:.2g} % E, hard {:.2g}, ",
                                   100 * c.material.yield_stress / c.material.young_modulus,
                                   c.material.hardening / c.material.yield_stress);
    }
    result.text += fmt::format("{:3.0f} deg", angle);
    if (c.bend) {
        const double h = frame.size.y();
        result.text +=
            fmt::format(", radius {:.2f} thick, pushers {:.2f}, place {:+.2f}, mu {:.2f}",
                        given.at("radius") / h, given.at("pusher_radius") / h, given.at("place"),
                        given.at("friction"));
    }

    std::vector<int> iterations;
    std::vector<std::string> told;
    int halvings = 0;
    double carried_most = 0, carried = 0, pressed = 0;
    if (frame_by_frame) fmt::print("{}\n", result.text);
    std::string failure;
    try {
        const SimSettings settings;
        Simulation simulation(matter, machine.apparatus, settings);
        Drive before = drive_at(machine, 0, 1);
        for (int n = 1; n <= c.frames; ++n) {
            const double t = static_cast<double>(n) / c.frames;
            const Drive after = drive_at(machine, t, 1);
            const FrameReport report = simulation.advance(before, after);
            before = after;
            iterations.push_back(report.iterations);
            halvings += report.halvings;
            carried = 0;
            for (const ToolLoad& load : report.load) carried = std::max(carried, load.force.norm());
            carried_most = std::max(carried_most, carried);
            for (const std::string& sentence : report.warning) {
                told.push_back(fmt::format("at {:.2f}: {}", t, sentence));
                result.reported |= sentence.find("slipped") != std::string::npos;
            }
            if (c.bend && std::abs(t - machine.parameter.at("press")) < 0.5 / c.frames) {
                pressed = angle_between_ends(matter);
                result.slipped = carried <= kNothing * carried_most || pressed < kMissed * angle;
                result.silent = result.slipped && !result.reported;
            }
            if (frame_by_frame) {
                fmt::print(
                    "   t {:.3f}: {} iterations, {} increments, {} halvings, residual {:.2g}, "
                    "ends {:.1f} deg, elastic {:.3g} J, plastic {:.3g} J,{}\n",
                    t, report.iterations, report.increments, report.halvings, report.residual,
                    angle_between_ends(matter), report.elastic, report.plastic, loads_text(report));
                std::fflush(stdout);
            }
        }
        result.converged = true;
    } catch (const Error& error) {
        failure = error.what();
    }

    for (int n : iterations) result.iterations += n;
    std::sort(iterations.begin(), iterations.end());
    const std::chrono::duration<double> seconds = Stopwatch::Clock::now() - start;
    result.text += fmt::format(
        ", {} frames\n   iterations a frame: median {}, most {}; halvings "
        "{}; {:.1f} s",
        c.frames, iterations.empty() ? 0 : iterations[iterations.size() / 2],
        iterations.empty() ? 0 : iterations.back(), halvings, seconds.count());
    if (c.bend && result.converged) {
        result.false_report = result.reported && !result.slipped && pressed >= kReached * angle;
        result.text += fmt::format("; ends at {:.0f} deg pressed, {:.0f} deg let go", pressed,
                                   angle_between_ends(matter));
        if (result.slipped) result.text += "; SLIPPED";
        if (result.silent) result.text += "; NOT REPORTED";
        if (result.false_report) result.text += "; FALSE REPORT";
    }
    if (!result.converged) {
        result.text += fmt::format("\n   FAILED after {} frames: {}", iterations.size(), failure);
    }
    for (const std::string& note : machine.notes) result.text += "\n   note: " + note;
    for (const std::string& sentence : told) result.text += "\n   told " + sentence;
    result.text += "\n";
    return result;
}

MachineSpec shipped_machine(const std::string& name) {
    const auto reading = read_machine(std::string(SWAGE_SOURCE_DIR "/machines/") + name + ".toml");
    if (!reading.machine) fail(ExitCode::scene, "{}", mistake_text(reading.mistakes.front()));
    return *reading.machine;
}

}  // namespace

int main(int count, char** argument) {
    const std::vector<MachineSpec> machines = {shipped_machine("bend"), shipped_machine("twist")};
    std::vector<int> seed;
    for (int n = 1; n < count; ++n) seed.push_back(std::atoi(argument[n]));
    const bool frame_by_frame = !seed.empty();
    for (int n = 1; count == 1 && n <= kBends + kTwists; ++n) seed.push_back(n);

    // The lattices are too small to share out; whole cases are.
    set_thread_count(0);
    const int workers = thread_count();
    set_thread_count(1);
    std::vector<Result> result(seed.size());
    std::vector<bool> done(seed.size(), false);
    std::mutex printing;
    std::size_t printed = 0;
    std::atomic<std::size_t> next = 0;
    std::vector<std::thread> worker;
    for (int w = 0; w < workers; ++w) {
        worker.emplace_back([&] {
            for (std::size_t n; (n = next++) < seed.size();) {
                result[n] = run_case(seed[n], machines, frame_by_frame);
                const std::lock_guard<std::mutex> hold(printing);  // in order, as soon as may be
                done[n] = true;
                for (; printed < seed.size() && done[printed]; ++printed) {
                    fmt::print("{}", result[printed].text);
                    std::fflush(stdout);
                }
            }
        });
    }
    for (std::thread& w : worker) w.join();

    int converged = 0, slipped = 0, reported = 0, silent = 0, false_reports = 0;
    long iterations = 0;
    for (const Result& r : result) {
        converged += r.converged;
        slipped += r.slipped;
        reported += r.reported;
        silent += r.silent;
        false_reports += r.false_report;
        iterations += r.iterations;
    }
    fmt::print(
        "machining: converged {} of {}, slipped {} ({} of them not reported), reported {}, false "
        "reports {}, {} iterations in all\n",
        converged, seed.size(), slipped, silent, reported, false_reports, iterations);
    return converged == static_cast<int>(seed.size()) && silent == 0 && false_reports == 0 ? 0 : 1;
}

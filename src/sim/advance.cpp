// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <variant>

#include "sim/explicit_steps.h"
#include "sim/lattice_forces.h"
#include "sim/quasistatic.h"
#include "sim/sever.h"

namespace swage {

namespace {

constexpr int kCrumb = 8;  // a piece of fewer particles is less than one cell

double kinetic_energy(const Aggregate& matter) {
    double sum = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        sum += 0.5 * matter.particle_mass[p] * matter.particle_velocity.at(p).squaredNorm();
    }
    return sum;
}

// Marks the particles of pieces that are less than a cell.
std::vector<char> crumbs_of(const Aggregate& matter) {
    const Pieces pieces = find_pieces(matter);
    std::vector<int> size(pieces.count, 0);
    for (int piece : pieces.particle_piece) ++size[piece];
    std::vector<char> crumb;
    for (int piece : pieces.particle_piece) crumb.push_back(size[piece] < kCrumb);
    return crumb;
}

}  // namespace

struct Simulation::Rooms {
    Aggregate& matter;
    const Apparatus& apparatus;
    std::variant<QuasistaticSolver, ExplicitSolver> solver;
    int pieces = 1;
    std::ptrdiff_t crumbs = 0;  // particles
    double plastic = 0, damped = 0, severed_energy = 0, fracture = 0, set_free = 0;
    std::vector<double> work, push_work;
    double stored_at_start = 0;                  // kinetic and elastic [J]
    std::deque<std::vector<SeverEvent>> plan{};  // cuts of the coming frames

    const LoadSet& pushes() const {
        return std::visit([](const auto& solver) -> const LoadSet& { return solver.pushes(); },
                          solver);
    }

    double elastic() {
        return std::visit([](auto& solver) { return solver.elastic_energy(); }, solver);
    }

    std::vector<SeverEvent> crossed(const Aggregate& body, const Drive& from,
                                    const Drive& to) const {
        std::vector<std::array<Vec3, 3>> swept;
        for (std::size_t b = 0; b < apparatus.blade.size(); ++b) {
            const auto part = swept_triangles(apparatus.blade[b], from.world_from_blade[b],
                                              to.world_from_blade[b]);
            swept.insert(swept.end(), part.begin(), part.end());
        }
        return crossed_connections(body, swept);
    }

    static std::variant<QuasistaticSolver, ExplicitSolver> choose(Aggregate& matter,
                                                                  const Apparatus& apparatus,
                                                                  const SimSettings& settings) {
        if (settings.solver == Solver::explicit_steps) {
            return ExplicitSolver(matter, apparatus, settings);
        }
        return QuasistaticSolver(matter, apparatus, settings);
    }
};

Simulation::Simulation(Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings)
    : rooms_(new Rooms{matter,
                       apparatus,
                       Rooms::choose(matter, apparatus, settings),
                       find_pieces(matter).count,
                       0,
                       0,
                       0,
                       0,
                       0,
                       0,
                       std::vector<double>(apparatus.tool.size() + apparatus.grip.size(), 0.0),
                       {}}) {
    if (settings.solver == Solver::quasistatic) {
        // Equilibria have no speed; whatever an explicit stage left behind is gone.
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            matter.particle_velocity.set(p, Vec3::Zero());
        }
    }
    rooms_->push_work.assign(rooms_->pushes().count(), 0.0);
    rooms_->stored_at_start = kinetic_energy(matter) + rooms_->elastic();
}

Simulation::~Simulation() = default;

bool Simulation::blades_reach(const Drive& from, const Drive& to) const {
    return !rooms_->crossed(rooms_->matter, from, to).empty();
}

void Simulation::plan_cuts(const std::vector<Drive>& drives) {
    Aggregate ahead = rooms_->matter;
    rooms_->plan.clear();
    for (std::size_t n = 0; n + 1 < drives.size(); ++n) {
        rooms_->plan.push_back(rooms_->crossed(ahead, drives[n], drives[n + 1]));
        for (const SeverEvent& e : rooms_->plan.back()) {
            ahead.connection[e.direction].weight[e.lower] = 0;
        }
    }
    // What would fall off as a crumb stays with the side that it is cut from.
    const std::vector<char> crumb = crumbs_of(ahead);
    for (std::vector<SeverEvent>& events : rooms_->plan) {
        std::erase_if(events,
                      [&](const SeverEvent& e) { return crumb[e.lower] || crumb[e.upper]; });
    }
}

std::vector<ToolLoad> Simulation::bodies(const Drive& now) const {
    std::vector<ToolLoad> bodies;
    const auto add = [&](const auto& parts, const std::vector<Pose>& pose) {
        for (std::size_t n = 0; n < parts.size(); ++n) {
            bodies.emplace_back();
            bodies.back().name = parts[n].name;
            bodies.back().pose = pose[n];
        }
    };
    const Apparatus& apparatus = rooms_->apparatus;
    add(apparatus.tool, now.world_from_tool);
    add(apparatus.grip, now.world_from_grip);
    add(apparatus.blade, now.world_from_blade);
    std::vector<Pose> middle;
    for (const PushSum& push : rooms_->pushes().sums(rooms_->matter, now)) {
        middle.push_back({Quat::Identity(), push.centre});
    }
    add(apparatus.load, middle);
    if (rooms_->pushes().has_gravity()) {
        bodies.emplace_back();
        bodies.back().name = "gravity";
        bodies.back().pose = middle.back();
    }
    return bodies;
}

FrameReport Simulation::advance(const Drive& from, const Drive& to) {
    Rooms& r = *rooms_;
    FrameReport report;
    report.time = to.time;

    // Sever what the blades sweep.
    std::vector<SeverEvent> events;
    if (r.plan.empty()) {
        events = r.crossed(r.matter, from, to);
    } else {
        events = std::move(r.plan.front());
        r.plan.pop_front();
    }
    if (!events.empty()) {
        const double before = r.elastic();
        for (const SeverEvent& e : events) r.matter.connection[e.direction].weight[e.lower] = 0;
        report.severed = static_cast<int>(events.size());
        std::visit([](auto& solver) { solver.connections_changed(); }, r.solver);
        r.severed_energy += before - r.elastic();
    }
    const auto count_pieces = [&](const char* who) {
        const std::vector<char> crumb = crumbs_of(r.matter);
        const auto loose = std::count(crumb.begin(), crumb.end(), 1);
        if (loose > r.crumbs) {
            report.warning.push_back(fmt::format(
                "{} left crumbs of less than one cell, {} particles in all", who, loose));
        }
        r.crumbs = loose;
        r.pieces = find_pieces(r.matter).count;
    };
    if (report.severed > 0) count_pieces("the blade");

    // Move.
    const MoveOutcome outcome =
        std::visit([&](auto& solver) { return solver.advance(from, to); }, r.solver);

    report.broken = outcome.broken;
    if (report.broken > 0) count_pieces("fracture");

    // Report.
    report.pieces = r.pieces;
    report.iterations = outcome.iterations;
    report.increments = outcome.increments;
    report.halvings = outcome.halvings;
    report.steps = outcome.steps;
    report.residual = outcome.residual;
    if (!outcome.lost.empty()) {
        std::string names;
        for (std::size_t n = 0; n < outcome.lost.size(); ++n) {
            if (n > 0) names += n + 1 == outcome.lost.size() ? " and " : ", ";
            names += outcome.lost[n];
        }
        report.warning.push_back(
            fmt::format("the work-piece slipped away from {} although no tool drew back", names));
    }
    if (outcome.drag_held) {
        report.warning.push_back(
            "the drag is so strong that it stops some of the surface within a few steps; there it "
            "is held to what a step can follow");
    }
    if (outcome.buckled) {
        report.warning.push_back(
            "the work-piece buckled: it left its shape for one that bears less");
    }
    r.plastic += outcome.plastic_work;
    r.damped += outcome.damped_work;
    report.plastic = r.plastic;
    report.damped = r.damped;
    report.severed_energy = r.severed_energy;
    r.fracture += outcome.fracture_work;
    r.set_free += outcome.set_free;
    report.fracture = r.fracture;
    report.set_free = r.set_free;
    report.elastic = r.elastic();
    report.kinetic = kinetic_energy(r.matter);
    report.load = bodies(to);
    for (std::size_t n = 0; n < outcome.load.size(); ++n) {
        r.work[n] += outcome.work[n];
        report.work += r.work[n];
        const LoadSum& sum = outcome.load[n];
        ToolLoad& load = report.load[n];
        load = {load.name, load.pose,       sum.force,   sum.torque,
                r.work[n], sum.penetration, sum.contacts};
    }
    const std::vector<PushSum> pushes = r.pushes().sums(r.matter, to);
    const std::size_t first = report.load.size() - pushes.size();
    for (std::size_t n = 0; n < pushes.size(); ++n) {
        r.push_work[n] += outcome.push_work[n];
        const bool gravity = n == r.apparatus.load.size();
        (gravity ? report.gravity_work : report.load_work) += r.push_work[n];
        ToolLoad& load = report.load[first + n];
        load.force = pushes[n].force;
        load.torque = pushes[n].torque;
        load.work = r.push_work[n];
        if (!gravity) load.contacts = static_cast<int>(r.apparatus.load[n].point.size());
    }
    report.remainder = report.work + report.load_work + report.gravity_work -
                       (report.kinetic + report.elastic - r.stored_at_start) - report.plastic -
                       report.damped - report.severed_energy - report.fracture - report.set_free;
    return report;
}

double explicit_steps_per_second(const Aggregate& matter, const SimSettings& settings) {
    return 1 / explicit_step(matter, settings);
}

}  // namespace swage

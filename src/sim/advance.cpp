// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <utility>
#include <variant>

#include "base/error.h"
#include "sim/energy_steps.h"
#include "sim/explicit_steps.h"
#include "sim/lattice_forces.h"
#include "sim/quasistatic.h"
#include "sim/sever.h"

namespace swage {

namespace {

constexpr int kCrumb = 8;  // a piece of fewer particles is less than one cell

// Of each piece, whether it is less than a cell.
std::vector<char> crumbs_of(const Pieces& pieces) {
    std::vector<int> size(pieces.count, 0);
    for (int piece : pieces.particle_piece) ++size[piece];
    std::vector<char> crumb;
    for (int particles : size) crumb.push_back(particles < kCrumb);
    return crumb;
}

// How many particles are in such pieces.
std::ptrdiff_t particles_in_crumbs(const Pieces& pieces) {
    const std::vector<char> crumb = crumbs_of(pieces);
    return std::count_if(pieces.particle_piece.begin(), pieces.particle_piece.end(),
                         [&](int piece) { return crumb[piece] != 0; });
}

// What would fall off as a crumb stays with one side that it is cut from, that which held it by
// most; with both it would join them. `cut`: the matter with all of the plan severed.
void keep_crumbs(const Aggregate& cut, std::deque<std::vector<SeverEvent>>& plan) {
    const Pieces pieces = find_pieces(cut);
    const std::vector<char> crumb = crumbs_of(pieces);
    const std::vector<int>& of = pieces.particle_piece;
    std::map<std::pair<int, int>, double> held;  // of a crumb by a piece: weights
    for (const std::vector<SeverEvent>& events : plan) {
        for (const SeverEvent& e : events) {
            const int a = of[e.lower], b = of[e.upper];
            if (crumb[a] && !crumb[b]) held[{a, b}] += e.weight;
            if (crumb[b] && !crumb[a]) held[{b, a}] += e.weight;
        }
    }
    std::vector<int> side(pieces.count, -1);
    std::vector<double> most(pieces.count, 0.0);
    for (const auto& [pair, weight] : held) {
        if (weight > most[pair.first]) most[pair.first] = weight, side[pair.first] = pair.second;
    }
    const auto stays = [&](const SeverEvent& e) {
        const int a = of[e.lower], b = of[e.upper];
        return (crumb[a] && (a == b || side[a] == b)) || (crumb[b] && side[b] == a);
    };
    for (std::vector<SeverEvent>& events : plan) std::erase_if(events, stays);
}

using AnySolver = std::variant<QuasistaticSolver, ExplicitSolver, EnergySteps>;

AnySolver choose_solver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                        const SimSettings& settings) {
    const bool quasistatic = settings.solver == Solver::quasistatic;
    if (bodies.size() > 1 && (quasistatic || settings.solver == Solver::implicit_steps)) {
        fail(ExitCode::stopped, "{}: solver = \"{}\" moves one body: use solver = \"explicit\"",
             apparatus.name, name_of(settings.solver));
    }
    if (quasistatic) return QuasistaticSolver(*bodies[0], apparatus, settings);
    if (settings.solver == Solver::energy_stepped) return EnergySteps(bodies, apparatus, settings);
    if (settings.solver == Solver::implicit_steps) {
        if (const char* why = ImplicitStep::cannot(*bodies[0])) {
            fail(ExitCode::stopped, "{}: solver = \"implicit\" cannot move this body: {}",
                 apparatus.name, why);
        }
    }
    return ExplicitSolver(bodies, apparatus, settings);
}

// A body, and what the stage has done to it so far.
struct WorkedBody {
    Aggregate* matter;
    int pieces;
    std::ptrdiff_t crumbs;  // particles
    Books books{};
    bool begun = false;
    double stored_at_start = 0;                  // [J]
    std::deque<std::vector<SeverEvent>> plan{};  // cuts of the coming frames
};

}  // namespace

void Books::add(const Books& other) {
    kinetic += other.kinetic;
    elastic += other.elastic;
    work += other.work;
    load_work += other.load_work;
    gravity_work += other.gravity_work;
    contact += other.contact;
    passed += other.passed;
    plastic += other.plastic;
    friction += other.friction;
    drag += other.drag;
    damped += other.damped;
    severed_energy += other.severed_energy;
    fracture += other.fracture;
    set_free += other.set_free;
    remainder += other.remainder;
}

struct Simulation::Rooms {
    std::vector<WorkedBody> body;
    const Apparatus& apparatus;
    AnySolver solver;
    std::vector<double> work, push_work;  // of each tool and grip, load and gravity, on all bodies

    const LoadSet& pushes(std::size_t b) const {
        return std::visit([&](const auto& any) -> const LoadSet& { return any.pushes(b); }, solver);
    }
    double elastic(std::size_t b) {
        return std::visit([&](auto& any) { return any.elastic_energy(b); }, solver);
    }
    void connections_changed(std::size_t b) {
        std::visit([&](auto& any) { any.connections_changed(b); }, solver);
    }

    std::vector<SeverEvent> crossed(const Aggregate& matter, std::span<const Drive> way) const {
        return crossed_connections(matter, swept_triangles(apparatus, way));
    }

    std::vector<PushSum> push_sums(const Drive& now) const;
    int cut(std::size_t b, const Drive& from, const Drive& to);
    void count_pieces(std::size_t b, const char* who, std::vector<std::string>& warning);
    void book(const MoveOutcome& outcome, FrameReport& report);
};

// Of all bodies together.
std::vector<PushSum> Simulation::Rooms::push_sums(const Drive& now) const {
    std::vector<PushSum> all = pushes(0).sums(*body[0].matter, now);
    double mass = body[0].matter->mass();
    for (std::size_t b = 1; b < body.size(); ++b) {
        const std::vector<PushSum> more = pushes(b).sums(*body[b].matter, now);
        for (std::size_t n = 0; n < apparatus.load.size(); ++n) {
            if (apparatus.load[n].body == static_cast<int>(b)) all[n] = more[n];
        }
        if (!pushes(b).has_gravity()) continue;
        const double own = body[b].matter->mass();
        all.back().centre = (mass * all.back().centre + own * more.back().centre) / (mass + own);
        all.back().force += more.back().force;
        mass += own;
    }
    return all;
}

// Cuts what the blades sweep on this way; returns the number of connections.
int Simulation::Rooms::cut(std::size_t b, const Drive& from, const Drive& to) {
    WorkedBody& at = body[b];
    std::vector<SeverEvent> events;
    if (at.plan.empty()) {
        events = crossed(*at.matter, std::array{from, to});
    } else {
        events = std::move(at.plan.front());
        at.plan.pop_front();
        // A crack may have run ahead of the blade since.
        std::erase_if(events, [&](const SeverEvent& e) {
            return at.matter->connection[e.direction].weight[e.lower] <= 0;
        });
    }
    if (events.empty()) return 0;
    const double before = elastic(b);
    sever(*at.matter, events);
    connections_changed(b);
    at.books.severed_energy += before - elastic(b);
    return static_cast<int>(events.size());
}

void Simulation::Rooms::count_pieces(std::size_t b, const char* who,
                                     std::vector<std::string>& warning) {
    WorkedBody& at = body[b];
    const Pieces pieces = find_pieces(*at.matter);
    const std::ptrdiff_t loose = particles_in_crumbs(pieces);
    if (loose > at.crumbs) {
        warning.push_back(fmt::format("{} left crumbs of less than one cell", who));
    }
    at.crumbs = loose;
    at.pieces = pieces.count;
}

void Simulation::Rooms::book(const MoveOutcome& outcome, FrameReport& report) {
    for (std::size_t b = 0; b < body.size(); ++b) {
        const BodyOutcome& part = outcome.body[b];
        Books& books = body[b].books;
        books.plastic += part.plastic_work;
        books.damped += part.damped_work + part.met.damped;
        books.fracture += part.fracture_work;
        books.friction += part.friction_work + part.met.friction;
        books.drag += part.drag_work;
        books.set_free += part.set_free;
        for (double done : part.work) books.work += done;
        for (std::size_t n = 0; n < part.push_work.size(); ++n) {
            const bool gravity = n == apparatus.load.size();
            (gravity ? books.gravity_work : books.load_work) += part.push_work[n];
        }
        // Half of what a contact holds and takes is on its books; the rest of its work is passed
        // on.
        books.passed +=
            part.met.work + part.met.damped + part.met.friction + part.met.stored - part.met.held;
        books.kinetic = part.after.kinetic;
        books.elastic = part.after.elastic;
        books.contact = part.after.contact;
        if (!body[b].begun) {
            // What the blades took before the first move was in it too.
            body[b].stored_at_start = part.before.sum() + books.severed_energy;
            body[b].begun = true;
        }
        books.remainder = books.work + books.load_work + books.gravity_work + books.passed -
                          (part.after.sum() - body[b].stored_at_start) - books.plastic -
                          books.damped - books.friction - books.drag - books.severed_energy -
                          books.fracture - books.set_free;
        report.body.push_back(books);
        report.add(books);
    }
    // What one passes the other gets: what is left is an error as any other.
    report.remainder -= report.passed;
    report.passed = 0;
}

Simulation::Simulation(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                       const SimSettings& settings)
    : rooms_(new Rooms{{}, apparatus, choose_solver(bodies, apparatus, settings), {}, {}}) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        Aggregate& matter = *bodies[b];
        if (settings.solver == Solver::quasistatic) {
            // Equilibria have no speed; whatever an explicit stage left behind is gone.
            for (std::size_t p = 0; p < matter.particle_count(); ++p) {
                matter.particle_velocity.set(p, Vec3::Zero());
            }
        }
        const Pieces pieces = find_pieces(matter);
        rooms_->body.push_back({&matter, pieces.count, particles_in_crumbs(pieces)});
    }
    rooms_->work.assign(apparatus.tool.size() + apparatus.grip.size(), 0.0);
    rooms_->push_work.assign(rooms_->pushes(0).count(), 0.0);
}

Simulation::~Simulation() = default;

bool Simulation::blades_reach(std::size_t body, std::span<const Drive> way) const {
    return !rooms_->crossed(*rooms_->body[body].matter, way).empty();
}

void Simulation::plan_cuts(std::size_t body, std::span<const Drive> way, int steps) {
    const std::size_t each = static_cast<std::size_t>(steps);
    WorkedBody& at = rooms_->body[body];
    Aggregate ahead = *at.matter;
    at.plan.clear();
    for (std::size_t n = 0; n + each < way.size(); n += each) {
        at.plan.push_back(rooms_->crossed(ahead, way.subspan(n, each + 1)));
        sever(ahead, at.plan.back());
    }
    keep_crumbs(ahead, at.plan);
}

std::vector<ToolLoad> Simulation::loads(const Drive& now) const {
    std::vector<ToolLoad> loads;
    const auto add = [&](const auto& parts, const std::vector<Pose>& pose) {
        for (std::size_t n = 0; n < parts.size(); ++n) {
            loads.emplace_back();
            loads.back().name = parts[n].name;
            loads.back().pose = pose[n];
        }
    };
    const Apparatus& apparatus = rooms_->apparatus;
    add(apparatus.tool, now.world_from_tool);
    add(apparatus.grip, now.world_from_grip);
    add(apparatus.blade, now.world_from_blade);
    std::vector<Pose> middle;
    for (const PushSum& push : rooms_->push_sums(now)) {
        middle.push_back({Quat::Identity(), push.centre});
    }
    add(apparatus.load, middle);
    if (rooms_->pushes(0).has_gravity()) {
        loads.emplace_back();
        loads.back().name = "gravity";
        loads.back().pose = middle.back();
    }
    return loads;
}

FrameReport Simulation::start() const {
    FrameReport report;
    report.pieces = 0;
    for (std::size_t b = 0; b < rooms_->body.size(); ++b) {
        const Aggregate& matter = *rooms_->body[b].matter;
        Books books;
        for (std::size_t p = 0; p < matter.particle_count(); ++p) {
            books.kinetic +=
                0.5 * matter.particle_mass[p] * matter.particle_velocity.at(p).squaredNorm();
        }
        books.elastic = rooms_->elastic(b);
        report.pieces += rooms_->body[b].pieces;
        report.body.push_back(books);
        report.add(books);
    }
    report.contact = std::numeric_limits<double>::quiet_NaN();
    return report;
}

void FrameReport::go_on(FrameReport next) {
    next.iterations += iterations;
    next.increments += increments;
    next.halvings += halvings;
    next.steps += steps;
    next.rejected += rejected;
    next.rescued += rescued;
    if (steps > 0) next.shortest_step = std::min(next.shortest_step, shortest_step);
    next.residual = std::max(next.residual, residual);
    next.severed += severed;
    next.broken += broken;
    for (std::size_t n = 0; n < load.size(); ++n) {
        next.load[n].touched = next.load[n].touched || load[n].touched;
        next.load[n].penetration = std::max(next.load[n].penetration, load[n].penetration);
    }
    next.warning.insert(next.warning.begin(), warning.begin(), warning.end());
    *this = std::move(next);
}

FrameReport Simulation::advance(const Drive& from, const Drive& to) {
    Rooms& r = *rooms_;
    FrameReport report;
    report.time = to.time;
    for (std::size_t b = 0; b < r.body.size(); ++b) {
        const int severed = r.cut(b, from, to);
        report.severed += severed;
        if (severed > 0) r.count_pieces(b, "the blade", report.warning);
    }

    const MoveOutcome outcome =
        std::visit([&](auto& solver) { return solver.advance(from, to); }, r.solver);

    report.pieces = 0;
    for (std::size_t b = 0; b < r.body.size(); ++b) {
        report.broken += outcome.body[b].broken;
        if (outcome.body[b].broken > 0) r.count_pieces(b, "fracture", report.warning);
        report.pieces += r.body[b].pieces;
    }
    report.iterations = outcome.iterations;
    report.increments = outcome.increments;
    report.halvings = outcome.halvings;
    report.steps = outcome.steps;
    report.rescued = outcome.rescued;
    report.asleep = outcome.asleep;
    report.rejected = outcome.rejected;
    report.shortest_step = outcome.shortest_step;
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
    if (outcome.afloat > 0) {
        const bool one = outcome.afloat == 1;
        report.warning.push_back(fmt::format(
            "{} would fall, for nothing holds {} against gravity and loads: equilibria have no "
            "fall (solver = \"explicit\" has), so from here on these leave {} alone",
            one ? "a piece" : fmt::format("{} pieces", outcome.afloat), one ? "it" : "them",
            one ? "it" : "them"));
    }
    if (outcome.hanging > 0) {
        const bool one = outcome.hanging == 1;
        report.warning.push_back(fmt::format(
            "{} by less than a whole cell, which cannot bear {} against gravity and loads: from "
            "here on these leave {} alone",
            one ? "a piece hangs" : fmt::format("{} pieces hang", outcome.hanging),
            one ? "it" : "them", one ? "it" : "them"));
    }
    if (outcome.let_be > 0) {
        report.warning.push_back(fmt::format(
            "no equilibrium is found with {} point{} of the work-piece's surface that lie deeper "
            "than a fifth of a cell in it: from here on these go through it",
            outcome.let_be, outcome.let_be == 1 ? "" : "s"));
    }
    if (outcome.left_over > 0) {
        report.warning.push_back(
            fmt::format("what was cut, broken or let go of does not come to rest as exactly as the "
                        "loads ask: from here on {:.2g} N of forces may be out of balance",
                        outcome.left_over));
    }
    if (outcome.drag_held) {
        report.warning.push_back(
            "the drag is so strong that it stops some of the surface within a few steps; there it "
            "is held to what a step can follow");
    }
    if (outcome.rescued > 0) {
        report.warning.push_back(fmt::format(
            "explicit steps went wrong however short they were: {} implicit ones stand in for them",
            outcome.rescued));
    }
    if (outcome.inside_out > 0) {
        report.warning.push_back(fmt::format(
            "{} cell{} turned inside out, which shorter steps did not keep from it: the matter is "
            "crushed harder than its stiffness can hold",
            outcome.inside_out, outcome.inside_out == 1 ? "" : "s"));
    }
    if (outcome.buckled) {
        report.warning.push_back(
            "the work-piece buckled: it left its shape for one that bears less");
    }

    r.book(outcome, report);
    report.load = loads(to);
    for (std::size_t n = 0; n < r.work.size(); ++n) {
        ToolLoad& load = report.load[n];
        for (const BodyOutcome& body : outcome.body) {
            r.work[n] += body.work[n];
            load.force += body.load[n].force;
            load.torque += body.load[n].torque;
            load.penetration = std::max(load.penetration, body.load[n].penetration);
            load.contacts += body.load[n].contacts;
            load.touched = load.touched || body.touched[n] || body.load[n].contacts > 0;
        }
        load.work = r.work[n];
    }
    const std::vector<PushSum> pushes = r.push_sums(to);
    const std::size_t first = report.load.size() - pushes.size();
    for (std::size_t n = 0; n < pushes.size(); ++n) {
        for (const BodyOutcome& body : outcome.body) r.push_work[n] += body.push_work[n];
        ToolLoad& load = report.load[first + n];
        load.force = pushes[n].force;
        load.torque = pushes[n].torque;
        load.work = r.push_work[n];
        if (n < r.apparatus.load.size()) {
            load.contacts = static_cast<int>(r.apparatus.load[n].point.size());
        }
    }
    return report;
}

double explicit_steps_per_second(const Aggregate& matter, const SimSettings& settings) {
    return 1 / explicit_step(matter, settings);
}

long equilibria_along(const Aggregate& matter, const Apparatus& apparatus,
                      const SimSettings& settings, const std::vector<Drive>& drives) {
    const ContactSet contacts(matter, apparatus, settings);
    long count = 0;
    for (std::size_t n = 1; n < drives.size(); ++n) {
        count += increments_between(contacts, matter, drives[n - 1], drives[n]);
    }
    return count;
}

}  // namespace swage

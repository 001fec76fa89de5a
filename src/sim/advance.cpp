// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/advance.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/bytes.h"
#include "base/error.h"
#include "sim/blade_way.h"
#include "sim/block_steps.h"
#include "sim/cell_flow.h"
#include "sim/crumbs.h"
#include "sim/cut_plan.h"
#include "sim/energy_steps.h"
#include "sim/given_up.h"
#include "sim/lattice_forces.h"
#include "sim/move_warnings.h"
#include "sim/quasistatic.h"
#include "sim/sever.h"
#include "sim/weigh_pieces.h"

namespace swage {

namespace {

// Spacings that matter may have moved from the path of a blade that severs it as planned.
constexpr double kBeside = 2;

using AnySolver = std::variant<QuasistaticSolver, BlockSolver, EnergySteps>;

AnySolver choose_solver(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                        const SimSettings& settings) {
    const bool quasistatic = settings.solver == Solver::quasistatic;
    if (bodies.size() > 1 && (quasistatic || settings.solver == Solver::implicit_steps)) {
        fail(ExitCode::stopped,
             "{}: solver = \"{}\" moves only one body: use solver = \"explicit\"", apparatus.name,
             name_of(settings.solver));
    }
    if (!apparatus.limit.empty() && !quasistatic) {
        fail(ExitCode::stopped, "{}: solver = \"{}\" cannot stop at a limit: use \"quasistatic\"",
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
    return BlockSolver(bodies, apparatus, settings);
}

// A body, and what the stage has done to it so far.
struct WorkedBody {
    Aggregate* matter;
    int pieces;
    std::ptrdiff_t crumbs;  // particles
    Books books{};
    bool begun = false;
    CutPlan plan{};                  // cuts of the coming frames
    std::vector<PointSide> sides{};  // of what these will part

    template <typename Io>
    void visit(Io& io) {
        io(pieces, crumbs, books, begun, plan, sides);
    }
};

}  // namespace

struct Simulation::Rooms {
    std::vector<WorkedBody> body;
    const Apparatus& apparatus;
    AnySolver solver;
    std::vector<double> work, load_work;  // of each tool and grip, load and gravity, on all bodies
    std::vector<long> severed;            // by each blade
    Vec3 gravity;                         // at full strength [m/s2]

    template <typename Io>
    void visit(Io& io) {
        std::visit([&](auto& any) { io(any); }, solver);
        for (WorkedBody& one : body) io(one);
        io(work, load_work, severed);
    }

    const LoadSet& pushes(std::size_t b) const {
        return std::visit([&](const auto& any) -> const LoadSet& { return any.pushes(b); }, solver);
    }
    double elastic(std::size_t b) {
        return std::visit([&](auto& any) { return any.elastic_energy(b); }, solver);
    }
    BodyContact* contact() {  // null: nothing moves
        return std::visit(
            [](auto& any) -> BodyContact* {
                if constexpr (std::is_same_v<std::decay_t<decltype(any)>, QuasistaticSolver>) {
                    return nullptr;
                } else {
                    return &any.contact();
                }
            },
            solver);
    }
    double connections_changed(std::size_t b, const Drive& now) {
        return std::visit([&](auto& any) { return any.connections_changed(b, now); }, solver);
    }

    bool moves() const { return !std::holds_alternative<QuasistaticSolver>(solver); }

    std::vector<SeverEvent> crossed(const Aggregate& matter, std::span<const Drive> way) const {
        return crossed_connections(matter, swept_triangles(apparatus, way));
    }

    std::vector<LoadSum> load_sums(const Drive& now) const;
    std::vector<ToolLoad> loads(const Drive& now, const std::vector<LoadSum>& pushes) const;
    struct Cut {
        int severed = 0;
        std::size_t missed = 0;  // of what was planned
    };
    Cut cut(std::size_t b, const Drive& from, const Drive& to);
    std::size_t put_off(WorkedBody& at, std::vector<SeverEvent>& events) const;
    void count_pieces(std::size_t b, const char* who, std::vector<std::string>& warning);
    void book(const MoveOutcome& outcome, FrameReport& report);
};

// Of all bodies together.
std::vector<LoadSum> Simulation::Rooms::load_sums(const Drive& now) const {
    std::vector<LoadSum> all = pushes(0).sums(*body[0].matter, now);
    double mass = body[0].matter->mass();
    for (std::size_t b = 1; b < body.size(); ++b) {
        const std::vector<LoadSum> more = pushes(b).sums(*body[b].matter, now);
        for (std::size_t n = 0; n < apparatus.load.size(); ++n) {
            if (apparatus.load[n].body == static_cast<int>(b)) all[n] = more[n];
        }
        if (!pushes(b).has_gravity()) continue;
        // Whose centre does not jump: of several bodies nothing is left alone.
        const double own = body[b].matter->mass();
        all.back().centre = (mass * all.back().centre + own * more.back().centre) / (mass + own);
        all.back().force += more.back().force;
        mass += own;
    }
    return all;
}

std::vector<ToolLoad> Simulation::Rooms::loads(const Drive& now,
                                               const std::vector<LoadSum>& pushes) const {
    std::vector<ToolLoad> loads;
    const auto add = [&](const auto& parts, const std::vector<Pose>& pose) {
        for (std::size_t n = 0; n < parts.size(); ++n) {
            loads.emplace_back();
            loads.back().name = parts[n].name;
            loads.back().pose = pose[n];
        }
    };
    add(apparatus.tool, now.world_from_tool);
    add(apparatus.grip, now.world_from_grip);
    add(apparatus.blade, now.world_from_blade);
    std::vector<Pose> middle;
    for (const LoadSum& push : pushes) middle.push_back({Quat::Identity(), push.centre});
    add(apparatus.load, middle);
    if (pushes.size() > apparatus.load.size()) {
        loads.emplace_back();
        loads.back().name = "gravity";
        loads.back().pose = middle.back();
    }
    const std::size_t first = loads.size() - pushes.size();
    for (std::size_t n = 0; n < pushes.size(); ++n) {
        ToolLoad& load = loads[first + n];
        load.jump = pushes[n].jump;
        load.force = pushes[n].force;
        load.torque = pushes[n].torque;
        load.strength = n < apparatus.load.size() ? now.load_strength[n] : now.gravity_strength;
        if (n < apparatus.load.size()) {
            load.contacts = static_cast<int>(apparatus.load[n].point.size());
        }
    }
    return loads;
}

// What moves may have left the path that it was to be cut along, or be ahead of the blade there: it
// waits until a blade has been beside it. Returns how many will not see that. Met ones come first.
std::size_t Simulation::Rooms::put_off(WorkedBody& at, std::vector<SeverEvent>& events) const {
    const auto waits = std::ranges::find_if(events, [](const SeverEvent& e) { return !e.met; });
    const auto count = static_cast<std::size_t>(events.end() - waits);
    if (!at.plan.empty()) at.plan.front().insert(at.plan.front().end(), waits, events.end());
    events.erase(waits, events.end());
    return at.plan.empty() ? count : 0;
}

// Cuts what the blades sweep on this way.
Simulation::Rooms::Cut Simulation::Rooms::cut(std::size_t b, const Drive& from, const Drive& to) {
    WorkedBody& at = body[b];
    std::vector<SeverEvent> events;
    Cut cut;
    std::vector<Drive> way = {from, to};
    if (at.plan.empty()) {
        events = crossed(*at.matter, way);
        if (events.empty()) return {};
        name_blades(events, *at.matter, apparatus, way);
        at.sides = sides_of(*at.matter, events, swept_triangles(apparatus, way));
    } else {
        if (moves()) {
            if (!is_gripped(apparatus, b)) {
                const bool falls = !(at.books.contact > 0);
                way = way_in_flight(*at.matter, apparatus, way, falls ? gravity : Vec3::Zero());
            }
            mark_met(at.plan, *at.matter, swept_triangles(apparatus, way),
                     kBeside * at.matter->lattice.spacing);
        }
        events = std::move(at.plan.front());
        at.plan.pop_front();
        // A crack may have run ahead of the blade since.
        std::erase_if(events, [&](const SeverEvent& e) {
            return at.matter->connection[e.direction].weight[e.lower] <= 0;
        });
        std::ranges::stable_partition(events, &SeverEvent::met);
        drop_doubles(events);
        if (moves()) cut.missed = put_off(at, events);
    }
    if (events.empty()) return cut;
    const double before = elastic(b);
    sever(*at.matter, events);
    const std::vector<double> mass = at.matter->particle_mass;
    const double slowed = weigh_pieces(*at.matter, events);
    if (at.matter->particle_mass != mass) {
        std::visit([&](auto& any) { any.masses_changed(b, mass); }, solver);
    }
    keep_sides(*at.matter, at.sides);
    for (const SeverEvent& e : events) ++severed[static_cast<std::size_t>(e.blade)];
    const double let_go = connections_changed(b, from);
    at.books.severed_energy += before - elastic(b) + let_go + slowed;
    cut.severed = static_cast<int>(events.size());
    return cut;
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
        books.damped += part.damped_work + part.by_contact.damped;
        books.fracture += part.fracture_work;
        books.friction += part.friction_work + part.by_contact.friction;
        books.drag += part.drag_work;
        books.set_free += part.set_free;
        for (double done : part.work) books.work += done;
        for (std::size_t n = 0; n < part.load_work.size(); ++n) {
            const bool gravity = n == apparatus.load.size();
            (gravity ? books.gravity_work : books.load_work) += part.load_work[n];
        }
        // Half of what a contact holds and takes is on its books; what else it works is passed on.
        books.passed += part.by_contact.work + part.by_contact.damped + part.by_contact.friction +
                        part.by_contact.stored - part.by_contact.stored_at_start;
        books.kinetic = part.after.kinetic;
        books.elastic = part.after.elastic;
        books.contact = part.after.contact;
        if (!body[b].begun) {
            books.kinetic_at_start = part.before.kinetic;
            books.elastic_at_start = part.before.elastic + books.severed_energy;
            books.contact_at_start = part.before.contact;
            books.among_at_start = part.by_contact.stored_at_start;
            body[b].begun = true;
        }
        books.remainder = books.left_over();
        report.body.push_back(books);
        report.add(books);
    }
    // What one passes the other gets: what is left is an error as any other.
    report.remainder -= report.passed;
    report.passed = 0;
}

Simulation::Simulation(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                       const SimSettings& settings)
    : rooms_(new Rooms{{},
                       apparatus,
                       choose_solver(bodies, apparatus, settings),
                       {},
                       {},
                       {},
                       settings.gravity}) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        Aggregate& matter = *bodies[b];
        if (!in_motion(settings.solver)) {
            // Equilibria have no speed; whatever an explicit stage left behind is gone.
            for (std::size_t p = 0; p < matter.particle_count(); ++p) {
                matter.particle_velocity.set(p, Vec3::Zero());
            }
        }
        const Pieces pieces = find_pieces(matter);
        rooms_->body.push_back({&matter, pieces.count, particles_in_crumbs(pieces)});
    }
    rooms_->work.assign(apparatus.tool.size() + apparatus.grip.size(), 0.0);
    rooms_->load_work.assign(rooms_->pushes(0).count(), 0.0);
    rooms_->severed.assign(apparatus.blade.size(), 0);
}

Simulation::~Simulation() = default;

bool Simulation::blades_reach(std::size_t body, std::span<const Drive> way) const {
    return !rooms_->crossed(*rooms_->body[body].matter, way).empty();
}

void Simulation::plan_cuts(std::size_t body, std::span<const Drive> way, int steps,
                           const std::vector<char>& blades) {
    const std::size_t each = static_cast<std::size_t>(steps);
    WorkedBody& at = rooms_->body[body];
    take_out(at.plan, blades);
    if (!severs_any(at.plan)) at.sides.clear();
    const std::vector<Drive> own =
        blades.empty() ? std::vector<Drive>(way.begin(), way.end()) : way_of(blades, way);
    Aggregate ahead = *at.matter;
    CutPlan more;
    std::vector<SeverEvent> all;
    for (std::size_t n = 0; n + each < own.size(); n += each) {
        more.push_back(rooms_->crossed(ahead, std::span(own).subspan(n, each + 1)));
        sever(ahead, more.back());
        name_blades(more.back(), ahead, rooms_->apparatus, own);
        all.insert(all.end(), more.back().begin(), more.back().end());
    }
    at.plan.resize(more.size());
    add_plan(at.plan, more);
    add_sides(at.sides, sides_of(*at.matter, all, swept_triangles(rooms_->apparatus, own)));
}

Aggregate Simulation::planned(std::size_t body) const {
    Aggregate ahead = *rooms_->body[body].matter;
    for (const std::vector<SeverEvent>& events : rooms_->body[body].plan) sever(ahead, events);
    return ahead;
}

bool Simulation::keep(std::size_t body, const Aggregate& planned, const std::vector<char>& piece,
                      const std::vector<char>& blades) {
    // What others are to cut, for which its skin has been cut too, they cut.
    CutPlan& plan = rooms_->body[body].plan;
    CutPlan own = take_out(plan, blades);
    keep_pieces(find_pieces(planned), piece, own);
    const bool is_more = severs_more(own, plan);
    add_plan(plan, own);
    return is_more;
}

std::vector<ToolLoad> Simulation::loads(const Drive& now) const {
    return rooms_->loads(now, rooms_->load_sums(now));
}

FrameReport Simulation::start() const {
    FrameReport report;
    report.pieces = 0;
    for (std::size_t b = 0; b < rooms_->body.size(); ++b) {
        Books books{.kinetic = kinetic_energy(*rooms_->body[b].matter),
                    .elastic = rooms_->elastic(b)};
        books.kinetic_at_start = books.kinetic;
        books.elastic_at_start = books.elastic;
        report.pieces += rooms_->body[b].pieces;
        report.body.push_back(books);
        report.add(books);
    }
    report.contact = std::numeric_limits<double>::quiet_NaN();
    return report;
}

void FrameReport::go_on(FrameReport next) {
    StepCounts counts = *this;
    counts.count(next);
    static_cast<StepCounts&>(next) = counts;
    next.severed += severed;
    next.broken += broken;
    for (std::size_t n = 0; n < load.size(); ++n) {
        next.load[n].touched = next.load[n].touched || load[n].touched;
        next.load[n].penetration = std::max(next.load[n].penetration, load[n].penetration);
    }
    next.warning.insert(next.warning.begin(), warning.begin(), warning.end());
    *this = std::move(next);
}

FrameReport Simulation::advance(const Drive& from, const Drive& to, const DriveAt& way) {
    Rooms& r = *rooms_;
    FrameReport report;
    std::size_t missed = 0;
    for (std::size_t b = 0; b < r.body.size(); ++b) {
        const auto cut = r.cut(b, from, to);
        report.severed += cut.severed;
        missed += cut.missed;
        if (cut.severed > 0) r.count_pieces(b, "the blade", report.warning);
    }
    if (missed > 0) {
        report.warning.push_back(fmt::format(
            "{} connection{} that lay in the blade's path as it met the matter moved out of it and "
            "stay{} whole, while the skin is cut there: move the blade faster, or hold what it "
            "cuts",
            missed, missed == 1 ? "" : "s", missed == 1 ? "s" : ""));
    }

    MoveOutcome outcome = std::visit(
        [&](auto& solver) {
            if constexpr (std::is_same_v<std::decay_t<decltype(solver)>, QuasistaticSolver>) {
                return solver.advance(from, to, way);
            } else {
                return solver.advance(from, to);
            }
        },
        r.solver);
    const Drive& end = outcome.end(to);
    report.stop = outcome.stop;
    report.time = end.time;

    report.pieces = 0;
    for (std::size_t b = 0; b < r.body.size(); ++b) {
        report.broken += outcome.body[b].broken;
        if (outcome.body[b].broken > 0) r.count_pieces(b, "fracture", report.warning);
        report.pieces += r.body[b].pieces;
    }
    static_cast<StepCounts&>(report) = outcome;
    report.asleep = outcome.asleep;
    for (std::string& sentence : move_warnings(outcome)) {
        report.warning.push_back(std::move(sentence));
    }

    r.book(outcome, report);
    const std::vector<LoadSum> pushes = r.load_sums(end);
    report.load = r.loads(end, pushes);
    for (std::size_t n = 0; n < r.work.size(); ++n) {
        ToolLoad& load = report.load[n];
        for (const BodyOutcome& body : outcome.body) {
            r.work[n] += body.work[n];
            load.force += body.part[n].force;
            load.torque += body.part[n].torque;
            load.penetration = std::max(load.penetration, body.part[n].penetration);
            load.contacts += body.part[n].contacts;
            load.touched = load.touched || body.touched[n] || body.part[n].contacts > 0;
        }
        load.work = r.work[n];
    }
    for (std::size_t n = 0; n < r.severed.size(); ++n) {
        report.load[r.work.size() + n].severed = r.severed[n];
    }
    const std::size_t first = report.load.size() - pushes.size();
    for (std::size_t n = 0; n < pushes.size(); ++n) {
        for (const BodyOutcome& body : outcome.body) r.load_work[n] += body.load_work[n];
        report.load[first + n].work = r.load_work[n];
    }
    if (outcome.given_up) throw GivenUp(outcome.given_up->why, std::move(report));
    return report;
}

std::string Simulation::hand_on() const {
    ByteWriter out;
    BodyContact* const contact = rooms_->contact();
    if (contact != nullptr && contact->acts()) contact->hand_on(out);
    return out.take();
}

void Simulation::take_on(std::string_view contacts, bool unpressed) {
    BodyContact* const contact = rooms_->contact();
    if (contact == nullptr || !contact->acts()) return;
    if (unpressed) contact->begin_unpressed();
    ByteReader in(contacts);
    if (!contacts.empty()) contact->take_on(in);
}

void Simulation::save(ByteWriter& out) const { out(*rooms_); }

void Simulation::load(ByteReader& in) { in(*rooms_); }

double explicit_steps_per_second(const Aggregate& matter, const SimSettings& settings,
                                 bool is_cut) {
    return 1 / explicit_step(matter, settings, is_cut);
}

long equilibria_along(const Aggregate& matter, const Apparatus& apparatus,
                      const SimSettings& settings, const std::vector<Drive>& drives) {
    constexpr std::size_t kEnough = 4096;  // points: with thousands of drives all are too many
    const std::size_t every = 1 + matter.surface.size() / kEnough;
    const RestingContacts contacts(matter, apparatus, settings);
    long count = 0;
    for (std::size_t n = 1; n < drives.size(); ++n) {
        count += increments_between(contacts, matter, drives[n - 1], drives[n], every);
    }
    return count;
}

}  // namespace swage

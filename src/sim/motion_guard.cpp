// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion_guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/cell_volume.h"

namespace swage {

namespace {

constexpr double kFarthestWay = 0.5;  // spacings a step
// Shares of all energy that was ever put in.
constexpr double kLeastGain = 0.002;  // in one block: less is no alarm
constexpr double kCreptGain = 0.2;    // until this much has come of it

bool is_lost(const Aggregate& matter, std::size_t p) {
    return !std::isfinite(matter.particle_position.at(p).sum() +
                          matter.particle_velocity.at(p).squaredNorm());
}

// The first that is lost, else the fastest.
std::size_t worst_particle(const Aggregate& matter) {
    std::size_t worst = 0;
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        if (is_lost(matter, p)) return p;
        if (matter.particle_velocity.at(p).squaredNorm() >
            matter.particle_velocity.at(worst).squaredNorm()) {
            worst = p;
        }
    }
    return worst;
}

struct Strained {
    ParticleId lower = -1, upper = -1;
    double stretch = 1;  // distance over length
};

// The connection that is stretched or pressed most, of one particle or of all.
Strained most_strained(const Aggregate& matter, std::ptrdiff_t particle = -1) {
    Strained worst;
    double most = -1;
    for (const Span& span : matter.lattice.span) {
        const double length = reference_length(matter.lattice, span.direction);
        for (int n = 0; n < span.count; ++n) {
            const ParticleId lower = span.lower + n, upper = span.upper + n;
            if (particle >= 0 && lower != particle && upper != particle) continue;
            if (!(matter.connection[span.direction].weight[lower] > 0)) continue;
            const double stretch =
                (matter.particle_position.at(upper) - matter.particle_position.at(lower)).norm() /
                length;
            const double size = std::isfinite(stretch) ? std::abs(stretch - 1) : 1e300;
            if (size <= most) continue;
            most = size;
            worst = {lower, upper, stretch};
        }
    }
    return worst;
}

std::string text_of(const Strained& connection) {
    if (connection.lower < 0) return "no connection";
    return fmt::format("the connection of particles {} and {} is {:.3g} times its rest length",
                       connection.lower, connection.upper, connection.stretch);
}

std::string advice(Solver solver) {
    const std::string rest =
        "move the tools more slowly (a longer duration), raise [mold] across where matter is "
        "crushed, or contact_stiffness where bodies are pressed deep into each other";
    if (solver == Solver::energy_stepped) {
        return "use solver = \"explicit\", whose steps may gain more, " + rest;
    }
    const std::string shorter =
        solver == Solver::implicit_steps ? "use more frames, " : "lower step_safety, ";
    return shorter + rest + ", or use solver = \"quasistatic\" if only one body is machined";
}

std::string place(const Vec3& x) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", x.x(), x.y(), x.z());
}

}  // namespace

Finding look_at(const MovingBody& body, double way, int allowed) {
    Finding found;
    found.way = way;
    if (!std::isfinite(way)) {
        const Aggregate& matter = body.matter();
        found.fault = is_lost(matter, worst_particle(matter)) ? Fault::lost : Fault::unsolved;
    } else if (way > kFarthestWay * body.matter().lattice.spacing) {
        found.fault = Fault::too_far;
    } else if (body.inside_out() > allowed) {
        found.fault = Fault::inside_out;
    }
    return found;
}

std::string sentence_of(const Finding& finding, const MovingBody& body, const std::string& stage,
                        double step, Solver solver) {
    const Aggregate& matter = body.matter();
    const std::size_t p = worst_particle(matter);
    const std::string where =
        fmt::format("particle {} of body {}", p, finding.body + 1) +
        (is_lost(matter, p) ? std::string() : " at " + place(matter.particle_position.at(p)));
    std::string what;
    switch (finding.fault) {
        case Fault::none:
            break;
        case Fault::lost:
            what = fmt::format("{} is lost (its position or speed is not a number)", where);
            break;
        case Fault::unsolved:
            what = fmt::format("an implicit step has no solution; {} is the fastest", where);
            break;
        case Fault::too_far:
            what = fmt::format("{} moves {:.3g} spacings in one step", where,
                               finding.way / matter.lattice.spacing);
            break;
        case Fault::inside_out: {
            const CellId cell = first_inside_out(matter);
            what = fmt::format(
                "cell {} turns inside out, next to {}", cell,
                cell < 0 ? where
                         : fmt::format("particle {}", matter.lattice.cell_corners(cell)[0]));
            break;
        }
        case Fault::gains:
            what = fmt::format("energy appears from nowhere, {:.3g} % of all that was put in; {}",
                               100 * finding.gain, where + " is the fastest");
            break;
    }
    const bool lost = is_lost(matter, p);
    const Strained worst =
        lost ? most_strained(matter, static_cast<std::ptrdiff_t>(p)) : most_strained(matter);
    return fmt::format("{}: step {} at {:.6g} s: {}, and {}, even with steps of {:.3g} s; {}",
                       stage, finding.step, finding.time, what, text_of(worst), step,
                       advice(solver));
}

bool EnergyGuard::accepts(double turned_over, double done, double lost, double gain, double noise,
                          double at_once) {
    const double budget = budget_ + turned_over;
    double more = gain + lost - done;
    if (more > 0) more = std::max(0.0, more - noise);
    tried_ = excess_ + more;
    const bool creeps = more <= kLeastGain * budget && tried_ <= kCreptGain * budget;
    if (!(tried_ <= kMostGain * budget || creeps || more <= 0)) return false;
    if (more > at_once * budget) return false;
    budget_ = budget;
    excess_ = std::max(tried_, -kMostGain * budget);
    return true;
}

}  // namespace swage

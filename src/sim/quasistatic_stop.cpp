// SPDX-License-Identifier: GPL-3.0-or-later
// What the quasi-static solver says where it finds no equilibrium.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "base/units.h"
#include "base/way_text.h"
#include "sim/quasistatic.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr const char* kNoContact = "no tool in contact";  // RestingContacts::hardest_point()
constexpr double kFarAway = 2;  // spacings that a body without rest has gone

bool has_broken(const Aggregate& matter) {
    return std::any_of(matter.connection.begin(), matter.connection.end(), [](const auto& all) {
        return std::any_of(all.damage.begin(), all.damage.end(), [](float d) { return d >= 1; });
    });
}

// Where it was at rest last, and what of the loads it bore there.
std::string borne_last(const Apparatus& apparatus, const Drive& at) {
    std::string text = fmt::format("it was last at rest at {:.4g} s", at.time);
    for (std::size_t n = 0; n < apparatus.load.size(); ++n) {
        const Load& load = apparatus.load[n];
        Vec3 force = Vec3::Zero();
        for (const Vec3& one : load.force) force += at.load_strength[n] * one;
        const std::string size =
            load.force.empty()
                ? quantity_text(at.load_strength[n] * load.pressure, Quantity::stress)
                : quantity_text(force.norm(), Quantity::force);
        text += fmt::format("{}{} of {}", n > 0 ? ", " : " under ", size, load.name);
    }
    return text;
}

// Whether forces draw away from what it lies on, by its weight, a body that nothing takes hold of.
bool is_lifted(const Apparatus& apparatus, const Drive& at, const Vec3& weight) {
    if (!apparatus.grip.empty() || apparatus.tool.empty()) return false;
    Vec3 sum = weight;
    for (std::size_t n = 0; n < apparatus.load.size(); ++n) {
        if (apparatus.load[n].force.empty()) return false;
        for (const Vec3& one : apparatus.load[n].force) sum += at.load_strength[n] * one;
    }
    return sum.dot(weight) < 0;
}

// Where loads push more aside than all that acts pushes up or down; else 0.
Vec3 pushed_aside(const std::vector<LoadSum>& sums, const Vec3& gravity) {
    Vec3 push = Vec3::Zero();
    for (const LoadSum& one : sums) push += one.force;
    const Vec3 down = gravity.normalized();  // or 0
    const Vec3 along = push.dot(down) * down, aside = push - along;
    return aside.norm() > along.norm() ? aside : Vec3(Vec3::Zero());
}

const char* pushers(const LoadSet& pushes, const Apparatus& apparatus) {
    if (apparatus.load.empty()) return "gravity pulls it";
    return pushes.has_gravity() ? "loads and gravity push it" : "loads push it";
}

}  // namespace

// What a try that has come to nothing met, at the positions that it came to.
std::string QuasistaticSolver::met(const StaticMove& move) {
    std::string text = forces_.contacts.hardest_point(matter_, move.to);
    const double a = matter_.lattice.spacing;
    if (forces_.self.presses()) {
        text += fmt::format("; the work-piece touches itself, {:.2g} spacings deep",
                            forces_.self.sums().penetration / a);
    }
    const double way = farthest_move(matter_.particle_position, move.start);
    if (forces_.pushes.count() > 0 && way > kFarAway * a) {
        text +=
            fmt::format("; the work-piece was moving, {:.2g} spacings from where it lay", way / a);
    }
    return text;
}

// Of a stage that has found no rest yet: what acts from its first instant on matter that has borne
// next to nothing, which no number of frames brings on more slowly, and what does. Empty: nothing.
std::string QuasistaticSolver::acts_at_once(const StaticMove& move) {
    constexpr double kNothing = 1e-6;  // of what a cell would store that bore it all
    if (move.from.time > 0) return {};
    double modulus = 0;
    for (std::size_t m = 0; m < matter_.material_count(); ++m) {
        modulus = std::max(modulus, matter_.material_at(m).young_modulus);
    }
    const double size = forces_.pushes.size(matter_, move.from);
    const double stored = size * size / (2 * modulus * matter_.lattice.spacing);
    if (elastic_energy() > kNothing * stored) return {};
    std::vector<std::string> name, key;
    if (!forces_.pushes.gravity(move.from).isZero(0)) {
        name.emplace_back("gravity"), key.emplace_back("gravity_strength = \"t\"");
    }
    for (std::size_t n = 0; n < apparatus_.load.size(); ++n) {
        if (move.from.load_strength[n] == 0) continue;
        name.push_back(apparatus_.load[n].name);
        if (key.empty() || key.back().starts_with("gravity")) {
            key.emplace_back("strength = \"t\"");
        }
    }
    if (name.empty()) return {};
    return fmt::format(
        "{} {} from the first instant on, however many frames there are: {} lets {} "
        "grow over the stage",
        joined(name, " and "), name.size() == 1 ? "acts" : "act", joined(key, " and "),
        name.size() == 1 ? "it" : "them");
}

void QuasistaticSolver::stop(const Relaxation& tried, const StaticMove& move,
                             const std::string& met) {
    const Vec3 push = tried.falls ? forces_.free.push_off(forces_.pushes, move.to) : Vec3::Zero();
    if (!push.isZero(0)) {
        fail(ExitCode::stopped,
             "{}: the work-piece{} goes off at {:.4g} s: {} with {} along the world's {}, which "
             "its grips leave free, and equilibria cannot move: hold it that way too (`along`), or "
             "let it move with solver = \"explicit\"",
             apparatus_.name, has_broken(matter_) ? ", which has broken," : "", move.to.time,
             pushers(forces_.pushes, apparatus_), quantity_text(push.norm(), Quantity::force),
             way_text(push.normalized()));
    }
    const Vec3 aside = tried.falls ? pushed_aside(forces_.pushes.sums(matter_, move.to),
                                                  forces_.pushes.gravity(move.to))
                                   : Vec3::Zero();
    if (!aside.isZero(0)) {
        fail(ExitCode::stopped,
             "{}: the work-piece{} goes off along the world's {} at {:.4g} s, as nothing holds it "
             "there against loads, and equilibria cannot move: hold it, or let it move with "
             "solver = \"explicit\"",
             apparatus_.name, has_broken(matter_) ? ", which has broken," : "",
             way_text(aside.normalized()), move.to.time);
    }
    if (tried.falls) {
        fail(ExitCode::stopped,
             "{}: the work-piece{} falls at {:.4g} s, as nothing holds it against gravity and "
             "loads, and equilibria cannot fall: hold it, support it, or let it fall with solver = "
             "\"explicit\"",
             apparatus_.name, has_broken(matter_) ? ", which has broken," : "", move.to.time);
    }
    std::string advice = "raise frames or tolerance of the stage";
    const std::string at_once = acts_at_once(move);
    if (!tried.converged && met.starts_with(kNoContact) &&
        is_lifted(apparatus_, move.to, matter_.mass() * forces_.pushes.gravity(move.to))) {
        advice =
            "no tool touches it any more: the loads lift it off, as nothing holds it; hold it, "
            "lower them, or let it move with solver = \"explicit\"";
    } else if (const Vec3 turn = forces_.free.turn_off(forces_.pushes, move.to); !turn.isZero(0)) {
        advice = fmt::format(
            "{} round the world's {}, and its grips leave it free to turn so: hold it, or let it "
            "move with solver = \"explicit\"",
            pushers(forces_.pushes, apparatus_), way_text(turn.normalized()));
    } else if (!at_once.empty()) {
        advice = at_once;
        if (matter_.yields()) advice += "; matter that flows under what it cannot bear needs less";
    } else if (tried.converged) {
        advice = "a cell is crushed flat: raise [mold] across, or bend and twist less";
    } else if (forces_.pushes.count() > 0 && matter_.yields()) {
        advice =
            "if the matter flows under loads that it cannot bear, lower these; otherwise raise "
            "frames or tolerance of the stage";
    }
    fail(ExitCode::stopped,
         "{}: no equilibrium found at {:.4g} s after {} iterations and {} halvings (residual "
         "{:.2g} of the largest push, required {:.2g}; {}); {}; {}",
         apparatus_.name, move.to.time, tried.iterations, move.depth, tried.residual,
         settings_.tolerance, met,
         at_once.empty() ? borne_last(apparatus_, move.from)
                         : "it has not been at rest since the stage began",
         advice);
}

}  // namespace swage

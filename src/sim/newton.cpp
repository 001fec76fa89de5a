// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/newton.h"

#include <algorithm>
#include <cmath>

#include "base/interrupt.h"
#include "sim/free_motions.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kMostSteps = 60, kMostFalling = 300;
constexpr int kMostIterations = 400;  // of conjugate gradients
constexpr int kKeptSteps = 3;         // that coarse matrices serve in one solution
constexpr int kMostTries = 12;        // of the length of a step
constexpr struct {
    double geometric, firmer;  // by a share of the diagonal
} kPrepared[] = {{1, 0}, {0, 0}, {0, 0.01}, {0, 0.1}};
// Of the matter's own stiffness: less than the one below zero is no instability, more than the
// other is a turn of the whole, which strains nothing.
constexpr double kFalls = 0.01, kTurns = 50;
constexpr bool leaves_rest(double left) { return left < -kFalls && left > -kTurns; }
constexpr double kNearRest = 1;     // times what it is pushed with, left over
constexpr double kMostly = 0.5;     // of how far it has gone
constexpr double kLeastGone = 0.1;  // spacings: less is no other shape
constexpr double kDownhill = 2;     // spacings, where the curvature is negative
constexpr double kFarthest = 0.1;   // of the body, for what leaves an equilibrium
constexpr double kProbe = 0.05;     // spacings, to find how that bends
constexpr double kOvershoot = 0.5;  // of the work along a step that may be left, either way
constexpr double kTurned = 0.1;     // that cells turn or strain in a step that is not cut [rad]
constexpr int kPatience = 3;        // such steps that may not have come low enough yet
constexpr double kLower = 0.2;      // of what the first one promises, to be low enough

// What any cell turns or strains by along this way, at most.
double most_turned(const Lattice& lattice, const Vec3Array& way) {
    double most = 0;
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            Vec3 of[8];
            for (int c = 0; c < 8; ++c) of[c] = way.at(run.corner(n, c));
            for (int c = 0; c < 8; ++c) {
                for (int d = 0; d < 3; ++d) {
                    if (!(c >> d & 1)) most = std::max(most, (of[c | 1 << d] - of[c]).norm());
                }
            }
        }
    }
    return most / lattice.spacing;
}

// Where the work along a straight way is zero, between these shares of it: what it loses goes as
// the tangent says, by which it would be zero at 1, and with the cube, by which a way stretches
// what turns.
double zero_of_work(double start, double share, double work, double low, double high) {
    const double cube = (start * (1 - share) - work) / (share * share * share);
    const double least = low + 0.1 * (high - low), most = high - 0.1 * (high - low);
    for (int n = 0; n < 20; ++n) {
        const double s = 0.5 * (low + high);
        (start * (1 - s) > cube * s * s * s ? low : high) = s;
    }
    return std::clamp(low, least, most);
}

}  // namespace

Newton::Newton(const Aggregate& matter, const std::vector<float>& carried_fill)
    : tangent_(matter, carried_fill),
      multigrid_(matter),
      extent_(matter.lattice.spacing * matter.lattice.cell_count.maxCoeff()) {}

void Newton::product(const Aggregate& matter, const NewtonProblem& problem, CellTangent::Kind kind,
                     const Vec3Array& direction, Vec3Array& result) {
    tangent_.product(matter, kind, direction, result);
    for (const HeldPoint& h : problem.held) {
        Vec3 way = Vec3::Zero();
        for (int c = 0; c < 8; ++c) way += double(h.weight[c]) * direction.at(h.corner[c]);
        const Vec3 force = h.stiffness * way;
        for (int c = 0; c < 8; ++c) result.add(h.corner[c], double(h.weight[c]) * force);
    }
    for_each_chunk(direction.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            result.add(p, problem.drag[p] * direction.at(p));
        }
    });
}

// Whether no point is held or let go of, and nothing has gone far, since.
bool Newton::Prepared::is_for(const NewtonProblem& problem, const Aggregate& matter) const {
    return stands && points == problem.held.size() &&
           !(farthest_move(at, matter.particle_position) > matter.lattice.spacing);
}

void Newton::Prepared::serve(int count) {
    if (iterations < 0) iterations = count;
    is_stale = count > iterations + iterations / 2 + 4;
}

// The exact tangent where that is stable and wanted, else the part of it that is, made firmer where
// that is not: far strained matter may be soft by itself.
bool Newton::prepare(const Aggregate& matter, const NewtonProblem& problem, bool exact) {
    prepared_.stands = false;
    for (const auto& [geometric, firmer] : kPrepared) {
        if (geometric == 1 && !exact) continue;
        const CellTangent::Kind kind{Flow::trial, geometric};
        const auto times = [&](const Vec3Array& d, Vec3Array& r) {
            product(matter, problem, kind, d, r);
        };
        std::vector<double> drag = problem.drag;
        for (std::size_t p = 0; p < drag.size(); ++p) drag[p] += firmer * problem.diagonal[p];
        if (multigrid_.prepare(matter, tangent_, kind, problem.held, drag, times)) {
            prepared_ = {true, kind, matter.particle_position, problem.held.size()};
            return true;
        }
    }
    return false;
}

// Conjugate gradients for the exact tangent; ends early where that has no positive curvature.
bool Newton::find_direction(const Aggregate& matter, const NewtonProblem& problem,
                            double accuracy) {
    const auto times = [&](const Vec3Array& d, Vec3Array& r) {
        product(matter, problem, prepared_.kind, d, r);
    };
    residual_ = force_;
    set_zero(matter.particle_count(), direction_);
    // Scaled by the diagonal.
    const auto norm = [&] {
        return chunked_sum(residual_.size(), [&](std::size_t p) {
            const double k = problem.diagonal[p];
            return k > 0 ? residual_.at(p).squaredNorm() / k : 0.0;
        });
    };
    const double enough = accuracy * accuracy * norm();
    multigrid_.solve(times, residual_, better_);
    double size = dot(residual_, better_);
    if (!(size > 0)) return false;
    search_ = better_;
    for (int n = 1; n <= kMostIterations; ++n) {
        throw_if_interrupted();
        product(matter, problem, {Flow::trial, 1.0}, search_, image_);
        const double curvature = dot(search_, image_);
        if (!(curvature > 0)) {
            if (!std::isfinite(curvature)) return false;
            falls_ = true;
            give_way(matter, problem, curvature);
            combine(1, kDownhill * matter.lattice.spacing / longest_of(search_), search_,
                    direction_);
            return true;
        }
        const double length = size / curvature;
        combine(1, length, search_, direction_);
        combine(1, -length, image_, residual_);
        if (norm() <= enough) {
            prepared_.serve(n);
            return true;
        }
        multigrid_.solve(times, residual_, better_);
        const double next = dot(residual_, better_);
        if (!(next > 0)) return false;
        combine(next / size, 1, better_, search_);
        size = next;
    }
    prepared_.is_stale = true;
    return true;
}

double gone_by(const Aggregate& matter, const Vec3Array& motion, const Vec3Array& start) {
    const std::vector<double>& mass = matter.particle_mass;
    const Vec3Array& x = matter.particle_position;
    const double gone = chunked_sum(x.size(), [&](std::size_t p) {
        return mass[p] * motion.at(p).dot(x.at(p) - start.at(p));
    });
    return gone / chunked_sum(x.size(), [&](std::size_t p) {
               return mass[p] * motion.at(p).squaredNorm();
           });
}

// The present search direction has this curvature. NOTE: far from rest, where a step has stretched
// what is slender, that says nothing: a blade under too little to tip over gave way there, and came
// back upright.
void Newton::give_way(const Aggregate& matter, const NewtonProblem& problem, double curvature) {
    if (gave_way_.size() > 0 || !(problem.residual(force_) <= kNearRest)) return;
    product(matter, problem, {Flow::trial, 0.0}, search_, image_);
    const double own = dot(search_, image_);
    if (own > 0 && leaves_rest(curvature / own)) gave_way_ = search_;
}

bool Newton::has_gone_over(const Aggregate& matter, const Vec3Array& start) const {
    if (gave_way_.size() == 0) return false;
    const double far = std::abs(gone_by(matter, gave_way_, start)) * longest_of(gave_way_);
    return far > kMostly * farthest_move(matter.particle_position, start) &&
           far > kLeastGone * matter.lattice.spacing;
}

Newton::Way Newton::way_of(const Aggregate& matter, bool loose) const {
    const Vec3Array& x = matter.particle_position;
    const std::vector<double>& mass = matter.particle_mass;
    Way way{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), direction_};
    if (!loose) return way;
    double whole = 0;
    for (std::size_t p = 0; p < x.size(); ++p) {
        whole += mass[p];
        way.center += mass[p] * x.at(p);
        way.shift += mass[p] * direction_.at(p);
    }
    way.center /= whole;
    way.shift /= whole;
    Mat3 inertia = Mat3::Zero();
    Vec3 momentum = Vec3::Zero();
    for (std::size_t p = 0; p < x.size(); ++p) {
        const Vec3 arm = x.at(p) - way.center;
        inertia += mass[p] * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
        momentum += mass[p] * arm.cross(direction_.at(p));
    }
    way.turn = solve_symmetric(inertia, momentum);
    for (std::size_t p = 0; p < x.size(); ++p) {
        way.rest.add(p, -way.shift - way.turn.cross(x.at(p) - way.center));
    }
    return way;
}

// Goes as far as the forces still work along the way; they are found there. Returns the share of
// the direction gone, 0 when nowhere is better. Where the body leaves an equilibrium that does not
// hold, forces on the way say nothing of how far it will go: there it goes all the way, bent as the
// matter would go by itself, for straight ways stretch what is slender. What has been stretched so,
// in a body that has buckled, comes back first; and of what it goes there little may be left.
// NOTE: a way that was too long ended at a tenth of it, which may be nine tenths too short. For all
// bodies alike, those that flow gave up more often.
double Newton::line_search(Aggregate& matter, const NewtonProblem& problem, bool turns) {
    from_ = matter.particle_position;
    const double start = dot(force_, direction_);
    if (!(start > 0)) return 0;
    const bool stretched = problem.gives_way && problem.residual(force_) > 1;
    const bool bends = falls_ && !turns && !stretched && find_bend(matter, problem);
    const Way way = way_of(matter, turns);
    Vec3Array& x = matter.particle_position;
    double share = 1, low = 0, high = 0;  // high: the least that was too far; 0: none
    if (bends) share = std::min(1.0, kFarthest * extent_ / longest_of(direction_));
    for (int n = 0; n < kMostTries; ++n) {
        const Mat3 turned = turn_by(share * way.turn).toRotationMatrix();
        for_each_chunk(x.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                const Vec3 arm = turned * (from_.at(p) - way.center);
                Vec3 place = way.center + arm + share * (way.shift + way.rest.at(p));
                if (bends) place += share * share * bent_.at(p);
                x.set(p, place);
                direction_.set(p, way.turn.cross(arm) + way.shift + way.rest.at(p));
            }
        });
        problem.forces(force_);
        const double work = dot(force_, direction_);
        const bool is_short = high > 0 && problem.gives_way && work > kOvershoot * start;
        if (std::isfinite(work) && (bends || work >= -kOvershoot * start)) {
            if (!is_short || n + 1 == kMostTries) return share;
            low = share;
        } else {
            high = share;
        }
        if (!std::isfinite(work)) {
            share = low + 0.1 * (high - low);
        } else if (problem.gives_way) {
            share = zero_of_work(start, share, work, low, high);
        } else {
            share *= std::clamp(start / (start - work), 0.1, 0.7);
        }
    }
    return 0;
}

// The way of a body that has buckled down a curved valley. Straight steps along it stretch what
// turns, and the next takes that back: cut by their work, next to nothing is left of them. So they
// are gone, and where several come to no lower energy the first of them is cut after all: the
// watchdog technique (Chamberlain, Powell, Lemarechal, Pedersen, Math. Prog. Study 16, 1982).
struct Newton::Descent {
    Vec3Array lowest{}, force{}, direction{};  // positions, and there
    double promised = 0;                       // that energy falls by [J]
    double rise = 0;                           // of energy since [J]
    int steps = 0;                             // since
};

// NOTE: cells that turn by 0.3 in a step threw broad bodies on slender legs into other valleys.
double Newton::go_down(Aggregate& matter, const NewtonProblem& problem, Descent& descent) {
    Vec3Array& x = matter.particle_position;
    const double share = std::min(1.0, kTurned / most_turned(matter.lattice, direction_));
    double work = dot(force_, direction_);
    if (descent.steps == 0) descent = {x, force_, direction_, share * work};
    // Simpson's rule: forces along a straight way go with its cube.
    for (int half = 1; half <= 2; ++half) {
        combine(1, 0.5 * share, direction_, x);
        problem.forces(force_);
        work += (half == 1 ? 4 : 1) * dot(force_, direction_);
    }
    descent.rise -= share * work / 6;
    if (std::isfinite(descent.rise)) {
        descent.steps = descent.rise < -kLower * descent.promised ? 0 : descent.steps + 1;
        if (descent.steps <= kPatience) return share;
    }
    x = descent.lowest;
    force_ = descent.force;
    direction_ = descent.direction;
    descent.steps = 0;
    prepared_.is_stale = true;
    return line_search(matter, problem, false);
}

// What forces at a small part of the way have that is of its square, and what gives way to that.
bool Newton::find_bend(Aggregate& matter, const NewtonProblem& problem) {
    const double part = kProbe * matter.lattice.spacing / longest_of(direction_);
    Vec3Array& x = matter.particle_position;
    const Vec3Array force = force_;
    Vec3Array ahead;
    for (double side : {1.0, -1.0}) {
        x = from_;
        combine(1, side * part, direction_, x);
        problem.forces(force_);
        if (side > 0) ahead = force_;
    }
    x = from_;
    for (std::size_t p = 0; p < ahead.size(); ++p) {
        ahead.set(p, (ahead.at(p) + force_.at(p) - 2 * force.at(p)) / (2 * part * part));
    }
    // The stable part of the tangent: a stretched way is no reason to go on down.
    if (!prepare(matter, problem, false)) return false;
    prepared_.is_stale = true;
    const auto times = [&](const Vec3Array& d, Vec3Array& r) {
        product(matter, problem, prepared_.kind, d, r);
    };
    multigrid_.solve(times, ahead, bent_);  // about; the next step mends it
    return true;
}

bool Newton::buckles(const Aggregate& matter, const NewtonProblem& problem, double load) {
    tangent_.moved();
    if (!prepared_.is_for(problem, matter) && !prepare(matter, problem, true)) return false;
    const auto times = [&](double geometric) {
        return [&, geometric](const Vec3Array& from, Vec3Array& to) {
            product(matter, problem, {Flow::trial, geometric}, from, to);
        };
    };
    const SoftMode::Map prepared = times(prepared_.kind.geometric);
    const double left = softest_.follow(
        matter.particle_mass, problem.diagonal, free_motions(matter, problem.held), times(1),
        times(0), [&](const Vec3Array& b, Vec3Array& x) { multigrid_.solve(prepared, b, x); },
        load);
    return leaves_rest(left);
}

bool Newton::buckles_in_flow(const FlowAside& flow) const {
    return leaves_rest(softest_.left() - flow.borne());
}

// NOTE: along one motion, for what tools carry along as they go says nothing of how far a neck or a
// slender body has come by itself.
Newton::Astray Newton::astray(const Aggregate& matter, const NewtonProblem& problem,
                              const Vec3Array& force, const Vec3Array& start) {
    if (!prepared_.stands) return {};
    const std::vector<double>& mass = matter.particle_mass;
    const auto by_mass = [&](const Vec3Array& from, Vec3Array& to) {
        to = from;
        for (std::size_t p = 0; p < mass.size(); ++p) to.set(p, mass[p] * from.at(p));
    };
    const auto times = [&](double geometric) {
        return [&, geometric](const Vec3Array& from, Vec3Array& to) {
            product(matter, problem, {Flow::trial, geometric}, from, to);
        };
    };
    const SoftMode::Map prepared = times(prepared_.kind.geometric);
    const double stiffness = slowest_.follow(
        mass, problem.diagonal, free_motions(matter, problem.held), times(1), by_mass,
        [&](const Vec3Array& b, Vec3Array& x) { multigrid_.solve(prepared, b, x); });
    if (!(stiffness > 0)) return {};
    const Vec3Array& way = slowest_.motion();
    const double longest = longest_of(way), gone = chunked_sum(mass.size(), [&](std::size_t p) {
        return mass[p] * way.at(p).dot(matter.particle_position.at(p) - start.at(p));
    });
    return {.gone = std::abs(gone) * longest,
            .left = std::abs(dot(force, way) / stiffness) * longest};
}

Newton::Result Newton::solve(Aggregate& matter, NewtonProblem problem) {
    Result result;
    problem.forces(force_);
    const bool turns = problem.held.empty() && !problem.held_now;
    tangent_.moved();
    falls_ = false;
    gave_way_ = {};
    // NOTE: what flows goes down no such valley; a column of steel took half as many steps again.
    const bool slides = problem.gives_way && !turns && !matter.yields();
    Descent descent;
    const auto most = [&] { return falls_ || problem.gives_way ? kMostFalling : kMostSteps; };
    for (result.steps = 0; result.steps < most(); ++result.steps) {
        result.residual = problem.residual(force_);
        if (!std::isfinite(result.residual)) break;
        result.converged = result.residual <= problem.tolerance;
        if (result.converged) break;
        bool serves = prepared_.stands && !prepared_.is_stale;
        if (problem.held_now) {
            problem.held = problem.held_now();
            serves = serves && prepared_.points == problem.held.size();
        }
        if (!serves && !prepare(matter, problem, true)) break;
        const double accuracy = std::clamp(std::sqrt(result.residual) / 10, 1e-4, 0.1);
        if (!find_direction(matter, problem, accuracy) &&
            !(prepare(matter, problem, false) && find_direction(matter, problem, accuracy))) {
            break;
        }
        const double share = slides ? go_down(matter, problem, descent)
                                    : line_search(matter, problem, turns);
        tangent_.moved();
        if (share == 0) break;
        if (share < 1 || result.steps % kKeptSteps == kKeptSteps - 1) {
            prepared_.is_stale = true;
        }
    }
    return result;
}

}  // namespace swage

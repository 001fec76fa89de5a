// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/implicit_step.h"

#include <algorithm>

#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr double kTolerance = 1e-6;  // of the forces that are at work
constexpr double kRoundOff = 1e-13;  // of E a^2 a particle

}  // namespace

const char* ImplicitStep::cannot(const Aggregate& matter) {
    if (matter.material.mechanics == Mechanics::springs) {
        return "mechanics = \"springs\" has no exact tangent";
    }
    if (matter.breaks()) return "matter that breaks has no exact tangent";
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            if (!cell_is_whole(matter, run.row_at(n))) {
                return "matter that is cut has no exact tangent";
            }
        }
    }
    return nullptr;
}

bool ImplicitStep::move(MovingBody& body, const Drive& now, double step, BodyOutcome& outcome) {
    Aggregate& matter = body.matter();
    const std::vector<float>* cells = body.cells_alone();
    if (cells == nullptr) return false;
    if (!newton_) newton_ = std::make_unique<Newton>(matter, *cells);
    const std::size_t count = matter.particle_count();
    inertia_.resize(count);
    start_ = matter.particle_position;
    aim_ = start_;
    combine(1, step, matter.particle_velocity, aim_);
    double kinetic = 0;
    const Vec3 drift = step * matter.mean_velocity();
    if (!drift.allFinite()) return false;
    Vec3Array carried = start_;
    for (std::size_t p = 0; p < count; ++p) {
        inertia_[p] = matter.particle_mass[p] / (step * step);
        carried.add(p, drift);
        kinetic += 0.5 * inertia_[p] * (carried.at(p) - aim_.at(p)).squaredNorm();
    }
    // The step looks for the least of inertia's and the matter's energy, from where the velocities
    // lead, or from the matter as it is, carried along: what is drawn out so far that its law
    // hardly resists any more may come to rest as well.
    const double elastic = body.elastic_energy();
    matter.particle_position = aim_;
    const bool from_aim = body.elastic_energy() <= elastic + kinetic;
    if (!from_aim) matter.particle_position = carried;
    body.find_candidates(now);

    // Forces below these are round-off: of the matter's, and of the inertia's.
    const double a = matter.lattice.spacing;
    double extent = a, stiff = 0;
    for (std::size_t p = 0; p < count; ++p) {
        extent = std::max(extent, matter.particle_position.at(p).cwiseAbs().maxCoeff());
        stiff += inertia_[p];
    }
    const double least =
        kRoundOff * (matter.mean_modulus() * a * a * double(count) + stiff * 0.01 * extent);
    double pushed = 0;  // the forces at work: the most they were in this step
    NewtonProblem problem;
    problem.forces = [&](Vec3Array& force) {
        body.find_forces(now, 0, outcome);
        force.resize(count);
        for (std::size_t p = 0; p < count; ++p) {
            force.set(p, matter.particle_mass[p] * body.acceleration(p) -
                             inertia_[p] * (matter.particle_position.at(p) - aim_.at(p)));
        }
    };
    problem.residual = [&](const Vec3Array& force) {
        const double sum = chunked_sum(count, [&](std::size_t p) { return force.at(p).norm(); });
        const double at_work = chunked_sum(count, [&](std::size_t p) {
            return matter.particle_mass[p] * body.acceleration(p).norm();
        });
        pushed = std::max(pushed, at_work);
        return sum / (pushed + least / kTolerance);
    };
    problem.tolerance = kTolerance;
    if (body.meets_tools()) {
        problem.held_now = [&] { return body.held_points(now); };
    } else {
        problem.held = body.held_points(now);
    }
    problem.diagonal = body.stiffness_bound();
    for (std::size_t p = 0; p < count; ++p) problem.diagonal[p] += inertia_[p];
    problem.drag = inertia_;
    Newton::Result result = newton_->solve(matter, problem);
    if (!result.converged) {
        matter.particle_position = from_aim ? carried : aim_;
        result = newton_->solve(matter, problem);
    }
    if (!result.converged) return false;
    for (std::size_t p = 0; p < count; ++p) {
        matter.particle_velocity.set(p, (matter.particle_position.at(p) - start_.at(p)) / step);
    }
    return true;
}

}  // namespace swage

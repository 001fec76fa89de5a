// SPDX-License-Identifier: GPL-3.0-or-later
// One body in motion: its matter, and all that acts on it except other bodies.
#pragma once

#include <optional>

#include "matter/drive.h"
#include "matter/matter_state.h"
#include "sim/fastest_swing.h"
#include "sim/internal_damping.h"
#include "sim/lattice_forces.h"
#include "sim/load_set.h"
#include "sim/move_outcome.h"
#include "sim/moving_contacts.h"
#include "sim/settings.h"
#include "sim/surface_drag.h"

namespace swage {

// The longest stable step times the settings' safety [s]; dt < 2 / w (sqrt(1 + zeta^2) - zeta), w
// the lattice's highest angular frequency and zeta its damping ratio there; w^2 is twice what
// sim/fastest_swing.h finds, no more than max(bound / m) of stiffness_bound(), and of what can part
// no less than that of its springs; all branches of the damping are taken as springs beside it.
// `is_cut`: a blade may part it.
double explicit_step(const Aggregate& matter, const SimSettings& settings, bool is_cut = false);

class MovingBody {
  public:
    // `number`: of the body, as grips and loads name it. The references must outlive it.
    MovingBody(Aggregate& matter, int number, const Apparatus& apparatus,
               const SimSettings& settings);

    double stable_step() const { return step_; }  // at first [s], with the settings' safety
    // No contact is stiffer than what its carriers can follow in steps of this length [s].
    void limit_stiffness(double step) { contacts_.limit_stiffness(matter_, step); }

    // A leg begins: forces where the body is now.
    void start(const Drive& from, BodyOutcome& outcome);
    void find_candidates(const Drive& now);
    // What is done on the branches of the damping between these, and they do not store, is lost.
    void begin_block(BodyOutcome& outcome) {
        in_time_ = true;
        block_energy_ = branch_energy();
        outcome.damped_work += block_energy_;
    }
    void end_block(BodyOutcome& outcome) { outcome.damped_work -= branch_energy(); }

    // Whether the steps that follow are implicit: tools then act without rates, and nothing damps.
    void set_implicit(bool implicit);

    // A step from the present positions and drive begins.
    void begin_step(const Drive& before);
    // v += kick (f / m + g), x += step v. Returns the longest way of any particle, not a number
    // where one is lost [m].
    double move(double kick, double step);
    void kick(double kick) { move(kick, 0); }
    // Whether its speeds stand at the time of its places: until it first moves in a block, or since
    // it was woken within one.
    bool is_in_time() const { return in_time_; }
    // Its velocity where it flies (sim/free_flight.h) but for what it comes to touch [m/s].
    std::optional<Vec3> flight_velocity();
    const TouchPoints* touch() const { return contacts_.at_rest().pairs().touch(); }
    // Flies from one drive to another at this velocity.
    void fly(const Drive& before, const Drive& now, const Vec3& velocity, BodyOutcome& outcome);
    // Forces at the present positions, at which a step of this length [s] has just ended.
    void find_forces(const Drive& now, double step, BodyOutcome& outcome);
    // The step is kept.
    void finish_step(const Drive& before, const Drive& now, double step, BodyOutcome& outcome);
    // Finds the candidates anew if anything could have come near since.
    void renew_candidates(const Drive& before, const Drive& now, double way);

    // Whether anything that acts on it has changed or moved since then.
    bool is_stirred(const Drive& since, const Drive& now) const;
    // The farthest that what holds it, or may come to touch it, moves [m].
    double drive_travel(const Drive& from, const Drive& to) const {
        return contacts_.travel(matter_, from, to);
    }
    // The most that loads and gravity come to change the acceleration of any particle by [m/s2].
    double push_change(const Drive& from, const Drive& to) const;
    void stop();

    // What it holds at the present positions and forces, between steps of this length [s]. The
    // kinetic energy is that of the steps themselves, 1/2 m v(-) v(+) with the velocities half a
    // step before and after: what the forces' work by the trapezoid rule adds up to exactly.
    Stored stored(const Drive& now, double step);
    double kinetic_energy(double step) const;  // alone [J]
    // That new springs have lost already and the next step books, after one in which cells cracked.
    double loss_to_book() const { return loss_to_book_; }  // [J]
    // How wrong a step of this length [s] may leave its energy, for places are rounded: to what
    // forces then do, and as sim/free_flight.h has it [J].
    double round_off(double step) const;

    // What a solution by the tangent asks for.
    const std::vector<float>* cells_alone() const { return lattice_.cells_alone(); }
    std::vector<HeldPoint> held_points(const Drive& now) const {
        return contacts_.at_rest().held_points(matter_, now, RestingContacts::Slipping::free);
    }
    std::vector<double> stiffness_bound() const;  // of each particle [N/m]
    bool meets_tools() const { return touches_; }

    double top_speed() const;  // of any particle [m/s]
    // Cells inside out when the forces were found; of rubber, when it was last looked at.
    int inside_out() const { return inside_out_; }
    // Of the present state: what has flowed is thinner, pressed foam stiffer; cells inside out
    // included [s].
    double present_step();
    Vec3 acceleration(std::size_t p) const {
        return force_.at(p) / matter_.particle_mass[p] + gravity_;
    }

    // A blade comes to sever connections, beside which the particles had these masses [kg].
    void masses_changed(const std::vector<double>& was);
    // It has severed them. Returns what contacts with tools and grips held by what is
    // gone [J].
    double connections_changed(const Drive& now) {
        lattice_.connections_changed(matter_, true);
        branch_energy_ = -1;
        return surface_changed(now);
    }
    // In the lattice and in the branches of its damping [J].
    double elastic_energy();

    Aggregate& matter() { return matter_; }
    const Aggregate& matter() const { return matter_; }
    Vec3Array& force() { return force_; }
    const Vec3& gravity() const { return gravity_; }  // [m/s2]
    // As they were found at the state that restore() went back to.
    void restore_forces(Vec3Array force, const Vec3& gravity) {
        force_ = std::move(force);
        gravity_ = gravity;
    }
    const LoadSet& pushes() const { return pushes_; }
    const std::vector<PartSum>& load() const { return load_; }  // by tool, then grip
    bool drags() const { return drag_.acts(); }  // a medium does, which implicit steps have none of

    // All that a step changes.
    struct State {
        MatterState matter;
        std::optional<MovingContacts> contacts;
        std::optional<LoadSet> pushes;
        std::optional<InternalDamping> damping;  // none, nor memory: no copy is kept
        std::vector<BranchMemory> memory;
        Vec3Array drag;  // empty: none acts
        std::vector<PartSum> load;
        double gone, turned, loss_to_book;
    };
    void save(State& state) const;
    // NOTE: but for energy-stepped ones, which are often taken back, no copy is kept of what the
    // branches of the damping remember, which is more than all else: they give way. What they held
    // when the block began is booked as damped.
    void restore(const State& state, BodyOutcome& outcome);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        lattice_.visit(io, matter_);
        io(damping_);
        contacts_.visit(io, matter_);
        io(pushes_, swings_, step_, present_step_, flowed_, drag_, force_, load_, turned_, gone_,
           implicit_, branch_energy_, block_energy_, gravity_, inside_out_, loss_to_book_);
        if constexpr (Io::kReads) drag_.find_limits(matter_, step_);
    }

  private:
    double branch_energy();
    void let_go();  // the branches
    double surface_changed(const Drive& now);
    void find_inner_forces(double step, BodyOutcome& outcome);
    bool remember(const Drive& now, double step,
                  BodyOutcome& outcome);  // whether the forces have changed by it

    Aggregate& matter_;
    LatticeForces lattice_;
    bool breaks_;
    SwingBound swings_;
    InternalDamping damping_;
    MovingContacts contacts_;
    LoadSet pushes_;
    double safety_, step_, present_step_;
    bool flowed_ = false;  // since present_step_ was found
    SurfaceDrag drag_;
    Vec3Array force_;
    std::vector<PartSum> load_;
    double turned_ = 0;      // way gone since the last look at what is bent, at the most [m]
    double gone_ = 0;        // no particle has gone farther since candidates were found [m]
    bool touches_;           // a tool could
    bool remembers_;         // its matter yields or breaks
    bool stiffens_ = false;  // as it is pressed, far
    bool implicit_;
    bool saves_branches_;
    bool flies_;  // where nothing is near
    bool in_time_ = true;
    // In the branches [J]: now, negative where it is not known; when the block began.
    double branch_energy_ = -1, block_energy_ = 0;
    Vec3 gravity_ = Vec3::Zero();
    int inside_out_ = 0;
    double loss_to_book_ = 0;
};

}  // namespace swage

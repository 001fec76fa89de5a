// SPDX-License-Identifier: GPL-3.0-or-later
// All bodies that move by blocks of steps (sim/block_steps.h): what they do to each other, which of
// them sleep (sim/sleeping.h), what wakes those, and the way back to where a block began. What
// sleeps stays as it fell asleep: nothing of it is moved, found or saved.
#pragma once

#include <memory>
#include <vector>

#include "base/parallel.h"
#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/body_contact.h"
#include "sim/free_flight.h"
#include "sim/move_outcome.h"
#include "sim/moving_body.h"
#include "sim/settings.h"
#include "sim/sleeping.h"

namespace swage {

class MovingBodies {
  public:
    // The references must outlive it.
    MovingBodies(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                 const SimSettings& settings);

    std::size_t size() const { return body_.size(); }
    MovingBody& operator[](std::size_t body) { return body_[body]; }
    const MovingBody& operator[](std::size_t body) const { return body_[body]; }
    bool may_meet() const { return contact_.acts(); }  // each other, or one itself
    BodyContact& contact() { return contact_; }
    bool is_asleep(std::size_t body) const { return sleeping_.is_asleep(body); }

    template <typename Act>
    void for_each_awake(const Act& act) const {
        for (std::size_t b = 0; b < body_.size(); ++b) {
            if (!sleeping_.is_asleep(b)) act(b);
        }
    }
    // The same at once, where act(b) changes nothing but what is of body b.
    template <typename Act>
    void for_all_awake(const Act& act) const {
        if (body_.size() == 1) return for_each_awake(act);
        std::vector<std::size_t> awake;
        std::size_t particles = 0;
        for_each_awake([&](std::size_t b) {
            awake.push_back(b);
            particles += body_[b].matter().particle_count();
        });
        parallel_for(awake.size(), particles / kThreadShare, [&](std::size_t n) { act(awake[n]); });
    }

    void limit_stiffness(double step);  // of contacts, as MovingBody's
    void masses_changed(std::size_t body, const std::vector<double>& was) {  // as MovingBody's
        body_[body].masses_changed(was);
    }
    double connections_changed(std::size_t body, const Drive& now);  // likewise

    // A leg begins, and the speeds go on by a step of this length [s].
    void start(const Drive& from, double step, MoveOutcome& outcome);

    // Remembers what the block to come goes back to. `may_crush`: any cell may turn inside out in
    // it.
    void save(bool may_crush);
    // Back to that and the books of then, from where the speeds go on by a step of this length [s].
    void restore(const Drive& begin, double step, const std::vector<BodyOutcome>& so_far,
                 MoveOutcome& outcome);
    void begin_block(bool implicit, MoveOutcome& outcome);
    void end_block(MoveOutcome& outcome);
    // Cells of a body that may be inside out in the block.
    int may_be_inside_out(std::size_t body) const { return inside_out_[body]; }

    // How long they fly from here, on the way from one drive to another, before any can touch
    // anything; 0: not all do, or some touch something or themselves [s].
    double free_time(const Drive& from, const Drive& to, const Drive& now);
    // They fly, and the speeds go on from there by a step of this length [s].
    void fly(const Drive& before, const Drive& now, double step, MoveOutcome& outcome);

    // A step [s] begins: wakes what something has come to move since it fell asleep.
    void wake_stirred(const Drive& before, const Drive& now, double step, MoveOutcome& outcome);
    // It is kept, in which no particle of each body went farther than its `way` [m], and all forces
    // are found but those of bodies on each other.
    void finish_step(const Drive& before, const Drive& now, double step,
                     const std::vector<double>& way, MoveOutcome& outcome);
    // Bodies that lie still, as far as all that are near them do.
    void put_to_sleep(const Drive& now, MoveOutcome& outcome);

    // What each holds, as MovingBody's; what sleeps, when it was last awake.
    std::vector<Stored> stored(const Drive& now, double step);
    // The same where nothing has moved since, but for a step of another length.
    std::vector<Stored> still_stored(double step);

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(contact_, by_contact_, sleeping_, asleep_since_, stored_, inside_out_, may_crush_,
           in_block_);
        for (MovingBody& body : body_) io(body);
    }

  private:
    static constexpr std::size_t kThreadShare = 512;  // particles that a thread is worth waking for

    void save_one(std::size_t body);
    // Adds what bodies in contact do to each other in a step of this length [s] from here.
    void meet(const Drive& now, double step, Meet how, MoveOutcome& outcome);
    void wake(std::size_t body, MoveOutcome& outcome);
    std::vector<Flyer> flyers();  // none: not all fly
    void wake_neighbours(const Drive& now, MoveOutcome& outcome);

    const Apparatus& apparatus_;
    std::vector<MovingBody> body_;
    std::vector<MovingBody::State> state_;
    BodyContact contact_;
    std::shared_ptr<const BodyContact::State> contact_state_;
    std::vector<ContactSums> by_contact_;  // when it was last found, by body; empty: none
    Sleeping sleeping_;
    std::vector<Drive> asleep_since_;
    std::vector<Stored> stored_;
    std::vector<int> inside_out_;
    bool may_crush_ = false;
    bool in_block_ = false;
};

}  // namespace swage

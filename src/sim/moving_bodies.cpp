// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/moving_bodies.h"

#include <limits>
#include <utility>

namespace swage {

MovingBodies::MovingBodies(const std::vector<Aggregate*>& bodies, const Apparatus& apparatus,
                           const SimSettings& settings)
    : apparatus_(apparatus),
      state_(bodies.size()),
      contact_(is_explicit(settings.solver) ? bodies : std::vector<Aggregate*>{}, settings),
      sleeping_(bodies, settings),
      asleep_since_(bodies.size()),
      stored_(bodies.size()),
      inside_out_(bodies.size(), 0) {
    body_.reserve(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        body_.emplace_back(*bodies[b], static_cast<int>(b), apparatus, settings);
    }
}

void MovingBodies::limit_stiffness(double step) {
    for (MovingBody& body : body_) body.limit_stiffness(step);
    contact_.limit_stiffness(step);
}

double MovingBodies::connections_changed(std::size_t b, const Drive& now) {
    const double let_go = body_[b].connections_changed(now);
    contact_.connections_changed(b);
    sleeping_.wake(b);
    return let_go;
}

void MovingBodies::start(const Drive& from, double step, MoveOutcome& outcome) {
    for_each_awake([&](std::size_t b) { body_[b].start(from, outcome.body[b]); });
    meet(from, step, Meet::as_kept, outcome);
    for (std::size_t b = 0; b < by_contact_.size(); ++b) {
        outcome.body[b].by_contact.start(by_contact_[b]);
    }
}

void MovingBodies::save_one(std::size_t b) {
    body_[b].save(state_[b]);
    inside_out_[b] = may_crush_ ? std::numeric_limits<int>::max() : body_[b].inside_out();
}

void MovingBodies::save(bool may_crush) {
    may_crush_ = may_crush;
    for_all_awake([&](std::size_t b) { save_one(b); });
    contact_state_ = contact_.save();
}

void MovingBodies::restore(const Drive& begin, double step, const std::vector<BodyOutcome>& so_far,
                           MoveOutcome& outcome) {
    const std::vector<BodyOutcome> gone_wrong = std::exchange(outcome.body, so_far);
    in_block_ = false;
    for_each_awake([&](std::size_t b) {
        body_[b].restore(state_[b], outcome.body[b]);
        body_[b].begin_step(begin);
        body_[b].find_forces(begin, 0, outcome.body[b]);
        if (gone_wrong[b].broken > outcome.body[b].broken) contact_.connections_changed(b);
    });
    contact_.restore(*contact_state_);
    meet(begin, step, Meet::as_kept, outcome);
}

void MovingBodies::begin_block(bool implicit, MoveOutcome& outcome) {
    in_block_ = true;
    for_all_awake([&](std::size_t b) { body_[b].begin_block(outcome.body[b]); });
    for (MovingBody& body : body_) body.set_implicit(implicit);
}

void MovingBodies::end_block(MoveOutcome& outcome) {
    for_all_awake([&](std::size_t b) { body_[b].end_block(outcome.body[b]); });
    in_block_ = false;
}

void MovingBodies::meet(const Drive& now, double step, Meet how, MoveOutcome& outcome) {
    if (!contact_.acts()) return;
    contact_.renew(sleeping_.asleep());
    if (sleeping_.any()) wake_neighbours(now, outcome);
    std::vector<Vec3Array*> force;
    for (MovingBody& body : body_) force.push_back(&body.force());
    contact_.add_forces(force, body_[0].gravity(), step, sleeping_.asleep(), by_contact_, how);
}

// What sleeps near a body that is awake.
void MovingBodies::wake_neighbours(const Drive& now, MoveOutcome& outcome) {
    const std::vector<std::size_t> group = contact_.groups();
    std::vector<char> awake(group.size(), 0);
    for_each_awake([&](std::size_t b) { awake[group[b]] = 1; });
    for (std::size_t b = 0; b < body_.size(); ++b) {
        if (!sleeping_.is_asleep(b) || !awake[group[b]]) continue;
        wake(b, outcome);
        body_[b].begin_step(now);
        body_[b].find_forces(now, 0, outcome.body[b]);
    }
}

void MovingBodies::wake(std::size_t b, MoveOutcome& outcome) {
    sleeping_.wake(b);
    if (!in_block_) return;
    save_one(b);  // it lies as it did when the block began
    body_[b].begin_block(outcome.body[b]);
}

std::vector<Flyer> MovingBodies::flyers() {
    std::vector<Flyer> all;
    for (std::size_t b = 0; b < body_.size(); ++b) {
        const std::optional<Vec3> velocity =
            is_asleep(b) ? std::nullopt : body_[b].flight_velocity();
        if (!velocity) return {};
        const Aggregate& matter = body_[b].matter();
        all.push_back(
            {&matter.particle_position, matter.lattice.spacing, body_[b].touch(), *velocity});
    }
    return all;
}

double MovingBodies::free_time(const Drive& from, const Drive& to, const Drive& now) {
    if (from.gravity_strength != to.gravity_strength) return 0;
    // What touches, presses or sticks, whether or not it has moved anything yet.
    for (const ContactSums& sums : by_contact_) {
        if (sums.contacts > 0) return 0;
    }
    const std::vector<Flyer> flying = flyers();
    if (flying.empty()) return 0;
    return swage::free_time(flying, apparatus_, from, to, now, body_[0].gravity());
}

void MovingBodies::fly(const Drive& before, const Drive& now, double step, MoveOutcome& outcome) {
    const std::vector<Flyer> flying = flyers();
    for_all_awake(
        [&](std::size_t b) { body_[b].fly(before, now, flying[b].velocity, outcome.body[b]); });
    meet(now, step, Meet::anew, outcome);
    contact_.commit(sleeping_.asleep());
}

void MovingBodies::wake_stirred(const Drive& before, const Drive& now, double step,
                                MoveOutcome& outcome) {
    bool any = false;
    for (std::size_t b = 0; b < body_.size(); ++b) {
        if (!sleeping_.is_asleep(b)) continue;
        body_[b].renew_candidates(before, now, 0);
        if (!body_[b].is_stirred(asleep_since_[b], now)) continue;
        wake(b, outcome);
        any = true;
    }
    if (!any) return;
    for_each_awake([&](std::size_t b) {
        body_[b].begin_step(before);
        body_[b].find_forces(before, 0, outcome.body[b]);
    });
    meet(before, step, Meet::as_kept, outcome);
}

void MovingBodies::finish_step(const Drive& before, const Drive& now, double step,
                               const std::vector<double>& way, MoveOutcome& outcome) {
    std::vector<char> broke(body_.size(), 0);
    for_all_awake([&](std::size_t b) {
        const int broken = outcome.body[b].broken;
        body_[b].finish_step(before, now, step, outcome.body[b]);
        body_[b].renew_candidates(before, now, way[b]);
        broke[b] = outcome.body[b].broken > broken;
    });
    for (std::size_t b = 0; b < body_.size(); ++b) {
        if (broke[b]) contact_.connections_changed(b);
    }
    if (!contact_.acts()) return;
    meet(now, step, Meet::anew, outcome);
    for (std::size_t b = 0; b < body_.size(); ++b) {
        outcome.body[b].by_contact.add(by_contact_[b], step);
    }
    contact_.commit(sleeping_.asleep());
}

void MovingBodies::put_to_sleep(const Drive& now, MoveOutcome& outcome) {
    std::vector<char> rests(body_.size(), 1);
    for_each_awake([&](std::size_t b) {
        rests[b] =
            sleeping_.rests(b, now.time, outcome.body[b].after.kinetic, body_[b].gravity().norm());
    });
    std::vector<std::size_t> group = contact_.groups();
    for (std::size_t b = group.size(); b < body_.size(); ++b) group.push_back(b);
    std::vector<char> all(body_.size(), 1);
    for (std::size_t b = 0; b < body_.size(); ++b) all[group[b]] = all[group[b]] && rests[b];
    for_each_awake([&](std::size_t b) {
        if (!all[group[b]]) return;
        sleeping_.put_to_sleep(b);
        asleep_since_[b] = now;
        outcome.body[b].damped_work += outcome.body[b].after.kinetic;
        outcome.body[b].after.kinetic = stored_[b].kinetic = 0;
        body_[b].stop();
    });
}

std::vector<Stored> MovingBodies::stored(const Drive& now, double step) {
    for_all_awake([&](std::size_t b) {
        stored_[b] = body_[b].stored(now, step);
        if (b < by_contact_.size()) stored_[b].contact += by_contact_[b].stored;
    });
    return stored_;
}

std::vector<Stored> MovingBodies::still_stored(double step) {
    for_all_awake([&](std::size_t b) { stored_[b].kinetic = body_[b].kinetic_energy(step); });
    return stored_;
}

}  // namespace swage

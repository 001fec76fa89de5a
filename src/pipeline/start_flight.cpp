// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/start_flight.h"

#include <algorithm>
#include <cmath>
#include <list>

#include "geometry/box.h"
#include "sim/free_flight.h"
#include "sim/standing_contacts.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr int kMostLooks = 200;  // each goes at least half of the way that is left
constexpr double kRounding = 1e-9;

// Whether any press on each other as they stand.
bool any_press(const std::vector<NamedMatter>& bodies, const SimSettings& sim) {
    std::vector<Box> box;
    bool near = false;
    for (const NamedMatter& body : bodies) {
        box.push_back(box_of(body.matter->particle_position));
        for (std::size_t b = 0; b + 1 < box.size(); ++b) {
            near = near || !(gap_between(box[b], box.back()) > 0);
        }
    }
    if (!near) return false;
    std::list<Aggregate> copy;
    std::vector<Aggregate*> matter;
    for (const NamedMatter& body : bodies) matter.push_back(&copy.emplace_back(*body.matter));
    return std::ranges::any_of(standing_contacts(matter, sim),
                               [](const ContactSums& one) { return one.contacts > 0; });
}

}  // namespace

double start_flight(const StageSpec& stage, const Machine& machine,
                    const std::vector<NamedMatter>& bodies, double step) {
    const SimSettings& sim = stage.sim;
    const bool is_steady = stage.machine.stands() && stage.machine.gravity_strength.empty();
    if (!is_steady || !only_gravity_acts(machine.apparatus, sim)) return 0;
    std::list<TouchPoints> touch;
    std::list<Vec3Array> position;
    std::vector<Flyer> flying;
    for (const NamedMatter& body : bodies) {
        const Aggregate& matter = *body.matter;
        const std::optional<Vec3> velocity = flight_velocity(matter, step);  // molded unstrained
        if (!velocity) return 0;
        flying.push_back({&position.emplace_back(matter.particle_position), matter.lattice.spacing,
                          &touch.emplace_back(matter), *velocity});
    }
    if (any_press(bodies, sim)) return 0;
    const Drive from = drive_at(machine, 0, stage.duration);
    Drive to = from, now = from;
    to.time = stage.duration;
    // A run looks anew at each frame, and flies on where that is worth it from there.
    const double frame = stage.duration / stage.frames;
    const auto flown_until = [&](double begin, double free) {
        double end = (std::floor(begin / frame * (1 + kRounding)) + 1) * frame;
        const double most = std::min(begin + free, to.time);  // what nothing moves is free for good
        while (end < most && most - end > kWorthFlying * step) end += frame;
        return std::min(end, most);
    };
    for (int n = 0; n < kMostLooks && now.time < to.time; ++n) {
        const double free = free_time(flying, machine.apparatus, from, to, now, sim.gravity);
        if (!(free > kWorthFlying * step)) break;
        const double time = flown_until(now.time, free) - now.time;
        now.time += time;
        auto at = position.begin();
        for (Flyer& body : flying) {
            const Vec3 way = time * (body.velocity + 0.5 * time * sim.gravity);
            for (std::size_t p = 0; p < at->size(); ++p) at->add(p, way);
            body.velocity += time * sim.gravity;
            ++at;
        }
    }
    return now.time;
}

}  // namespace swage

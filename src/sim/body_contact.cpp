// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/body_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "geometry/near_pairs.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // contacts
constexpr double kWay = 0.45;         // spacings that anything may go between searches
constexpr int kSheet = 3;  // cells nearer than this to each other are one place of contact

Box box_of_cell(const Vec3Array& position, const std::array<ParticleId, 8>& corner) {
    Box box;
    for (ParticleId p : corner) box.grow(position.at(p));
    return box;
}

double box_gap(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

}  // namespace

BodyContact::BodyContact(const std::vector<Aggregate*>& bodies, const SimSettings& settings)
    : settings_(settings), least_spacing_(std::numeric_limits<double>::infinity()) {
    if (bodies.size() < 2 && !settings.self_contact) return;
    for (Aggregate* body : bodies) {
        side_.emplace_back(*body, settings.self_contact);
        least_spacing_ = std::min(least_spacing_, body->lattice.spacing);
    }
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            if (a == b && !settings.self_contact) continue;
            const Material &m = bodies[a]->material, &n = bodies[b]->material;
            const double soft = m.young_modulus / bodies[a]->lattice.spacing,
                         other = n.young_modulus / bodies[b]->lattice.spacing;
            Way way{static_cast<int>(a), static_cast<int>(b)};
            const double e = shared_restitution(m.restitution, soft, n.restitution, other);
            way.law = {.stiffness = 0,
                       .restitution = e,
                       .loss = restitution_loss(e),
                       .damping = restitution_damping(e),
                       .friction = 0.5 * (m.friction + n.friction),
                       .holding = 0.5 * (m.holding_friction() + n.holding_friction()),
                       .hold = 0};
            set_stiffness(way);
            way_.push_back(std::move(way));
        }
    }
}

void BodyContact::set_stiffness(Way& way) {
    const Aggregate &a = side_[way.from].matter(), &b = side_[way.onto].matter();
    const SurfacePoints& points = side_[way.from].points();
    const double one = a.material.young_modulus / a.lattice.spacing,
                 other = b.material.young_modulus / b.lattice.spacing;
    const double k = 0.5 * settings_.contact_stiffness * one * other / (one + other);
    // Both ways share the tension as they do the stiffness.
    const double hold = 0.25 * (a.material.stickiness + b.material.stickiness);
    way.stiffness.clear();
    way.hold.clear();
    for (std::size_t p = 0; p < points.size(); ++p) {
        way.stiffness.push_back(k * points.area[p]);
        way.hold.push_back(hold * points.area[p]);
        if (!(step_ > 0)) continue;
        const double most = 0.25 * lightest_carrier(a, points, p) / (step_ * step_);
        way.stiffness[p] = std::min(way.stiffness[p], most);
    }
}

void BodyContact::limit_stiffness(double step) {
    step_ = step;
    for (Way& way : way_) set_stiffness(way);
}

void BodyContact::connections_changed(std::size_t body) {
    if (!acts()) return;
    side_[body].connections_changed();
    const int b = static_cast<int>(body);
    const int own = static_cast<int>(side_[body].own_points());
    for (Way& way : way_) {
        if (way.from != b && way.onto != b) continue;
        way.has_broken = true;
        for (Contact& contact : way.contact) contact.is_new = true;
        if (way.from != b) continue;
        std::erase_if(way.contact, [&](const Contact& c) { return c.point >= own; });
        set_stiffness(way);
    }
    allowance_ = -1;
}

struct BodyContact::State {
    std::vector<std::vector<Contact>> contact;
};

std::shared_ptr<const BodyContact::State> BodyContact::save() const {
    State state;
    for (const Way& way : way_) state.contact.push_back(way.contact);
    return std::make_shared<const State>(std::move(state));
}

void BodyContact::restore(const State& state) {
    for (std::size_t w = 0; w < way_.size(); ++w) way_[w].contact = state.contact[w];
    allowance_ = -1;
}

std::size_t BodyContact::candidates() const {
    std::size_t count = 0;
    for (const Way& way : way_) count += way.contact.size();
    return count;
}

void BodyContact::renew(const std::vector<char>& asleep) {
    if (!acts()) return;
    double farthest = 0;
    for (std::size_t b = 0; b < listed_.size(); ++b) {
        if (asleep[b]) continue;
        const Vec3Array& x = side_[b].matter().particle_position;
        const std::vector<ParticleId>& skin = side_[b].skin();
        for (std::size_t n = 0; n < skin.size() && allowance_ >= 0; ++n) {
            farthest = std::max(farthest, (x.at(skin[n]) - listed_[b][n]).squaredNorm());
        }
    }
    if (!(farthest <= allowance_ * allowance_) || allowance_ < 0) renew_all(asleep);
}

void BodyContact::renew_all(const std::vector<char>& asleep) {
    if (!acts()) return;
    std::vector<Box> box(side_.size());
    listed_.resize(side_.size());
    for (std::size_t b = 0; b < side_.size(); ++b) {
        const Vec3Array& x = side_[b].matter().particle_position;
        for (ParticleId p : side_[b].skin()) box[b].grow(x.at(p));
        // What lies still is found where it was when it was listed.
        if (asleep[b] && !listed_[b].empty()) continue;
        listed_[b].clear();
        for (ParticleId p : side_[b].skin()) listed_[b].push_back(x.at(p));
    }
    const double step = kWay * least_spacing_;
    allowance_ = std::numeric_limits<double>::infinity();
    for (Way& way : way_) {
        if (asleep[way.from] && asleep[way.onto]) continue;
        const double gap = box_gap(box[way.from], box[way.onto]);
        const bool near = way.from == way.onto || gap <= 2 * step;
        allowance_ = std::min(allowance_, near ? step : 0.5 * gap);
        if (near) {
            find_pairs(way, 2 * step);
        } else {
            way.contact.clear();
        }
    }
}

std::vector<std::size_t> BodyContact::groups() const {
    std::vector<std::size_t> group(side_.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    const auto root = [&](std::size_t b) {
        while (group[b] != b) b = group[b];
        return b;
    };
    for (const Way& way : way_) {
        if (!way.contact.empty()) group[root(way.from)] = root(way.onto);
    }
    for (std::size_t b = 0; b < group.size(); ++b) group[b] = root(b);
    return group;
}

void BodyContact::find_pairs(Way& way, double margin) {
    const ContactSide &from = side_[way.from], &onto = side_[way.onto];
    const Aggregate& other = onto.matter();
    // New surface lies up to half a cell outside the cells that hold it.
    margin += 0.5 * other.lattice.spacing * (onto.points().size() > onto.own_points());
    const std::size_t points = from.points().size();
    std::vector<Vec3> point(points);
    parallel_for((points + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t stop = std::min(points, (chunk + 1) * kChunk);
        for (std::size_t p = chunk * kChunk; p < stop; ++p) {
            point[p] = from.position(static_cast<int>(p));
        }
    });
    Box all = box_of(point);
    all.low.array() -= margin;
    all.high.array() += margin;
    std::vector<CellId> cell;
    std::vector<Vec3i> site;
    std::vector<std::array<ParticleId, 8>> corner;
    std::vector<Box> box;
    auto run = other.lattice.cell_run.begin();
    for (CellId id : onto.surface().skin()) {
        if (!onto.is_whole(id)) continue;
        while (id >= run->first + run->count) ++run;
        const int n = id - run->first;
        std::array<ParticleId, 8> c;
        for (int q = 0; q < 8; ++q) c[q] = run->row[q >> 1] + n + (q & 1);
        Box one = box_of_cell(other.particle_position, c);
        if ((one.low.array() > all.high.array()).any() ||
            (one.high.array() < all.low.array()).any()) {
            continue;
        }
        one.low.array() -= margin;
        one.high.array() += margin;
        cell.push_back(id);
        site.emplace_back(run->i + n, run->j, run->k);
        corner.push_back(c);
        box.push_back(one);
    }
    const std::vector<NearPair> pair = near_pairs(point, box);

    std::vector<Contact> found;
    auto old = way.contact.begin();
    const auto one_place = [](const Vec3i& a, const Vec3i& b) {
        return ((a - b).array().abs() <= kSheet).all();
    };
    for (std::size_t n = 0; n < pair.size();) {
        const int p = pair[n].point;
        for (; old != way.contact.end() && old->point < p; ++old) {
            if (old->history.touches) found.push_back(*old);
        }
        const std::size_t first = found.size();
        for (; old != way.contact.end() && old->point == p; ++old) {
            if (old->history.touches) found.push_back(*old);
        }
        const std::size_t kept = found.size();
        std::vector<double> nearest;
        for (; n < pair.size() && pair[n].point == p; ++n) {
            const int b = pair[n].box;
            if (!from.meets(p)) continue;
            if (way.from == way.onto && from.is_neighbour(p, site[b])) continue;
            const double far = (box[b].center() - point[p]).squaredNorm();
            bool is_new = true;
            for (std::size_t m = first; m < found.size() && is_new; ++m) {
                if (!one_place(found[m].site, site[b])) continue;
                is_new = false;
                if (m < kept || far >= nearest[m - kept]) continue;
                nearest[m - kept] = far;
                found[m].cell = cell[b];
                found[m].site = site[b];
                found[m].corner = corner[b];
            }
            if (!is_new) continue;
            found.push_back({{cell[b], site[b], corner[b]}, p});
            nearest.push_back(far);
        }
    }
    for (; old != way.contact.end(); ++old) {
        if (old->history.touches) found.push_back(*old);
    }
    way.contact = std::move(found);
}

BodyContact::Meeting BodyContact::meet(const Way& way, Contact& contact) const {
    Meeting meeting;
    const ContactSide& onto = side_[way.onto];
    const Vec3 x = side_[way.from].position(contact.point);
    const Vec3 was = contact.place;
    if (!find_place(onto, x, contact, meeting.gradient)) {
        const Vec3 p = contact.place;
        // Outside, but what sticks may still hold it.
        const bool held = contact.history.touches && way.law.hold >= 0 &&
                          way.hold[contact.point] > 0 && (p.array() > -0.3).all() &&
                          (p.array() < 1.3).all();
        if (!held) {
            contact.place = was.cwiseMax(0.0).cwiseMin(1.0);
            return meeting;
        }
    }
    if (!onto.may_hold(contact.cell)) return meeting;
    const RestSurface::Depth depth = onto.surface().at(contact.cell, contact.place);
    const Vec3 slope = meeting.gradient.inverse().transpose() * depth.gradient;
    const double size = slope.norm();
    if (!(size > 0)) return meeting;
    if (way.from == way.onto &&
        onto.is_closed_crack(contact.point, contact.site.cast<double>() + contact.place)) {
        return meeting;
    }
    meeting.is_known = true;
    meeting.depth = -depth.distance / size;
    meeting.normal = slope / size;
    meeting.meets = meeting.depth > 0 || (contact.history.touches && way.hold[contact.point] > 0);
    return meeting;
}

// All that does not depend on forces.
void BodyContact::prepare(const Way& way, const Contact& contact, double step, Meeting& at) const {
    const Aggregate &a = side_[way.from].matter(), &b = side_[way.onto].matter();
    const SurfacePoints& points = side_[way.from].points();
    const auto& carrier = points.corner[contact.point];
    const auto& share = points.weight[contact.point];
    at.weight = trilinear_weights(contact.place);
    at.own.setZero();
    Vec3 other = Vec3::Zero();
    at.give = 0;
    for (int c = 0; c < 8; ++c) {
        const double w = share[c], u = at.weight[c];
        const ParticleId p = carrier[c], q = contact.corner[c];
        if (w != 0) {
            at.own += w * a.particle_velocity.at(p);
            at.give += w * w * side_[way.from].lightness()[p];
        }
        other += u * b.particle_velocity.at(q);
        at.give += u * u * side_[way.onto].lightness()[q];
    }
    at.now = at.own - other;
    if (way.has_broken && at.is_known) {
        const double pressed = contact.history.touches ? contact.pressed : 0;
        const double could = contact.is_new ? 0 : 2 * step * at.now.norm();
        const double sunk = std::max(contact.is_new ? 0 : contact.sunk, at.depth - pressed - could);
        at.sunk = std::clamp(sunk, 0.0, std::max(0.0, at.depth));
        at.depth -= at.sunk;
        at.meets = at.meets && (at.depth > 0 || way.hold[contact.point] > 0);
    }
    if (!at.meets) return;
    at.reach.setZero();
    const double k = way.stiffness[contact.point];
    at.spring = std::max(k * at.depth, -way.hold[contact.point]) * at.normal;
    if (!contact.history.touches) return;
    at.reach = at.gradient * (contact.anchor - contact.site.cast<double>() - contact.place);
    const Vec3 along = k * (at.reach - at.normal * at.normal.dot(at.reach));
    const double limit = (contact.history.slides ? way.law.friction : way.law.holding) *
                         (at.spring.dot(at.normal) + way.hold[contact.point]);
    const double size = along.norm();
    at.spring += size > limit ? limit / size * along : along;
}

// Adds a force on contact n's point and its opposite on the cell that holds it.
void BodyContact::spread(const Way& way, std::size_t n, const Vec3& f,
                         const std::vector<Vec3Array*>& force) const {
    const SurfacePoints& points = side_[way.from].points();
    const Contact& contact = way.contact[n];
    const auto& share = points.weight[contact.point];
    for (int c = 0; c < 8; ++c) {
        if (share[c] != 0) force[way.from]->add(points.corner[contact.point][c], share[c] * f);
        force[way.onto]->add(contact.corner[c], -way.meeting[n].weight[c] * f);
    }
}

// Dashpots and friction, one contact after the other, given what all springs do.
void BodyContact::respond(Way& way, const std::vector<Vec3Array*>& force, double step) {
    const std::vector<double>&light_a = side_[way.from].lightness(),
          &light_b = side_[way.onto].lightness();
    const SurfacePoints& points = side_[way.from].points();
    const Vec3Array &on_a = *force[way.from], &on_b = *force[way.onto];
    auto& [sum_a, sum_b] = way.sum = {};
    way.push.assign(way.contact.size(), {});
    for (std::size_t n = 0; n < way.contact.size(); ++n) {
        const Contact& contact = way.contact[n];
        const Meeting& at = way.meeting[n];
        const int point = contact.point;
        ImpactForce& f = way.push[n].made;
        if (at.meets) {
            const auto& carrier = points.corner[point];
            const auto& share = points.weight[point];
            Vec3 push = -at.give * at.spring;  // of all others, over the mass
            for (int c = 0; c < 8; ++c) {
                const ParticleId p = carrier[c], q = contact.corner[c];
                if (share[c] != 0) push += share[c] * light_a[p] * on_a.at(p);
                push -= at.weight[c] * light_b[q] * on_b.at(q);
            }
            ImpactLaw law = way.law;
            law.stiffness = way.stiffness[point];
            law.hold = way.hold[point];
            f = impact_force(law,
                             {.depth = at.depth,
                              .normal = at.normal,
                              .now = at.now,
                              .velocity = at.now + step * push,
                              .reach = at.reach,
                              .give = at.give,
                              .step = step},
                             contact.history);
            spread(way, n, f.force - at.spring, force);
        }
        if (f.history.touches) {
            const Vec3 here = contact.site.cast<double>() + contact.place;
            way.push[n].anchor = here + at.gradient.inverse() * f.reach;
            for (ContactSums* sum : {&sum_a, &sum_b}) {
                sum->stored += 0.5 * f.stored;
                sum->friction += 0.5 * f.friction;
                sum->penetration = std::max(sum->penetration, at.depth);
                ++sum->contacts;
                sum->sliding += f.history.slides;
            }
        } else if (contact.history.touches) {
            const double lost = parting_loss(way.stiffness[point], contact.bond, at.now, step);
            sum_a.damped += 0.5 * lost;
            sum_b.damped += 0.5 * lost;
        }
    }
}

// What the contacts do while the bodies move, now that all forces are known.
void BodyContact::book(Way& way, const std::vector<Vec3Array*>& force, const Vec3& gravity,
                       double step) const {
    const std::vector<double>&light_a = side_[way.from].lightness(),
          &light_b = side_[way.onto].lightness();
    const SurfacePoints& points = side_[way.from].points();
    const Vec3Array &on_a = *force[way.from], &on_b = *force[way.onto];
    struct Power {
        double came[2] = {0, 0}, goes[2] = {0, 0};  // on the one body and on the other
        double took = 0, takes = 0;
    };
    std::vector<Power> power((way.contact.size() + kChunk - 1) / kChunk);
    parallel_for(power.size(), [&](std::size_t chunk) {
        Power& sum = power[chunk];
        const std::size_t stop = std::min(way.contact.size(), (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < stop; ++n) {
            const Contact& contact = way.contact[n];
            const ImpactForce& f = way.push[n].made;
            if (!f.history.touches) continue;
            const auto& carrier = points.corner[contact.point];
            const auto& share = points.weight[contact.point];
            const std::array<double, 8>& weight = way.meeting[n].weight;
            Vec3 va = way.meeting[n].own, vb = va - way.meeting[n].now, pa = gravity, pb = gravity;
            for (int c = 0; c < 8; ++c) {
                const ParticleId p = carrier[c], q = contact.corner[c];
                if (share[c] != 0) pa += share[c] * light_a[p] * on_a.at(p);
                pb += weight[c] * light_b[q] * on_b.at(q);
            }
            const Vec3 dashed = f.force - f.elastic;
            sum.came[0] += f.force.dot(va);
            sum.came[1] -= f.force.dot(vb);
            sum.took -= dashed.dot(va - vb);
            va += step * pa, vb += step * pb;
            sum.goes[0] += f.force.dot(va);
            sum.goes[1] -= f.force.dot(vb);
            sum.takes -= dashed.dot(va - vb);
        }
    });
    for (const Power& sum : power) {
        for (int s = 0; s < 2; ++s) {
            way.sum[s].came += sum.came[s];
            way.sum[s].goes += sum.goes[s];
            way.sum[s].took += 0.5 * sum.took;
            way.sum[s].takes += 0.5 * sum.takes;
        }
    }
}

void BodyContact::add_forces(const std::vector<Vec3Array*>& force, const Vec3& gravity, double step,
                             const std::vector<char>& asleep, std::vector<ContactSums>& sums) {
    const auto sleeps = [&](const Way& way) { return asleep[way.from] && asleep[way.onto]; };
    for (Way& way : way_) {
        if (sleeps(way)) continue;
        const std::size_t count = way.contact.size();
        way.meeting.resize(count);
        parallel_for((count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
            const std::size_t stop = std::min(count, (chunk + 1) * kChunk);
            for (std::size_t n = chunk * kChunk; n < stop; ++n) {
                way.meeting[n] = meet(way, way.contact[n]);
                prepare(way, way.contact[n], step, way.meeting[n]);
            }
        });
        for (std::size_t n = 0; n < count; ++n) {
            if (way.meeting[n].meets) spread(way, n, way.meeting[n].spring, force);
        }
    }
    for (Way& way : way_) {
        if (!sleeps(way)) respond(way, force, step);
    }
    sums.assign(side_.size(), {});
    for (Way& way : way_) {
        if (sleeps(way)) {
            for (ContactSums& sum : way.sum) sum.freeze();
        } else {
            book(way, force, gravity, step);
        }
        sums[way.from].join(way.sum[0]);
        sums[way.onto].join(way.sum[1]);
    }
}

void BodyContact::commit() {
    for (Way& way : way_) {
        for (std::size_t n = 0; n < way.contact.size(); ++n) {
            Contact& contact = way.contact[n];
            contact.history = way.push[n].made.history;
            contact.anchor = way.push[n].anchor;
            contact.bond = way.push[n].made.bond;
            contact.sunk = way.meeting[n].sunk;
            contact.pressed = way.meeting[n].depth;
            contact.is_new = contact.is_new && !way.meeting[n].is_known;
        }
    }
}

}  // namespace swage

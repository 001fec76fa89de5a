// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_way.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "sim/contact_search.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // contacts

}  // namespace

ContactWay::ContactWay(const ContactSide& from, const ContactSide& onto, double stiffness)
    : from_(&from), onto_(&onto), scale_(stiffness) {
    const Material &m = from.matter().material, &n = onto.matter().material;
    const double soft = m.young_modulus / from.matter().lattice.spacing,
                 other = n.young_modulus / onto.matter().lattice.spacing;
    const double e = shared_restitution(m.restitution, soft, n.restitution, other);
    law_ = {.stiffness = 0,
            .restitution = e,
            .loss = restitution_loss(e),
            .damping = restitution_damping(e),
            .friction = 0.5 * (m.friction + n.friction),
            .holding = 0.5 * (m.holding_friction() + n.holding_friction()),
            .hold = 0};
    set_stiffness(0);
}

void ContactWay::surfaces_changed(bool points_too, double step) {
    has_broken_ = true;
    for (Contact& contact : contact_) contact.is_new = true;
    if (!points_too) return;
    const int own = static_cast<int>(from_->own_points());
    std::erase_if(contact_, [&](const Contact& c) { return c.point >= own; });
    set_stiffness(step);
}

void ContactWay::search(double margin) {
    contact_ = find_contacts(*from_, *onto_, margin, contact_);
}

void ContactWay::set_stiffness(double step) {
    const Aggregate &a = from_->matter(), &b = onto_->matter();
    const SurfacePoints& points = from_->points();
    const double one = a.material.young_modulus / a.lattice.spacing,
                 other = b.material.young_modulus / b.lattice.spacing;
    const double k = 0.5 * scale_ * one * other / (one + other);
    // Both ways share the tension as they do the stiffness.
    const double hold = 0.25 * (a.material.stickiness + b.material.stickiness);
    stiffness_.clear();
    hold_.clear();
    for (std::size_t p = 0; p < points.size(); ++p) {
        stiffness_.push_back(k * points.area[p]);
        hold_.push_back(hold * points.area[p]);
        if (!(step > 0)) continue;
        const double most = 0.25 * lightest_carrier(a, points, p) / (step * step);
        stiffness_[p] = std::min(stiffness_[p], most);
    }
}

void ContactWay::meet(double step) {
    const std::size_t count = contact_.size();
    meeting_.resize(count);
    parallel_for((count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t stop = std::min(count, (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < stop; ++n) {
            meeting_[n] = find(contact_[n]);
            prepare(contact_[n], step, meeting_[n]);
        }
    });
}

ContactWay::Meeting ContactWay::find(Contact& contact) const {
    const ContactSide &a = *from_, &b = *onto_;
    Meeting meeting;
    const Vec3 x = a.position(contact.point);
    const Vec3 was = contact.place;
    if (!find_place(b, x, contact, meeting.gradient)) {
        const Vec3 p = contact.place;
        // Outside, but what sticks may still hold it.
        const bool held = contact.history.touches && law_.hold >= 0 && hold_[contact.point] > 0 &&
                          (p.array() > -0.3).all() && (p.array() < 1.3).all();
        if (!held) {
            contact.place = was.cwiseMax(0.0).cwiseMin(1.0);
            return meeting;
        }
    }
    if (!b.may_hold(contact.cell)) return meeting;
    const RestSurface::Depth depth = b.surface().at(contact.cell, contact.place);
    const Vec3 slope = meeting.gradient.inverse().transpose() * depth.gradient;
    const double size = slope.norm();
    if (!(size > 0)) return meeting;
    if (from_ == onto_ &&
        b.is_closed_crack(contact.point, contact.site.cast<double>() + contact.place)) {
        return meeting;
    }
    meeting.is_known = true;
    meeting.depth = -depth.distance / size;
    meeting.normal = slope / size;
    meeting.meets = meeting.depth > 0 || (contact.history.touches && hold_[contact.point] > 0);
    return meeting;
}

// All that does not depend on forces.
void ContactWay::prepare(const Contact& contact, double step, Meeting& at) const {
    const ContactSide &a = *from_, &b = *onto_;
    const Vec3Array &speed_a = a.matter().particle_velocity,
                    &speed_b = b.matter().particle_velocity;
    const SurfacePoints& points = a.points();
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
            at.own += w * speed_a.at(p);
            at.give += w * w * a.lightness()[p];
        }
        other += u * speed_b.at(q);
        at.give += u * u * b.lightness()[q];
    }
    at.now = at.own - other;
    if (has_broken_ && at.is_known) {
        const double pressed = contact.history.touches ? contact.pressed : 0;
        const double could = contact.is_new ? 0 : 2 * step * at.now.norm();
        const double sunk = std::max(contact.is_new ? 0 : contact.sunk, at.depth - pressed - could);
        at.sunk = std::clamp(sunk, 0.0, std::max(0.0, at.depth));
        at.depth -= at.sunk;
        at.meets = at.meets && (at.depth > 0 || hold_[contact.point] > 0);
    }
    if (!at.meets) return;
    at.reach.setZero();
    const double k = stiffness_[contact.point];
    at.spring = std::max(k * at.depth, -hold_[contact.point]) * at.normal;
    if (!contact.history.touches) return;
    at.reach = at.gradient * (contact.anchor - contact.site.cast<double>() - contact.place);
    const Vec3 along = k * (at.reach - at.normal * at.normal.dot(at.reach));
    const double limit = (contact.history.slides ? law_.friction : law_.holding) *
                         (at.spring.dot(at.normal) + hold_[contact.point]);
    const double size = along.norm();
    at.spring += size > limit ? limit / size * along : along;
}

// Adds a force on contact n's point and its opposite on the cell that holds it.
void ContactWay::spread(std::size_t n, const Vec3& f, Vec3Array& on_a, Vec3Array& on_b) const {
    const SurfacePoints& points = from_->points();
    const Contact& at = contact_[n];
    const auto& share = points.weight[at.point];
    for (int c = 0; c < 8; ++c) {
        if (share[c] != 0) on_a.add(points.corner[at.point][c], share[c] * f);
        on_b.add(at.corner[c], -meeting_[n].weight[c] * f);
    }
}

void ContactWay::push(Vec3Array& on_a, Vec3Array& on_b) const {
    for (std::size_t n = 0; n < contact_.size(); ++n) {
        if (meeting_[n].meets) spread(n, meeting_[n].spring, on_a, on_b);
    }
}

void ContactWay::respond(double step, Vec3Array& on_a, Vec3Array& on_b) {
    const std::vector<double>&light_a = from_->lightness(), &light_b = onto_->lightness();
    const SurfacePoints& points = from_->points();
    auto& [sum_a, sum_b] = sum_ = {};
    push_.assign(contact_.size(), {});
    for (std::size_t n = 0; n < contact_.size(); ++n) {
        const Contact& contact = contact_[n];
        const Meeting& at = meeting_[n];
        const int point = contact.point;
        ImpactForce& f = push_[n].made;
        if (at.meets) {
            const auto& carrier = points.corner[point];
            const auto& share = points.weight[point];
            Vec3 push = -at.give * at.spring;  // of all others, over the mass
            for (int c = 0; c < 8; ++c) {
                const ParticleId p = carrier[c], q = contact.corner[c];
                if (share[c] != 0) push += share[c] * light_a[p] * on_a.at(p);
                push -= at.weight[c] * light_b[q] * on_b.at(q);
            }
            ImpactLaw law = law_;
            law.stiffness = stiffness_[point];
            law.hold = hold_[point];
            f = impact_force(law,
                             {.depth = at.depth,
                              .normal = at.normal,
                              .now = at.now,
                              .velocity = at.now + step * push,
                              .reach = at.reach,
                              .give = at.give,
                              .step = step},
                             contact.history);
            spread(n, f.force - at.spring, on_a, on_b);
        }
        if (f.history.touches) {
            const Vec3 here = contact.site.cast<double>() + contact.place;
            push_[n].anchor = here + at.gradient.inverse() * f.reach;
            for (ContactSums* sum : {&sum_a, &sum_b}) {
                sum->stored += 0.5 * f.stored;
                sum->friction += 0.5 * f.friction;
                sum->penetration = std::max(sum->penetration, at.depth);
                ++sum->contacts;
                sum->sliding += f.history.slides;
            }
        } else if (contact.history.touches) {
            const double lost = parting_loss(stiffness_[point], contact.bond, at.now, step);
            sum_a.damped += 0.5 * lost;
            sum_b.damped += 0.5 * lost;
        }
    }
}

void ContactWay::book(double step, const Vec3& gravity, const Vec3Array& on_a,
                      const Vec3Array& on_b) {
    const std::vector<double>&light_a = from_->lightness(), &light_b = onto_->lightness();
    const SurfacePoints& points = from_->points();
    struct Power {
        double came[2] = {0, 0}, goes[2] = {0, 0};  // on the one body and on the other
        double took = 0, takes = 0;
    };
    std::vector<Power> power((contact_.size() + kChunk - 1) / kChunk);
    parallel_for(power.size(), [&](std::size_t chunk) {
        Power& sum = power[chunk];
        const std::size_t stop = std::min(contact_.size(), (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < stop; ++n) {
            const Contact& contact = contact_[n];
            const ImpactForce& f = push_[n].made;
            if (!f.history.touches) continue;
            const auto& carrier = points.corner[contact.point];
            const auto& share = points.weight[contact.point];
            const std::array<double, 8>& weight = meeting_[n].weight;
            Vec3 va = meeting_[n].own, vb = va - meeting_[n].now, pa = gravity, pb = gravity;
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
            sum_[s].came += sum.came[s];
            sum_[s].goes += sum.goes[s];
            sum_[s].took += 0.5 * sum.took;
            sum_[s].takes += 0.5 * sum.takes;
        }
    }
}

void ContactWay::commit() {
    for (std::size_t n = 0; n < contact_.size(); ++n) {
        Contact& contact = contact_[n];
        contact.history = push_[n].made.history;
        contact.anchor = push_[n].anchor;
        contact.bond = push_[n].made.bond;
        contact.sunk = meeting_[n].sunk;
        contact.pressed = meeting_[n].depth;
        contact.is_new = contact.is_new && !meeting_[n].is_known;
    }
}

}  // namespace swage

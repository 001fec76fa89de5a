// SPDX-License-Identifier: GPL-3.0-or-later
// What contacts do, one after the other: where each meets, what its springs do, what it does then.
#include <algorithm>
#include <cmath>

#include "sim/contact_way.h"
#include "sim/vector_clones.h"

namespace swage {

namespace {

constexpr double kBeside = 0.1;  // cells beyond the reach of the one that it has met: a point's way
constexpr double kTurned = 0.1;  // of a reach squared, across a surface that has turned, that holds

}  // namespace

// What is done with each contact, for the width of vectors that the caller is built for.
struct ContactWay::Kernel {
    ContactWay& way;
    const ContactSide& onto = *way.onto_;
    ContactPatch &a = way.from_->patch(), &b = way.onto_->patch();
    // Of each point; null before the sides have come near.
    const double* const asked = way.points_ ? way.points_->asked.data() : nullptr;
    const double* const hold_at = way.points_ ? way.points_->hold.data() : nullptr;

    double hold_of(const Contact& contact) const { return hold_at[contact.point]; }

    // Whether it presses, or sticks and is not torn off.
    static bool acts(const Meeting& at, const ContactMemory& last, double hold) {
        return at.depth() > 0 ||
               (last.history.touches && is_bound(at.stiffness(), at.depth(), hold));
    }

    // How deep the point lies as it goes on from where it has met; false where it has left the
    // cell and what is around it.
    SWAGE_INLINE bool find_by_plane(Contact& contact, Vec4 x, Plane& plane,
                                    const CellCorners& corner, CellGradient& gradient,
                                    RestSurface::Depth& depth) const {
        const bool found = find_in_cell(corner, x, onto.matter().lattice.spacing,
                                        onto.beyond(contact.cell), contact.place, gradient);
        const Vec3& p = contact.place;
        const double beyond = onto.beyond(contact.cell) + kBeside;
        if (!found || (p.array() < -beyond).any() || (p.array() > 1 + beyond).any()) {
            contact.place = p.cwiseMax(0.0).cwiseMin(1.0);
            plane.is_met = false;
            return false;
        }
        depth = {plane.distance + plane.gradient.dot(p - plane.place), plane.gradient};
        return true;
    }

    // How deep it lies below the surface; false where it lies outside. kOwn: of one body.
    template <bool kOwn>
    SWAGE_INLINE bool find_depth(Contact& contact, const ContactMemory& last, Vec4 x,
                                 CellCorners& corner, CellGradient& gradient,
                                 RestSurface::Depth& depth) const {
        const double hold = hold_of(contact);
        const Vec3 was = contact.place;
        if (!find_place(onto, x, contact, corner, gradient)) {
            const Vec3 p = contact.place;
            // Outside, but what sticks may still hold it.
            const bool held = last.history.touches && hold > 0 && (p.array() > -0.3).all() &&
                              (p.array() < 1.3).all();
            if (!held) {
                contact.place = was.cwiseMax(0.0).cwiseMin(1.0);
                return false;
            }
        }
        if (!onto.may_hold(contact.cell) || !(gradient.volume > 0)) return false;
        depth = onto.depth(contact.site, contact.cell, contact.place, last.slope);
        contact.slope = depth.gradient.cast<float>();
        if constexpr (kOwn) {
            const auto own = onto.own_share(contact.point, contact.site, contact.place);
            depth.gradient = own.value * depth.gradient + depth.distance * own.gradient;
            depth.distance *= own.value;
        }
        return true;
    }

    // Where the point lies in the other side.
    template <bool kOwn>
    SWAGE_INLINE void find(Contact& contact, const ContactMemory& last, Plane* plane,
                           CellCorners& corner, CellGradient& gradient, Meeting& at) const {
        const double hold = hold_of(contact);
        Vec4 x{};
        for (int c = 0; c < contact.carriers; ++c) {
            x += double(contact.share[c]) * a.motion(contact.carrier[c]).place;
        }
        RestSurface::Depth depth;
        if (!kOwn || plane == nullptr || !plane->is_met ||
            !find_by_plane(contact, x, *plane, corner, gradient, depth)) {
            if (!find_depth<kOwn>(contact, last, x, corner, gradient, depth)) return;
            if (kOwn && plane != nullptr && depth.distance < 0) {
                *plane = {true, contact.place, depth.gradient, depth.distance};
            }
        }
        const double share = 1 / gradient.volume;
        Vec4 slope{};
        for (int i = 0; i < 3; ++i) {
            at.inverse[i] = share * gradient.r[i];
            slope += depth.gradient[i] * at.inverse[i];
            at.inverse[i][3] = 0;
        }
        const double size = std::sqrt(dot3(slope, slope));
        if (!(size > 0)) return;
        const double stretch = onto.matter().lattice.spacing * size;
        const double whole = asked[contact.point] * stretch * stretch;
        double soft = last.history.touches ? last.soft : 1;
        if (soft * whole > way.stiffest(contact.point)) {
            soft = way.stiffest(contact.point) / whole;
        }
        at.set_stiffness(soft * whole);
        at.normal = slope / size;
        at.set_depth(-depth.distance / size);
        at.set_stretch(stretch);
        if (acts(at, last, hold)) at.set_soft(soft);
    }

    // Of its depth, what nobody has pressed: that does not count.
    SWAGE_INLINE void take_off_sunk(const ContactMemory& last, bool is_new, double step,
                                    double hold, Meeting& at) const {
        const double stretch = at.stretch(), whole = stretch * at.depth();
        double sunk = last.sunk;
        if (is_new) {
            const double pressed = last.history.touches ? last.pressed : 0;
            const double approach = way.is_static() ? 0 : std::max(0.0, -dot3(at.now, at.normal));
            sunk = std::max(sunk, whole - pressed - step * stretch * approach);
        }
        at.set_sunk(std::clamp(sunk, 0.0, std::max(0.0, whole)));
        at.set_depth(at.depth() - at.sunk() / stretch);
        if (!acts(at, last, hold)) at.set_soft(0);
    }

    // All that does not depend on forces.
    SWAGE_INLINE void prepare(const Contact& contact, const ContactMemory& last,
                              const CellCorners& corner, const CellGradient& gradient, bool is_new,
                              double step, Meeting& at, Chunk& sums, ContactHeld& sum) const {
        const std::array<double, 8> weight = trilinear_weights(contact.place);
        at.now = Vec4{};
        for (int c = 0; c < contact.carriers; ++c) {
            at.now += double(contact.share[c]) * a.motion(contact.carrier[c]).speed;
        }
        for (int c = 0; c < 8; ++c) at.now -= weight[c] * corner.now[c]->speed;
        sums.took -= dot3(at.now, vec4(contact.dashed));
        const double hold = hold_of(contact);
        if (at.is_known() && (is_new || last.sunk > 0)) {
            take_off_sunk(last, is_new, step, hold, at);
        }
        if (!at.meets()) return;
        const double k = at.stiffness();
        const double push = spring_push(k, at.depth(), hold);
        at.spring = push * at.normal;
        at.reach = Vec4{};
        if (last.history.touches) {
            const Vec3 back = last.place - contact.site.cast<double>() - contact.place;
            const auto turned = [&](const Vec3& way) __attribute__((always_inline)) {
                return gradient.g[0] * way.x() + gradient.g[1] * way.y() + gradient.g[2] * way.z();
            };
            Vec4 held = turned(last.reach);
            const double whole = dot3(held, held);
            held -= dot3(at.normal, held) * at.normal;
            const double left = dot3(held, held);
            if (left > kTurned * whole) {
                const double was = at.soft() < last.soft ? k * last.soft / at.soft() : k;
                held *= std::sqrt(2 * last.held / (was * left));
            } else {
                held = Vec4{};
                sum.turned += last.held;
            }
            at.reach = turned(back) + held;
            const Vec4 along = k * (at.reach - dot3(at.normal, at.reach) * at.normal);
            double limit =
                (last.history.slides ? way.law_.friction : way.law_.holding) * (push + hold);
            const double size = std::sqrt(dot3(along, along));
            // Dashpots may have held it to more.
            if (size > limit) limit = std::max(limit, k * std::sqrt(dot3(held, held)));
            at.spring += size > limit ? limit / size * along : along;
        }
        at.spring[3] = k;
        sum.now += 0.5 / k * dot3(at.spring, at.spring);
        if (push > k * at.depth()) sum.now += push * (at.depth() - push / k);
    }

    // Whether it has come to another cell beside which it lies, as before a cut: how deep it is
    // said to be is then another cell's guess, which may jump.
    bool hops(const Contact& contact, CellId was) const {
        return contact.cell != was && !way.is_static() &&
               ((contact.place.array() < -kSlack).any() ||
                (contact.place.array() > 1 + kSlack).any());
    }

    // Whether an earlier contact of its point has come into the same cell by another way: of one
    // body, or of one pressed so thin that layers far apart at rest are near.
    bool is_twice(std::size_t begin, std::size_t n) const {
        const auto& all = way.list_.contact;
        for (std::size_t m = n; m-- > begin && all[m].point == all[n].point;) {
            if (all[m].cell == all[n].cell && way.meeting_[m].meets()) return true;
        }
        return false;
    }

    template <bool kOwn>
    SWAGE_INLINE void find_chunk(std::size_t chunk, double step) const {
        Chunk& result = way.chunk_[chunk];
        result.moved.clear();
        result.took = 0;
        result.is_met = false;
        result.held = {};
        const std::size_t begin = way.begin_of(chunk), end = way.begin_of(chunk + 1);
        for (std::size_t n = begin; n < end; ++n) {
            Contact& contact = way.list_.contact[n];
            const ContactMemory& last = way.list_.memory[n];
            Meeting& at = way.meeting_[n];
            at.normal = at.now = at.inverse[0] = at.inverse[1] = Vec4{};
            const CellId was = contact.cell;
            CellCorners corner(b, contact);
            CellGradient gradient;
            ContactHeld& held = kOwn ? way.own_held_[n] : result.held;
            if (kOwn) held = {};
            find<kOwn>(contact, last, way.plane_.empty() ? nullptr : &way.plane_[n], corner,
                       gradient, at);
            if (contact.cell != was) result.moved.push_back(static_cast<int>(n));
            if (at.meets() && is_twice(begin, n)) at.forget();
            result.is_met = result.is_met || (at.meets() && !last.history.touches);
            if (!at.is_known()) held.gone += last.stored;
            if (at.meets() || last.history.touches || !contact.dashed.isZero(0)) {
                prepare(contact, last, corner, gradient, last.is_new || hops(contact, was), step,
                        at, result, held);
                if (at.is_known() && !at.meets()) held.gone += last.bound;
            }
            if (kOwn) {
                const bool does = at.meets() || held.gone != 0 || held.turned != 0;
                way.own_spot_[n] = does ? way.own_.spot_of(way.own_way(contact)) : OwnSpot{};
            }
        }
    }

    // What its springs do; of one body its share of it, and by the slope of that.
    template <bool kOwn>
    SWAGE_INLINE Vec4 push_of(std::size_t n) const {
        const Meeting& at = way.meeting_[n];
        if (!kOwn) return at.spring;
        const Vec4 f = way.own_.share(n) * at.spring;
        if (!way.own_.slopes(n)) return f;
        const Vec3 slope = way.own_held_[n].now * way.own_.slope(n);
        Vec4 by = slope[0] * at.inverse[0] + slope[1] * at.inverse[1] + slope[2] * at.inverse[2];
        by[3] = 0;
        return f - by;
    }

    template <bool kOwn>
    SWAGE_INLINE void push_chunk(std::size_t chunk) const {
        Pushed &point = way.point_push_, &cell = way.cell_push_;
        const std::size_t end = way.begin_of(chunk + 1);
        for (std::size_t n = way.begin_of(chunk); n < end; ++n) {
            const Contact& contact = way.list_.contact[n];
            if (!way.meeting_[n].meets()) continue;
            const std::array<double, 8> weight = trilinear_weights(contact.place);
            const Vec4 f = push_of<kOwn>(n);
            for (int c = 0; c < contact.carriers; ++c) {
                point.force[contact.carrier[c] - point.low].value +=
                    share_lanes(contact.share[c]) * f;
            }
            for (int c = 0; c < 8; ++c) {
                cell.force[contact.corner[c] - cell.low].value += share_lanes(-weight[c]) * f;
            }
        }
    }

    SWAGE_INLINE ImpactForce impact(const Contact& contact, const ContactMemory& last,
                                    const Meeting& at, double share, double step) const {
        const std::array<double, 8> weight = trilinear_weights(contact.place);
        Vec4 push{};  // of all but dashpots, over the mass
        for (int c = 0; c < contact.carriers; ++c) {
            push += share_lanes(contact.share[c]) * a.springs(contact.carrier[c]);
        }
        for (int c = 0; c < 8; ++c) push += share_lanes(-weight[c]) * b.springs(contact.corner[c]);
        double beside = 0;
        for (int c = 0; c < contact.carriers && !way.met_.empty(); ++c) {
            beside =
                std::max(beside, way.met_[std::size_t(contact.carrier[c] - way.point_push_.low)]);
        }
        ImpactLaw law = way.law_;
        law.stiffness = share * at.stiffness();
        law.hold = share * hold_of(contact);
        const double give = push[3] / law.stiffness;
        // The law takes its own spring off again.
        push -= give * share * at.spring;
        return impact_force(law,
                            {.depth = at.depth(),
                             .normal = vec3(at.normal),
                             .now = vec3(at.now),
                             .velocity = vec3(at.now + step * push),
                             .reach = vec3(at.reach),
                             .give = give,
                             .step = step,
                             .beside = beside},
                            last.history);
    }

    // Of what has touched when last committed, and is still where it was then.
    SWAGE_INLINE ImpactForce same_as(const Contact& contact, const ContactMemory& last,
                                     const Meeting& at, double share) const {
        ImpactForce f =
            impact_as_found(share * at.stiffness(), at.depth(), share * hold_of(contact),
                            vec3(at.normal), vec3(at.reach), contact.dashed, last.bond);
        f.history = last.history;
        return f;  // `bound` is found with what is kept
    }

    template <bool kOwn>
    SWAGE_INLINE void respond_chunk(std::size_t chunk, double step, Meet meet) const {
        ContactSums& sums = way.chunk_[chunk].sums = {};
        double& kept = way.chunk_[chunk].kept = 0;
        const std::size_t end = way.begin_of(chunk + 1);
        for (std::size_t n = way.begin_of(chunk); n < end; ++n) {
            Contact& contact = way.list_.contact[n];
            const ContactMemory& last = way.list_.memory[n];
            Meeting& at = way.meeting_[n];
            ContactMemory& next = way.next_[n];
            const double share = kOwn ? way.own_.share(n) : way.share_;
            ImpactForce f;
            if (at.meets()) {
                f = meet == Meet::as_kept && last.history.touches
                        ? same_as(contact, last, at, share)
                        : impact(contact, last, at, share, step);
                at.spring = vec4(f.force) - share * at.spring;
            }
            next.history = f.history;
            next.bond = f.bond;
            next.stiffness = share * at.stiffness();
            next.sunk = at.sunk();
            next.pressed = at.stretch() * at.depth();
            next.soft = at.soft();
            next.stored = f.stored / share;
            kept += next.stored;
            if (kOwn) way.own_held_[n].now = next.stored;
            next.is_new = !at.is_known() && (last.is_new || !way.is_static());
            contact.dashed = f.force - f.elastic;
            next.bound = 0;
            next.slope.setZero();
            if (f.history.touches) {
                if (way.onto_->is_thin()) next.slope = contact.slope;
                const Vec4 reach = vec4(f.reach);
                next.place = contact.site.cast<double>() + contact.place;
                next.reach = Vec3(dot3(at.inverse[0], reach), dot3(at.inverse[1], reach),
                                  dot3(at.inverse[2], reach));
                const double k = at.stiffness(), pulled = std::min(at.depth(), 0.0);
                next.held = 0.5 * k * dot3(reach, reach);
                next.bound = next.held + spring_energy(k, pulled, hold_of(contact));
                sums.took -= 0.5 * contact.dashed.dot(vec3(at.now));
                sums.stored += 0.5 * f.stored;
                sums.friction += 0.5 * f.friction;
                sums.penetration = std::max(sums.penetration, at.depth());
                ++sums.contacts;
                if (last.history.touches && next.soft < last.soft) {
                    const double was = k * last.soft / next.soft;
                    const double hold = hold_of(contact), depth = at.depth();
                    sums.damped +=
                        0.5 * share *
                        (0.5 * (was - k) * dot3(reach, reach) + spring_energy(was, depth, hold) -
                         spring_energy(k, depth, hold));
                    if (meet == Meet::as_kept) way.list_.memory[n].soften(next);
                }
            } else if (last.history.touches && at.is_known()) {
                // What its bond does no longer on the way from there.
                sums.damped -= 0.25 * step * last.bond.dot(vec3(at.now));
            }
        }
    }

    // On the points, and their opposites on the cells that hold them.
    SWAGE_INLINE void answer_chunk(std::size_t chunk) const {
        const std::size_t end = way.begin_of(chunk + 1);
        for (std::size_t n = way.begin_of(chunk); n < end; ++n) {
            if (!way.meeting_[n].meets()) continue;
            const Contact& contact = way.list_.contact[n];
            const std::array<double, 8> weight = trilinear_weights(contact.place);
            const Vec4 f = way.meeting_[n].spring;
            for (int c = 0; c < contact.carriers; ++c) {
                a.force(contact.carrier[c]) += double(contact.share[c]) * f;
            }
            for (int c = 0; c < 8; ++c) b.force(contact.corner[c]) -= weight[c] * f;
        }
    }
};

void ContactWay::find_chunk(std::size_t chunk, double step) {
    by_fours([&]() __attribute__((always_inline)) {
        is_own() ? Kernel{*this}.find_chunk<true>(chunk, step)
                 : Kernel{*this}.find_chunk<false>(chunk, step);
    });
}

void ContactWay::push_chunk(std::size_t chunk) {
    by_fours([&]() __attribute__((always_inline)) {
        is_own() ? Kernel{*this}.push_chunk<true>(chunk) : Kernel{*this}.push_chunk<false>(chunk);
    });
}

void ContactWay::respond_chunk(std::size_t chunk, double step, Meet meet) {
    by_fours([&]() __attribute__((always_inline)) {
        is_own() ? Kernel{*this}.respond_chunk<true>(chunk, step, meet)
                 : Kernel{*this}.respond_chunk<false>(chunk, step, meet);
    });
}

void ContactWay::answer_chunk(std::size_t chunk) {
    by_fours([&]() __attribute__((always_inline)) { Kernel{*this}.answer_chunk(chunk); });
}

}  // namespace swage

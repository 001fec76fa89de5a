// SPDX-License-Identifier: GPL-3.0-or-later
// Two surfaces that meet in motion: a push that never pulls and gives back a set share of the speed
// (S0.4; Hunt and Crossley, J. Appl. Mech. 42, 1975), friction whose static coefficient is above
// the kinetic one (S0.5), and tension up to a limit where they stick (S2.8).
//
//     N = k d + c d',   c = beta k |d| / v        d depth [m], k [N/m], v [m/s] when met
//
// For a mass that meets at v, dw / dd with w = d'/v gives beta from the restitution e alone,
//
//     0 = int_{-e}^{1} w / (1 + beta w) dw,   or   beta (1 + e) = ln((1 + beta) / (1 - beta e)),
//
// whatever its size and k. It never pulls: d' >= -e v > -v / beta. c grows with d, so the force
// does not jump at the first touch.
// NOTE: what a deformable body gives back is also what its inside does: e is that of the contact,
// met where the contact gives way more than the bodies behind it.
//
// v is the highest speed of approach in the touch; what touches later than points beside it takes
// theirs, or what is round would be met by its rim ever more slowly, and lose too much: with one v
// for all, e is that of the whole, however its points come to touch. NOTE: what approaches anew
// without having parted rests or swings, and has met nothing: from then on c = 2 zeta sqrt(k m)
// with the point's own mass, zeta = -ln e / sqrt(pi^2 + ln^2 e). With a v of its own each time, the
// small swings of what rests had N jump between k d (1 + beta) and nothing. The same c acts along
// the surface and in tension.
//
// What sticks pulls by k |d| until that is all it holds, then by that, to twice as far (as
// Dugdale's zone does, J. Mech. Phys. Solids 8, 1960): points of which some are half as stiff as
// others, as steps make those that little mass carries, hold together what each of them would.
//
// NOTE: c is at most 20 beta sqrt(k m), which bodies of up to 400 times the point's own mass do not
// reach: what is let down slowly would hang in its dashpots, and N would shake with every tremor.
//
// NOTE: kinetic friction begins at a speed, half of what the point would swing along the surface
// with, mu N / k sqrt(k / m), and ends at half of that. Edges of what rests creep a little under
// any pull, and tremble; were that sliding already, bodies would slide as wholes below the static
// coefficient (at a tenth, a block on a slope did at 0.85 to 0.95 of it; so none does below 0.99).
//
// Dashpots are taken at the end of the step, all at once, given what all springs do. Were they
// taken one after the other, those of what rests would bear against each other, the first would
// slip before the last, and losses would hang on their order. Points i share carriers p, which they
// load with w_ip, so that dashpots together would overshoot; each is therefore taken as if all that
// touch worked as it does, in proportion to their stiffness, 1 / m of the above being S:
//
//     S_i = sum_p |w_ip| sum_j |w_jp| k_j / (m_p k_i),   F_i = c_i v_i / (1 + c_i dt S_i)
//
// With P = dt F = D v they change v by -A D v; A is symmetric and not negative, D diagonal and D_i
// at most 1 / S_i = k_i / (|A| k)_i. The eigenvalues of A D, those of D^1/2 A D^1/2, grow with D,
// and with the largest one are those of A_ij k_j / (|A| k)_i, none of whose rows sums up to more
// than 1. So they lie from 0 to 1: dashpots never turn a speed round.
//
// x(n+1) - 2 x(n) + x(n-1) + dt M^-1 C (x(n+1) - x(n)) + dt^2 M^-1 K x(n) = 0 has for each mode
// m (l - 1)^2 + dt c l (l - 1) + dt^2 k l = 0, whose roots stay within the unit circle while
// dt^2 k < 4 m + 2 dt c: a dashpot of any size only widens the bound.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/portable_math.h"
#include "laws/lane_tensor.h"

namespace swage {

inline constexpr double kSlow = 0.5;  // of the speed of a swing along the surface: does not slide

inline constexpr double kMostDamping = 20;
inline constexpr double kLetsGo = 2;  // times the way at which a bond first pulls all it holds

// NOTE: less is taken as this. beta goes as 1 / e, the way in which a body is stopped as its root,
// and a contact whose dashpots stop it in a tenth of its springs' way is a wall to elastic bodies:
// they come back by what they themselves store. Asked 0, two blocks parted at 0.37 and 0.63 of
// their speed (contact_stiffness 0.01 and 0.1) with 0.005 here, and part at 0.13 and 0.42.
inline constexpr double kDullest = 0.05;

// beta; 0 for e = 1.
inline double restitution_loss(double restitution) {
    const double e = std::max(restitution, kDullest);
    if (e >= 1) return 0;
    double low = 0, high = 1 / e;
    for (int n = 0; n < 60; ++n) {
        const double beta = 0.5 * (low + high);
        const bool above = beta * (1 + e) < portable::log((1 + beta) / (1 - beta * e));
        (above ? high : low) = beta;
    }
    return 0.5 * (low + high);
}

// The damping ratio of a swing of which e is left after half a turn.
inline double restitution_damping(double restitution) {
    const double e = std::max(restitution, kDullest), turn = std::numbers::pi;
    return e >= 1 ? 0 : -portable::log(e) / portable::hypot(turn, portable::log(e));
}

// Of two materials from theirs: what each gives back of the energy that its part of the give k_1,
// k_2 in series takes up.
inline double shared_restitution(double e1, double k1, double e2, double k2) {
    return std::sqrt((e1 * e1 * k2 + e2 * e2 * k1) / (k1 + k2));
}

struct ImpactLaw {
    double stiffness;    // k, also across [N/m]
    double restitution;  // e
    double loss;         // beta
    double damping;      // ratio, of swings along the surface and in tension
    double friction;     // kinetic
    double holding;      // static friction, >= friction
    double hold;         // tension that it holds once it has touched [N], >= 0
};

// What a contact remembers, committed once a step. Zero where nothing touches.
struct ImpactHistory {
    double speed = 0;  // v [m/s]
    bool touches = false, parts = false, rests = false, slides = false;
};

// One contact in one step. All vectors of the point relative to the other side.
struct ImpactState {
    double depth;       // [m]
    Vec3 normal;        // outward of the other side, unit
    Vec3 now;           // velocity [m/s]
    Vec3 velocity;      // at the end of the step without this contact [m/s]
    Vec3 reach;         // from the point to where it sticks [m]
    double give;        // 1 / m: S [1/kg]
    double step;        // [s]
    double beside = 0;  // v of what touches beside it [m/s]
};

// What its dashpots take is -(force - elastic) . v, with the speed that all forces together leave.
struct ImpactForce {
    Vec3 force = Vec3::Zero();    // on the point [N]
    Vec3 elastic = Vec3::Zero();  // of the springs alone, that hold `stored` [N]
    Vec3 bond = Vec3::Zero();     // of that, what breaks when the contact ends [N]
    double bound = 0;             // and what it holds of `stored` [J]
    double normal = 0;            // N [N], less than zero where it pulls
    Vec3 reach = Vec3::Zero();    // to keep: across the normal, along the friction [m]
    double stored = 0;            // in the springs [J]
    double friction = 0;          // taken by it [J]
    ImpactHistory history;        // to commit
};

// Of the spring across the surface: its push [N] and what it holds [J].
SWAGE_INLINE double spring_push(double stiffness, double depth, double hold) {
    return std::max(stiffness * depth, -hold);
}
SWAGE_INLINE double spring_energy(double stiffness, double depth, double hold) {
    const double over = spring_push(stiffness, depth, hold) - stiffness * depth;
    return 0.5 * stiffness * depth * depth - 0.5 * over * over / stiffness;
}

// Whether a bond still holds, however it pulls.
SWAGE_INLINE bool is_bound(double stiffness, double depth, double hold) {
    return hold > 0 && stiffness * depth >= -kLetsGo * hold;
}

// What is lost where a contact has ended in a step [s]: what its bond held, less what it no longer
// does on the way, from the velocity then, of the point relative to the other side [J].
inline double parting_loss(double bound, const Vec3& bond, const Vec3& velocity, double step) {
    return bound - 0.5 * step * bond.dot(velocity);
}

SWAGE_INLINE ImpactForce impact_force(const ImpactLaw& law, const ImpactState& at,
                                      const ImpactHistory& last) {
    ImpactForce result;
    const double k = law.stiffness;
    if (at.depth <= 0 && !(last.touches && is_bound(k, at.depth, law.hold))) return result;
    ImpactHistory& next = result.history;
    next = last;
    const double rate = -at.normal.dot(at.now), approach = -at.normal.dot(at.velocity);
    next.rests = last.rests || (rate > 0 && last.parts) || (rate <= 0 && !last.touches);
    next.speed = std::max({next.speed, rate, last.touches ? 0.0 : at.beside});
    next.parts = rate <= 0;
    next.touches = true;

    // Along the surface and in tension the mass is the point's own share.
    const double swing = 2 * law.damping * std::sqrt(k / at.give);
    const double most = kMostDamping * law.loss * std::sqrt(k / at.give);
    const double met = next.speed > 0 ? std::min(most, law.loss * k * at.depth / next.speed) : 0;
    const double c = at.depth > 0 && !next.rests ? met : swing, along = std::max(c, swing);
    const double elastic = spring_push(k, at.depth, law.hold), m = at.step * at.give;
    const double push = elastic + c * (approach - m * elastic) / (1 + c * m);
    const double N = result.normal = std::max(push, -law.hold);

    Vec3 reach = Vec3::Zero();  // without friction it sticks nowhere
    if (law.holding > 0) reach = at.reach - at.normal * at.normal.dot(at.reach);
    const Vec3 across = at.velocity + approach * at.normal;
    Vec3 T = (k * reach - along * across) / (1 + along * m);
    const double size = T.norm(), bears = N + law.hold;
    const auto is_slow = [&](double part) __attribute__((always_inline)) {
        const double speed = (at.now + rate * at.normal).norm();
        return speed <= part * kSlow * law.holding * bears / k * std::sqrt(k * at.give);
    };
    if (!(bears > 0) || (next.slides && is_slow(0.5))) next.slides = false;
    result.reach = reach;
    const double limit = (next.slides ? law.friction : law.holding) * bears;
    if (size > limit) {
        next.slides = next.slides || !is_slow(1);
        T *= (next.slides ? law.friction : law.holding) * bears / size;
        if (T.norm() < k * reach.norm()) {
            result.reach = T / k;
            // Of the spring as far as it was stretched, less what it had not pulled yet on the way.
            // From one equilibrium to the next it has never pulled more than it may.
            const Vec3 slip = reach - result.reach;
            result.friction =
                at.step > 0
                    ? 0.5 * k * (slip.dot(reach + result.reach) + at.step * slip.dot(at.now))
                    : k * slip.dot(result.reach);
        }
    }
    const double over = elastic - k * at.depth, given = 0.5 * over * over / k;
    result.stored = 0.5 * k * (at.depth * at.depth + result.reach.squaredNorm()) - given;
    result.bound = at.depth < 0 ? result.stored : 0.5 * k * result.reach.squaredNorm();
    result.force = N * at.normal + T;
    result.bond = k * result.reach + std::min(elastic, 0.0) * at.normal;
    result.elastic = k * result.reach + elastic * at.normal;
    return result;
}

// What has touched when last found, with its depth and reach as they are now. Found by dashpots
// from other speeds it would differ a little, and friction with it, which takes what it lets go.
SWAGE_INLINE ImpactForce impact_as_found(double stiffness, double depth, double hold,
                                         const Vec3& normal, const Vec3& reach, const Vec3& dashpot,
                                         const Vec3& bond) {
    ImpactForce f;
    const double k = stiffness, over = spring_push(k, depth, hold) - k * depth;
    f.reach = reach - normal * normal.dot(reach);
    f.elastic = k * (f.reach + depth * normal);
    f.stored = 0.5 / k * (f.elastic.squaredNorm() - over * over);
    f.elastic += over * normal;
    f.force = f.elastic + dashpot;
    f.bond = bond;
    return f;
}

}  // namespace swage

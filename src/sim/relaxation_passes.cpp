// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/relaxation_passes.h"

#include <algorithm>
#include <cstring>

#include "sim/lane_memory.h"
#include "sim/vector_clones.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

SWAGE_INLINE FewLanes bounded(const FewLanes& value, double most) {
    const FewLanes high = FewLanes{} + most;
    const FewLanes below = value > high ? high : value;
    return below < -high ? -high : below;
}

SWAGE_INLINE FewLanes positive(const FewLanes& value) { return larger(value, -value); }

// As many numbers as there are, the rest zero.
SWAGE_INLINE FewLanes some(const double* from, std::size_t count) {
    FewLanes value{};
    if (count >= std::size_t(kFewLanes)) return load<FewLanes>(from);
    for (std::size_t l = 0; l < count; ++l) value[l] = from[l];
    return value;
}
SWAGE_INLINE void put_some(const FewLanes& value, std::size_t count, double* to) {
    if (count >= std::size_t(kFewLanes)) {
        store(value, to);
    } else {
        std::memcpy(to, &value, count * sizeof(double));
    }
}

double sum_of(const FewLanes& lanes) {
    double sum = 0;
    for (int l = 0; l < kFewLanes; ++l) sum += lanes[l];
    return sum;
}

SWAGE_VECTOR_CLONES
void restrain(const double* x, const double* back_to, const double* drag, const double* mass,
              double share, double gravity, std::size_t count, double* force) {
    for (std::size_t p = 0; p < count; p += kFewLanes) {
        const std::size_t left = count - p;
        const FewLanes pull =
            share * some(drag + p, left) * (some(x + p, left) - some(back_to + p, left));
        put_some(some(force + p, left) + (some(mass + p, left) * gravity - pull), left, force + p);
    }
}

SWAGE_VECTOR_CLONES
RelaxationSums chunk_sums(const double* const (&v)[3], const double* const (&f)[3],
                          const double* mass, std::size_t count) {
    FewLanes power{}, motion{};
    for (std::size_t p = 0; p < count; p += kFewLanes) {
        const std::size_t left = count - p;
        FewLanes along{}, speed{};
        for (int i = 0; i < 3; ++i) {
            const FewLanes vi = some(v[i] + p, left), fi = some(f[i] + p, left);
            along += vi * fi, speed += vi * vi;
        }
        power += along;
        motion += some(mass + p, left) * speed;
    }
    return {sum_of(power), sum_of(motion)};
}

SWAGE_VECTOR_CLONES
double move_component(const RelaxationMove& move, const double* f, const double* inverse_mass,
                      const double* listed, std::size_t count, double* v, double* x) {
    FewLanes farthest{};
    for (std::size_t p = 0; p < count; p += kFewLanes) {
        const auto at = [&](const double* from) __attribute__((always_inline)) {
            return some(from + p, count - p);
        };
        const FewLanes speed = move.keep * at(v) + move.kick * at(f) * at(inverse_mass);
        const FewLanes now = at(x) + bounded(move.step * speed, move.longest);
        put_some(speed, count - p, v + p);
        put_some(now, count - p, x + p);
        farthest = larger(farthest, positive(now - at(listed)));
    }
    double most = 0;
    for (int l = 0; l < kFewLanes; ++l) most = std::max(most, farthest[l]);
    return most;
}

}  // namespace

void add_restraint(const Vec3Array& position, const Restraint& restraint, Vec3Array& force) {
    const auto& [back_to, drag, share, mass, gravity] = restraint;
    for_each_chunk(position.size(), [&](std::size_t begin, std::size_t end) {
        const auto component = [&](const std::vector<double>& x, const std::vector<double>& from,
                                   double g, std::vector<double>& f) {
            restrain(x.data() + begin, from.data() + begin, drag.data() + begin,
                     mass.data() + begin, share, g, end - begin, f.data() + begin);
        };
        component(position.x, back_to.x, gravity.x(), force.x);
        component(position.y, back_to.y, gravity.y(), force.y);
        component(position.z, back_to.z, gravity.z(), force.z);
    });
}

RelaxationSums relaxation_sums(const Vec3Array& velocity, const Vec3Array& force,
                               const std::vector<double>& mass) {
    const auto of_chunk = [&](std::size_t begin, std::size_t end) {
        const double* const v[3] = {velocity.x.data() + begin, velocity.y.data() + begin,
                                    velocity.z.data() + begin};
        const double* const f[3] = {force.x.data() + begin, force.y.data() + begin,
                                    force.z.data() + begin};
        return chunk_sums(v, f, mass.data() + begin, end - begin);
    };
    RelaxationSums all;
    for (const RelaxationSums& one : of_each_chunk(velocity.size(), of_chunk)) {
        all.power += one.power, all.motion += one.motion;
    }
    return all;
}

double move_on(const RelaxationMove& move, const Vec3Array& force,
               const std::vector<double>& inverse_mass, const Vec3Array& listed,
               Vec3Array& velocity, Vec3Array& position) {
    const auto move_chunk = [&](std::size_t begin, std::size_t end) {
        const auto component = [&](const std::vector<double>& f, const std::vector<double>& from,
                                   std::vector<double>& v, std::vector<double>& x) {
            return move_component(move, f.data() + begin, inverse_mass.data() + begin,
                                  from.data() + begin, end - begin, v.data() + begin,
                                  x.data() + begin);
        };
        return std::max({component(force.x, listed.x, velocity.x, position.x),
                         component(force.y, listed.y, velocity.y, position.y),
                         component(force.z, listed.z, velocity.z, position.z)});
    };
    double most = 0;
    for (double one : of_each_chunk(position.size(), move_chunk)) most = std::max(most, one);
    return most;
}

}  // namespace swage

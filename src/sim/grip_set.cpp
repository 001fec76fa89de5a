// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/grip_set.h"

#include <algorithm>
#include <utility>

#include "sim/surface_forces.h"
#include "sim/torn_forces.h"

namespace swage {

GripSet::GripSet(const Aggregate& matter, const Apparatus& apparatus, const SimSettings& settings,
                 int body)
    : apparatus_(&apparatus),
      body_(body),
      of_layer_(settings.grip_stiffness),
      layer_(matter, matter.surface, settings.solver) {
    // As grips took hold of them: by what they are as molded.
    carry_points(matter, [](std::size_t, const PointCarriage& molded) { return molded; });
}

void GripSet::connections_changed(const Aggregate& matter) {
    const std::vector<char> let_go = torn_;
    carry_points(matter, [&](std::size_t point, PointCarriage by) {
        const SurfacePoints& before = points(matter);
        if (before.row(point) == by.row) {
            by.place = before.place(point);
        } else if (!let_go.empty() && let_go[point]) {
            by.is_whole = false;
        } else {
            by = brought_to(before.position(point, matter.particle_position), matter, by);
        }
        return by;
    });
}

// `carriage`: of a point that another cell holds than as molded, from that as molded.
template <typename Carriage>
void GripSet::carry_points(const Aggregate& matter, const Carriage& carriage) {
    torn_.clear();
    std::shared_ptr<SurfacePoints> beside;
    for_each_grip([&](std::size_t, const Grip& grip) {
        const std::vector<PointCarriage> holder = holders(grip, matter);
        for (std::size_t n = 0; n < holder.size(); ++n) {
            const auto point = static_cast<std::size_t>(grip.point[n]);
            PointCarriage by = holder[n];
            const bool by_another = by.is_whole && by.row != matter.surface.row(point);
            if (by_another) by = carriage(point, by);
            if (!by.is_whole) {
                torn_.resize(matter.surface.size(), 0);
                torn_[point] = 1;
            } else if (by_another) {
                if (!beside) beside = std::make_shared<SurfacePoints>(matter.surface);
                carry(*beside, point, by);
            }
        }
    });
    const bool limits_change =
        beside_ != nullptr || beside != nullptr || std::exchange(limit_is_old_, false);
    beside_ = std::move(beside);
    if (limits_change && !limit_.empty()) find_limits(matter);
}

double GripSet::stiffness(const Aggregate& matter, int point) const {
    const double k = layer_.stiffness(points(matter), std::size_t(point), of_layer_);
    return limit_.empty() ? k : std::min(k, limit_[point]);
}

double GripSet::stiffness(const Aggregate& matter, const Grip& grip, std::size_t n) const {
    const double share = grip.share_of(n);
    return share * share * stiffness(matter, grip.point[n]);
}

void GripSet::limit_stiffness(const Aggregate& matter, double step) {
    limit_step_ = step;
    find_limits(matter);
}

void GripSet::find_limits(const Aggregate& matter) {
    limit_.clear();
    std::vector<double> all;
    for (std::size_t p = 0; p < matter.surface.size(); ++p) {
        all.push_back(stiffness(matter, int(p)));
    }
    limit_ =
        stiffest_of_points(matter, points(matter), all, kGripShare / (limit_step_ * limit_step_));
}

template <typename Act>
void GripSet::for_each_point(const Aggregate& matter, const Drive& now, const Act& act) const {
    for_each_grip([&](std::size_t g, const Grip& grip) {
        const Pose& pose = now.world_from_grip[g];
        const bool wholly = grip.hold == Vec3::Ones();
        for_each_held(matter, grip, [&](std::size_t n, int point, double k) {
            const Vec3 x = points(matter).position(std::size_t(point), matter.particle_position);
            Vec3 force;
            if (wholly) {
                force = k * (pose * grip.anchor[n] - x);
            } else {
                const Vec3 reach = grip.anchor[n] - pose.inverse() * x;
                force = pose.turn(k * grip.hold.cwiseProduct(reach));
            }
            act(g, point, x, force, k);
        });
    });
}

void GripSet::add_stiffness(const Aggregate& matter, std::vector<double>& stiffness) const {
    for_each_grip([&](std::size_t, const Grip& grip) {
        for_each_held(matter, grip, [&](std::size_t, int point, double k) {
            spread_stiffness(points(matter), point, k, stiffness);
        });
    });
}

void GripSet::add_held_points(const Aggregate& matter, const Drive& now,
                              std::vector<HeldPoint>& held) const {
    for_each_grip([&](std::size_t g, const Grip& grip) {
        const Mat3 turn = now.world_from_grip[g].rotation.toRotationMatrix();
        const Mat3 hold = turn * grip.hold.asDiagonal() * turn.transpose();
        for_each_held(matter, grip, [&](std::size_t, int point, double k) {
            held.push_back(held_point(points(matter), point, k * hold));
        });
    });
}

void GripSet::add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force) const {
    for_each_point(matter, now, [&](std::size_t, int point, const Vec3&, const Vec3& f, double) {
        spread(points(matter), point, f, force);
    });
}

void GripSet::add_loads(const Aggregate& matter, const Drive& now, std::size_t first,
                        std::vector<PartSum>& sums) const {
    for_each_point(matter, now, [&](std::size_t g, int, const Vec3& x, const Vec3& f, double) {
        sums[first + g].add(x - now.world_from_grip[g].translation, f);
    });
}

double GripSet::stored_energy(const Aggregate& matter, const Drive& now) const {
    double sum = 0;
    for_each_point(matter, now, [&](std::size_t, int, const Vec3&, const Vec3& f, double k) {
        sum += 0.5 * f.squaredNorm() / k;
    });
    return sum;
}

double GripSet::add_all(const Aggregate& matter, const Drive& now, Vec3Array& force,
                        std::size_t first, std::vector<PartSum>& sums) const {
    double stored = 0;
    for_each_point(matter, now,
                   [&](std::size_t g, int point, const Vec3& x, const Vec3& f, double k) {
                       spread(points(matter), point, f, force);
                       sums[first + g].add(x - now.world_from_grip[g].translation, f);
                       stored += 0.5 * f.squaredNorm() / k;
                   });
    return stored;
}

double GripSet::travel(const Drive& from, const Drive& to) const {
    double farthest = 0;
    for_each_grip([&](std::size_t g, const Grip& grip) {
        for (const Vec3& anchor : grip.anchor) {
            const Vec3 way = to.world_from_grip[g] * anchor - from.world_from_grip[g] * anchor;
            farthest = std::max(farthest, way.norm());
        }
    });
    return farthest;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/load_set.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/surface_forces.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;

Vec3 centre_of(const std::vector<double>& area, const std::vector<Vec3>& position) {
    Vec3 sum = Vec3::Zero();
    double all = 0;
    for (std::size_t n = 0; n < area.size(); ++n) {
        sum += area[n] * position[n];
        all += area[n];
    }
    return all > 0 ? Vec3(sum / all) : sum;
}

std::vector<Vec3> positions_of(const Aggregate& matter, const std::vector<int>& points) {
    std::vector<Vec3> position;
    position.reserve(points.size());
    for (int p : points) position.push_back(matter.surface_position(p));
    return position;
}

PushSum sum_of(const std::vector<double>& area, const std::vector<Vec3>& position,
               const std::vector<Vec3>& force) {
    PushSum sum;
    sum.centre = centre_of(area, position);
    for (std::size_t n = 0; n < area.size(); ++n) {
        sum.force += force[n];
        sum.torque += (position[n] - sum.centre).cross(force[n]);
    }
    return sum;
}

// NOTE: the points sample a closed surface, and their area vectors sum to nothing only nearly. What
// is left would drive a free body for ever, so it is taken off: evenly by area, and by a turn.
void balance(const std::vector<double>& area, const std::vector<Vec3>& position,
             std::vector<Vec3>& force) {
    const PushSum sum = sum_of(area, position, force);
    double all = 0;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t n = 0; n < area.size(); ++n) {
        const Vec3 r = position[n] - sum.centre;
        all += area[n];
        inertia += area[n] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    if (!(all > 0)) return;
    const Vec3 push = sum.force / all, turn = inertia.ldlt().solve(sum.torque);
    for (std::size_t n = 0; n < area.size(); ++n) {
        force[n] -= area[n] * (push + turn.cross(position[n] - sum.centre));
    }
}

Vec3 mass_moment(const Aggregate& matter) {
    const Vec3Array& x = matter.particle_position;
    const auto of_chunk = [&](std::size_t begin, std::size_t end) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t p = begin; p < end; ++p) sum += matter.particle_mass[p] * x.at(p);
        return sum;
    };
    Vec3 sum = Vec3::Zero();
    for (const Vec3& one : of_each_chunk(x.size(), of_chunk)) sum += one;
    return sum;
}

}  // namespace

LoadSet::LoadSet(const Apparatus& apparatus, const SimSettings& settings, int body)
    : apparatus_(&apparatus), body_(body), gravity_(settings.gravity) {}

void LoadSet::connections_changed(const Aggregate& matter) {
    parted_ = nullptr;
    const bool presses =
        std::any_of(apparatus_->load.begin(), apparatus_->load.end(),
                    [&](const Load& load) { return pushes(load) && load.force.empty(); });
    if (!presses) return;
    std::vector<char> parted(matter.surface.size());
    parallel_for((parted.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t end = std::min(parted.size(), (chunk + 1) * kChunk);
        for (std::size_t p = chunk * kChunk; p < end; ++p) {
            parted[p] = is_parted(matter, p);
        }
    });
    if (std::find(parted.begin(), parted.end(), 1) == parted.end()) return;
    parted_ = std::make_shared<const std::vector<char>>(std::move(parted));
}

std::vector<double> LoadSet::areas_of(const Load& load, const Aggregate& matter) const {
    std::vector<double> area;
    area.reserve(load.point.size());
    const bool presses = load.force.empty();
    for (int p : load.point) {
        const bool is_off = presses && parted_ != nullptr && (*parted_)[p];
        area.push_back(is_off ? 0 : matter.surface.area(p));
    }
    return area;
}

std::vector<Vec3> LoadSet::forces_of(const Load& load, double strength,
                                     const Aggregate& matter) const {
    std::vector<Vec3> force(load.point.size());
    if (!load.force.empty()) {
        for (std::size_t n = 0; n < force.size(); ++n) force[n] = strength * load.force[n];
        return force;
    }
    const double pressure = strength * load.pressure;
    if (pressure == 0) {
        std::fill(force.begin(), force.end(), Vec3::Zero());
        return force;
    }
    const std::vector<double> area = areas_of(load, matter);
    parallel_for((force.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t end = std::min(force.size(), (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < end; ++n) {
            force[n] = area[n] > 0
                           ? pressure_force(pressure, surface_area_vector(matter, load.point[n]))
                           : Vec3(Vec3::Zero());
        }
    });
    if (load.closed) balance(area, positions_of(matter, load.point), force);
    return force;
}

void LoadSet::add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force) const {
    for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
        const Load& load = apparatus_->load[l];
        if (!pushes(load) || now.load_strength[l] == 0) continue;
        const std::vector<Vec3> push = forces_of(load, now.load_strength[l], matter);
        for (std::size_t n = 0; n < push.size(); ++n) {
            spread(matter.surface, load.point[n], push[n], force);
        }
    }
}

double LoadSet::size(const Aggregate& matter, const Drive& now) const {
    double largest = has_gravity() ? matter.mass() * gravity(now).norm() : 0;
    for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
        const Load& load = apparatus_->load[l];
        if (!pushes(load)) continue;
        double sum = 0;
        for (const Vec3& force : load.force) sum += force.norm();
        if (load.force.empty()) {
            for (double area : areas_of(load, matter)) sum += std::abs(load.pressure) * area;
        }
        largest = std::max(largest, std::abs(now.load_strength[l]) * sum);
    }
    return largest;
}

bool LoadSet::eases(const Drive& from, const Drive& to) const {
    bool eases = has_gravity() && gravity(to).norm() < gravity(from).norm();
    for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
        if (!pushes(apparatus_->load[l])) continue;
        eases = eases || std::abs(to.load_strength[l]) < std::abs(from.load_strength[l]);
    }
    return eases;
}

bool LoadSet::is_stirred(const Drive& since, const Drive& now) const {
    constexpr double kLeast = 1e-6;
    bool stirred = (gravity(now) - gravity(since)).norm() > kLeast * gravity_.norm();
    for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
        if (!pushes(apparatus_->load[l])) continue;
        stirred = stirred || std::abs(now.load_strength[l] - since.load_strength[l]) > kLeast;
    }
    return stirred;
}

LoadSet::Settled LoadSet::settled(const Aggregate& matter, const Drive& now) const {
    Settled state;
    for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
        const Load& load = apparatus_->load[l];
        if (!pushes(load)) {
            state.position.emplace_back();
            state.force.emplace_back();
            continue;
        }
        state.position.push_back(positions_of(matter, load.point));
        state.force.push_back(forces_of(load, now.load_strength[l], matter));
    }
    if (has_gravity()) {
        state.moment = mass_moment(matter);
        state.gravity = gravity(now);
    }
    return state;
}

void LoadSet::start(const Aggregate& matter, const Drive& now) {
    if (started_ || count() == 0) return;
    connections_changed(matter);
    last_ = settled(matter, now);
    started_ = true;
}

void LoadSet::commit(const Aggregate& matter, const Drive& now, std::vector<double>& work) {
    if (count() == 0) return;
    Settled state = settled(matter, now);
    for (std::size_t l = 0; l < state.force.size(); ++l) {
        for (std::size_t n = 0; n < state.force[l].size(); ++n) {
            work[l] += 0.5 * (last_.force[l][n] + state.force[l][n])
                                 .dot(state.position[l][n] - last_.position[l][n]);
        }
    }
    if (has_gravity()) {
        work.back() += 0.5 * (last_.gravity + state.gravity).dot(state.moment - last_.moment);
    }
    last_ = std::move(state);
}

std::vector<PushSum> LoadSet::sums(const Aggregate& matter, const Drive& now) const {
    std::vector<PushSum> sums;
    for (std::size_t l = 0; l < apparatus_->load.size(); ++l) {
        const Load& load = apparatus_->load[l];
        if (!pushes(load)) {
            sums.emplace_back();
            continue;
        }
        sums.push_back(sum_of(areas_of(load, matter), positions_of(matter, load.point),
                              forces_of(load, now.load_strength[l], matter)));
    }
    if (has_gravity()) {
        const double mass = matter.mass();
        sums.push_back({mass_moment(matter) / mass, mass * gravity(now), Vec3::Zero()});
    }
    return sums;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_patch.h"

#include "base/parallel.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 2048;  // particles

}  // namespace

void ContactPatch::clear() {
    for (ParticleId p : particle_) slot_[p] = -1;
    particle_.clear();
    motion_.clear();
    force_.clear();
}

int ContactPatch::slot_of(ParticleId particle) {
    int& slot = slot_[particle];
    if (slot >= 0) return slot;
    slot = static_cast<int>(particle_.size());
    particle_.push_back(particle);
    motion_.emplace_back();
    force_.emplace_back();
    if (others_) read(particle_.size() - 1, particle_.size());
    return slot;
}

ContactPatch::Motion ContactPatch::motion_of(ParticleId p) const {
    return {vec4(matter_->particle_position.at(p), 1 / matter_->particle_mass[p]),
            vec4(matter_->particle_velocity.at(p))};
}

void ContactPatch::read(std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
        const ParticleId p = particle_[n];
        motion_[n] = motion_of(p);
        force_[n].all = vec4(others_->at(p));
    }
}

void ContactPatch::find_springs() {
    parallel_chunks(particle_.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            force_[n].springs = motion_[n].place[3] * force_[n].all;
        }
    });
}

void ContactPatch::read(const Vec3Array& force) {
    others_ = &force;
    parallel_chunks(particle_.size(), kChunk,
                    [&](std::size_t begin, std::size_t end) { read(begin, end); });
}

void ContactPatch::write(Vec3Array& force, const Vec3& gravity, double step, ContactSums& sums) {
    struct Power {
        double came = 0, goes = 0;
    };
    const auto write_some = [&](std::size_t begin, std::size_t end) {
        Power power;
        for (std::size_t n = begin; n < end; ++n) {
            const ParticleId p = particle_[n];
            const Vec3 all = vec3(force_[n].all), done = all - force.at(p);
            const Vec3 v = vec3(motion_[n].speed);
            power.came += done.dot(v);
            power.goes += done.dot(v + step * (gravity + motion_[n].place[3] * all));
            force.set(p, all);
        }
        return power;
    };
    for (const Power& one : parallel_parts(particle_.size(), kChunk, write_some)) {
        sums.came += one.came;
        sums.goes += one.goes;
    }
    others_ = nullptr;
}

}  // namespace swage

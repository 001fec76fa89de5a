// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/spec.h"

namespace swage {

BodySpec::BodySpec() = default;
BodySpec::~BodySpec() = default;
BodySpec::BodySpec(const BodySpec&) = default;
BodySpec::BodySpec(BodySpec&&) noexcept = default;
BodySpec& BodySpec::operator=(const BodySpec&) = default;
BodySpec& BodySpec::operator=(BodySpec&&) noexcept = default;

StageSpec::StageSpec() = default;
StageSpec::~StageSpec() = default;
StageSpec::StageSpec(const StageSpec&) = default;
StageSpec::StageSpec(StageSpec&&) noexcept = default;
StageSpec& StageSpec::operator=(const StageSpec&) = default;
StageSpec& StageSpec::operator=(StageSpec&&) noexcept = default;

SceneSpec::SceneSpec() = default;
SceneSpec::~SceneSpec() = default;
SceneSpec::SceneSpec(const SceneSpec&) = default;
SceneSpec::SceneSpec(SceneSpec&&) noexcept = default;
SceneSpec& SceneSpec::operator=(const SceneSpec&) = default;
SceneSpec& SceneSpec::operator=(SceneSpec&&) noexcept = default;

bool StartSpec::moves() const { return velocity != Vec3::Zero() || spin != Vec3::Zero(); }

std::string BodySpec::label() const {
    return name == BodySpec().name && !mesh.file.empty() ? mesh.file.stem().string() : name;
}

std::vector<const Material*> BodySpec::materials() const {
    std::vector<const Material*> all{&material};
    for (const InsetSpec& one : inset) all.push_back(&one.material);
    return all;
}

bool SceneSpec::breaks() const {
    return any_material([](const Material& m) { return m.breaks(); });
}

bool SceneSpec::yields() const {
    return any_material([](const Material& m) { return m.yields(); });
}

bool SceneSpec::damps() const {
    return any_material([](const Material& m) { return m.damping_ratio > 0; });
}

bool SceneSpec::moves() const {
    return any_stage([](const StageSpec& one) { return in_motion(one.sim.solver); });
}

}  // namespace swage

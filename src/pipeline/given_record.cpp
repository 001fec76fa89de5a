// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/given_record.h"

#include <cmath>

#include "matter/material_names.h"

namespace swage {

namespace {

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json finite(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

}  // namespace

Json material_json(const Material& material) {
    Json curve = Json::array();  // of flow; [] where the hardening is linear
    for (const auto& [strain, stress] : material.flow_curve) curve.push_back({strain, stress});
    Json json = {{"name", material.name},
                 {"mechanics", name_in(kMechanicsNames, material.mechanics)},
                 {"elasticity", name_in(kElasticityNames, material.elasticity)},
                 {"young_modulus_Pa", material.young_modulus},
                 {"poisson_ratio", material.poisson_ratio},
                 {"density_kg_m3", material.density},
                 {"yield_stress_Pa", finite(material.yield_stress)},
                 {"hardening_Pa", material.hardening},
                 {"flow_curve_Pa", curve},
                 {"strength_Pa", finite(material.strength)},
                 {"toughness_J_m2", finite(material.toughness)},
                 {"damping_ratio", material.damping_ratio},
                 {"friction", material.friction},
                 {"static_friction", material.holding_friction()},
                 {"restitution", material.restitution},
                 {"stickiness_Pa", material.stickiness}};
    if (material.shifts()) {
        json["back_stress_Pa"] = material.back_stress;
        json["back_strain"] = material.back_strain;
    }
    return json;
}

Json settings_json(const SimSettings& settings) {
    return {{"tolerance", settings.tolerance},
            {"iteration_limit", settings.iteration_limit},
            {"halving_limit", settings.halving_limit},
            {"contact_stiffness",
             settings.contact_stiffness > 0 ? Json(settings.contact_stiffness) : Json(nullptr)},
            {"grip_stiffness", settings.grip_stiffness},
            {"self_contact", settings.self_contact},
            {"step_safety", settings.step_safety},
            {"retry_limit", settings.retry_limit},
            {"sleep", settings.sleep},
            {"medium_density_kg_m3", settings.medium_density},
            {"drag_coefficient", settings.drag_coefficient},
            {"directional_drag_Pa_s_m", settings.directional_drag},
            {"directional_drag_along",
             settings.directional_drag_along == DragAlong::normal ? "normal" : "motion"},
            {"gravity_m_s2", {settings.gravity.x(), settings.gravity.y(), settings.gravity.z()}}};
}

Json mold_json(const MoldSettings& settings) {
    Json json = {{"kind", settings.kind == MoldKind::block ? "block" : "shape"},
                 {"cell_limit", settings.cell_limit}};
    if (settings.across) json["across"] = *settings.across;
    if (settings.spacing) json["spacing_m"] = *settings.spacing;
    return json;
}

Json skin_json(const SkinSettings& settings) {
    const char* kind = settings.kind == SkinKind::boundary ? "boundary"
                       : settings.kind == SkinKind::frame4 ? "frame4"
                                                           : "mount";
    return {{"kind", kind},
            {"divide", settings.longest_edge ? Json(*settings.longest_edge) : Json(false)},
            {"crease_angle_rad", settings.crease_angle},
            {"roughness", settings.roughness}};
}

Json start_json(const StartSpec& start) {
    return {{"at_m", start.at ? vector_json(*start.at) : Json(nullptr)},
            {"turn_rad", vector_json(start.turn)},
            {"velocity_m_s", vector_json(start.velocity)},
            {"spin_rad_s", vector_json(start.spin)}};
}

Json inset_json(const InsetSpec& inset) {
    if (!inset.file.empty()) return {{"file", inset.file.string()}};
    return {{"from", vector_json(inset.from)}, {"to", vector_json(inset.to)}};
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "geometry/calf.h"
#include "geometry/implicit.h"
#include "geometry/made_shapes.h"

namespace swage {

MadeShape make_calf(const ShapeValues& values) {
    constexpr double kModelLength = 1.123;
    const double trunk_edge = kModelLength / values.at("division");
    FieldMeshSettings settings;
    settings.box = calf_bounds();
    settings.edge_length = 0.5 * trunk_edge;
    settings.edge_length_at = [&](const Vec3& p) { return trunk_edge * calf_edge_length(p); };
    settings.sample_spacing = std::min(0.0085, settings.edge_length);  // the ears are thin

    MadeShape made;
    made.mesh = mesh_of_field(calf_distance, settings);
    smooth_by_crease_angle(made.mesh, kPi);
    AtlasSettings atlas;
    atlas.density = calf_texel_density;
    unwrap(made.mesh, atlas);
    made.texture = paint_texture(made.mesh, static_cast<int>(values.at("texture")), calf_color);
    SurfaceMaterial hide;
    hide.name = "hide";
    hide.color = Vec3::Ones();
    hide.roughness = 0.75;
    made.mesh.material = {hide};
    made.mesh.triangle_material.assign(made.mesh.triangle.size(), 0);

    const Box box = box_of(made.mesh.position);
    const double scale = values.at("length") / box.size().x();
    const Vec3 foot(box.center().x(), box.low.y(), box.center().z());
    for (Vec3& p : made.mesh.position) p = scale * (p - foot);
    return made;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/input_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/log.h"
#include "base/units.h"
#include "geometry/mesh_read.h"
#include "geometry/mesh_repair.h"
#include "pipeline/body_look.h"
#include "pipeline/start_warnings.h"
#include "render/image_read.h"
#include "skin/new_look.h"

namespace swage {

namespace {

constexpr double kHuge = 50;  // [m], beyond which a mesh is likely to be in other units

double scale_to(double length, const TriMesh& mesh) {
    const double longest = box_of(mesh.position).size().maxCoeff();
    return longest > 0 ? length / longest : 1.0;
}

bool looks_the_same(const TriMesh& a, const TriMesh& b) {
    return a.material.size() == b.material.size() &&
           a.triangle_uv.empty() == b.triangle_uv.empty() &&
           a.position_color.empty() == b.position_color.empty() &&
           a.triangle_smooth.empty() == b.triangle_smooth.empty();
}

// A picture that cannot be drawn, or has no place on the skin.
void refuse_texture(const BodySpec& body, const TriMesh& mesh, SkinKind skin) {
    const MeshSpec& spec = body.mesh;
    if (spec.texture.empty()) return;
    const auto refuse = [&](const std::string& why) {
        throw SceneError({mistake_at(spec.texture_place, why)});
    };
    if (mesh.triangle_uv.empty()) {
        refuse(
            fmt::format("the mesh {} has no texture coordinates: nothing says where the texture "
                        "lies on it",
                        spec.file.filename().string()));
    }
    if (skin == SkinKind::boundary && body.mold.kind == MoldKind::block) {
        refuse("the boundary of a block has no texture coordinates: give it a color instead");
    }
    try {
        read_image(spec.texture);
    } catch (const Error& error) {
        refuse(error.what());
    }
}

}  // namespace

void make_solid(InputMesh& input, MoldKind kind, double crease_angle) {
    if (kind == MoldKind::block || input.report.is_one_body()) return;
    if (!input.report.bounds_a_volume()) {
        for (const std::string& finding : input.report.finding) log_warning("{}", finding);
    }
    Repair repaired = repair_mesh(input.mesh, crease_angle);
    input.repair = repaired.account;
    for (const std::string& act : repaired.account) log_info("repaired: {}", act);
    if (repaired.account.empty()) return;
    log_info("repaired: {}", summary_line(check_mesh(repaired.mesh)));
    if (looks_the_same(input.mesh, repaired.mesh)) {
        input.mesh = std::move(repaired.mesh);
    } else {
        log_info("the original mesh is kept as the skin, the repaired one only shapes the matter");
        input.solid = std::move(repaired.mesh);
    }
}

InputMesh read_mesh_as_it_is(const std::filesystem::path& file, std::optional<double> length,
                             double crease_angle, bool looks) {
    InputMesh input;
    input.mesh = read_mesh(file, {}, &input.finding, crease_angle, looks);
    if (length) {
        input.scale = scale_to(*length, input.mesh);
        if (input.scale != 1) {
            for (Vec3& p : input.mesh.position) p *= input.scale;
        }
    }
    const double longest = box_of(input.mesh.position).size().maxCoeff();
    if (!length && longest > kHuge) {
        input.finding.push_back(
            fmt::format("it is {} long, as the file's numbers are taken as metres: give its length "
                        "with `length`",
                        quantity_text(longest, Quantity::length)));
    }
    input.report = check_mesh(input.mesh);
    return input;
}

InputMesh read_input_mesh(const MeshSpec& spec, MoldKind kind, double crease_angle, bool looks) {
    InputMesh input = read_mesh_as_it_is(spec.file, spec.length, crease_angle, looks);
    log_info("{}: {}", spec.file.filename().string(), summary_line(input.report));
    // Whatever its name, a file's own is no cut's look.
    for (SurfaceMaterial& look : input.mesh.material) {
        if (is_cut_look(look)) look.name.insert(std::string(kCutMaterial).size(), ".2");
    }
    make_solid(input, kind, crease_angle);
    return input;
}

std::vector<InputMesh> read_input_meshes(const SceneSpec& scene) {
    std::vector<InputMesh> input;
    const auto is_same = [](const BodySpec& a, const BodySpec& b) {
        return a.mesh.file == b.mesh.file && a.mesh.length == b.mesh.length &&
               a.mold.kind == b.mold.kind && a.is_painted() == b.is_painted();
    };
    for (const BodySpec& body : scene.body) {
        const auto known = std::find_if(scene.body.begin(), scene.body.end(),
                                        [&](const BodySpec& one) { return is_same(one, body); });
        const auto n = static_cast<std::size_t>(known - scene.body.begin());
        if (n < input.size()) {
            input.push_back(InputMesh(input[n]));
        } else {
            input.push_back(read_input_mesh(body.mesh, body.mold.kind, scene.skin.crease_angle,
                                            !body.is_painted()));
        }
        refuse_texture(body, input.back().mesh, scene.skin.kind);
    }
    for (std::size_t b = 0; b < input.size(); ++b) {
        const BodySpec& body = scene.body[b];
        if (!body.gives_look || !hides_material(body, input[b].mesh)) continue;
        input[b].finding.emplace_back(
            "the mesh file says how it looks, so the look of the material is not seen: "
            "look = \"material\" beside file shows it");
    }
    for (const std::string& warning : warnings_of_meshes(scene, input)) log_warning("{}", warning);
    return input;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/memory_cost.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "base/portable_math.h"
#include "pipeline/disk_cost.h"
#include "render/image_read.h"
#include "render/picture_bytes.h"
#include "render/targets.h"
#include "sim/contact_list.h"

namespace swage {

namespace {

constexpr double kProgram = 26e6;  // a bar of 2 x 2 x 20 cells
constexpr double kKept = 4e6;      // buffers of what is written as it goes
// Of a mesh while it is read and checked, each triangle: balls of 461,000 and 2.5 million.
constexpr double kReadTriangle = 450;
// A vertex of a skin: its mesh, mount and places, and what is written of it (a ball of 230,498
// that falls); more where blades cut it (the same in three slices); of a boundary, which has no
// mount (animals of 24 to 56 cells across).
constexpr double kMountedVertex = 1080, kCutVertex = 600, kBoundaryVertex = 600;
// A particle, beside its matter: forces, moves and what is found of it at the end of a stage
// (explicit steps of an animal of 17,386, 69,742 and 179,045); coarser lattices, their matrices and
// where it was before (a bar of 20,449 and 116,909 twisted).
constexpr double kMoved = 840, kRested = 1270;
constexpr double kFlowed = 100, kFlowedSpring = 250;  // of copper that strikes, 90,751
// A cell that may break, with springs, pieces and surfaces, as brittle matter mostly does: of glass
// 4,400 to 28,000, by how much of it is shattered (animals of 8,645 to 107,000 cells that strike at
// 8 m/s).
constexpr double kBroken = 6000;
// Of rubble, each particle, and each vertex of its skin (balls of glass of 613 to 6,085 particles
// with rough and plain faces, and with a boundary).
constexpr double kRubble = 12e3, kRubbleVertex = 1550;
// Of insets each triangle, as they are read and molded; each vertex of those that go on as skins do
// (a bar with one of 299,568 and of 46,128 triangles, in slices).
constexpr double kInsetTriangle = 170, kCarriedVertex = 1080;
// A cell's face at the surface: its points; what these have near, where there are tools or bodies
// (the animals and the bars).
constexpr double kFace = 2700, kTouchingFace = 2500;
// Of what is cut each point of the surface has cells of its own body near, in one place or two: so
// it is looked whether pieces overlap at the end. Each place, and what is found of it (a flower
// from a sheet of dough, 46,000 points: 81 MB).
constexpr double kPointsPerFace = 4, kOwnPlaces = 1.5;
constexpr double kOwnContact = sizeof(Contact) + sizeof(ContactMemory) + 830;
// Libraries that draw, shaders as they are compiled and maps of shadows (stills of 64 x 64 pixels);
// those for passes more.
constexpr double kDrawing = 114e6, kPassShaders = 6e6;
// Of what is drawn, a vertex of a skin as it came, of one that a still shows, and of the one before
// it where it is another.
constexpr double kGivenVertex = 150, kDrawnVertex = 500, kMovedVertex = 200;

constexpr const char* kLargerCells = "a larger [mold] spacing";

// What can be changed, and what it takes [byte].
struct MemoryPart {
    const char* less;
    double bytes;
};

double own_contacts(const MemoryShare& of) {
    return kOwnContact * kOwnPlaces * kPointsPerFace * (of.faces + of.cut_faces);
}

const MemoryPart& largest(const std::vector<MemoryPart>& parts) {
    return *std::max_element(
        parts.begin(), parts.end(),
        [](const MemoryPart& a, const MemoryPart& b) { return a.bytes < b.bytes; });
}

// Of skins, whose vertices are those of meshes, or as many as cells ask for.
const char* fewer_vertices(const SceneSpec& scene, const std::vector<InputMesh>& input,
                           double vertices) {
    double given = 0;
    for (const InputMesh& one : input) given += static_cast<double>(one.mesh.position.size());
    return scene.skin.kind != SkinKind::boundary && given > 0.5 * vertices
               ? "a mesh of fewer triangles"
               : kLargerCells;
}

// Of the meshes, each picture as often as there are materials with it at the most.
TextureBytes textures(const std::vector<InputMesh>& input) {
    TextureBytes all;
    for (const InputMesh& one : input) {
        for (const SurfaceMaterial& material : one.mesh.material) {
            const auto size = material.embedded_texture   ? picture_size(*material.embedded_texture)
                              : !material.texture.empty() ? picture_size(material.texture)
                                                          : std::nullopt;
            if (!size) continue;
            const TextureBytes bytes = texture_bytes(size->front(), size->back());
            all.kept += bytes.kept;
            all.reading = std::max(all.reading, bytes.reading);
        }
    }
    return all;
}

}  // namespace

// Those of one name cut across the length, those of several in all directions.
double cut_faces(const SceneSpec& scene, const TriMesh& mesh, double spacing) {
    const double volume = std::abs(signed_volume(mesh));
    const double across = volume / box_of(mesh.position).size().maxCoeff(),
                 any = portable::pow(volume, 2. / 3);
    double area = 0;
    for (const StageSpec& stage : scene.stage) {
        std::set<std::string> names;
        for (const BladeSpec& blade : stage.machine.blade) {
            names.insert(blade.repeat.name.empty() ? blade.name : blade.repeat.name);
        }
        const auto blades = static_cast<double>(stage.machine.blade.size());
        area += blades * (names.size() > 1 ? any : across);
    }
    return 2 * area / (spacing * spacing);
}

MemoryBytes memory_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                         const MemoryShare& of, bool draws) {
    double held = kProgram, read = kInsetTriangle * of.inset_triangles;
    for (const InputMesh& one : input) {
        const double triangles =
            static_cast<double>(one.mesh.triangle.size() + one.solid.triangle.size());
        read = std::max(read, kReadTriangle * triangles);
    }
    const auto cuts = [](const StageSpec& stage) { return !stage.machine.blade.empty(); };
    const auto rests = [](const StageSpec& stage) { return !in_motion(stage.sim.solver); };
    const auto touches = [&](const StageSpec& stage) {
        return !stage.machine.tool.empty() || stage.sim.self_contact;
    };
    const bool springs = scene.any_material(
        [](const Material& m) { return m.yields() && m.mechanics == Mechanics::springs; });
    const double flowed = springs ? kFlowedSpring : scene.yields() ? kFlowed : 0;
    const double particle = (scene.any_stage(rests) ? kRested : kMoved) + flowed;
    const double face =
        kFace + (scene.any_stage(touches) || scene.body.size() > 1 ? kTouchingFace : 0);
    const double vertex = scene.skin.kind == SkinKind::boundary
                              ? kBoundaryVertex
                              : kMountedVertex + (scene.any_stage(cuts) ? kCutVertex : 0);
    const double simulated = of.matter + of.particles * particle + of.faces * face +
                             of.vertices * vertex + of.carried_vertices * kCarriedVertex + of.way +
                             kKept + (scene.any_stage(cuts) ? own_contacts(of) : 0);
    const auto pixels = [&](double vertices) {
        return picture_bytes(scene.render, 2 * vertices <= double(kMostMultisampledTriangles));
    };
    const TextureBytes texture = draws ? textures(input) : TextureBytes();
    const double given =
        std::accumulate(input.begin(), input.end(), 0.0, [](double sum, const InputMesh& one) {
            return sum + kGivenVertex * static_cast<double>(one.mesh.position.size());
        });
    // Those of two pictures are kept, where skins are other ones in each.
    const double pictures = scene.breaks() || scene.any_stage(cuts) ? 3 : 1;
    const double each =
        pictures * kDrawnVertex + (scene.render.has(PicturePass::motion) ? 2 * kMovedVertex : 0);
    const auto drawn = [&](double vertices) {
        if (!draws) return 0.0;
        return kDrawing + (scene.render.passes.empty() ? 0 : kPassShaders) + texture.kept +
               std::max(texture.reading, given + pixels(vertices) + vertices * each);
    };
    const auto peak = [&](double broken, double vertices) {
        return held + std::max({read, simulated + broken, drawn(vertices)});
    };
    const char* of_skins = fewer_vertices(scene, input, of.vertices);
    const auto less = [&](double broken) {
        const double skins = of.vertices * vertex;
        if (drawn(of.vertices) > std::max(read, simulated + broken)) {
            return largest({{"a smaller [render] size", pixels(of.vertices)},
                            {"smaller textures", texture.kept + texture.reading},
                            {of_skins, of.vertices * each}})
                .less;
        }
        if (read > simulated + broken) return "a mesh of fewer triangles";
        return largest({{kLargerCells, simulated + broken - skins - of.way},
                        {of_skins, skins},
                        {"fewer frames", of.way}})
            .less;
    };
    const double undrawn = held + std::max(read, simulated);
    if (!scene.breaks()) return {peak(0, of.vertices), peak(0, of.vertices), undrawn, less(0)};
    const bool is_boundary = scene.skin.kind == SkinKind::boundary;
    const double rubble = broken_vertices(scene, of.particles, of.vertices, of.faces),
                 about = of.cells * kBroken,
                 most = of.particles * kRubble +
                        rubble * (is_boundary ? kBoundaryVertex : kRubbleVertex);
    return {peak(about, of.vertices), peak(std::max(about, most), of.vertices + rubble),
            undrawn + about, less(about)};
}

}  // namespace swage

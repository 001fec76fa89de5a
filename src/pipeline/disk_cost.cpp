// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/disk_cost.h"

#include <algorithm>
#include <cmath>

#include "pipeline/draw.h"
#include "pipeline/stage_keeper.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// Of what files take at the most, what they do at the least: 0.44 to 0.55 of it were measured with
// stills (a calf in slices, a shelf, bodies that fall, a bent bar).
constexpr double kLeastShare = 0.4;
// What files take at the most, in ordinary runs.
constexpr double kStillBytes = 2000, kStillBytesPerPixel = 1.05;     // with its share of the film
constexpr double kPassBytesPerPixel[] = {2.5, 0.02, 7, 9, 3, 0.02};  // in order of PicturePass
constexpr double kMeshBytesPerVertex = 400;             // as OBJ and PLY, with its two triangles
constexpr double kSkinBytesPerVertex = 140;             // in the motion file, likewise
constexpr double kPartBytes = 170e3;                    // there: of a machine's tool, grip or blade
constexpr double kBallBytes = 1e6;                      // there: of a tool that is a sphere
constexpr double kToolFileShare = 3;                    // there: of a tool's own mesh file
constexpr double kFieldBytes = 4;                       // of a vertex, there and in PLY
constexpr double kFrameBytes = 1000;                    // of poses and curves
constexpr double kBodyFrameBytes = 400;                 // of its motion
constexpr double kStageBytes = 60e3, kRunBytes = 20e3;  // of plots and records
// Of a body that is broken to its particles: of each of them, a cell's corners and, on rough faces,
// what is between these; and of a mounted mesh where cuts between them cross its edges, over the
// root of its vertices times the faces of cells that its area has.
constexpr double kBrokenVertices = 8, kRoughVertices = 26;
constexpr double kCrossings = 9, kRoughCrossings = 15;
constexpr double kCurvePointBytes = 90;  // of a flow curve in run.json
// What is kept within a stage in motion, to what is after one, but for images: 1.33 and 1.47 were
// measured (rubber of 69,742 particles that falls, copper of 17,386 that strikes).
constexpr double kMarkShare = 1.5;
// Of what rests, on top: the coarse system, as it was solved (bars of 12,221 and 46,529: both 16.5
// MB), and less of what is small.
constexpr double kCoarseBytes = 17e6, kCoarseBytesPerParticle = 1400;
// In a checkpoint, beside the matter.
constexpr double kKeptBytesPerVertex = 300, kLookBytesPerVertex = 200;
constexpr double kKeptBytesPerParticle = 40;
// A particle, for its history.
constexpr double kDampedBytes = 180, kYieldedBytes = 100, kShiftedBytes = 80;

// Of a machine as it is drawn.
double machine_bytes(const MachineSpec& machine) {
    double bytes = kPartBytes * static_cast<double>(machine.tool.size() + machine.grip.size() +
                                                    machine.blade.size());
    for (const ToolSpec& tool : machine.tool) {
        if (tool.shape == ToolShape::sphere) bytes += kBallBytes;
        std::error_code none;
        const std::uintmax_t size = tool.mesh.empty() ? 0 : fs::file_size(tool.mesh, none);
        if (!none) bytes += kToolFileShare * static_cast<double>(size);
    }
    return bytes;
}

double embedded_bytes(const TriMesh& mesh) {
    double bytes = 0;
    for (const SurfaceMaterial& material : mesh.material) {
        if (material.embedded_texture) {
            bytes += static_cast<double>(material.embedded_texture->size());
        }
    }
    return bytes;
}

// Pictures of the mesh: beside its meshes, and what its file holds in the motion file too.
double texture_bytes(const TriMesh& mesh) {
    double bytes = 2 * embedded_bytes(mesh);
    for (const SurfaceMaterial& material : mesh.material) {
        if (!material.texture.empty()) {
            std::error_code none;
            const std::uintmax_t size = fs::file_size(material.texture, none);
            if (!none) bytes += static_cast<double>(size);
        }
    }
    return bytes;
}

double picture_bytes(const RenderSettings& render, double stills) {
    const double pixels = static_cast<double>(render.width) * render.height;
    const double shrunk =
        std::min(1.0, double(kSheetPictureWidth) / std::max(render.width, render.height));
    const double on_sheet = std::min(stills, double(kSheetPictures)) * shrunk * shrunk * pixels;
    double passes = 0;
    for (const PicturePass pass : render.passes) passes += kPassBytesPerPixel[std::size_t(pass)];
    return stills * (kStillBytes + passes * pixels) +
           kStillBytesPerPixel * (stills * pixels + on_sheet);
}

// What is there to go on from, with the pictures, when that is the most: after a `stage`, and
// `within` one.
double kept_bytes(const SceneSpec& scene, double stage, double within, double pictures) {
    const auto stages = static_cast<double>(scene.stage.size());
    const bool stay = scene.output.keep_stages;
    // In the last stage one is kept of it while the next is written; they go as it ends.
    const double before = std::max(0.0, stay ? stages - 1 : std::min(stages - 1, 1.0));
    return std::max(before * stage + 2 * within, (stay ? stages : 0) * stage + pictures);
}

// What is there in the end, but for pictures and what is kept to go on from.
double written_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                     const DiskShare& of) {
    double skins = 1;  // stored: where matter may part in every frame
    double bytes = kRunBytes;
    for (const StageSpec& stage : scene.stage) {
        bytes += kStageBytes + machine_bytes(stage.machine);
        if (stage.remold) ++skins;
        if (in_motion(stage.sim.solver)) {
            bytes += kBodyFrameBytes * static_cast<double>(scene.body.size()) * stage.frames;
        }
        if (scene.breaks() || !stage.machine.blade.empty()) skins += stage.frames;
    }
    for (const InputMesh& one : input) bytes += texture_bytes(one.mesh);
    for (const BodySpec& body : scene.body) {
        for (const Material* one : body.materials()) {
            bytes += kCurvePointBytes * static_cast<double>(one->flow_curve.size());
        }
    }
    const double meshes =
        scene.output.meshes_per_frame ? of.frames : static_cast<double>(scene.stage.size());
    const double fields = kFieldBytes * static_cast<double>(scene.output.fields.size());
    return bytes + of.frames * (of.vertices * (12 + fields) + kFrameBytes) +
           of.vertices * (skins * kSkinBytesPerVertex + meshes * (kMeshBytesPerVertex + fields));
}

}  // namespace

double checkpoint_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                        const DiskShare& of) {
    const bool damps = scene.moves() && scene.damps();
    const bool shifts = scene.any_material([](const Material& m) { return m.shifts(); });
    double bytes =
        of.matter + of.vertices * kKeptBytesPerVertex +
        of.particles * (kKeptBytesPerParticle + (damps ? kDampedBytes : 0) +
                        (scene.yields() ? kYieldedBytes : 0) + (shifts ? kShiftedBytes : 0));
    for (const InputMesh& one : input) {
        if (scene.skin.kind == SkinKind::boundary) {
            bytes += kLookBytesPerVertex * static_cast<double>(one.mesh.position.size());
        }
        bytes += embedded_bytes(one.mesh);
    }
    return bytes;
}

double broken_vertices(const SceneSpec& scene, double particles, double vertices, double faces) {
    const bool is_rough = scene.skin.roughness > 0 && scene.skin.kind != SkinKind::boundary;
    return particles * (is_rough ? kRoughVertices : kBrokenVertices) +
           std::sqrt(vertices * faces) * (is_rough ? kRoughCrossings : kCrossings);
}

double disk_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input, DiskShare of) {
    if (scene.breaks()) of.vertices += broken_vertices(scene, of.particles, of.vertices, of.faces);
    double images = 0;
    for (const InputMesh& one : input) images += embedded_bytes(one.mesh);
    const double stage = checkpoint_bytes(scene, input, of);
    const bool rests =
        scene.any_stage([](const StageSpec& one) { return !in_motion(one.sim.solver); });
    const double within =
        rests ? stage + std::min(kCoarseBytes, kCoarseBytesPerParticle * of.particles)
              : kMarkShare * (stage - images) + images;
    // It is kept the first time after so long.
    const double is_kept = std::min(1.0, of.seconds / kLeastKept);
    return written_bytes(scene, input, of) +
           kept_bytes(scene, stage, is_kept * within, picture_bytes(scene.render, of.stills));
}

double least_disk_bytes(const SceneSpec& scene, const std::vector<InputMesh>& input,
                        const DiskShare& of) {
    return kLeastShare * (written_bytes(scene, input, of) + picture_bytes(scene.render, of.stills));
}

}  // namespace swage

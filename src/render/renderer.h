// SPDX-License-Identifier: GPL-3.0-or-later
// The door of the room: a scene of meshes becomes a picture. OpenGL stays behind it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/stopwatch.h"
#include "geometry/trimesh.h"
#include "render/framed_action.h"
#include "render/image.h"
#include "render/layers.h"
#include "render/settings.h"

namespace swage {

struct DrawItem {
    const TriMesh* mesh = nullptr;
    const std::vector<Vec3>* position = nullptr;  // as many as the mesh's; null: the mesh's own
    Pose world_from_mesh;
    std::optional<SurfaceMaterial> material_override;  // for the whole item
    // Stands for the ground: fades out into the backdrop away from the action, casts no shadow.
    bool endless = false;
    // Its colours tell numbers: light changes them little, so that they are the scale's.
    bool tells_numbers = false;
};

struct Picture {
    std::vector<DrawItem> item;
    double film_share = 0;  // 0 to 1, for the camera's keys
};

// Lives in one thread from construction to destruction, which may be any thread.
class Renderer {
  public:
    // `action_bounds`: the box of the whole motion, tools too, in the world (y up) [m].
    // `threads`: of the software rasteriser, 0 for all cores; the first Renderer of the process
    // decides. `framed`: by the camera; none: that box. Throws Error(output) when there is nothing
    // to draw with.
    Renderer(const RenderSettings& settings, const Box& action_bounds, double ground_height,
             int threads = 0, std::optional<FramedAction> framed = {});
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    // Meshes and positions are only read during the call. `layers`: to be told as well.
    Image draw(const Picture& picture, Layers* layers = nullptr);

    std::string renderer_string() const;

    // Adds each pass's time to the watch; slower, for passes then wait for each other. Null: off.
    void time_passes(Stopwatch* watch);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace swage

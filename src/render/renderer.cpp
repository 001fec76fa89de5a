// SPDX-License-Identifier: GPL-3.0-or-later
// One picture is five passes: normal and depth at half size; shadow maps about what is seen there;
// occlusion and shadow from these, blurred; the surfaces in full size with four samples a pixel, each already developed
// to the picture's colours; the mean of the samples. Occlusion is known before the surfaces are
// lit, so it dims only the light it should. Shading happens once a pixel and surface.
#include "render/renderer.h"

#include <algorithm>

#include "base/error.h"
#include "render/mesh_cache.h"
#include "render/picture_shaders.h"
#include "render/studio.h"
#include "render/targets.h"
#include "render/texture_cache.h"
#include "render/visibility_pass.h"

namespace swage {

namespace {

// Of the light on what tells numbers by its colours, the share that is the same everywhere.
constexpr float kEvened = 0.65f;

constexpr double kShadowReach = 4;  // [stage] about the action, in which shadows fall on it

Box world_box(const DrawItem& item) {
    Box box;
    for (const Vec3& p : item.position ? *item.position : item.mesh->position) {
        const Vec3 world = item.world_from_mesh * p;
        if (world.allFinite()) box.grow(world);
    }
    return box;
}

// The largest that lies in a flat item: middle and radius in the stage.
glm::vec4 disc_of(const DrawItem& item, const Stage& stage) {
    const Box box = box_of(item.mesh->position);
    const Vec3 size = box.size();
    const double across = size.sum() - size.maxCoeff() - size.minCoeff();
    const Vec3 middle = (item.world_from_mesh * box.center() - stage.center) / stage.radius;
    return {to_glm(middle), 0.5 * across / stage.radius};
}

// The upper side of a flat item: its normal, and how far along that it lies in the stage; zeros for
// what is not flat.
glm::vec4 plane_of(const DrawItem& item, const Stage& stage) {
    constexpr double kFlat = 0.2;
    const Box box = box_of(item.mesh->position);
    Eigen::Index thin = 0;
    const double thickness = box.size().minCoeff(&thin);
    const double across = box.size().sum() - thickness - box.size().maxCoeff();
    if (!(thickness < kFlat * across)) return glm::vec4(0);
    Vec3 normal = item.world_from_mesh.rotation * Vec3::Unit(thin);
    if (normal.y() < 0) normal = -normal;
    const Vec3 top = item.world_from_mesh * box.center() + 0.5 * thickness * normal;
    return {to_glm(normal), normal.dot(top - stage.center) / stage.radius};
}

}  // namespace

struct Renderer::Parts {
    Parts(const RenderSettings& wanted, const Box& bounds, double ground, int threads,
          std::optional<FramedAction> framed)
        : settings(wanted),
          action_bounds(bounds),
          ground_height(ground),
          stage(bounds),
          camera(wanted, framed ? std::move(*framed) : FramedAction{bounds}),
          canvas(wanted.gl, threads),
          gl(canvas.gl()),
          meshes(gl),
          textures(gl),
          bare(gl),
          visibility(gl, bare, wanted.width, wanted.height),
          surface_shaders(gl, ""),
          frame_buffer(make_buffer(gl)) {
        front = front_of(camera.at(0));
    }

    RenderSettings settings;
    Box action_bounds;
    double ground_height;
    Stage stage;
    CameraPath camera;
    double front = 0;  // azimuth of the film's first view
    Canvas canvas;
    const Gl& gl;
    MeshCache meshes;
    TextureCache textures;
    BareShapes bare;
    VisibilityPass visibility;
    SurfaceShaders surface_shaders;
    std::optional<SurfaceShaders> light_shaders;  // these and the next two when first needed
    GlHandle frame_buffer;
    PictureTargets bytes{kStillFormat.color}, light{kLightFormat.color};
    Target layered;
    std::optional<LayerShaders> layer_shaders, triangle_shaders;
    Stopwatch* watch = nullptr;

    template <typename Pass>
    void timed(const char* name, const Pass& pass) {
        if (watch == nullptr) return pass();
        const Stopwatch::Lap lap = watch->lap(name);
        pass();
        gl.Finish();
    }

    bool extend(Extent& extent, Drawable& drawable, const Vec3& eye) const;
    std::vector<Drawable> prepare(const Picture& picture, const Vec3& eye, Extent& extent);
    void draw_surfaces(const std::vector<Drawable>& drawables, bool ground, const Target& target,
                       const SurfaceShaders& by);
    const Target& target_of(PictureTargets& picture, bool multisampled);
    const Target& whole_picture(PictureTargets& picture, bool multisampled, const Shader& smooth);
    Image read_back(const Target& target) const;
    std::vector<float> read_floats(const Target& target) const;
    std::vector<float> draw_flat(const Picture& picture, const std::vector<Drawable>& drawables,
                                 bool ground, const LayerShaders& by);
    Layers draw_layers(const Picture& picture, const std::vector<Drawable>& drawables, bool ground);
    std::vector<float> draw_light(const std::vector<Drawable>& drawables, bool ground,
                                  bool multisampled);
    Image draw(const Picture& picture, Layers* layers);
};

// Returns false for what is not to be drawn: a floor without end, which from below hides everything.
bool Renderer::Parts::extend(Extent& extent, Drawable& drawable, const Vec3& eye) const {
    const DrawItem& item = *drawable.item;
    if (item.endless) {
        const glm::vec4 plane = plane_of(item, stage);
        if (plane.y > 0) {
            const double above = Vec3(plane.x, plane.y, plane.z).dot(eye - stage.center);
            const double gap = above - plane.w * stage.radius;
            if (gap > 0) extent.nearest = std::min(extent.nearest, gap);
            return gap > 0;
        }
    }
    Box own = world_box(item);
    if (own.empty()) return true;
    extent.shown.grow(own);
    extent.nearest = std::min(extent.nearest, own.gap_to(eye));
    if (item.endless) return true;
    // A tool that waits far away, or is very long, would leave nothing of the map to the action.
    if (!action_bounds.empty()) {
        const Box reach = action_bounds.widened(kShadowReach * stage.radius);
        own = {own.low.cwiseMax(reach.low), own.high.cwiseMin(reach.high)};
    }
    if (!own.empty()) drawable.casting = stage.box(own);
    return true;
}

std::vector<Drawable> Renderer::Parts::prepare(const Picture& picture, const Vec3& eye,
                                               Extent& extent) {
    meshes.begin_picture();
    std::vector<Drawable> drawables;
    extent.shown.grow(action_bounds);
    for (const DrawItem& item : picture.item) {
        if (item.mesh == nullptr || item.mesh->triangle.empty()) continue;
        Drawable drawable;
        drawable.item = &item;
        if (!extend(extent, drawable, eye)) continue;
        // Read now: loading one in the middle of a pass would unbind what the pass has bound.
        if (item.material_override) textures.texture(*item.material_override);
        for (const SurfaceMaterial& material : item.mesh->material) {
            textures.texture(material);
        }
        drawable.mesh = &meshes.prepared(*item.mesh, item.position);
        drawable.stage_from_mesh = stage.from_mesh(item.world_from_mesh, drawable.mesh->origin);
        drawables.push_back(std::move(drawable));
    }
    if (extent.shown.empty()) extent.shown.grow(stage.center);
    return drawables;
}

void Renderer::Parts::draw_surfaces(const std::vector<Drawable>& drawables, bool ground,
                                    const Target& target, const SurfaceShaders& by) {
    target.bind(gl);
    gl.Clear(GL_DEPTH_BUFFER_BIT);  // the backdrop covers every pixel
    set_unit(gl, 0, visibility.result());
    static const SurfaceMaterial plain_material;
    for (const Drawable& d : drawables) {
        const TriMesh& mesh = *d.item->mesh;
        const glm::vec4 endless = d.item->endless ? disc_of(*d.item, stage) : glm::vec4(0);
        const Culling culling(gl, d.culls);
        for (const DrawMesh::Range& range : d.mesh->split.range) {
            const bool named =
                range.material >= 0 && range.material < static_cast<int>(mesh.material.size());
            const SurfaceMaterial& material =
                d.item->material_override ? *d.item->material_override
                : named                   ? mesh.material[static_cast<std::size_t>(range.material)]
                : mesh.material.size() == 1 ? mesh.material.front()
                                            : plain_material;
            const glm::vec4 color(to_glm(material.color), 1);
            const glm::vec4 finish(material.roughness, material.metallic,
                                   material.takes_colors ? 1 : 0, material.clear);
            const GLuint texture = range.textured ? textures.texture(material) : 0;
            const Shader& shader = texture != 0 ? by.textured : by.surface;
            shader.use();
            shader.set_matrix("stage_from_mesh", glm::value_ptr(d.stage_from_mesh));
            shader.set4("material_color", glm::value_ptr(color));
            shader.set4("material_finish", glm::value_ptr(finish));
            shader.set4("endless", glm::value_ptr(endless));
            const float evened[4] = {d.item->tells_numbers ? kEvened : 0, 0, 0, 0};
            shader.set4("evened", evened);
            if (texture != 0) set_unit(gl, 1, texture);
            d.mesh->draw(gl, range);
        }
    }
    if (ground) {
        by.ground.use();
        bare.draw_ground();
    }
    gl.DepthFunc(GL_LEQUAL);
    by.backdrop.use();
    bare.cover_screen();
    gl.DepthFunc(GL_LESS);
}

const Target& Renderer::Parts::target_of(PictureTargets& picture, bool multisampled) {
    TargetFormat format{.color = picture.format, .depth_buffer = true};
    if (picture.plain.width == 0) {
        picture.plain = make_target(gl, settings.width, settings.height, format);
    }
    if (!multisampled) return picture.plain;
    format.samples = kSamples;
    if (picture.sampled.width == 0) {
        picture.sampled = make_target(gl, settings.width, settings.height, format);
    }
    return picture.sampled;
}

const Target& Renderer::Parts::whole_picture(PictureTargets& picture, bool multisampled,
                                             const Shader& smooth) {
    const Target& plain = picture.plain;
    if (multisampled) {
        gl.BindFramebuffer(GL_READ_FRAMEBUFFER, picture.sampled.framebuffer.id());
        gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, plain.framebuffer.id());
        gl.BlitFramebuffer(0, 0, plain.width, plain.height, 0, 0, plain.width, plain.height,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
        return plain;
    }
    if (picture.smoothed.width == 0) {
        picture.smoothed = make_target(gl, plain.width, plain.height, {.color = picture.format});
    }
    gl.Disable(GL_DEPTH_TEST);
    picture.smoothed.bind(gl);
    smooth.use();
    set_unit(gl, 0, plain.color.id());
    bare.cover_screen();
    gl.Enable(GL_DEPTH_TEST);
    return picture.smoothed;
}

Image Renderer::Parts::read_back(const Target& target) const {
    const std::size_t width = static_cast<std::size_t>(target.width);
    const std::size_t height = static_cast<std::size_t>(target.height);
    std::vector<std::uint8_t> rgba(4 * width * height);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer.id());
    gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl.ReadPixels(0, 0, target.width, target.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    if (gl.GetError() != GL_NO_ERROR) fail(ExitCode::output, "OpenGL failed to draw a picture");
    Image image{target.width, target.height, {}};
    image.rgb.resize(3 * width * height);
    const bool is_clear = settings.background == Background::transparent;
    if (is_clear) image.alpha.resize(width * height);
    for (std::size_t y = 0; y < height; ++y) {  // OpenGL's first row is the lowest
        const std::uint8_t* from = &rgba[4 * width * (height - 1 - y)];
        std::uint8_t* to = &image.rgb[3 * width * y];
        for (std::size_t x = 0; x < width; ++x) {
            for (std::size_t c = 0; c < 3; ++c) to[3 * x + c] = from[4 * x + c];
            if (!is_clear) continue;
            const int alpha = image.alpha[width * y + x] = from[4 * x + 3];
            for (std::size_t c = 0; c < 3 && alpha > 0; ++c) {
                const int color = (255 * from[4 * x + c] + alpha / 2) / alpha;
                to[3 * x + c] = static_cast<std::uint8_t>(std::min(color, 255));
            }
        }
    }
    return image;
}

// Rows from below.
std::vector<float> Renderer::Parts::read_floats(const Target& target) const {
    std::vector<float> rgba(4 * static_cast<std::size_t>(target.width) *
                            static_cast<std::size_t>(target.height));
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer.id());
    gl.ReadPixels(0, 0, target.width, target.height, GL_RGBA, GL_FLOAT, rgba.data());
    if (gl.GetError() != GL_NO_ERROR) fail(ExitCode::output, "OpenGL failed to draw a picture");
    return rgba;
}

std::vector<float> Renderer::Parts::draw_flat(const Picture& picture,
                                              const std::vector<Drawable>& drawables, bool ground,
                                              const LayerShaders& by) {
    if (layered.width == 0) {
        layered = make_target(gl, settings.width, settings.height, kLayerFormat);
    }
    layered.bind(gl);
    gl.ClearColor(0, 0, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const auto set_number = [](const Shader& shader, int item) {
        shader.use();
        const float number[4] = {layer_number(item), 0, 0, 0};
        shader.set4("number", number);
    };
    for (const Drawable& d : drawables) {
        set_number(by.layer, static_cast<int>(d.item - picture.item.data()));
        draw_shapes(gl, by.layer, {d});
    }
    // The ground and what stands for it go on to the horizon.
    const auto draw_plane = [&](const glm::vec4& plane, int item) {
        set_number(by.horizon, item);
        by.horizon.set4("plane", glm::value_ptr(plane));
        bare.cover_screen();
    };
    gl.DepthFunc(GL_LEQUAL);
    for (const Drawable& d : drawables) {
        if (!d.item->endless) continue;
        const glm::vec4 plane = plane_of(*d.item, stage);
        if (plane.y > 0) draw_plane(plane, static_cast<int>(d.item - picture.item.data()));
    }
    if (ground) {
        const double height = (ground_height - stage.center.y()) / stage.radius;
        draw_plane(glm::vec4(0, 1, 0, height), kGroundThere);
    }
    gl.DepthFunc(GL_LESS);
    return read_floats(layered);
}

Layers Renderer::Parts::draw_layers(const Picture& picture, const std::vector<Drawable>& drawables,
                                    bool ground) {
    if (!layer_shaders) layer_shaders.emplace(gl, "");
    Layers layers =
        layers_of(settings.width, settings.height,
                  draw_flat(picture, drawables, ground, *layer_shaders), stage.radius);
    if (!settings.has(PicturePass::motion) && !settings.has(PicturePass::piece)) return layers;
    if (!triangle_shaders) triangle_shaders.emplace(gl, "TRIANGLES");
    set_triangles(draw_flat(picture, drawables, ground, *triangle_shaders), layers);
    std::vector<const DrawMesh*> drawn(picture.item.size(), nullptr);
    for (const Drawable& d : drawables) drawn[d.item - picture.item.data()] = &d.mesh->split;
    for (std::size_t i = 0; i < layers.triangle.size(); ++i) {
        int& triangle = layers.triangle[i];
        if (triangle < 0) continue;
        const DrawMesh& split = *drawn.at(static_cast<std::size_t>(layers.item[i]));
        triangle = static_cast<int>(split.triangle.at(static_cast<std::size_t>(triangle)));
    }
    return layers;
}

std::vector<float> Renderer::Parts::draw_light(const std::vector<Drawable>& drawables, bool ground,
                                               bool multisampled) {
    if (!light_shaders) light_shaders.emplace(gl, "LINEAR");
    draw_surfaces(drawables, ground, target_of(light, multisampled), *light_shaders);
    return from_above(settings.width, settings.height,
                      read_floats(whole_picture(light, multisampled, light_shaders->smooth)));
}

Image Renderer::Parts::draw(const Picture& picture, Layers* layers) {
    canvas.make_current();
    const View view = camera.at(picture.film_share);
    Extent extent;
    std::vector<Drawable> drawables;
    timed("send", [&] { drawables = prepare(picture, view.eye, extent); });
    std::size_t triangles = 0;
    for (const Drawable& d : drawables) triangles += d.mesh->split.index.size() / 3;
    const bool multisampled =
        triangles <= kMostMultisampledTriangles &&
        static_cast<long>(settings.width) * settings.height <= kMostMultisampledPixels;

    const bool eye_is_outside = !extent.shown.contains(view.eye);
    for (Drawable& d : drawables) d.culls = d.mesh->closed && eye_is_outside;
    FrameBlock frame = frame_block(settings, stage, extent, view, ground_height, front);
    const auto tell_shaders = [&] {
        gl.BindBuffer(GL_UNIFORM_BUFFER, frame_buffer.id());
        gl.BufferData(GL_UNIFORM_BUFFER, sizeof frame, &frame, GL_STREAM_DRAW);
        gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer.id());
    };
    tell_shaders();
    // From below the ground would hide everything.
    const bool ground = settings.ground && view.eye.y() > ground_height &&
                        std::none_of(picture.item.begin(), picture.item.end(),
                                     [](const DrawItem& item) { return item.endless; });

    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_LESS);
    timed("depth", [&] { visibility.draw_depth(drawables, ground); });
    timed("shadow", [&] {
        const Mat3 from_light = world_from_key_light(settings.light, front);
        const ShadowMaps maps = visibility.fit_shadows(drawables, frame, from_light);
        frame.set_shadows(maps);
        tell_shaders();
        visibility.draw_shadows(drawables, maps, from_light);
    });
    timed("visibility", [&] { visibility.draw_visibility(); });
    timed("surfaces", [&] {
        draw_surfaces(drawables, ground, target_of(bytes, multisampled), surface_shaders);
    });
    const Target* whole = nullptr;
    timed("resolve", [&] { whole = &whole_picture(bytes, multisampled, surface_shaders.smooth); });
    Image image;
    timed("read back", [&] { image = read_back(*whole); });
    if (layers != nullptr) {
        timed("layers", [&] { *layers = draw_layers(picture, drawables, ground); });
        if (settings.has(PicturePass::beauty)) {
            timed("light", [&] { layers->beauty = draw_light(drawables, ground, multisampled); });
        }
    }
    return image;
}

Renderer::Renderer(const RenderSettings& settings, const Box& action_bounds, double ground_height,
                   int threads, std::optional<FramedAction> framed)
    : parts_(std::make_unique<Parts>(settings, action_bounds, ground_height, threads,
                                     std::move(framed))) {}

Renderer::~Renderer() {
    try {
        parts_->canvas.make_current();  // another renderer's context would lose its objects
    } catch (const Error&) {
        // The context is gone, and with it what it held.
    }
}

Image Renderer::draw(const Picture& picture, Layers* layers) {
    return parts_->draw(picture, layers);
}

std::string Renderer::renderer_string() const { return parts_->canvas.renderer_string(); }

void Renderer::time_passes(Stopwatch* watch) { parts_->watch = watch; }

}  // namespace swage

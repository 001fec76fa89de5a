// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/glb_export.h"

#include <algorithm>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/file_contents.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/portable_math.h"
#include "base/progress.h"
#include "base/text.h"
#include "geometry/frame_changes.h"
#include "geometry/picture_kind.h"
#include "pipeline/free_room.h"
#include "pipeline/glb_skin.h"
#include "pipeline/json.h"
#include "pipeline/made_folder.h"
#include "pipeline/signals.h"
#include "pipeline/view_track.h"
#include "render/image_read.h"
#include "render/png.h"
#include "skin/cut_layout.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// Frames in which a body has one skin.
struct Segment {
    int skin, first, last;
    std::size_t vertices = 0;
    bool has_normals = false;
    GlbBounds bounds = {};
    Box box = {};                     // all along
    std::vector<int> moved = {};      // frames in which its shape is another than in the one before
    std::vector<GlbBounds> way = {};  // of each, from the first frame's shape
};

// A skin in its first frame.
struct Base {
    const Segment* of = nullptr;
    std::optional<GlbSurface> surface;
    std::vector<Vec3> place, normal;
};

class GlbExporter {
  public:
    GlbExporter(const FrameStore& store, const ExportScene& scene, const FrameRange& frames)
        : store_(store), scene_(scene), frames_(frames), machines_(store, scene.shown(), frames) {}

    ExportOutcome write(const fs::path& file) {
        look_at_all();
        const std::size_t root = add_node({{"name", scene_.name}});
        document()["scene"] = 0;
        document()["scenes"] = {{{"name", scene_.name}, {"nodes", {root}}}};
        if (scene_.render.up != Up::y) {
            node(root)["rotation"] = numbers(drawn_from_up(scene_.render.up));
        }
        for (std::size_t b = 0; b < body_.size(); ++b) add_body(root, b);
        add_machines(root);
        add_camera(root);
        add_materials();
        if (!channel_.empty()) {
            document()["animations"] = {
                {{"name", scene_.name}, {"channels", channel_}, {"samplers", sampler_}}};
        }
        const double room = free_disk(fs::absolute(file));
        if (glb_.bytes() > room) {
            log_warning("{}: would take about {}, and {} of disk is free", file.string(),
                        bytes_text(glb_.bytes()), bytes_text(room));
        }
        progress_.emplace("export", samples_);
        samples_ = 0;
        glb_.write(file);
        return {body_.size(), machines_.count(), fs::file_size(file), glb_.bytes(), {}};
    }

  private:
    Json& document() { return glb_.document(); }
    Json& node(std::size_t number) { return document()["nodes"][number]; }
    std::size_t add_node(Json node) {
        document()["nodes"].push_back(std::move(node));
        return document()["nodes"].size() - 1;
    }
    std::size_t add_node(std::size_t parent, Json of) {
        const std::size_t number = add_node(std::move(of));
        node(parent)["children"].push_back(number);
        return number;
    }
    static Json numbers(const Quat& turn) {
        const Eigen::Vector4f q = turn.normalized().coeffs().cast<float>();
        return {q[0], q[1], q[2], q[3]};
    }
    float time(int frame) const {
        return static_cast<float>((frame - frames_.first) / scene_.render.frame_rate.value());
    }

    void animate(std::size_t node, const char* path, const char* between,
                 const std::vector<int>& frame, int output) {
        std::vector<float> times;
        for (int f : frame) times.push_back(time(f));
        channel_.push_back(
            {{"sampler", sampler_.size()}, {"target", {{"node", node}, {"path", path}}}});
        sampler_.push_back(
            {{"input", glb_.add_times(times)}, {"output", output}, {"interpolation", between}});
    }

    // Something of so many numbers that the frames from the first on have.
    template <int kWidth>
    void animate(std::size_t node, const char* path, Between between, int first,
                 const std::vector<Eigen::Matrix<float, kWidth, 1>>& of_frame) {
        const std::vector<int> frame = changes(of_frame, first, between);
        if (frame.size() < 2) return;
        std::vector<float> value;
        for (const int f : frame) {
            const auto& now = of_frame[std::size_t(f - first)];
            value.insert(value.end(), now.begin(), now.end());
        }
        animate(node, path, between == Between::held ? "STEP" : "LINEAR", frame,
                glb_.add_numbers(value, kWidth));
    }

    // Readers know no other way to hide something for a while than to make it nothing.
    void show(std::size_t of, const std::vector<char>& is_seen) {
        std::vector<Eigen::Vector3f> scale;
        for (const char seen : is_seen) scale.push_back(Eigen::Vector3f::Constant(seen ? 1 : 0));
        if (!is_seen[0]) node(of)["scale"] = {0, 0, 0};
        animate(of, "scale", Between::held, frames_.first, scale);
    }

    void move(std::size_t of, int first, const std::vector<Pose>& pose) {
        std::vector<Eigen::Vector3f> place;
        for (const Pose& now : pose) place.push_back(now.translation.cast<float>());
        const std::vector<Eigen::Vector4f> turn = steady_turns(pose);
        node(of)["translation"] = std::vector<float>(place[0].begin(), place[0].end());
        node(of)["rotation"] = std::vector<float>(turn[0].begin(), turn[0].end());
        animate(of, "translation", Between::straight, first, place);
        animate(of, "rotation", Between::straight, first, turn);
    }

    GlbSurface surface_of(int skin) {
        TriMesh mesh = store_.skin(skin);
        lay_out_cuts(mesh);
        return {std::move(mesh), looks_};
    }

    void look_at_all() {
        std::vector<Base> base;
        std::vector<std::uint64_t> shape;
        for (int frame = frames_.first; frame <= frames_.last; ++frame) {
            throw_if_interrupted();
            const StoredFrame stored = store_.frame(frame - 1);
            machines_.look_at(frame, stored, looks_);
            body_.resize(std::max(body_.size(), stored.body.size()));
            base.resize(body_.size()), shape.resize(body_.size());
            for (std::size_t b = 0; b < stored.body.size(); ++b) {
                const StoredBody& now = stored.body[b];
                Hasher hash;
                for (const Vec3& p : now.position) {
                    const Eigen::Vector3f at = p.cast<float>();
                    hash.add_bytes(at.data(), 3 * sizeof(float));
                }
                if (body_[b].empty() || body_[b].back().skin != now.skin) {
                    begin(body_[b], frame, now, base[b]);
                } else if (hash.value() != shape[b]) {
                    Segment& segment = body_[b].back();
                    const std::vector<Vec3> place = base[b].surface->places(now.position);
                    segment.moved.push_back(frame);
                    segment.way.push_back(bounds_of(way(base[b].place, place)));
                }
                if (shape[b] != hash.value() || body_[b].back().first == frame) {
                    for (const Vec3& p : now.position) body_[b].back().box.grow(p);
                }
                body_[b].back().last = frame;
                shape[b] = hash.value();
            }
        }
    }
    void begin(std::vector<Segment>& segments, int frame, const StoredBody& now, Base& base) {
        base.surface = surface_of(now.skin);
        base.place = in_floats(base.surface->places(now.position));
        is_open_ = is_open_ || !base.surface->is_closed();
        Segment& segment = segments.emplace_back(Segment{now.skin, frame, frame});
        segment.vertices = base.surface->count();
        segment.has_normals = base.surface->has_normals();
        segment.bounds = bounds_of(base.place);
    }

    // Of a segment, for what is written of it.
    const Base& base_of(std::size_t body, const Segment& segment) {
        if (base_.of == &segment) return base_;
        base_ = {&segment, surface_of(segment.skin), {}, {}};
        const std::vector<Vec3> place = places(body, segment.first);
        base_.place = in_floats(base_.surface->places(place));
        if (segment.has_normals) base_.normal = in_floats(base_.surface->normals(place));
        return base_;
    }
    std::vector<Vec3> places(std::size_t body, int frame) {
        throw_if_interrupted();
        progress_->advance(++samples_);
        return std::move(store_.frame(frame - 1).body.at(body).position);
    }

    // Accessors of places, and of normals where there are any.
    Json add_shape(const Segment& segment, const GlbBounds& bounds, const GlbFile::Fill& fill) {
        ++samples_;
        std::vector<GlbFloats> floats = {{segment.vertices, 3, bounds.low, bounds.high}};
        if (segment.has_normals) floats.push_back({segment.vertices, 3});
        const std::vector<int> accessor = glb_.add(floats, GlbFile::Use::vertices, fill);
        Json attributes = {{"POSITION", accessor[0]}};
        if (segment.has_normals) attributes["NORMAL"] = accessor[1];
        return attributes;
    }

    void add_body(std::size_t root, std::size_t body) {
        const std::string name = scene_.body_name(body);
        const std::vector<Segment>& segments = body_[body];
        if (segments.size() == 1) {
            add_segment(add_node(root, {{"name", name}}), body, segments[0], name);
            return;
        }
        const std::size_t parent = add_node(root, {{"name", name}});
        for (std::size_t n = 0; n < segments.size(); ++n) {
            const std::string own = fmt::format("{}-{}", name, n + 1);
            const std::size_t at = add_node(parent, {{"name", own}});
            add_segment(at, body, segments[n], own);
            std::vector<char> is_seen;
            for (int f = frames_.first; f <= frames_.last; ++f) {
                is_seen.push_back(segments[n].first <= f && f <= segments[n].last);
            }
            show(at, is_seen);
        }
    }

    void add_segment(std::size_t at, std::size_t body, const Segment& segment,
                     const std::string& name) {
        if (segment.vertices == 0) return;
        const Json base = add_shape(segment, segment.bounds, [this, body, &segment] {
            const Base& own = base_of(body, segment);
            return glb_bytes(own.place) + glb_bytes(own.normal);
        });
        Json primitives = surface_of(segment.skin).primitives(glb_, base, looks_);
        Json targets = Json::array(), names = Json::array();
        for (std::size_t n = 0; n < segment.moved.size(); ++n) {
            const int frame = segment.moved[n];
            targets.push_back(add_shape(segment, segment.way[n], [this, body, &segment, frame] {
                const Base& own = base_of(body, segment);
                const std::vector<Vec3> place = places(body, frame);
                std::string bytes = glb_bytes(way(own.place, own.surface->places(place)));
                if (segment.has_normals) {
                    bytes += glb_bytes(way(own.normal, own.surface->normals(place)));
                }
                return bytes;
            }));
            names.push_back(fmt::format("frame {}", frame + scene_.render.first_frame - 1));
        }
        Json mesh = {{"name", name}};
        if (!targets.empty()) {
            for (Json& one : primitives) one["targets"] = targets;
            mesh["weights"] = std::vector<int>(targets.size(), 0);
            mesh["extras"] = {{"targetNames", names}};
            animate_shapes(at, segment);
        }
        mesh["primitives"] = std::move(primitives);
        document()["meshes"].push_back(std::move(mesh));
        node(at)["mesh"] = document()["meshes"].size() - 1;
    }

    // In each frame the last of its shapes counts alone, and between two the one goes into the
    // other.
    void animate_shapes(std::size_t at, const Segment& segment) {
        const std::size_t count = segment.moved.size();
        std::vector<int> frame;
        std::vector<float> weight;
        const auto keep = [&](int now, std::size_t shape) {  // 0: the first frame's
            frame.push_back(now);
            weight.resize(weight.size() + count, 0.0f);
            if (shape > 0) weight[weight.size() - count + shape - 1] = 1;
        };
        keep(segment.first, 0);
        for (std::size_t n = 0; n < count; ++n) {
            if (frame.back() < segment.moved[n] - 1) keep(segment.moved[n] - 1, n);
            keep(segment.moved[n], n + 1);
        }
        animate(at, "weights", "LINEAR", frame, glb_.add_numbers(weight, 1));
    }

    void add_machines(std::size_t root) {
        for (const MachineTracks::Machine& machine : machines_.all()) {
            if (machine.part.empty()) continue;
            const std::size_t group = add_node(
                root, {{"name", stage_of_machine(scene_.stage, machine.id, machine.first)}});
            show(group, machine.is_seen);
            for (const MachineTracks::Part& part : machine.part) {
                const std::size_t at = add_node(group, {{"name", part.drawn.name}});
                const TriMesh& drawn = part.drawn.surface;
                const GlbSurface surface(drawn, std::vector<int>(drawn.triangle.size(), part.look));
                is_open_ = is_open_ || !surface.is_closed();
                Segment segment{-1, 0, 0};
                segment.vertices = surface.count();
                segment.has_normals = surface.has_normals();
                const std::vector<Vec3> placed = in_floats(surface.places(drawn.position));
                segment.bounds = bounds_of(placed);
                std::string bytes = glb_bytes(placed);
                if (segment.has_normals) bytes += glb_bytes(surface.normals(drawn.position));
                const Json base =
                    add_shape(segment, segment.bounds, [all = std::move(bytes)] { return all; });
                --samples_;
                document()["meshes"].push_back(
                    {{"name", part.drawn.name},
                     {"primitives", surface.primitives(glb_, base, looks_)}});
                node(at)["mesh"] = document()["meshes"].size() - 1;
                move(at, machine.first, part.pose);
            }
        }
    }

    void add_camera(std::size_t root) {
        Box seen = machines_.box(false), all = machines_.box(true);
        for (const auto& segments : body_) {
            for (const Segment& segment : segments) {
                seen.grow(segment.box), all.grow(segment.box);
            }
        }
        const Shot shot = shot_of(store_, scene_.render);
        const ViewTrack view = view_track(shot, store_.frame_count(), frames_, seen, all);
        const std::size_t at = add_node(root, {{"name", "camera"}});
        document()["cameras"] = {
            {{"name", "camera"},
             {"type", "perspective"},
             {"perspective",
              {{"aspectRatio", static_cast<float>(view.lens.tangent_x / view.lens.tangent_y)},
               {"yfov", static_cast<float>(2 * portable::atan(view.lens.tangent_y))},
               {"znear", static_cast<float>(view.near)},
               {"zfar", static_cast<float>(view.far)}}}}};
        node(at)["camera"] = 0;
        move(at, frames_.first, view.pose);
    }

    void add_materials() {
        std::map<std::string, int> texture;  // by the image
        for (const MeshLooks::Look& look : looks_.all()) {
            const SurfaceMaterial& of = look.material;
            Json surface = {
                {"baseColorFactor", {of.color[0], of.color[1], of.color[2], 1 - of.clear}},
                {"metallicFactor", of.metallic},
                {"roughnessFactor", of.roughness}};
            if (has_image(of)) {
                std::string image = image_of(of);
                const auto [at, is_new] = texture.try_emplace(image, -1);
                if (is_new) {
                    const std::string_view kind = picture_kind(image)->name;
                    at->second = glb_.add_image(std::move(image),
                                                kind == "PNG" ? "image/png" : "image/jpeg");
                }
                surface["baseColorTexture"] = {{"index", at->second}};
            }
            Json material = {{"name", name_of(of)}, {"pbrMetallicRoughness", std::move(surface)}};
            if (of.clear > 0) material["alphaMode"] = "BLEND";
            if (is_open_) material["doubleSided"] = true;
            document()["materials"].push_back(std::move(material));
        }
    }
    // A PNG or JPEG: it holds no others.
    static std::string image_of(const SurfaceMaterial& of) {
        std::string bytes;
        if (of.embedded_texture != nullptr) {
            bytes = *of.embedded_texture;
        } else {
            std::string why;
            std::optional<std::string> read = file_contents(of.texture, kAnyLength, &why);
            if (!read) fail(ExitCode::output, "{}: {}", of.texture.string(), why);
            bytes = std::move(*read);
        }
        const std::optional<PictureKind> kind = picture_kind(bytes);
        if (kind && (kind->name == "PNG" || kind->name == "JPEG")) return bytes;
        return encode_png(decode_image(bytes, of.texture.string()));
    }

    const FrameStore& store_;
    const ExportScene& scene_;
    const FrameRange frames_;
    MachineTracks machines_;
    MeshLooks looks_{true};
    GlbFile glb_;
    std::vector<std::vector<Segment>> body_;
    Json channel_ = Json::array(), sampler_ = Json::array();
    bool is_open_ = false;
    Base base_;  // as last asked for
    std::optional<Progress> progress_;
    int samples_ = 0;  // of shapes: in all, then as far as they are written
};

}  // namespace

ExportOutcome export_glb(const FrameStore& store, const ExportScene& scene,
                         const FrameRange& frames, const fs::path& file) {
    refuse_frames_beyond(store.frame_count(), frames, scene.render.first_frame);
    refuse_foreign(file, is_our_glb);
    const MadeFolder folder(fs::absolute(file).parent_path());
    return GlbExporter(store, scene, frames).write(file);
}

}  // namespace swage

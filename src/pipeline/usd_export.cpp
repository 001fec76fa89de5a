// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/usd_export.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/file_contents.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/text.h"
#include "geometry/edges.h"
#include "geometry/files_beside.h"
#include "geometry/shown_color.h"
#include "geometry/usd_look.h"
#include "geometry/usd_mesh.h"
#include "geometry/usd_text.h"
#include "geometry/usd_time.h"
#include "pipeline/free_room.h"
#include "pipeline/made_folder.h"
#include "pipeline/piece_track.h"
#include "pipeline/run_directory.h"
#include "pipeline/signals.h"
#include "pipeline/skin_track.h"
#include "pipeline/skin_velocity.h"
#include "pipeline/usd_camera.h"
#include "pipeline/usd_machine.h"
#include "skin/cut_layout.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBegin = "#usda 1.0\n(\n    doc = \"A run of swage";

// Bytes of what is written as text, about.
constexpr double kPlaceBytes = 38, kNormalBytes = 30, kCornerBytes = 13, kFaceBytes = 3;
constexpr double kCornerBytesInImage = 20, kColorBytes = 32, kFieldBytes = 13;
constexpr double kVelocityBytes = 38;
constexpr double kCornerBytesOfColor = 6;

struct Skin {
    int id = -1;
    TriMesh mesh;
    PolygonCorners polygons;
};

class Exporter {
  public:
    Exporter(const FrameStore& store, const ExportScene& scene, const FrameRange& frames)
        : store_(store), scene_(scene), frames_(frames), machines_(store, scene.shown(), frames) {
        std::set<std::string> taken;
        root_ = usd_identifier(scene.name, taken);
    }

    ExportOutcome write(const fs::path& file) {
        look_at_all();
        int samples = 0;
        for (const SkinTrack& track : track_) {
            samples += static_cast<int>(moves(track).size()) * (track.has_normals ? 2 : 1);
        }
        for (const std::string& name : looks_.without_colors()) {
            log_warning("material '{}': in USD its image is without the vertex colours", name);
        }
        progress_.emplace("export", samples);
        const double expected = expected_bytes(), room = free_disk(fs::absolute(file));
        if (expected > room) {
            log_warning("{}: would take about {}, and {} of disk is free", file.string(),
                        bytes_text(expected), bytes_text(room));
        }
        FilesBeside beside;
        const std::vector<std::string> image = copy_textures(file, looks_.materials(), beside);
        UsdText out(file, later());
        write_head(out);
        out.open(fmt::format("def Xform \"{}\"", root_));
        write_turn(out);
        std::set<std::string> taken = {"camera", "key_lamp", "machine", "materials"};
        const std::string materials = "/" + root_ + "/materials";
        if (!looks_.all().empty()) {
            out.open("def Scope \"materials\"");
            write_usd_looks(out, looks_, materials, image);
            out.close();
        }
        for (const std::string& identifier : usd_identifiers(looks_)) {
            look_.push_back(materials + "/" + identifier);
        }
        for (std::size_t b = 0; b < track_.size(); ++b) {
            track_[b].identifier = usd_identifier(track_[b].name, taken);
            write_body(out, b);
        }
        write_usd_machines(out, machines_, scene_.stage, look_);
        write_view(out);
        out.close();
        out.finish();
        beside.stay();
        ExportOutcome outcome{track_.size(), machines_.count(), fs::file_size(file), expected, {}};
        for (const std::string& one : std::set(image.begin(), image.end())) {
            if (!one.empty()) outcome.image.push_back(one);
        }
        return outcome;
    }

  private:
    const Skin& skin(std::size_t body, int frame) {
        const int id = track_[body].skin[std::size_t(frame - frames_.first)];
        if (skin_.id != id) {
            skin_.mesh = store_.skin(id);
            lay_out_cuts(skin_.mesh);
            skin_.polygons = rejoin_polygons(skin_.mesh);
            skin_.id = id;
        }
        return skin_;
    }
    std::vector<Vec3> places(std::size_t body, int frame) {
        throw_if_interrupted();
        progress_->advance(++samples_);
        return std::move(store_.frame(frame - 1).body.at(body).position);
    }

    void look_at_all() {
        for (int frame = frames_.first; frame <= frames_.last; ++frame) {
            throw_if_interrupted();
            const StoredFrame stored = store_.frame(frame - 1);
            track_.resize(std::max(track_.size(), stored.body.size()));
            machines_.look_at(frame, stored, looks_);
            for (std::size_t b = 0; b < stored.body.size(); ++b) {
                track_[b].add(stored.body[b]);
                std::vector<std::size_t>& groups = track_[b].smooth_groups;
                groups.push_back(groups.empty() ? 0 : groups.back());
                if (is_new_skin(track_[b].skin)) look_at_skin(track_[b], skin(b, frame));
            }
        }
        for (std::size_t b = 0; b < track_.size(); ++b) {
            track_[b].name = scene_.body_name(b);
        }
    }
    static bool is_new_skin(const std::vector<int>& skin) {
        return skin.size() < 2 || skin.back() != skin[skin.size() - 2];
    }
    void look_at_skin(SkinTrack& track, const Skin& skin) {
        for (const int look : looks_.of_polygons(skin.mesh, skin.polygons)) {
            if (look < 0) track.all_have_looks = false;
            if (look < 0) continue;
            const auto known = std::find(track.look.begin(), track.look.end(), look);
            const auto at = std::size_t(known - track.look.begin());
            if (known == track.look.end()) {
                track.look.push_back(look);
                track.faces.push_back(0);
            }
            ++track.faces[at];
        }
        track.smooth_groups.back() = std::size_t(skin.mesh.smooth_group_count);
        const double corners = double(skin.polygons.corner.size());
        track.skin_bytes += kFaceBytes * double(skin.polygons.count()) + kCornerBytes * corners;
        if (!skin.mesh.triangle_uv.empty()) track.skin_bytes += kCornerBytesInImage * corners;
        track.is_open = track.is_open || !is_closed(skin.mesh);
        track.has_uv = track.has_uv || !skin.mesh.triangle_uv.empty();
        if (!skin.mesh.position_color.empty()) {
            track.has_colors = true;
            const bool at_corners = !colors_of_positions(skin.mesh);
            track.has_corner_colors = track.has_corner_colors || at_corners;
            track.skin_bytes += kColorBytes * double(skin.mesh.position.size());
            if (at_corners) track.skin_bytes += kCornerBytesOfColor * corners;
        }
        track.has_normals =
            track.has_normals && skin.mesh.triangle_smooth.size() == skin.mesh.triangle.size();
    }

    double expected_bytes() const {
        double bytes = 0;
        for (const SkinTrack& track : track_) {
            const auto sum = [&](const std::vector<std::size_t>& count,
                                 const std::vector<int>& frames) {
                double all = 0;
                for (const int frame : frames) {
                    all += double(count.at(std::size_t(frame - frames_.first)));
                }
                return all;
            };
            bytes += track.skin_bytes + kPlaceBytes * sum(track.vertices, moves(track));
            if (track.changes_faces()) {
                bytes += kVelocityBytes * sum(track.vertices, moves(track));
            }
            if (track.has_normals) bytes += kNormalBytes * sum(track.smooth_groups, moves(track));
            for (const auto& field : track.field) {
                bytes += kFieldBytes *
                         sum(track.vertices, changes(field, frames_.first, Between::straight));
            }
        }
        return bytes;
    }

    // What frames are called beyond their numbers from 1 on.
    int later() const { return scene_.render.first_frame - 1; }

    void write_head(UsdText& out) const {
        const std::string rate = fmt::format("{}", scene_.render.frame_rate.value());
        out.line(
            fmt::format("{}, {}\"\n"
                        "    defaultPrim = \"{}\"\n"
                        "    endTimeCode = {}\n"
                        "    framesPerSecond = {}\n"
                        "    metersPerUnit = 1\n"
                        "    startTimeCode = {}\n"
                        "    timeCodesPerSecond = {}\n"
                        "    upAxis = \"{}\"\n"
                        ")\n",
                        kBegin, kVersion, root_, frames_.last + later(), rate,
                        frames_.first + later(), rate, scene_.render.up == Up::z ? "Z" : "Y"));
    }

    // In USD y or z is upward: else the scene is turned, as pictures of it are.
    void write_turn(UsdText& out) const {
        if (scene_.render.up == Up::y || scene_.render.up == Up::z) return;
        const Mat3 turn = drawn_from_up(scene_.render.up).toRotationMatrix().array().round() + 0.0;
        std::string rows;
        for (int axis = 0; axis < 3; ++axis) {  // of row vectors
            rows += fmt::format("({}, {}, {}, 0), ", turn(0, axis), turn(1, axis), turn(2, axis));
        }
        out.line("matrix4d xformOp:transform = ( " + rows +
                 "(0, 0, 0, 1) )\nuniform token[] xformOpOrder = [\"xformOp:transform\"]");
    }

    void write_body(UsdText& out, std::size_t body) {
        const SkinTrack& track = track_[body];
        out.open(
            usd_prim("Mesh", track.name, track.identifier, track.look.empty() ? "" : kUsdBinds));
        if (track.is_open) out.line("uniform bool doubleSided = 1");
        const std::vector<int> moves = this->moves(track);
        out.value("float3[] extent", "", moves, [&](int frame) {
            const auto& extent = track.extent[std::size_t(frame - frames_.first)];
            out.list(2, [&](std::size_t end) { out.vector(extent[end]); });
        });
        write_faces(out, body);
        out.line("uniform token orientation = \"rightHanded\"");
        out.value("point3f[] points", "", moves, [&](int frame) {
            const std::vector<Vec3> place = places(body, frame);
            out.list(place.size(), [&](std::size_t i) { out.vector<3>(place[i].cast<float>()); });
        });
        if (track.changes_faces()) write_velocities(out, body, moves);
        write_colors(out, body);
        if (track.has_normals) write_normals(out, body, moves);
        if (track.has_uv) write_uv(out, body);
        write_fields(out, body);
        write_pieces(out, body);
        out.line("uniform token subdivisionScheme = \"none\"");
        write_looks(out, body);
        out.close();
    }

    // At the times of the points, without which readers do not take them.
    void write_velocities(UsdText& out, std::size_t body, const std::vector<int>& moves) {
        out.value("vector3f[] velocities", "", moves, [&](int frame) {
            throw_if_interrupted();
            const std::vector<Vec3> velocity =
                skin_velocity(store_, body, frame, scene_.render.frame_rate.value());
            out.list(velocity.size(),
                     [&](std::size_t i) { out.vector<3>(velocity[i].cast<float>()); });
        });
    }

    // Of a body that comes apart in these frames; numbers as in `pieces.json`.
    void write_pieces(UsdText& out, std::size_t body) {
        if (!track_[body].changes_faces()) return;
        if (!pieces_) pieces_.emplace(store_, scene_.piece);
        bool comes_apart = false;
        for (int p = 1; p < pieces_->count(body); ++p) {
            comes_apart = comes_apart || pieces_->first_frame(body, p) <= frames_.last;
        }
        if (!comes_apart) return;
        out.value("int[] primvars:piece", "uniform", new_skins(body, Between::held),
                  [&](int frame) {
                      const Skin& now = skin(body, frame);
                      const std::vector<int> piece = pieces_->of_triangles(body, now.id, now.mesh);
                      out.list(now.polygons.count(), [&](std::size_t p) {
                          const int corner = now.polygons.corner[now.polygons.first[p]];
                          out.number(piece.at(std::size_t(corner / 3)) + 1);
                      });
                  });
    }

    // Camera and lamp of the stills.
    void write_view(UsdText& out) const {
        Box seen = machines_.box(false), all = machines_.box(true);
        for (const SkinTrack& track : track_) {
            for (const auto& extent : track.extent) {
                for (const Float3& end : extent) {
                    seen.grow(end.cast<double>());
                    all.grow(end.cast<double>());
                }
            }
        }
        const Shot shot = shot_of(store_, scene_.render);
        write_usd_view(out, shot, frames_.first,
                       view_track(shot, store_.frame_count(), frames_, seen, all));
    }

    std::vector<int> moves(const SkinTrack& track) const {
        return changes(track.shape, frames_.first, Between::straight);
    }
    std::vector<int> new_skins(std::size_t body, Between between) const {
        return changes(track_[body].skin, frames_.first, between);
    }

    void write_faces(UsdText& out, std::size_t body) {
        const std::vector<int> times = new_skins(body, Between::held);
        out.value("int[] faceVertexCounts", "", times, [&](int frame) {
            const std::vector<std::size_t>& first = skin(body, frame).polygons.first;
            out.list(first.size() - 1,
                     [&](std::size_t p) { out.number(static_cast<int>(first[p + 1] - first[p])); });
        });
        out.value("int[] faceVertexIndices", "", times, [&](int frame) {
            const Skin& now = skin(body, frame);
            out.list(now.polygons.corner.size(), [&](std::size_t i) {
                const int corner = now.polygons.corner[i];
                out.number(now.mesh.triangle[corner / 3][corner % 3]);
            });
        });
    }

    // USD's are linear, as those of meshes here are. Without those of vertices one stands for all.
    void write_colors(UsdText& out, std::size_t body) {
        const SkinTrack& track = track_[body];
        const std::string name = "color3f[] primvars:displayColor";
        const auto put = [&](const std::vector<Float3>& color) {
            out.list(color.size(), [&](std::size_t i) { out.vector(color[i]); });
        };
        if (!track.has_colors) {
            const int look = track.main_look();
            const SurfaceMaterial main =
                look < 0 ? SurfaceMaterial() : looks_.all()[std::size_t(look)].material;
            out.value(name, "constant", {frames_.first},
                      [&](int) { put({main.color.cast<float>()}); });
            return;
        }
        const std::vector<int> times = new_skins(body, Between::straight);
        if (!track.has_corner_colors) {
            out.value(name, "vertex", times,
                      [&](int frame) { put(*colors_of_positions(skin(body, frame).mesh)); });
            return;
        }
        const auto colors = [&](int frame) {
            const Skin& now = skin(body, frame);
            return corner_colors(now.mesh, now.polygons);
        };
        out.value(name, kUsdOfCorners, times, [&](int frame) { put(colors(frame).value); });
        out.value("int[] primvars:displayColor:indices", "", new_skins(body, Between::held),
                  [&](int frame) {
                      const std::vector<int> index = colors(frame).index;
                      out.list(index.size(), [&](std::size_t i) { out.number(index[i]); });
                  });
    }

    void write_normals(UsdText& out, std::size_t body, const std::vector<int>& moves) {
        out.value("normal3f[] primvars:normals", kUsdOfCorners, moves, [&](int frame) {
            const std::vector<Vec3> place = places(body, frame);
            const Skin& now = skin(body, frame);
            write_usd_normals(out, now.mesh, place, corner_normals(now.mesh, now.polygons));
        });
        out.value(
            "int[] primvars:normals:indices", "", new_skins(body, Between::held), [&](int frame) {
                const Skin& now = skin(body, frame);
                const CornerValues known = corner_normals(now.mesh, now.polygons);
                out.list(known.index.size(), [&](std::size_t i) { out.number(known.index[i]); });
            });
    }

    // What has none lies at the last of them, (0, 0).
    void write_uv(UsdText& out, std::size_t body) {
        const auto values = [&](const Skin& now) {
            return CornerValues(now.mesh.triangle_uv, now.mesh.uv.size(), now.polygons);
        };
        out.value(
            "texCoord2f[] primvars:st", kUsdOfCorners, new_skins(body, Between::straight),
            [&](int frame) {
                const Skin& now = skin(body, frame);
                const CornerValues known = values(now);
                out.list(known.used.size() + 1, [&](std::size_t i) {
                    const bool is_last = i == known.used.size();
                    out.vector<2>(
                        (is_last ? Vec2(Vec2::Zero()) : now.mesh.uv[known.used[i]]).cast<float>());
                });
            });
        out.value("int[] primvars:st:indices", "", new_skins(body, Between::held), [&](int frame) {
            const CornerValues known = values(skin(body, frame));
            const int none = static_cast<int>(known.used.size());
            out.list(known.index.size(), [&](std::size_t i) {
                out.number(known.index[i] < 0 ? none : known.index[i]);
            });
        });
    }

    void write_fields(UsdText& out, std::size_t body) {
        for (std::size_t n = 0; n < store_.fields().size(); ++n) {
            const std::string name = words_of(store_.fields()[n]).name;
            const std::vector<int> times =
                changes(track_[body].field[n], frames_.first, Between::straight);
            out.value("float[] primvars:" + name, "vertex", times, [&](int frame) {
                throw_if_interrupted();
                const std::vector<float> value = store_.frame(frame - 1).body.at(body).field[n];
                out.list(value.size(), [&](std::size_t i) { out.number(value[i]); });
            });
        }
    }

    void write_looks(UsdText& out, std::size_t body) {
        const SkinTrack& track = track_[body];
        const auto bind = [&](int look) {
            out.line(fmt::format("rel material:binding = <{}>", look_[std::size_t(look)]));
        };
        if (track.look.empty()) return;
        // Also beside parts, which not all readers know.
        if (track.all_have_looks) bind(track.main_look());
        if (track.look.size() == 1 && track.all_have_looks) return;
        out.line(fmt::format("uniform token subsetFamily:materialBind:familyType = \"{}\"",
                             track.all_have_looks ? "partition" : "nonOverlapping"));
        for (const int look : track.look) {
            const std::string& path = look_[std::size_t(look)];
            out.open(fmt::format("def GeomSubset \"{}\" (\n    {}\n)",
                                 path.substr(path.rfind('/') + 1), kUsdBinds));
            out.line(
                "uniform token elementType = \"face\"\n"
                "uniform token familyName = \"materialBind\"");
            out.value("int[] indices", "", new_skins(body, Between::held), [&](int frame) {
                const Skin& now = skin(body, frame);
                const std::vector<int> of_polygon = looks_.of_polygons(now.mesh, now.polygons);
                std::vector<int> face;
                for (std::size_t p = 0; p < of_polygon.size(); ++p) {
                    if (of_polygon[p] == look) face.push_back(static_cast<int>(p));
                }
                out.list(face.size(), [&](std::size_t i) { out.number(face[i]); });
            });
            bind(look);
            out.close();
        }
    }

    const FrameStore& store_;
    const ExportScene& scene_;
    const FrameRange frames_;
    MachineTracks machines_;
    std::vector<SkinTrack> track_;
    MeshLooks looks_{false};
    std::vector<std::string> look_;  // paths
    std::string root_;
    Skin skin_;  // as last read
    std::optional<PieceTrack> pieces_;
    std::optional<Progress> progress_;
    int samples_ = 0;  // of places, as far as they are written
};

}  // namespace

ExportOutcome export_usd(const FrameStore& store, const ExportScene& scene,
                         const FrameRange& frames, const fs::path& file) {
    refuse_frames_beyond(store.frame_count(), frames, scene.render.first_frame);
    refuse_foreign(file, [](std::string_view begin) { return begin.starts_with(kBegin); });
    const MadeFolder folder(fs::absolute(file).parent_path());
    return Exporter(store, scene, frames).write(file);
}

}  // namespace swage

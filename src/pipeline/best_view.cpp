// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/best_view.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/log.h"
#include "base/text.h"
#include "geometry/triangle_tree.h"
#include "pipeline/part_look.h"
#include "render/camera.h"
#include "render/camera_change.h"

namespace swage {

namespace {

constexpr int kFrames = 12;    // of the film that are looked at, at most
constexpr int kSamples = 400;  // of the skin in each
constexpr int kEvery = 4;      // in so many of them what bodies hide of themselves counts too
// Of the area that faces the camera where it stands: by which a view has to show more than that
// and than those tried before it.
constexpr double kClearly = 0.15;
// Of the area that bodies do not hide of themselves where it stands, as much as a view has to show:
// slices that stand in a row are seen from along it one by one.
constexpr double kClear = 0.7;
constexpr double kMuch = 0.5;  // of that area, hidden: it is told by what
constexpr double kSome = 0.1;  // of that area, hidden by a part that is named
constexpr double kDegree = kPi / 180;
constexpr double kAside[] = {
    0, 30 * kDegree, 60 * kDegree, 180 * kDegree, 210 * kDegree, 240 * kDegree};
constexpr double kLower[] = {10 * kDegree, 3 * kDegree};

// Areas of skin, square to the line of sight, as sums over samples.
struct Area {
    double facing = 0, seen = 0;
    double share() const { return facing > 0 ? seen / facing : 1; }
    void operator+=(const Area& other) { facing += other.facing, seen += other.seen; }
};

struct Sight {
    Area whole, worst;  // of the film, and of the half of it in which tools hide most
    double clear = 0;   // area that no body hides, whatever tools do
};

// Evenly spread over the skin by area, as drawn.
struct SkinSample {
    Vec3 place, normal;
};

std::vector<SkinSample> samples_of(const StoredFrame& frame,
                                   const std::vector<const std::vector<Corners>*>& triangles,
                                   const Quat& drawn_from_world) {
    std::vector<SkinSample> sample;
    const auto for_each = [&](const auto& use) {
        for (std::size_t b = 0; b < frame.body.size(); ++b) {
            for (const Corners& c : *triangles[b]) {
                const Vec3 area = area_vector(frame.body[b].position, c);
                use(b, c, area, area.norm());
            }
        }
    };
    double total = 0, passed = 0;
    for_each([&](std::size_t, const Corners&, const Vec3&, double size) { total += size; });
    for_each([&](std::size_t b, const Corners& c, const Vec3& area, double size) {
        passed += size;
        while (sample.size() < kSamples && (sample.size() + 0.5) / kSamples * total < passed) {
            // Within a triangle by the sequence R2 of M. Roberts, of the plastic number.
            const double k = static_cast<double>(sample.size());
            double u = std::fmod(0.5 + k * 0.7548776662466927, 1);
            double v = std::fmod(0.5 + k * 0.5698402909980532, 1);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const std::vector<Vec3>& at = frame.body[b].position;
            const Vec3 place = (1 - u - v) * at[c[0]] + u * at[c[1]] + v * at[c[2]];
            sample.push_back({drawn_from_world * place, drawn_from_world * (area / size)});
        }
    });
    return sample;
}

// Some frames of a run, with what is seen of tools in them.
class SampledFilm {
  public:
    SampledFilm(const FrameStore& store, const RenderSettings& settings,
                const Quat& drawn_from_world)
        : count_(store.frame_count()) {
        for (int m = 0; settings.tools && m < store.machine_count(); ++m) {
            std::vector<Part>& machine = machine_[m];
            for (const DrawnPart& part : store.machine(m)) {
                machine.push_back({part.name, {}});
                if (!look_of(part, settings)) continue;
                machine.back().tree.emplace(part.surface);
                hides_ = true;
            }
        }
        if (!hides_) return;
        std::map<int, std::vector<Corners>> skin;
        const int shown = std::min(count_, kFrames);
        const Pose turn{drawn_from_world, Vec3::Zero()};
        for (int n = 0; n < shown; ++n) {
            const int at = shown > 1 ? n * (count_ - 1) / (shown - 1) : 0;
            const StoredFrame stored = store.frame(at);
            std::vector<const std::vector<Corners>*> triangles;
            for (const StoredBody& body : stored.body) {
                const auto [known, is_new] = skin.try_emplace(body.skin);
                if (is_new) known->second = store.skin(body.skin).triangle;
                triangles.push_back(&known->second);
            }
            Frame frame{at, stored.machine, {}, samples_of(stored, triangles, drawn_from_world), {},
                        {}};
            if ((shown - 1 - n) % kEvery == 0) frame.bodies = together(stored, triangles, turn);
            for (const Pose& pose : stored.pose) {
                frame.part_from_drawn.push_back((turn * pose).inverse());
            }
            frame_.push_back(std::move(frame));
        }
    }
    bool hides() const { return hides_; }

    Sight from(const CameraPath& path, const std::vector<CameraKey>& keys) const {
        std::vector<Area> area(frame_.size());
        Sight sight;
        for (std::size_t f = 0; f < frame_.size(); ++f) {
            const Vec3 eye = path.at(still_share(keys, frame_[f].at, count_)).eye;
            for (const SkinSample& sample : frame_[f].sample) {
                const double facing = (eye - sample.place).normalized().dot(sample.normal);
                if (!(facing > 0)) continue;
                area[f].facing += facing;
                if (!is_hidden(frame_[f], sample.place, eye)) area[f].seen += facing;
                if (is_clear(frame_[f], sample, eye)) sight.clear += facing;
            }
        }
        std::stable_sort(area.begin(), area.end(),
                         [](const Area& a, const Area& b) { return a.share() < b.share(); });
        for (std::size_t f = 0; f < area.size(); ++f) {
            sight.whole += area[f];
            if (2 * f < area.size()) sight.worst += area[f];
        }
        return sight;
    }

    // Those that hide most of all, by name, such that the others hide less than a tenth each.
    std::vector<std::string> hiding(const CameraPath& path,
                                    const std::vector<CameraKey>& keys) const {
        std::map<std::string, double> hidden;
        double all = 0;
        for (const Frame& frame : frame_) {
            const Vec3 eye = path.at(still_share(keys, frame.at, count_)).eye;
            for (const SkinSample& sample : frame.sample) {
                const double facing = (eye - sample.place).normalized().dot(sample.normal);
                if (!(facing > 0)) continue;
                all += facing;
                for (const Part* part : between(frame, sample.place, eye)) {
                    hidden[part->name] += facing;
                }
            }
        }
        std::vector<std::string> names;
        for (const auto& [name, area] : hidden) {
            if (area > kSome * all) names.push_back(name);
        }
        std::ranges::stable_sort(names, [&](const std::string& a, const std::string& b) {
            return hidden[a] > hidden[b];
        });
        return names;
    }

  private:
    struct Part {
        std::string name;
        std::optional<TriangleTree> tree;  // where it is seen
    };
    struct Frame {
        int at, machine;
        std::vector<Pose> part_from_drawn;
        std::vector<SkinSample> sample;
        TriMesh bodies;  // as drawn; empty where what they hide does not count
        mutable std::optional<TriangleTree> tree;  // of these, once it is asked for
    };
    static TriMesh together(const StoredFrame& frame,
                            const std::vector<const std::vector<Corners>*>& triangles,
                            const Pose& drawn_from_world) {
        TriMesh all;
        for (std::size_t b = 0; b < frame.body.size(); ++b) {
            const int before = static_cast<int>(all.position.size());
            for (const Vec3& p : frame.body[b].position) {
                all.position.push_back(drawn_from_world * p);
            }
            for (const Corners& c : *triangles[b]) {
                all.triangle.push_back({c[0] + before, c[1] + before, c[2] + before});
            }
        }
        return all;
    }
    // Parts between place and eye; of those only the first that is found, where one is enough.
    std::vector<const Part*> between(const Frame& frame, const Vec3& place, const Vec3& eye,
                                     bool one_is_enough = false) const {
        std::vector<const Part*> found;
        const std::vector<Part>& machine = machine_.at(frame.machine);
        for (std::size_t p = 0; p < machine.size() && p < frame.part_from_drawn.size(); ++p) {
            const Pose& to = frame.part_from_drawn[p];
            if (!machine[p].tree || !machine[p].tree->lies_between(to * place, to * eye)) continue;
            found.push_back(&machine[p]);
            if (one_is_enough) break;
        }
        return found;
    }
    bool is_hidden(const Frame& frame, const Vec3& place, const Vec3& eye) const {
        return !between(frame, place, eye, true).empty();
    }

    static bool is_clear(const Frame& frame, const SkinSample& sample, const Vec3& eye) {
        if (frame.bodies.triangle.empty()) return false;
        if (!frame.tree) frame.tree.emplace(frame.bodies);
        const double off = 1e-5 * (eye - sample.place).norm();
        return !frame.tree->lies_between(sample.place + off * sample.normal, eye);
    }

    int count_;
    bool hides_ = false;
    std::map<int, std::vector<Part>> machine_;
    std::vector<Frame> frame_;
};

std::vector<std::vector<CameraKey>> candidates(const RenderSettings& settings) {
    const CameraKey& first = settings.camera.front();
    std::vector<double> elevation = {first.elevation};
    for (const double lower : kLower) {
        if (settings.open.elevation && lower < first.elevation) elevation.push_back(lower);
    }
    std::vector<std::vector<CameraKey>> result;
    for (const double aside : kAside) {
        if (aside != 0 && !settings.open.azimuth) break;
        for (const double above : elevation) {
            result.push_back(changed_camera(
                settings.camera, {.azimuth = first.azimuth + aside, .elevation = above}));
        }
    }
    return result;
}

// Where the camera went, and what hides much from there all the same.
void tell(const ChosenView& chosen, const CameraKey& before) {
    const auto told = [](const CameraKey& key) {
        return fmt::format("azimuth {:.3g} deg, elevation {:.3g} deg", key.azimuth / kDegree,
                           key.elevation / kDegree);
    };
    std::string text;
    if (chosen.seen > chosen.seen_before) {
        text =
            fmt::format("{}; tools hide {:.0f} % from there and {:.0f} % from {}, in half the film",
                        told(chosen.camera.front()), 100 * (1 - chosen.seen),
                        100 * (1 - chosen.seen_before), told(before));
    } else if (chosen.seen < 1 - kMuch) {
        text = fmt::format("tools hide {:.0f} % of the bodies in half the film",
                           100 * (1 - chosen.seen));
    }
    if (!chosen.hiding.empty()) {
        text += fmt::format(
            ", most of all {}: swage render RUN --hide {} draws without, as does hide in [render]",
            joined(chosen.hiding, ", "), joined(chosen.hiding, ","));
    }
    if (!text.empty()) log_info("camera: {}", text);
}

}  // namespace

ChosenView choose_view(const FrameStore& store, const RenderSettings& settings,
                       const ActionBox& action, const Quat& drawn_from_world) {
    const SampledFilm film(store, settings, drawn_from_world);
    if (!film.hides() || settings.camera.empty()) return {settings.camera};
    const auto path_of = [&](const std::vector<CameraKey>& keys) {
        RenderSettings plain;
        plain.camera = keys;
        for (CameraKey& key : plain.camera) key.zoom = 1, key.target.reset();
        return CameraPath(plain, action.framed);
    };
    const auto sight_from = [&](const std::vector<CameraKey>& keys) {
        return film.from(path_of(keys), keys);
    };
    const Sight before = sight_from(settings.camera);
    ChosenView chosen{settings.camera, before.worst.share(), before.worst.share()};
    if (chosen.seen_before > 1 - kClearly) return chosen;
    double most = 0;
    for (const std::vector<CameraKey>& keys : candidates(settings)) {
        const Sight sight = sight_from(keys);
        if (sight.whole.seen < before.whole.seen || sight.clear < kClear * before.clear) continue;
        // Share and area: a sheet is not shown better from its edge, although nothing hides that,
        // nor is a bar from its broad side where nothing hides it at all.
        const double gain = std::min(sight.worst.share() - before.worst.share(),
                                     (sight.worst.seen - before.worst.seen) / before.worst.facing);
        if (gain < most + kClearly) continue;
        most = gain;
        chosen.camera = keys;
        chosen.seen = sight.worst.share();
    }
    if (chosen.seen < 1 - kMuch) {
        chosen.hiding = film.hiding(path_of(chosen.camera), chosen.camera);
    }
    tell(chosen, settings.camera.front());
    return chosen;
}

}  // namespace swage

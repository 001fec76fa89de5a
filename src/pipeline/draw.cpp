// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/draw.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "pipeline/interrupt.h"
#include "render/canvas.h"
#include "render/contact_sheet.h"
#include "render/film.h"
#include "render/png.h"
#include "render/renderer.h"

namespace swage {

namespace {

constexpr int kSheetPictures = 20;  // about
constexpr int kSheetPictureWidth = 384;

// One frame of the run as the renderer wants it; skins and machines are read when they change.
class FrameSource {
  public:
    FrameSource(const FrameStore& store, bool tools) : store_(store), tools_(tools) {}

    Picture picture(int frame) {
        const StoredFrame stored = store_.frame(frame - 1);
        body_.resize(stored.body.size());
        if (tools_ && stored.machine != machine_id_) {
            machine_ = store_.machine(stored.machine);
            machine_id_ = stored.machine;
        }
        Picture picture;
        for (std::size_t b = 0; b < body_.size(); ++b) {
            Body& body = body_[b];
            if (stored.body[b].skin != body.skin_id) {
                body.skin = store_.skin(stored.body[b].skin);
                body.skin_id = stored.body[b].skin;
            }
            body.position.clear();
            for (const Eigen::Vector3f& p : stored.body[b].position) {
                body.position.push_back(p.cast<double>());
            }
            picture.item.push_back({&body.skin, &body.position, {}, std::nullopt});
        }
        for (std::size_t b = 0; tools_ && b < machine_.size(); ++b) {
            if (machine_[b].surface.triangle.empty()) continue;
            SurfaceMaterial look;
            look.name = machine_[b].name;
            look.color = machine_[b].color;
            look.roughness = machine_[b].matt ? 0.95 : 0.4;
            look.metallic = machine_[b].matt ? 0 : 0.6;
            picture.item.push_back({&machine_[b].surface, nullptr, stored.pose.at(b), look});
        }
        return picture;
    }

  private:
    const FrameStore& store_;
    bool tools_;
    struct Body {
        int skin_id = -1;
        TriMesh skin;
        std::vector<Vec3> position;
    };
    std::vector<Body> body_;
    int machine_id_ = -1;
    std::vector<DrawnPart> machine_;
};

// Frames of the sheet: evenly spread, first and last among them.
std::vector<int> sheet_frames(const FrameRange& frames) {
    const int count = frames.last - frames.first + 1;
    const int shown = std::min(count, kSheetPictures);
    std::vector<int> chosen;
    for (int n = 0; n < shown; ++n) {
        const double share = shown == 1 ? 0 : static_cast<double>(n) / (shown - 1);
        chosen.push_back(frames.first + static_cast<int>(std::lround(share * (count - 1))));
    }
    return chosen;
}

int sheet_columns(int pictures) {
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(pictures) - 1e-9)));
}

}  // namespace

void check_drawing(const RenderSettings& settings) {
    const Canvas canvas(settings.gl, thread_count());
    log_verbose("drawing by {}", canvas.renderer_string());
}

namespace {

// The farthest points along many directions: what a camera has to keep in the picture.
class Outline {
  public:
    Outline() {
        // Evenly spread over the sphere by the golden angle.
        constexpr int kDirections = 96;
        for (int n = 0; n < kDirections; ++n) {
            const double y = 1 - (2 * n + 1.0) / kDirections, r = std::sqrt(1 - y * y);
            const double turn = n * kPi * (3 - std::sqrt(5.0));
            direction_.emplace_back(r * std::cos(turn), y, r * std::sin(turn));
        }
        reach_.assign(direction_.size(), -std::numeric_limits<double>::infinity());
        point_.resize(direction_.size());
    }
    void grow(const Vec3& p) {
        for (std::size_t d = 0; d < direction_.size(); ++d) {
            const double reach = direction_[d].dot(p);
            if (!(reach > reach_[d])) continue;
            reach_[d] = reach;
            point_[d] = p;
        }
    }
    bool empty() const { return !(reach_.front() > -std::numeric_limits<double>::infinity()); }
    const std::vector<Vec3>& points() const { return point_; }

  private:
    std::vector<Vec3> direction_, point_;
    std::vector<double> reach_;
};

}  // namespace

ActionBox find_action(const FrameStore& store, bool tools) {
    Box skin, machines;
    Outline outline;
    std::vector<Vec3> tool_corners;
    std::vector<std::vector<Box>> part_box;  // of each machine's parts, in their own frames
    for (int m = 0; m < store.machine_count(); ++m) {
        part_box.emplace_back();
        for (const DrawnPart& part : store.machine(m)) {
            part_box.back().push_back(box_of(part.surface.position));
        }
    }
    for (int f = 0; f < store.frame_count(); ++f) {
        const StoredFrame frame = store.frame(f);
        for (const StoredBody& body : frame.body) {
            for (const Eigen::Vector3f& p : body.position) {
                skin.grow(p.cast<double>());
                outline.grow(p.cast<double>());
            }
        }
        const std::vector<Box>& boxes = part_box.at(static_cast<std::size_t>(frame.machine));
        for (std::size_t b = 0; b < boxes.size() && b < frame.pose.size(); ++b) {
            if (boxes[b].empty()) continue;
            for (int corner = 0; corner < 8; ++corner) {
                const Vec3 at =
                    frame.pose[b] * Vec3(corner & 1 ? boxes[b].high[0] : boxes[b].low[0],
                                         corner & 2 ? boxes[b].high[1] : boxes[b].low[1],
                                         corner & 4 ? boxes[b].high[2] : boxes[b].low[2]);
                machines.grow(at);
                tool_corners.push_back(at);
            }
        }
    }
    ActionBox action{skin, skin.empty() ? 0 : skin.low.y(), {}};
    if (!outline.empty()) action.outline = outline.points();
    if (!tools || machines.empty() || skin.empty()) return action;
    // A tool that waits far away, or is very long, must not make the work-piece small.
    const Vec3 reach = Vec3::Constant(0.12 * skin.size().maxCoeff());
    action.bounds.grow(machines.low.cwiseMax(skin.low - reach).cwiseMin(skin.high));
    action.bounds.grow(machines.high.cwiseMin(skin.high + reach).cwiseMax(skin.low));
    action.ground_height = action.bounds.low.y();
    for (const Vec3& corner : tool_corners) {
        outline.grow(corner.cwiseMax(action.bounds.low).cwiseMin(action.bounds.high));
    }
    action.outline = outline.points();
    return action;
}

DrawOutcome draw_run(const FrameStore& store, const RenderSettings& settings,
                     const FrameRange& frames, const DrawnFiles& files, Stopwatch& watch) {
    if (frames.first < 1 || frames.last > store.frame_count()) {
        fail(ExitCode::command_line, "--frames {}-{}: the run has the frames 1 to {}", frames.first,
             frames.last, store.frame_count());
    }
    make_folder(files.folder());
    const ActionBox action = find_action(store, settings.tools);
    Renderer renderer(settings, action.bounds, action.ground_height, thread_count(),
                      action.outline);
    DrawOutcome outcome{renderer.renderer_string(), settings.width, settings.height, frames, false};
    std::unique_ptr<Film> film;
    if (settings.film) {
        film = std::make_unique<Film>(files.film(), settings.width, settings.height,
                                      settings.frames_per_second);
    }
    const std::vector<int> on_sheet = sheet_frames(frames);
    std::vector<Image> thumbnails;
    FrameSource source(store, settings.tools);
    Progress progress("draw", frames.last - frames.first + 1);
    std::future<void> writing;  // of the picture before, while the next is drawn
    for (int frame = frames.first; frame <= frames.last; ++frame) {
        throw_if_interrupted();
        Image image;
        {
            const auto lap = watch.lap("draw");
            Picture picture = source.picture(frame);
            picture.film_share = store.frame_count() > 1
                                     ? static_cast<double>(frame - 1) / (store.frame_count() - 1)
                                     : 0;
            image = renderer.draw(picture);
        }
        const auto lap = watch.lap("wait for files");
        if (writing.valid()) writing.get();
        writing = std::async(std::launch::async, [&, frame, image = std::move(image)] {
            write_png(files.still(frame), image);
            if (film) film->add(image);
            if (std::binary_search(on_sheet.begin(), on_sheet.end(), frame)) {
                thumbnails.push_back(thumbnail(image, kSheetPictureWidth, kSheetPictureWidth));
            }
        });
        progress.advance(frame - frames.first + 1);
    }
    if (writing.valid()) writing.get();
    const auto lap = watch.lap("film and sheet");
    write_png(files.contact_sheet(),
              contact_sheet(thumbnails, sheet_columns(static_cast<int>(thumbnails.size()))));
    if (film) outcome.film = film->finish();
    return outcome;
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/draw.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "pipeline/field_look.h"
#include "pipeline/motion_vectors.h"
#include "pipeline/part_look.h"
#include "pipeline/shot.h"
#include "pipeline/signals.h"
#include "pipeline/surface_match.h"
#include "render/canvas_trial.h"
#include "render/contact_sheet.h"
#include "render/film.h"
#include "render/png.h"
#include "render/renderer.h"

namespace swage {

namespace {

// One frame of the run as the renderer wants it; skins and machines are read when they change.
class FrameSource {
  public:
    FrameSource(const FrameStore& store, const Shot& shot, const FieldLook* look)
        : store_(store),
          look_(look),
          settings_(shot.settings),
          camera_(shot.camera()),
          drawn_from_world_{shot.drawn_from_world, Vec3::Zero()} {}

    Picture picture(int frame) {
        StoredFrame stored = store_.frame(frame - 1);
        body_.resize(stored.body.size());
        if (settings_.tools && stored.machine != machine_id_) {
            machine_ = store_.machine(stored.machine);
            machine_id_ = stored.machine;
        }
        part_.clear();
        pose_ = stored.pose;
        Picture picture;
        for (std::size_t b = 0; b < body_.size(); ++b) {
            Body& body = body_[b];
            if (stored.body[b].skin != body.skin_id) {
                body.skin = store_.skin(stored.body[b].skin);
                body.skin_id = stored.body[b].skin;
                body.piece.clear();
            }
            if (look_) look_->dress(stored.body[b], body.skin);
            body.position = std::move(stored.body[b].position);
            picture.item.push_back({&body.skin, &body.position, drawn_from_world_, std::nullopt,
                                    false, look_ != nullptr});
        }
        for (std::size_t b = 0; b < machine_.size(); ++b) {
            const std::optional<SurfaceMaterial> look = look_of(machine_[b], settings_);
            if (!look) continue;
            part_.push_back(b);
            picture.item.push_back({&machine_[b].surface, nullptr,
                                    drawn_from_world_ * stored.pose.at(b), look,
                                    machine_[b].finish == Finish::endless});
        }
        return picture;
    }
    // Of the last picture.
    int machine() const { return machine_id_; }
    PassPicture passes(int frame, const Picture& picture, Layers layers, const PassWriter& writer) {
        PassPicture all;
        for (std::size_t b = 0; b < body_.size(); ++b) {
            all.number.push_back(writer.number_of_body(b));
            if (!settings_.has(PicturePass::piece)) continue;
            Body& body = body_[b];
            if (body.piece.empty()) body.piece = writer.pieces_of(b, body.skin_id, body.skin);
            all.piece.push_back(body.piece);
        }
        for (const std::size_t p : part_) {
            all.number.push_back(writer.number_of_part(machine_id_, p));
        }
        if (settings_.has(PicturePass::motion)) {
            const std::optional<MovedPicture> after = moved(frame + 1), before = moved(frame - 1);
            all.motion = motion_of(layers, picture, view(frame), lens_of(settings_),
                                   after ? &*after : nullptr, before ? &*before : nullptr);
        }
        all.layers = std::move(layers);
        return all;
    }

  private:
    View view(int frame) const {
        return camera_.at(still_share(settings_.camera, frame - 1, store_.frame_count()));
    }
    // What the last picture shows, in another frame; of a machine that is not there then, where it
    // stands.
    std::optional<MovedPicture> moved(int frame) const {
        if (frame < 1 || frame > store_.frame_count()) return std::nullopt;
        StoredFrame stored = store_.frame(frame - 1);
        MovedPicture then{view(frame), {}};
        for (std::size_t b = 0; b < body_.size(); ++b) {
            const Body& body = body_[b];
            StoredBody& there = stored.body.at(b);
            then.item.push_back(
                {drawn_from_world_, there.skin == body.skin_id
                                        ? std::move(there.position)
                                        : carried_places(body.skin, body.position,
                                                         store_.skin(there.skin), there.position)});
        }
        const bool is_there = stored.machine == machine_id_;
        for (const std::size_t p : part_) {
            then.item.push_back(
                {drawn_from_world_ * (is_there ? stored.pose.at(p) : pose_.at(p)), {}});
        }
        return then;
    }

    const FrameStore& store_;
    const FieldLook* look_;  // null: bodies as they look
    const RenderSettings& settings_;
    CameraPath camera_;
    Pose drawn_from_world_;
    struct Body {
        int skin_id = -1;
        std::vector<int> piece;  // of its triangles, once asked for
        TriMesh skin;
        std::vector<Vec3> position;
    };
    std::vector<Body> body_;
    int machine_id_ = -1;
    std::vector<DrawnPart> machine_;
    std::vector<std::size_t> part_;  // of it, that is to be seen
    std::vector<Pose> pose_;
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

// What is clear is grey on a sheet.
Image on_paper(const Image& image) {
    constexpr int kPaper = 150;
    Image laid = image;
    for (std::size_t i = 0; i < image.alpha.size(); ++i) {
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const int color = image.alpha[i] * image.rgb[c] + (255 - image.alpha[i]) * kPaper;
            laid.rgb[c] = static_cast<std::uint8_t>((color + 127) / 255);
        }
    }
    return laid;
}

int sheet_columns(int pictures) {
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(pictures) - 1e-9)));
}

// Writes a picture, and the passes beside it, while the next is drawn.
class PictureWriter {
  public:
    PictureWriter(const DrawnFiles& files, const RenderSettings& settings, const FrameRange& frames,
                  PassWriter& passes)
        : files_(files), passes_(passes), on_sheet_(sheet_frames(frames)) {
        if (settings.has_film()) {
            film_ = std::make_unique<Film>(files.film(), settings.width, settings.height,
                                           settings.frame_rate);
        }
    }

    // Once those before are written.
    void write(int frame, int machine, Image image, PassPicture beside) {
        wait();
        writing_ = std::async(std::launch::async, [this, frame, machine, image = std::move(image),
                                                   beside = std::move(beside)] {
            write_now(frame, machine, image, beside);
        });
    }

    void wait() {
        if (writing_.valid()) writing_.get();
    }

    // What is made of all of them.
    void finish(DrawOutcome& outcome) {
        passes_.finish();
        write_png(files_.contact_sheet(),
                  contact_sheet(thumbnail_, sheet_columns(static_cast<int>(thumbnail_.size()))));
        if (!film_) return;
        outcome.film = film_->finish();
        if (!outcome.film) outcome.warning.push_back(film_->warning());
    }

  private:
    void write_now(int frame, int machine, const Image& image, const PassPicture& beside) {
        write_png(files_.still(frame), image);
        if (beside.layers.width > 0) passes_.write(frame, machine, beside);
        if (film_) film_->add(image);
        if (std::binary_search(on_sheet_.begin(), on_sheet_.end(), frame)) {
            thumbnail_.push_back(
                thumbnail(on_paper(image), kSheetPictureWidth, kSheetPictureWidth));
        }
    }

    const DrawnFiles& files_;
    PassWriter& passes_;
    std::unique_ptr<Film> film_;
    const std::vector<int> on_sheet_;
    std::vector<Image> thumbnail_;
    std::future<void> writing_;  // ends before what it writes with
};

DrawOutcome outcome_of(const Shot& shot, const FrameRange& frames, const Renderer& renderer,
                       const std::optional<FieldLook>& look) {
    DrawOutcome outcome;
    outcome.renderer = renderer.renderer_string();
    outcome.width = shot.settings.width;
    outcome.height = shot.settings.height;
    outcome.frames = frames;
    outcome.first_frame = shot.settings.first_frame;
    outcome.color = shot.settings.color;
    outcome.view = shot.chosen;
    outcome.passes = shot.settings.passes;
    if (look) outcome.color_range = look->range();
    return outcome;
}

}  // namespace

void check_drawing(const RenderSettings& settings) { try_canvas(settings, thread_count()); }

DrawOutcome draw_run(const FrameStore& store, const RenderSettings& wanted,
                     const FrameRange& frames, const DrawnFiles& files, Stopwatch& watch,
                     const RunNames& names) {
    refuse_frames_beyond(store.frame_count(), frames, wanted.first_frame);
    std::optional<FieldLook> look;
    if (wanted.color) look.emplace(store, wanted);
    make_folder(files.folder());
    const Shot shot = shot_of(store, wanted);
    const RenderSettings& settings = shot.settings;
    const ActionBox& action = shot.action;
    const bool has_legend = look && settings.legend;
    Renderer renderer(settings, action.bounds, action.ground_height, thread_count(), action.framed);
    log_verbose("drawing by {}", renderer.renderer_string());
    DrawOutcome outcome = outcome_of(shot, frames, renderer, look);
    FrameSource source(store, shot, look ? &*look : nullptr);
    PassWriter passes(store, settings, files, names, shot.drawn_from_world);
    PictureWriter writer(files, settings, frames, passes);
    // What was made of earlier stills goes before the first of them does.
    std::error_code ignored;
    for (const std::filesystem::path& all : {files.film(), files.contact_sheet()}) {
        std::filesystem::remove(all, ignored);
    }
    Progress progress("draw", frames.last - frames.first + 1);
    for (int frame = frames.first; frame <= frames.last; ++frame) {
        throw_if_interrupted();
        Image image;
        PassPicture beside;
        {
            const auto lap = watch.lap("draw");
            Picture picture = source.picture(frame);
            picture.film_share = still_share(settings.camera, frame - 1, store.frame_count());
            Layers layers;
            image = renderer.draw(picture, settings.passes.empty() ? nullptr : &layers);
            if (layers.width > 0) {
                beside = source.passes(frame, picture, std::move(layers), passes);
            }
            if (has_legend && !look->add_legend(image) && frame == frames.first) {
                outcome.warning.push_back(fmt::format(
                    "the colour scale does not fit in pictures of {} x {} pixels and is left out",
                    settings.width, settings.height));
                log_warning_text(outcome.warning.back());
            }
        }
        const auto lap = watch.lap("wait for files");
        writer.write(frame, source.machine(), std::move(image), std::move(beside));
        progress.advance(frame - frames.first + 1);
    }
    writer.wait();
    const auto lap = watch.lap("film and sheet");
    writer.finish(outcome);
    return outcome;
}

}  // namespace swage

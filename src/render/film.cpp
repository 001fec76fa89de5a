// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/film.h"

#include <algorithm>
#include <system_error>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"

namespace swage {

namespace {

int even(int side) { return side + side % 2; }

// Picture and colour as players expect them; the number of threads is fixed and the bit-exact
// ways are taken, so that the same frames give the same bytes on any machine.
std::vector<std::string> encoder_command(const std::filesystem::path& out, int width, int height,
                                         const FrameRate& rate) {
    return {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y",
            // what comes in
            "-f", "rawvideo", "-pix_fmt", "rgb24", "-s:v", fmt::format("{}x{}", width, height),
            "-r", frame_rate_ratio(rate), "-i", "pipe:0",
            // from full-range RGB to video-range BT.709
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv:"
            "flags=bicubic+accurate_rnd+full_chroma_int+bitexact",
            "-c:v", "libx264", "-preset", "veryfast", "-crf", "16", "-threads", "4", "-pix_fmt",
            "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
            "-color_range", "tv", "-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v",
            "+bitexact", "-map_metadata", "-1", "-f", "mp4", "file:" + out.string()};
}

// The last column and row once more where the side is odd.
std::vector<std::uint8_t> padded(const Image& frame) {
    const std::size_t stride = 3 * static_cast<std::size_t>(frame.width);
    std::vector<std::uint8_t> out;
    for (int y = 0; y < even(frame.height); ++y) {
        const std::uint8_t* row = frame.pixel(0, std::min(y, frame.height - 1));
        out.insert(out.end(), row, row + stride);
        if (frame.width % 2 != 0) out.insert(out.end(), row + stride - 3, row + stride);
    }
    return out;
}

}  // namespace

Film::Film(std::filesystem::path file, int width, int height, const FrameRate& rate)
    : file_(std::move(file)), temporary_(temporary_for(file_)), width_(width), height_(height) {
    if (!program_exists("ffmpeg")) {
        give_up(
            "the program ffmpeg is not in PATH (Debian package ffmpeg); the stills are written "
            "all the same");
        return;
    }
    try {
        encoder_ = std::make_unique<PipedProgram>(
            encoder_command(temporary_, even(width), even(height), rate));
    } catch (const Error& error) {
        give_up(error.what());
    }
}

Film::~Film() {
    if (!encoder_) return;
    encoder_.reset();
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void Film::give_up(const std::string& reason) {
    warning_ = "no film: " + reason;
    log_warning("{}", warning_);
    encoder_.reset();
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void Film::add(const Image& frame) {
    if (frame.width != width_ || frame.height != height_) {
        fail(ExitCode::output, "{}: a frame of {} x {} pixels in a film of {} x {}", file_.string(),
             frame.width, frame.height, width_, height_);
    }
    if (!encoder_) return;
    const bool is_even = frame.width % 2 == 0 && frame.height % 2 == 0;
    const std::vector<std::uint8_t> wider = is_even ? std::vector<std::uint8_t>() : padded(frame);
    const std::vector<std::uint8_t>& bytes = is_even ? frame.rgb : wider;
    ++frame_count_;
    if (!encoder_->write(bytes.data(), bytes.size())) {
        const int status = encoder_->finish();
        if (encoder_->has_taken_nothing()) {
            give_up(fmt::format("ffmpeg took nothing of it for {} s", PipedProgram::kPatience));
            return;
        }
        give_up(fmt::format("ffmpeg ended early with status {}: {}", status,
                            encoder_->last_error_line()));
    }
}

bool Film::finish() {
    if (!encoder_) return false;
    const int status = encoder_->finish();
    if (frame_count_ == 0) {
        give_up("there is no frame");
        return false;
    }
    if (status != 0) {
        give_up(
            fmt::format("ffmpeg ended with status {}: {}", status, encoder_->last_error_line()));
        return false;
    }
    try {
        publish(temporary_, file_);
    } catch (const Error& error) {
        give_up(error.what());
        return false;
    }
    encoder_.reset();
    return true;
}

}  // namespace swage

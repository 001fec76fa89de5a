// SPDX-License-Identifier: GPL-3.0-or-later
// A film of the stills, made by the ffmpeg command that is found at run time. A run never fails
// for want of a film: what went wrong is one warning.
#pragma once

#include <filesystem>
#include <memory>

#include "base/process.h"
#include "render/frame_rate.h"
#include "render/image.h"

namespace swage {

class Film {
  public:
    // Frames will all have this size [pixel]. Odd sides are made even by repeating the last
    // row or column, which the common video format asks for.
    Film(std::filesystem::path file, int width, int height, const FrameRate& rate);
    ~Film();  // without finish() nothing is left behind
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    // Throws Error(output) when the size is another one.
    void add(const Image& frame);

    // The film stands under its name from here on; false when there is none.
    bool finish();
    const std::string& warning() const { return warning_; }  // why; in the log already

  private:
    void give_up(const std::string& reason);

    std::filesystem::path file_, temporary_;
    int width_, height_;
    int frame_count_ = 0;
    std::string warning_;
    std::unique_ptr<PipedProgram> encoder_;  // null: no film will come
};

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/render_directory.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "pipeline/signals.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// A still or a pass beside one, or what goes with these.
bool is_drawn_here(const DrawnFiles& files, const fs::path& file) {
    int number = 0;
    if (file == files.table(PicturePass::matte) || file == files.table(PicturePass::piece)) {
        return true;
    }
    if (std::sscanf(file.filename().c_str(), "frame_%9d.", &number) != 1 || number <= 0) {
        return false;
    }
    if (file == files.still(number)) return true;
    for (std::size_t n = 0; n < kPassName.size(); ++n) {
        if (file == files.pass(number, static_cast<PicturePass>(n))) return true;
    }
    return false;
}

}  // namespace

RenderDirectory::RenderDirectory(const fs::path& root, bool in_run, int first_frame)
    : root_(root), first_frame_(first_frame), folder_(root) {
    std::error_code error;
    if (holds_run(root_)) {
        fail(ExitCode::foreign,
             "{}: is a run directory, which holds the pictures of its scene; choose another --out",
             root_.string());
    }
    if (FolderLock::may_hold(root_)) lock_.emplace(root_);
    if (!in_run && !FolderLock::is_all_of(root_) && !fs::exists(mark(), error)) {
        fail(ExitCode::foreign,
             "{}: contains files that swage render did not draw; choose another --out",
             root_.string());
    }
    if (!lock_) lock_.emplace(root_);
    remove_temporaries(root_, 0);
    had_film_ = fs::exists(files().film(), error);
    write_file_whole(mark(), "swage render draws here, and removes what it drew here before\n");
    set_unfinished_work(root_);
}

RenderDirectory::~RenderDirectory() {
    set_unfinished_work({});
    remove_temporaries(root_, 0);  // a film program may outlive a process that was killed
    std::error_code error;
    fs::remove(files().folder(), error);  // where it is empty
    for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
        if (it->path() != mark() && !FolderLock::is_lock(it->path())) return;
    }
    if (!error) fs::remove(mark(), error);
}

int RenderDirectory::remove_others(const FrameRange& drawn, bool film,
                                   const std::vector<PicturePass>& passes) const {
    std::set<fs::path> of_now;
    for (int f = drawn.first; f <= drawn.last; ++f) {
        of_now.insert(files().still(f));
        for (const PicturePass pass : passes) of_now.insert(files().pass(f, pass));
    }
    for (const PicturePass pass : passes) {
        if (is_colored(pass)) of_now.insert(files().table(pass));
    }
    std::vector<fs::path> others;
    std::error_code error;
    for (fs::directory_iterator it(files().folder(), error), end; !error && it != end;
         it.increment(error)) {
        if (is_drawn_here({root_}, it->path()) && !of_now.contains(it->path()))
            others.push_back(it->path());
    }
    const auto removed = std::count_if(others.begin(), others.end(), [&](const fs::path& file) {
        return fs::remove(file, error);
    });
    return static_cast<int>(removed) + (had_film_ && !film);
}

}  // namespace swage

// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_directory.h"

#include <algorithm>
#include <optional>
#include <set>

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/text.h"
#include "geometry/mesh_write.h"
#include "pipeline/checkpoint.h"
#include "pipeline/folder_lock.h"
#include "pipeline/run_record.h"
#include "pipeline/signals.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr const char* kIdentityName = ".swage-run";

void remove_product(const fs::path& product) {
    std::error_code error;
    fs::remove_all(product, error);
    if (error) {
        fail(ExitCode::output, "{}: cannot be removed: {}", product.string(), error.message());
    }
}

// What a run leaves; nothing else in the directory is ever touched.
constexpr const char* kProducts[] = {"run.json", "film.mp4", "contact.png", "motion.bin",
                                     "frames",   "meshes",   "curves",      "resume",
                                     "again",    "usd",      kIdentityName};
void remove_products(const fs::path& root) {
    for (const char* name : kProducts) remove_product(root / name);
}

// Names for the same bytes, where the file system has them: a run never writes into a file that it
// has left, but puts another in its place.
void link_products(const fs::path& root, const fs::path& to) {
    for (const char* name : kProducts) {
        if (!fs::exists(root / name)) continue;
        std::error_code error;
        using enum fs::copy_options;
        fs::copy(root / name, to / name, recursive | create_hard_links, error);
        if (!error) continue;
        fs::remove_all(to / name);  // some may be linked
        fs::copy(root / name, to / name, recursive);
    }
    std::vector<fs::path> locks;  // of who draws there, which hang on the file
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(to)) {
        if (FolderLock::is_lock(entry.path())) locks.push_back(entry.path());
    }
    for (const fs::path& lock : locks) fs::remove(lock);
}

// But for what the first stages left; the motion file is gone on from, and replaced.
void remove_later_products(const fs::path& root, const std::vector<fs::path>& kept) {
    for (const char* name : {"run.json", "film.mp4", "contact.png", "frames", "again", "usd"}) {
        remove_product(root / name);
    }
    // Libraries of materials have names of their own.
    std::set<fs::path> stay(kept.begin(), kept.end());
    for (const fs::path& stem : kept) stay.insert(library_of(fs::path(stem) += ".obj"));
    std::vector<fs::path> others;
    std::error_code error;
    for (const fs::path folder : {"meshes", "curves"}) {
        for (fs::directory_iterator it(root / folder, error), end; !error && it != end;
             it.increment(error)) {
            // Pictures beside meshes are of all stages.
            const fs::path ending = it->path().extension();
            const bool is_folder = it->is_directory(error);
            const bool is_of_stage = is_folder || ending == ".obj" || ending == ".mtl" ||
                                     ending == ".ply" || ending == ".csv" || ending == ".svg" ||
                                     ending == ".gp";
            const bool is_whole_name = is_folder || ending == ".mtl";
            const fs::path name = is_whole_name ? it->path().filename() : it->path().stem();
            if (is_of_stage && !stay.contains(folder / name)) {
                others.push_back(it->path());
            }
        }
    }
    for (const fs::path& product : others) remove_product(product);
}

// A run that ended before its first frame leaves no file but these two.
bool holds_products(const fs::path& root) {
    std::error_code error;
    for (fs::recursive_directory_iterator it(root, error), end; !error && it != end;
         it.increment(error)) {
        const fs::path name = it->path().filename();
        if (it->is_directory(error) || name == kIdentityName || FolderLock::is_lock(name)) {
            continue;
        }
        return true;
    }
    return static_cast<bool>(error);
}

// How many stages the run that lies here has finished and kept, as it says itself.
int stages_said_to_be_kept(const fs::path& root, const RunIdentity& identity) {
    if (!keeps_stages(identity)) return 0;  // the last one at most, and that not for long
    const std::optional<Json> record = read_record(RunDirectory::record_in(root));
    const Json stages = record ? record->value("stages", Json()) : Json();
    const auto is_finished = [](const Json& stage) {
        return stage.is_object() && stage.value("state", Json()) == RunState::complete;
    };
    if (!stages.is_array()) return 0;
    return static_cast<int>(std::find_if_not(stages.begin(), stages.end(), is_finished) -
                            stages.begin());
}

// How many of its first stages are the same; the keys of stages count from none on.
int stages_alike(const std::vector<std::string>& there, const std::vector<std::string>& here) {
    const auto [end, unused] = std::mismatch(there.begin(), there.end(), here.begin(), here.end());
    return std::max(0, static_cast<int>(end - there.begin()) - 1);
}

}  // namespace

bool holds_run(const fs::path& folder) {
    std::error_code unknown;
    return fs::exists(folder / kIdentityName, unknown);
}

RunDirectory::RunDirectory(const fs::path& root, const RunIdentity& identity, EarlierRun earlier)
    : root_(root.has_filename() ? root : root.parent_path()),
      folder_(root_),
      identity_text_(identity_text(identity)),
      stage_keys_(identity.stage_key),
      anew_(earlier == EarlierRun::replace) {
    // One that is being made holds files before it is a run.
    if (FolderLock::may_hold(root_)) lock_.emplace(root_);
    if (!FolderLock::is_all_of(root_) && !holds_run(root_)) {
        fail(ExitCode::foreign,
             "{}: contains files that are not from a swage run; choose another --out",
             root_.string());
    }
    if (!lock_) lock_.emplace(root_);
    remove_temporaries(root_, 0);
    if (!anew_) claim(identity, earlier);
    set_unfinished_work(root_);
}

void RunDirectory::claim(const RunIdentity& identity, EarlierRun earlier) {
    const bool extends = earlier == EarlierRun::extend;
    const fs::path file = root_ / kIdentityName;
    std::error_code unknown;
    if (!fs::exists(file, unknown) || !holds_products(root_)) {
        write_file_whole(file, identity_text_);
        return;
    }
    const RunIdentity there = read_identity(file);
    const std::vector<std::string> found = differences(there, identity);
    last_that_was_kept_ =
        std::min(stages_said_to_be_kept(root_, there), stages_alike(there.stage_key, stage_keys_));
    if (found.empty()) return;
    const int all = static_cast<int>(stage_keys_.size()) - 1, kept = last_kept(root_, all),
              set_aside = holds_run(replaced()) ? last_kept(replaced(), all) : 0;
    const std::string change = joined(found, "; ");
    std::string more_there;
    if (set_aside > kept) {
        more_there = fmt::format(
            "{} has kept more stages that are the same ({} instead of {}): to go on from there, "
            "move it to a place of its own and give that as --out",
            replaced().string(), set_aside, kept);
    }
    if (extends && (kept > 0 || fs::exists(stage_mark(), unknown))) {
        if (fs::exists(fs::symlink_status(replaced(), unknown)) && !holds_run(replaced())) {
            fail(ExitCode::foreign,
                 "{}: is where the run that is there would be set aside, and is not a swage run: "
                 "move it away, or choose another --out",
                 replaced().string());
        }
        change_ = change;
        if (!more_there.empty()) log_warning("{}", more_there);
        return;
    }
    const auto first = [](int stages) {
        return stages == 1 ? "its first stage" : fmt::format("its first {} stages", stages);
    };
    std::string in_vain;
    if (extends) {
        in_vain = last_that_was_kept_ > 0
                      ? fmt::format("; and what it kept of {} is gone or damaged",
                                    first(last_that_was_kept_))
                      : "; and it has kept no stage to go on from that is the same";
        if (!more_there.empty()) in_vain += ", but " + more_there;
    }
    fail(ExitCode::foreign,
         "{}: belongs to another run: {}{}; choose another --out, or {}--fresh to throw {} away",
         root_.string(), change, in_vain,
         kept > 0 ? "--go-on to keep " + first(kept) + ", or " : "",
         holds_run(replaced()) ? "that run and the complete one in replaced/" : "that run");
}

// One that is not done is not worth it.
void RunDirectory::set_aside() const {
    const std::optional<Json> there = read_record(record());
    if (!there || !is_simulated(*there)) return;
    remove_replaced();
    const fs::path part = part_of_replaced();
    try {
        fs::create_directory(part);
        link_products(root_, part);
        fs::rename(part, replaced());
    } catch (const fs::filesystem_error& error) {
        std::error_code ignored;
        fs::remove_all(part, ignored);
        fail(ExitCode::output, "{}: the run that is there cannot be set aside: {}", root_.string(),
             error.code().message());
    }
    log_info("the run that was there stands in {} until this one is done", replaced().string());
}

// Of the run, which `swage render` may be at.
std::unique_ptr<FolderLock> RunDirectory::lock_of_drawing() const {
    if (!fs::is_directory(drawn_again(root_))) return nullptr;
    return std::make_unique<FolderLock>(drawn_again(root_));
}

void RunDirectory::begin(const std::vector<fs::path>& kept) {
    if (anew_) {
        has_begun_ = true;
        const auto drawing = lock_of_drawing();
        remove_products(root_);
        remove_replaced();
    } else if (is_changed()) {
        const auto drawing = lock_of_drawing();
        set_aside();  // before anything goes
        has_begun_ = true;
        remove_later_products(root_, kept);
    } else {
        has_begun_ = true;
        return;
    }
    write_file_whole(root_ / kIdentityName, identity_text_);
    anew_ = false;
    change_.clear();
}

fs::path RunDirectory::checkpoint_in(const fs::path& run, int stages) {
    return resume_in(run) / fmt::format("after-{}.bin", stages);
}

int RunDirectory::last_kept(const fs::path& run, int most) const {
    while (most > 0 && !is_kept(checkpoint_in(run, most), stage_keys_, most)) --most;
    return most;
}

void RunDirectory::forget_kept() const {
    std::error_code ignored;
    fs::remove_all(resume(), ignored);
}

void RunDirectory::forget_kept_but(int first, int last) const {
    std::set<fs::path> stay = {stage_mark(), kept_motion()};
    for (int stages = first; stages <= last; ++stages) stay.insert(checkpoint(stages));
    std::error_code ignored;
    std::vector<fs::path> others;
    for (fs::directory_iterator it(resume(), ignored), end; !ignored && it != end;
         it.increment(ignored)) {
        if (!stay.contains(it->path())) others.push_back(it->path());
    }
    for (const fs::path& file : others) fs::remove(file, ignored);
}

// In one step, so that no half of one is taken for a run.
void RunDirectory::remove_replaced() const {
    std::error_code ignored;
    if (holds_run(replaced())) fs::rename(replaced(), part_of_replaced(), ignored);
    fs::remove_all(part_of_replaced(), ignored);
}

RunDirectory::~RunDirectory() {
    set_unfinished_work({});
    remove_temporaries(root_, 0);  // a film program may outlive a process that was killed
    if (!has_begun_) remove_unbegun();
}

void RunDirectory::remove_unbegun() {
    std::error_code error;
    for (fs::directory_iterator it(root_, error), end; !error && it != end; it.increment(error)) {
        if (!FolderLock::is_lock(it->path()) && it->path().filename() != kIdentityName) return;
    }
    if (!error) fs::remove(root_ / kIdentityName, error);
}

std::string frame_name(int frame, int first_frame) {
    return fmt::format("frame_{:04d}", frame + (first_frame - 1));
}

fs::path DrawnFiles::still(int frame) const {
    return folder() / (frame_name(frame, first_frame) + ".png");
}

fs::path DrawnFiles::pass(int frame, PicturePass pass) const {
    return folder() / fmt::format("{}.{}.{}", frame_name(frame, first_frame),
                                  kPassName[std::size_t(pass)], is_colored(pass) ? "png" : "exr");
}

fs::path DrawnFiles::table(PicturePass pass) const {
    return folder() / (std::string(kPassName[std::size_t(pass)]) + "s.json");
}

}  // namespace swage

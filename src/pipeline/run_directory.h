// SPDX-License-Identifier: GPL-3.0-or-later
// The directory that a run writes into: which run it belongs to, who is writing in it, and where
// each file stands. A directory of another run is never mixed into.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/folder_lock.h"
#include "pipeline/made_folder.h"
#include "pipeline/run_identity.h"
#include "pipeline/run_options.h"
#include "render/settings.h"

namespace swage {

// Whether a run of swage lies in this folder, of whatever scene.
bool holds_run(const std::filesystem::path& folder);

class RunDirectory {
  public:
    // Creates the directory, and those that it is to lie in, or enters it. Throws Error(output)
    // when it cannot be written, Error(foreign) when it holds anything but this run, or while
    // another process writes in it. One that is to be replaced makes room in begin(); one that
    // ended before its first frame always does. One that is to be extended has the same first
    // stages and has kept what is to be gone on from; where it is done it stays whole until the new
    // one is.
    RunDirectory(const std::filesystem::path& root, const RunIdentity& identity,
                 EarlierRun earlier = EarlierRun::finish);
    // Lets others in. Where no run has begun, neither this one nor another, nothing is left of it.
    ~RunDirectory();
    RunDirectory(const RunDirectory&) = delete;
    RunDirectory& operator=(const RunDirectory&) = delete;

    const std::filesystem::path& root() const { return root_; }
    const std::vector<std::string>& stage_keys() const { return stage_keys_; }
    // Whatever run it holds is to make room.
    bool is_anew() const { return anew_; }
    // Of the run that it holds something else was changed than its first stages; empty: nothing.
    const std::string& change() const { return change_; }
    bool is_changed() const { return !change_.empty(); }
    // The run is about to write its first frame: now what makes room for it is removed. `kept`: of
    // a run that is changed the meshes and curves that stay, from its root on and without endings.
    void begin(const std::vector<std::filesystem::path>& kept = {});
    // The run is done: what it stands in place of goes.
    void remove_replaced() const;
    static std::filesystem::path record_in(const std::filesystem::path& run) {
        return run / "run.json";
    }
    static std::filesystem::path store_in(const std::filesystem::path& run) {
        return run / "motion.bin";
    }
    std::filesystem::path record() const { return record_in(root_); }
    std::filesystem::path store() const { return store_in(root_); }
    // What a run goes on from: after so many stages and, as long as it is not done, within the next
    // and its motion file.
    std::filesystem::path resume() const { return resume_in(root_); }
    std::filesystem::path checkpoint(int stages) const { return checkpoint_in(root_, stages); }
    std::filesystem::path stage_mark() const { return resume() / "stage.bin"; }
    std::filesystem::path kept_motion() const { return resume() / "motion.bin"; }
    // Whether the run that it holds says that it kept this, of a stage that is still the same.
    bool was_kept(int stages) const { return stages <= last_that_was_kept_; }
    void forget_kept() const;
    void forget_kept_but(int first, int last) const;  // after these numbers of stages
    // A run that was done, until the one that goes on from its first stages is.
    std::filesystem::path replaced() const { return root_ / "replaced"; }
    std::filesystem::path part_of_replaced() const { return root_ / ".replaced.part"; }
    // Where `swage render` draws a run that is not told where.
    static std::filesystem::path drawn_again(const std::filesystem::path& run) {
        return run / "again";
    }
    // Where `swage export` writes likewise.
    static std::filesystem::path exported(const std::filesystem::path& run) { return run / "usd"; }

  private:
    static std::filesystem::path resume_in(const std::filesystem::path& run) {
        return run / "resume";
    }
    static std::filesystem::path checkpoint_in(const std::filesystem::path& run, int stages);
    // The last of a run that was kept by these keys; 0: none.
    int last_kept(const std::filesystem::path& run, int most) const;
    void claim(const RunIdentity& identity, EarlierRun earlier);
    std::unique_ptr<FolderLock> lock_of_drawing() const;
    void set_aside() const;
    void remove_unbegun();

    std::filesystem::path root_;
    MadeFolder folder_;
    std::string identity_text_;
    std::vector<std::string> stage_keys_;
    std::string change_;
    int last_that_was_kept_ = 0;
    bool anew_, has_begun_ = false;
    std::optional<FolderLock> lock_;
};

// What files of a frame are called where the first is called that.
std::string frame_name(int frame, int first_frame);

// Where the drawn files of a run stand; `root` may also be another folder.
struct DrawnFiles {
    std::filesystem::path root;
    int first_frame = 1;  // what the first is called

    std::filesystem::path folder() const { return root / "frames"; }
    std::filesystem::path still(int frame) const;                   // frames/frame_0001.png
    std::filesystem::path pass(int frame, PicturePass pass) const;  // frames/frame_0001.depth.exr
    // Of a pass that is_colored: frames/mattes.json.
    std::filesystem::path table(PicturePass pass) const;
    std::filesystem::path film() const { return root / "film.mp4"; }
    std::filesystem::path contact_sheet() const { return root / "contact.png"; }
};

}  // namespace swage

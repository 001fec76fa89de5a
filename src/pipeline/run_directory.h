// SPDX-License-Identifier: GPL-3.0-or-later
// The directory that a run writes into: which run it belongs to, who is writing in it, and where
// each file stands. A directory of another run is never mixed into.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/build_name.h"
#include "pipeline/folder_lock.h"
#include "pipeline/made_folder.h"
#include "render/settings.h"

namespace swage {

inline constexpr const char* kVersion = SWAGE_VERSION;

// What makes a run this run: the program, to the build, and the bytes of everything that was read.
struct RunInput {
    std::string role;  // "scene", "machine bend", "mesh", ...; unique
    std::filesystem::path file;
    std::string hash;
    std::string text = {};  // of a scene or machine, so that it can be told what was changed in it
};
struct RunIdentity {
    std::string version = kVersion;
    std::vector<RunInput> input;
    std::string build = kBuildName;
    // Of the run up to each stage, from none of them to all, a text that is another where anything
    // is that what was done until then depends on.
    std::vector<std::string> stage_key = {};
};

// One sentence a difference, empty when they are the same run. File names may differ.
std::vector<std::string> differences(const RunIdentity& there, const RunIdentity& here);

// Whether a run of swage lies in this folder, of whatever scene.
bool holds_run(const std::filesystem::path& folder);

class RunDirectory {
  public:
    // Creates the directory, and those that it is to lie in, or enters it. Throws Error(output)
    // when it cannot be written, Error(foreign) when it holds anything but this run, or while
    // another process writes in it. `fresh`: whatever run it holds, that is to make room in
    // begin(). One that ended before its first frame always does. `go_on`: one whose first stages
    // are the same may be there, if it has kept what is to be gone on from.
    RunDirectory(const std::filesystem::path& root, const RunIdentity& identity, bool fresh,
                 bool go_on = false);
    // Lets others in. Where no run has begun, neither this one nor another, nothing is left of it.
    ~RunDirectory();
    RunDirectory(const RunDirectory&) = delete;
    RunDirectory& operator=(const RunDirectory&) = delete;

    const std::filesystem::path& root() const { return root_; }
    const std::vector<std::string>& stage_keys() const { return stage_keys_; }
    // Whatever run it holds is to make room.
    bool is_anew() const { return anew_; }
    // Of the run that it holds later stages are others.
    bool is_changed() const { return changed_; }
    // The run is about to write its first frame: now what makes room for it is removed. `kept`: of
    // a run that is changed the meshes and curves that stay, from its root on and without endings.
    void begin(const std::vector<std::filesystem::path>& kept = {});
    static std::filesystem::path record_in(const std::filesystem::path& run) {
        return run / "run.json";
    }
    static std::filesystem::path store_in(const std::filesystem::path& run) {
        return run / "motion.bin";
    }
    std::filesystem::path record() const { return record_in(root_); }
    std::filesystem::path store() const { return store_in(root_); }
    // Of a run that is not done: what it goes on from, after a stage and within the next, and its
    // motion file until it ends.
    std::filesystem::path checkpoint() const { return root_ / "resume" / "checkpoint.bin"; }
    std::filesystem::path stage_mark() const { return root_ / "resume" / "stage.bin"; }
    std::filesystem::path kept_motion() const { return root_ / "resume" / "motion.bin"; }
    void remove_checkpoint() const;
    // Where `swage render` draws a run that is not told where.
    static std::filesystem::path drawn_again(const std::filesystem::path& run) {
        return run / "again";
    }
    // Where `swage export` writes likewise.
    static std::filesystem::path exported(const std::filesystem::path& run) { return run / "usd"; }

  private:
    void claim(const RunIdentity& identity, bool go_on);
    void remove_unbegun();

    std::filesystem::path root_;
    MadeFolder folder_;
    std::string identity_text_;
    std::vector<std::string> stage_keys_;
    bool anew_, changed_ = false, has_begun_ = false;
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

// All of a small file that a run has left. Throws Error(code) when that is no plain file, cannot be
// read or is longer than any such file; never waits for what is none.
std::string record_text(const std::filesystem::path& file, ExitCode code);

}  // namespace swage

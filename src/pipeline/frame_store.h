// SPDX-License-Identifier: GPL-3.0-or-later
// The motion of a run on disk: skins, machines, and for each frame where both stand. It is written
// while the simulation goes on and read frame by frame, so that a run can be drawn, and drawn
// again, without simulating and without holding all frames in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/file_handle.h"
#include "base/math.h"
#include "geometry/trimesh.h"
#include "matter/drive.h"
#include "matter/skin_field.h"

namespace swage {

// A tool, grip or blade as it is drawn: a surface in its own frame.
struct DrawnPart {
    std::string name;
    TriMesh surface;
    Vec3 color = {0.5, 0.5, 0.5};
    Finish finish = Finish::metal;
};

struct StoredBody {
    int skin = 0;                // which skin
    std::vector<Vec3> position;  // of the skin's vertices [m]; kept to 1e-7 of the body's size
    SkinFieldValues field = {};  // likewise, of the fields that the file holds
};

struct StoredFrame {
    std::vector<StoredBody> body;
    int machine = 0;         // which machine
    std::vector<Pose> pose;  // world from part, of the machine's parts
};

// How far a motion file goes: its bytes but for the end, and a hash of what they are.
struct MotionMark {
    using IsPlain = MotionMark;

    std::uint64_t size = 0, hash = 0;
};

// Whether a file, if there is one, is this as far as that, to the byte.
bool holds_motion(const std::filesystem::path& file, const MotionMark& mark);

class FrameStoreWriter {
  public:
    // Writes to a temporary beside `file` until `finish`. `fields`: that bodies have in each frame.
    explicit FrameStoreWriter(const std::filesystem::path& file,
                              const std::vector<SkinField>& fields = {});
    // Goes on behind what holds_motion there: in `from` itself, or in a copy where it is `file` or
    // is to stay as it is.
    FrameStoreWriter(const std::filesystem::path& file, const std::filesystem::path& from,
                     const MotionMark& mark, bool stays = false);
    ~FrameStoreWriter();  // removes what was neither finished nor kept
    FrameStoreWriter(const FrameStoreWriter&) = delete;
    FrameStoreWriter& operator=(const FrameStoreWriter&) = delete;

    // Both are numbered from 0. A skin's positions are those of the mesh at rest.
    int add_skin(const TriMesh& skin);
    int add_machine(const std::vector<DrawnPart>& part);
    void add_frame(const StoredFrame& frame);
    int frame_count() const { return frames_; }
    int machine_count() const { return machines_; }

    // Flushed to disk under that name, it stays there until `finish`, whatever becomes of the
    // process: what the mark says then can be gone on from.
    void keep(const std::filesystem::path& as);
    const MotionMark& mark() const { return mark_; }
    void finish();

  private:
    // All of it or nothing: a full disk leaves what came before, with its end.
    void put(std::uint32_t kind, const std::string& bytes);
    void put_end();  // behind what is whole
    bool cut_off();
    void drop();
    void put_images(const TriMesh& mesh);

    std::filesystem::path file_, written_;
    bool is_kept_ = false;
    FileHandle handle_;
    MotionMark mark_;  // of what is whole
    int skins_ = 0, machines_ = 0, frames_ = 0;
    std::size_t fields_ = 0;
    std::set<std::uint64_t> image_;  // that the file holds, by hash
};

class FrameStore {
  public:
    // Throws Error(output) when the file is absent, damaged or of another version.
    explicit FrameStore(const std::filesystem::path& file);
    FrameStore(const FrameStore&) = delete;
    FrameStore& operator=(const FrameStore&) = delete;

    int frame_count() const { return static_cast<int>(frame_.size()); }
    const std::vector<SkinField>& fields() const { return field_; }
    int machine_count() const { return static_cast<int>(machine_.size()); }
    StoredFrame frame(int index) const;
    TriMesh skin(int index) const;
    std::vector<DrawnPart> machine(int index) const;

  private:
    struct Place {
        std::uint64_t offset, size, hash;
    };
    std::string bytes_at(const Place& place) const;
    template <typename T>
    T value_at(const Place& place) const;

    std::filesystem::path file_;
    FileHandle handle_;
    std::vector<Place> skin_, machine_, frame_;
    std::map<std::uint64_t, Place> image_;  // by hash
    std::vector<SkinField> field_;
};

}  // namespace swage

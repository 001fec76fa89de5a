// SPDX-License-Identifier: GPL-3.0-or-later
// The file: a magic word, then records of kind, size, hash and bytes, each head with a check of its
// own; the last says that the file is whole. It stands there from the start and moves on with every
// record, so that it never wants for room. Where frames hold fields of the matter the magic word is
// another, and the first record names them.
#include "pipeline/frame_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>

#include "base/atomic_file.h"
#include "base/file_contents.h"
#include "base/hash.h"
#include "pipeline/file_bytes.h"
#include "pipeline/mesh_bytes.h"

namespace swage {

namespace fs = std::filesystem;

template <typename Io>
void visit(Io& io, DrawnPart& part) {
    auto& [name, surface, color, finish] = part;
    io(name, surface, color, finish);
}

namespace {

constexpr std::uint64_t kMagic = 0x3830'6567'6177'7300;  // "\0swage08" on a little-endian machine
constexpr std::uint64_t kFieldMagic = 0x3930'6567'6177'7300;  // "\0swage09"
bool is_magic(std::uint64_t word) { return word == kMagic || word == kFieldMagic; }

enum RecordKind : std::uint32_t { kSkin = 1, kMachine, kFrame, kImage, kEnd, kFields };

struct RecordHead {
    std::uint32_t kind;
    std::uint32_t check;  // of the others
    std::uint64_t size;
    std::uint64_t hash;  // of the bytes
};

std::uint32_t check_of(const RecordHead& head) {
    Hasher hasher;
    hasher.add_bytes(&head.kind, sizeof head.kind);
    hasher.add_bytes(&head.size, sizeof head.size);
    hasher.add_bytes(&head.hash, sizeof head.hash);
    return static_cast<std::uint32_t>(hasher.value());
}

RecordHead head_of(std::uint32_t kind, const std::string& bytes) {
    RecordHead head{kind, 0, bytes.size(), hash_of(bytes)};
    head.check = check_of(head);
    return head;
}

std::uint64_t chained(std::uint64_t hash, const RecordHead& head) {
    Hasher hasher;
    hasher.add_bytes(&hash, sizeof hash);
    hasher.add_bytes(&head, sizeof head);
    return hasher.value();
}

std::string bytes_of(const std::vector<SkinField>& fields) {
    std::vector<std::string> names;
    for (const SkinField field : fields) names.emplace_back(words_of(field).name);
    ByteWriter out;
    out(names);
    return out.bytes();
}
std::vector<SkinField> fields_in(const std::string& bytes) {
    std::vector<SkinField> fields;
    ByteReader in(bytes);
    for (const std::string& name : in.get<std::vector<std::string>>()) {
        const std::optional<SkinField> field = skin_field_named(name);
        if (!field) fail(ExitCode::output, "this build of swage does not know the field {}", name);
        fields.push_back(*field);
    }
    return fields;
}

// What a motion file holds before a place in it.
struct Passed {
    int skins = 0, machines = 0, frames = 0;
    std::set<std::uint64_t> image;
    std::vector<SkinField> field;
};

// Nothing where that is not what the mark says; `to_the_byte`: or any byte of it is another.
std::optional<Passed> pass_records(int handle, const MotionMark& mark, bool to_the_byte) {
    Passed passed;
    std::uint64_t magic = 0, hash = 0, at = sizeof magic;
    char last = 0;
    if (!read_at(handle, 0, &magic, sizeof magic) || !is_magic(magic) || mark.size < sizeof magic ||
        !read_at(handle, mark.size - 1, &last, sizeof last)) {
        return std::nullopt;
    }
    std::string bytes;
    while (at < mark.size) {
        RecordHead head{};
        if (!read_at(handle, at, &head, sizeof head) || head.check != check_of(head)) {
            return std::nullopt;
        }
        at += sizeof head;
        if (at > mark.size || head.size > mark.size - at) return std::nullopt;
        if (to_the_byte || head.kind == kFields) {
            bytes.resize(head.size);
            if (!read_at(handle, at, bytes.data(), bytes.size()) || hash_of(bytes) != head.hash) {
                return std::nullopt;
            }
        }
        if (head.kind == kFields) passed.field = fields_in(bytes);
        passed.skins += head.kind == kSkin;
        passed.machines += head.kind == kMachine;
        passed.frames += head.kind == kFrame;
        if (head.kind == kImage) passed.image.insert(head.hash);
        hash = chained(hash, head);
        at += head.size;
    }
    if (passed.field.empty() != (magic == kMagic)) return std::nullopt;
    return at == mark.size && hash == mark.hash ? std::optional(passed) : std::nullopt;
}

void copy_start(int from, int to, const fs::path& file, std::uint64_t size) {
    std::string bytes;
    for (std::uint64_t at = 0; at < size; at += bytes.size()) {
        bytes.resize(std::min(size - at, std::uint64_t(1) << 20));
        if (!read_at(from, at, bytes.data(), bytes.size())) {
            fail(ExitCode::output, "{}: cannot be read", file.string());
        }
        write_at(to, file, at, bytes.data(), bytes.size());
    }
}

// By axis. What flies off leaves it with the rest.
Vec3 median(const std::vector<Vec3>& position) {
    Vec3 middle = Vec3::Zero();
    std::vector<double> along;
    for (int d = 0; d < 3 && !position.empty(); ++d) {
        along.clear();
        for (const Vec3& p : position) along.push_back(p[d]);
        const auto at = along.begin() + static_cast<std::ptrdiff_t>((along.size() - 1) / 2);
        std::nth_element(along.begin(), at, along.end());
        middle[d] = *at;
    }
    return middle;
}

FileHandle created(const fs::path& temporary, const fs::path& file) {
    FileHandle handle(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
    if (!handle.is_open()) {
        fail(ExitCode::output, "{}: cannot be created: {}", file.string(), std::strerror(errno));
    }
    return handle;
}

}  // namespace

bool holds_motion(const fs::path& file, const MotionMark& mark) {
    std::string why;
    const FileHandle handle = open_plain_file(file, why);
    return handle.is_open() && pass_records(handle.id(), mark, true);
}

FrameStoreWriter::FrameStoreWriter(const fs::path& file, const std::vector<SkinField>& fields)
    : file_(file),
      written_(temporary_for(file)),
      handle_(created(written_, file)),
      fields_(fields.size()) {
    try {
        const std::uint64_t magic = fields.empty() ? kMagic : kFieldMagic;
        write_at(handle_.id(), file_, 0, &magic, sizeof magic);
        mark_.size = sizeof magic;
        put_end();
        if (!fields.empty()) put(kFields, bytes_of(fields));
    } catch (...) {
        drop();
        throw;
    }
}

FrameStoreWriter::FrameStoreWriter(const fs::path& file, const fs::path& from,
                                   const MotionMark& mark, bool stays)
    : file_(file),
      written_(from == file || stays ? temporary_for(file) : from),
      is_kept_(from != file && !stays),
      mark_(mark) {
    FileHandle there(::open(from.c_str(), (is_kept_ ? O_RDWR : O_RDONLY) | O_CLOEXEC));
    const auto passed = there.is_open() ? pass_records(there.id(), mark, false) : std::nullopt;
    if (!passed) fail(ExitCode::output, "{}: cannot be gone on from", from.string());
    skins_ = passed->skins, machines_ = passed->machines, frames_ = passed->frames;
    image_ = passed->image;
    fields_ = passed->field.size();
    handle_ = is_kept_ ? std::move(there) : created(written_, file);
    try {
        if (!is_kept_) copy_start(there.id(), handle_.id(), file_, mark_.size);
        cut_off();
        put_end();
    } catch (...) {
        drop();
        throw;
    }
}

FrameStoreWriter::~FrameStoreWriter() { drop(); }

void FrameStoreWriter::drop() {
    if (!handle_.is_open()) return;
    handle_.close();
    if (!is_kept_) ::unlink(written_.c_str());
}

void FrameStoreWriter::put_end() {
    const RecordHead end = head_of(kEnd, {});
    write_at(handle_.id(), file_, mark_.size, &end, sizeof end);
}

// All but what is whole, and the room of an end.
bool FrameStoreWriter::cut_off() {
    return ::ftruncate(handle_.id(), static_cast<off_t>(mark_.size + sizeof(RecordHead))) == 0;
}

void FrameStoreWriter::put(std::uint32_t kind, const std::string& bytes) {
    const RecordHead head = head_of(kind, bytes);
    const MotionMark before = mark_;
    try {
        write_at(handle_.id(), file_, mark_.size, &head, sizeof head);
        write_at(handle_.id(), file_, mark_.size + sizeof head, bytes.data(), bytes.size());
        mark_.size += sizeof head + bytes.size();
        mark_.hash = chained(mark_.hash, head);
        put_end();
    } catch (const Error&) {
        // The room of the end that stood here is kept.
        mark_ = before;
        if (cut_off()) put_end();
        throw;
    }
}

// Once each: a skin may be another in every frame, its texture is the same.
void FrameStoreWriter::put_images(const TriMesh& mesh) {
    for (const SurfaceMaterial& material : mesh.material) {
        if (!material.embedded_texture) continue;
        const std::uint64_t hash = hash_of(*material.embedded_texture);
        if (image_.contains(hash)) continue;
        put(kImage, *material.embedded_texture);
        image_.insert(hash);
    }
}

int FrameStoreWriter::add_skin(const TriMesh& skin) {
    put_images(skin);
    ByteWriter out;
    out(skin);
    put(kSkin, out.bytes());
    return skins_++;
}

int FrameStoreWriter::add_machine(const std::vector<DrawnPart>& parts) {
    for (const DrawnPart& part : parts) put_images(part.surface);
    ByteWriter out;
    out(parts);
    put(kMachine, out.bytes());
    return machines_++;
}

void FrameStoreWriter::add_frame(const StoredFrame& frame) {
    ByteWriter out;
    out(frame.machine, std::uint64_t(frame.body.size()));
    for (const StoredBody& body : frame.body) {
        const Vec3 middle = median(body.position);
        std::vector<Eigen::Vector3f> away;
        away.reserve(body.position.size());
        for (const Vec3& p : body.position) away.push_back((p - middle).cast<float>());
        out(body.skin, middle, away);
    }
    out(std::uint64_t(frame.pose.size()));
    for (const Pose& pose : frame.pose) out(pose.rotation.coeffs(), pose.translation);
    for (const StoredBody& body : frame.body) {
        if (fields_ == 0) break;
        SkinFieldValues values = body.field;
        values.resize(fields_);
        for (std::vector<float>& one : values) one.resize(body.position.size(), 0.0f);
        out(values);
    }
    put(kFrame, out.bytes());
    ++frames_;
}

void FrameStoreWriter::keep(const fs::path& as) {
    if (::fsync(handle_.id()) != 0 || std::rename(written_.c_str(), as.c_str()) != 0) {
        fail(ExitCode::output, "{}: cannot be kept: {}", as.string(), std::strerror(errno));
    }
    written_ = as;
    is_kept_ = true;
}

void FrameStoreWriter::finish() {
    if (is_kept_) return keep(file_);  // what cannot get its name stays, to be gone on from
    handle_.close();
    publish(written_, file_);
}

FrameStore::FrameStore(const fs::path& file) : file_(file) {
    const auto give_up = [&](std::string_view why) {
        fail(ExitCode::output, "{}: {}", file_.string(), why);
    };
    std::string why;
    handle_ = open_plain_file(file, why);
    if (!handle_.is_open()) give_up(why);
    std::uint64_t magic = 0;
    if (!read_at(handle_.id(), 0, &magic, sizeof magic) || !is_magic(magic)) {
        give_up("is not a motion file of this build of swage");
    }
    const auto file_size = static_cast<std::uint64_t>(::lseek(handle_.id(), 0, SEEK_END));
    std::uint64_t at = sizeof magic;
    for (RecordHead head{};;) {
        if (!read_at(handle_.id(), at, &head, sizeof head)) give_up("ends early");
        at += sizeof head;
        if (head.check != check_of(head)) give_up("is damaged");
        if (head.size > file_size - at) give_up("ends early");
        const Place place{at, head.size, head.hash};
        if (head.kind == kSkin)
            skin_.push_back(place);
        else if (head.kind == kMachine)
            machine_.push_back(place);
        else if (head.kind == kFrame)
            frame_.push_back(place);
        else if (head.kind == kImage)
            image_.emplace(head.hash, place);
        else if (head.kind == kFields)
            field_ = fields_in(bytes_at(place));
        else if (head.kind == kEnd)
            break;
        else
            give_up("is damaged");
        at += head.size;
    }
    if (field_.empty() != (magic == kMagic)) give_up("is damaged");
}

std::string FrameStore::bytes_at(const Place& place) const {
    std::string bytes(place.size, '\0');
    if (!read_at(handle_.id(), place.offset, bytes.data(), bytes.size()) ||
        hash_of(bytes) != place.hash) {
        fail(ExitCode::output, "{}: is damaged", file_.string());
    }
    return bytes;
}

StoredFrame FrameStore::frame(int index) const {
    const std::string bytes = bytes_at(frame_.at(static_cast<std::size_t>(index)));
    ByteReader in(bytes);
    StoredFrame frame;
    in(frame.machine);
    frame.body.resize(in.count(0, 1));
    for (StoredBody& body : frame.body) {
        in(body.skin);
        const auto middle = in.get<Vec3>();
        for (const Eigen::Vector3f& away : in.get<std::vector<Eigen::Vector3f>>()) {
            body.position.push_back(middle + away.cast<double>());
        }
    }
    frame.pose.resize(in.count(0, 1));
    for (Pose& pose : frame.pose) in(pose.rotation.coeffs(), pose.translation);
    for (StoredBody& body : frame.body) {
        if (field_.empty()) break;
        in(body.field);
        const bool fits = body.field.size() == field_.size() &&
                          std::all_of(body.field.begin(), body.field.end(), [&](const auto& one) {
                              return one.size() == body.position.size();
                          });
        if (!fits) fail(ExitCode::output, "{}: is damaged", file_.string());
    }
    return frame;
}

template <typename T>
T FrameStore::value_at(const Place& place) const {
    const std::string bytes = bytes_at(place);
    ByteReader in(bytes, [&](std::uint64_t hash) {
        const auto known = image_.find(hash);
        if (known == image_.end()) fail(ExitCode::output, "{}: is damaged", file_.string());
        return std::make_shared<const std::string>(bytes_at(known->second));
    });
    return in.get<T>();
}

TriMesh FrameStore::skin(int index) const {
    return value_at<TriMesh>(skin_.at(static_cast<std::size_t>(index)));
}

std::vector<DrawnPart> FrameStore::machine(int index) const {
    return value_at<std::vector<DrawnPart>>(machine_.at(static_cast<std::size_t>(index)));
}

}  // namespace swage

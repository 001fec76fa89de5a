// SPDX-License-Identifier: GPL-3.0-or-later
// The file: a magic word, then records of kind, size, hash and bytes, each head with a check of its
// own; the last says that the file is whole. It stands there from the start and moves on with every
// record, so that it never wants for room.
#include "pipeline/frame_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "base/atomic_file.h"
#include "base/file_contents.h"
#include "base/hash.h"
#include "pipeline/mesh_bytes.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMagic = 0x3630'6567'6177'7300;  // "\0swage06" on a little-endian machine

enum RecordKind : std::uint32_t { kSkin = 1, kMachine, kFrame, kImage, kEnd };

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

void write_all(int handle, const fs::path& file, std::uint64_t offset, const void* data,
               std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = ::pwrite(handle, at, size, static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            fail(ExitCode::output, "{}: cannot be written: {}", file.string(),
                 std::strerror(errno));
        }
        at += written;
        offset += static_cast<std::uint64_t>(written);
        size -= static_cast<std::size_t>(written);
    }
}

bool read_all(int handle, std::uint64_t offset, void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
        const ssize_t got = ::pread(handle, at, size, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        offset += static_cast<std::uint64_t>(got);
        size -= static_cast<std::size_t>(got);
    }
    return true;
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

}  // namespace

FrameStoreWriter::FrameStoreWriter(const fs::path& file)
    : file_(file),
      temporary_(temporary_for(file)),
      handle_(::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
    if (!handle_.is_open()) {
        fail(ExitCode::output, "{}: cannot be created: {}", file.string(), std::strerror(errno));
    }
    try {
        write_all(handle_.id(), file_, 0, &kMagic, sizeof kMagic);
        size_ = sizeof kMagic;
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
    ::unlink(temporary_.c_str());
}

void FrameStoreWriter::put_end() {
    const RecordHead end = head_of(kEnd, {});
    write_all(handle_.id(), file_, size_, &end, sizeof end);
}

void FrameStoreWriter::put(std::uint32_t kind, const std::string& bytes) {
    const RecordHead head = head_of(kind, bytes);
    const std::uint64_t before = size_;
    try {
        write_all(handle_.id(), file_, size_, &head, sizeof head);
        write_all(handle_.id(), file_, size_ + sizeof head, bytes.data(), bytes.size());
        size_ += sizeof head + bytes.size();
        put_end();
    } catch (const Error&) {
        // The room of the end that stood here is kept.
        size_ = before;
        if (::ftruncate(handle_.id(), static_cast<off_t>(size_ + sizeof head)) == 0) put_end();
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
    put_mesh(out, skin);
    put(kSkin, out.bytes());
    return skins_++;
}

int FrameStoreWriter::add_machine(const std::vector<DrawnPart>& parts) {
    ByteWriter out;
    out.put<std::uint64_t>(parts.size());
    for (const DrawnPart& part : parts) {
        out.put_text(part.name);
        put_images(part.surface);
        put_mesh(out, part.surface);
        out.put(part.color);
        out.put(part.finish);
    }
    put(kMachine, out.bytes());
    return machines_++;
}

void FrameStoreWriter::add_frame(const StoredFrame& frame) {
    ByteWriter out;
    out.put(frame.machine);
    out.put<std::uint64_t>(frame.body.size());
    for (const StoredBody& body : frame.body) {
        out.put(body.skin);
        const Vec3 middle = median(body.position);
        std::vector<Eigen::Vector3f> away;
        away.reserve(body.position.size());
        for (const Vec3& p : body.position) away.push_back((p - middle).cast<float>());
        out.put(middle);
        out.put_array(away);
    }
    out.put<std::uint64_t>(frame.pose.size());
    for (const Pose& pose : frame.pose) {
        for (int c = 0; c < 4; ++c) out.put(pose.rotation.coeffs()[c]);
        out.put(pose.translation);
    }
    put(kFrame, out.bytes());
}

void FrameStoreWriter::finish() {
    handle_.close();
    publish(temporary_, file_);
}

FrameStore::FrameStore(const fs::path& file) : file_(file) {
    const auto give_up = [&](std::string_view why) {
        fail(ExitCode::output, "{}: {}", file_.string(), why);
    };
    std::string why;
    handle_ = open_plain_file(file, why);
    if (!handle_.is_open()) give_up(why);
    std::uint64_t magic = 0;
    if (!read_all(handle_.id(), 0, &magic, sizeof magic) || magic != kMagic) {
        give_up("is no motion file of the kind that this build of swage writes");
    }
    const auto file_size = static_cast<std::uint64_t>(::lseek(handle_.id(), 0, SEEK_END));
    std::uint64_t at = sizeof magic;
    for (RecordHead head{};;) {
        if (!read_all(handle_.id(), at, &head, sizeof head)) give_up("ends early");
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
        else if (head.kind == kEnd)
            break;
        else
            give_up("is damaged");
        at += head.size;
    }
}

std::string FrameStore::bytes_at(const Place& place) const {
    std::string bytes(place.size, '\0');
    if (!read_all(handle_.id(), place.offset, bytes.data(), bytes.size()) ||
        hash_of(bytes) != place.hash) {
        fail(ExitCode::output, "{}: is damaged", file_.string());
    }
    return bytes;
}

StoredFrame FrameStore::frame(int index) const {
    const std::string bytes = bytes_at(frame_.at(static_cast<std::size_t>(index)));
    ByteReader in(bytes);
    StoredFrame frame;
    frame.machine = in.get<int>();
    frame.body.resize(in.get<std::uint64_t>());
    for (StoredBody& body : frame.body) {
        body.skin = in.get<int>();
        const auto middle = in.get<Vec3>();
        for (const Eigen::Vector3f& away : in.get_array<Eigen::Vector3f>()) {
            body.position.push_back(middle + away.cast<double>());
        }
    }
    frame.pose.resize(in.get<std::uint64_t>());
    for (Pose& pose : frame.pose) {
        for (int c = 0; c < 4; ++c) pose.rotation.coeffs()[c] = in.get<double>();
        pose.translation = in.get<Vec3>();
    }
    return frame;
}

TriMesh FrameStore::mesh_from(ByteReader& in) const {
    return get_mesh(in, [&](std::uint64_t hash) {
        const auto known = image_.find(hash);
        if (known == image_.end()) fail(ExitCode::output, "{}: is damaged", file_.string());
        return std::make_shared<const std::string>(bytes_at(known->second));
    });
}

TriMesh FrameStore::skin(int index) const {
    const std::string bytes = bytes_at(skin_.at(static_cast<std::size_t>(index)));
    ByteReader in(bytes);
    return mesh_from(in);
}

std::vector<DrawnPart> FrameStore::machine(int index) const {
    const std::string bytes = bytes_at(machine_.at(static_cast<std::size_t>(index)));
    ByteReader in(bytes);
    std::vector<DrawnPart> parts(in.get<std::uint64_t>());
    for (DrawnPart& part : parts) {
        part.name = in.get_text();
        part.surface = mesh_from(in);
        part.color = in.get<Vec3>();
        part.finish = in.get<Finish>();
    }
    return parts;
}

}  // namespace swage

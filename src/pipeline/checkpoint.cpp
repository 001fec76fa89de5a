// SPDX-License-Identifier: GPL-3.0-or-later
// The file: a magic word, what is kept, and a hash of that.
#include "pipeline/checkpoint.h"

#include <cstring>
#include <string_view>

#include "base/atomic_file.h"
#include "base/file_contents.h"
#include "base/hash.h"
#include "pipeline/work_piece_bytes.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMagic = 0x3330'7063'6177'7300;  // "\0swacp03" on a little-endian machine

template <typename Io>
void visit_json(Io& io, Json& json) {
    std::string text = json_text(json);
    io(text);
    if constexpr (Io::kReads) json = Json::parse(text);
}

struct Head {
    int stages = 0;
    std::string key;
};
constexpr std::size_t kLongestHead = 256;

Head head_of(const StageKeys& keys, int stages) {
    return {stages, keys.at(static_cast<std::size_t>(stages))};
}
bool is_of(const StageKeys& keys, const Head& head) {
    return head.stages > 0 && static_cast<std::size_t>(head.stages) < keys.size() &&
           keys[static_cast<std::size_t>(head.stages)] == head.key;
}

}  // namespace

template <typename Io>
void visit(Io& io, Head& head) {
    auto& [stages, key] = head;
    io(stages, key);
}

template <typename Io>
void visit(Io& io, MotionMark& mark) {
    auto& [size, hash] = mark;
    io(size, hash);
}

template <typename Io>
void visit(Io& io, Reached& reached) {
    auto& [stages, bodies, matter, stage, start_warning, warning, steps, seconds, motion, skin] =
        reached;
    io(stages, bodies);
    visit_json(io, matter);
    visit_json(io, stage);
    io(start_warning, warning, steps, seconds, motion, skin);
}

void write_checkpoint(const fs::path& file, const StageKeys& keys, const Reached& reached) {
    ByteWriter out(true);
    out(kMagic, head_of(keys, reached.stages), state_hash(reached.bodies), reached);
    out(hash_of(std::string_view(out.bytes()).substr(sizeof kMagic)));
    write_file_whole(file, out.bytes());
}

int stages_kept(const fs::path& file, const StageKeys& keys) {
    std::string why;
    const FileHandle handle = open_plain_file(file, why);
    std::string bytes(kLongestHead, '\0');
    const auto got = handle.is_open() ? read_up_to(handle.id(), bytes.data(), bytes.size())
                                      : std::optional<std::size_t>(0);
    try {
        ByteReader in(std::span(bytes.data(), got.value_or(0)));
        if (in.get<std::uint64_t>() != kMagic) return 0;
        const auto head = in.get<Head>();
        return is_of(keys, head) ? head.stages : 0;
    } catch (const Error&) {
        return 0;
    }
}

std::optional<Reached> read_checkpoint(const fs::path& file, const StageKeys& keys,
                                       std::string& why) {
    why.clear();
    std::error_code unknown;
    if (!fs::exists(file, unknown)) return std::nullopt;
    const FileHandle handle = open_plain_file(file, why);
    if (!handle.is_open()) return std::nullopt;
    // However long what is none may be.
    std::uint64_t magic = 0, hash = 0;
    if (read_up_to(handle.id(), &magic, sizeof magic) != sizeof magic || magic != kMagic) {
        why = "is damaged";
        return std::nullopt;
    }
    const std::optional<std::string> bytes = rest_of_file(handle.id(), kAnyLength, why);
    if (!bytes) return std::nullopt;
    why = "is damaged";
    if (bytes->size() < sizeof hash) return std::nullopt;
    const std::string_view hashed(bytes->data(), bytes->size() - sizeof hash);
    std::memcpy(&hash, hashed.data() + hashed.size(), sizeof hash);
    if (hash != hash_of(hashed)) return std::nullopt;
    try {
        ByteReader in(hashed);
        const auto head = in.get<Head>();
        if (!is_of(keys, head)) {
            why = "is of another run, or of another build of swage";
            return std::nullopt;
        }
        in(hash);
        auto reached = in.get<Reached>();
        if (in.left() > 0 || reached.stages != head.stages ||
            reached.skin.size() != reached.bodies.size() || state_hash(reached.bodies) != hash) {
            return std::nullopt;
        }
        return reached;
    } catch (const Error&) {
    } catch (const Json::exception&) {
    }
    return std::nullopt;
}

}  // namespace swage

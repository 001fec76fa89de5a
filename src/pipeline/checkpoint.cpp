// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/checkpoint.h"

#include "pipeline/sealed_file.h"
#include "pipeline/work_piece_bytes.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMagic = 0x3531'7063'6177'7300;  // "\0swacp15" on a little-endian machine

template <typename Io>
void visit_json(Io& io, Json& json) {
    std::string text = json_text(json);
    io(text);
    if constexpr (Io::kReads) json = parse_json(text);
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
void visit(Io& io, Reached& reached) {
    auto& [stages, bodies, contacts, matter, stage, start_warning, warning, steps, seconds, motion,
           skin, foreseen] = reached;
    io(stages, bodies, contacts);
    visit_json(io, matter);
    visit_json(io, stage);
    io(start_warning, warning, steps, seconds, motion, skin, foreseen);
}

void write_checkpoint(const fs::path& file, const StageKeys& keys, const Reached& reached) {
    write_sealed(file, kMagic, [&](ByteWriter& out) {
        out(head_of(keys, reached.stages), state_hash(reached.bodies), reached);
    });
}

bool is_kept(const fs::path& file, const StageKeys& keys, int stages) {
    const std::string bytes = start_of_sealed(file, kMagic, kLongestHead);
    try {
        const auto head = ByteReader(bytes).get<Head>();
        return head.stages == stages && is_of(keys, head);
    } catch (const Error&) {
        return false;
    }
}

std::optional<Reached> read_checkpoint(const fs::path& file, const StageKeys& keys,
                                       std::string& why) {
    const std::optional<std::string> bytes = read_sealed(file, kMagic, why);
    if (!bytes) return std::nullopt;
    try {
        ByteReader in(*bytes);
        const auto head = in.get<Head>();
        if (!is_of(keys, head)) {
            why = "belongs to another run or another build of swage";
            return std::nullopt;
        }
        const auto hash = in.get<std::uint64_t>();
        auto reached = in.get<Reached>();
        if (in.left() == 0 && reached.stages == head.stages &&
            reached.skin.size() == reached.bodies.size() && state_hash(reached.bodies) == hash) {
            return reached;
        }
    } catch (const Error&) {
    } catch (const Json::exception&) {
    }
    why = "is damaged";
    return std::nullopt;
}

}  // namespace swage

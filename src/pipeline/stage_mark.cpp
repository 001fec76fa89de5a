// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_mark.h"

#include "pipeline/sealed_file.h"
#include "pipeline/work_piece_bytes.h"

namespace swage {

namespace {

constexpr std::uint64_t kMagic = 0x3230'6d61'6177'7300;  // "\0swam02" on a little-endian machine

// Of the run up to the end of the stage.
const std::string& key_of(const StageKeys& keys, int stages) {
    return keys.at(static_cast<std::size_t>(stages) + 1);
}

}  // namespace

template <typename Io>
void visit(Io& io, StageMark& mark) {
    auto& [stages, frame, motion, skin, seconds, bodies, bytes, state] = mark;
    io(stages, frame, motion, skin, seconds);
}

std::size_t write_stage_mark(const std::filesystem::path& file, const StageKeys& keys,
                             const StageMark& mark, const std::vector<WorkPiece>& bodies,
                             const std::function<void(ByteWriter&)>& state) {
    return write_sealed(file, kMagic, [&](ByteWriter& out) {
        out(key_of(keys, mark.stages), mark, bodies);
        state(out);
    });
}

std::optional<StageMark> read_stage_mark(const std::filesystem::path& file, const StageKeys& keys,
                                         int stages, std::string& why) {
    std::optional<std::string> bytes = read_sealed(file, kMagic, why);
    if (!bytes) return std::nullopt;
    try {
        ByteReader in(*bytes);
        if (in.get<std::string>() != key_of(keys, stages)) {
            why = "belongs to another run or another build of swage";
            return std::nullopt;
        }
        auto mark = in.get<StageMark>();
        in(mark.bodies);
        mark.state = bytes->size() - in.left();
        if (mark.stages == stages && mark.skin.size() == mark.bodies.size()) {
            mark.bytes = std::move(*bytes);
            return mark;
        }
    } catch (const Error&) {
    }
    why = "is damaged";
    return std::nullopt;
}

}  // namespace swage

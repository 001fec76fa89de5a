// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/passes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include "base/atomic_file.h"
#include "pipeline/json.h"
#include "pipeline/part_look.h"
#include "render/exr.h"
#include "render/png.h"

namespace swage {

namespace {

constexpr double kGolden = 0.6180339887498949;  // of a turn of hue: neighbours lie far apart

// `hue` 0 to 1, from red over green and blue.
MatteColor color_of(double hue, int strength) {
    const double share[] = {std::abs(6 * hue - 3) - 1, 2 - std::abs(6 * hue - 2),
                            2 - std::abs(6 * hue - 4)};
    MatteColor color{};
    for (std::size_t c = 0; c < 3; ++c) {
        color[c] =
            static_cast<std::uint8_t>(std::lround(strength * std::clamp(share[c], 0.0, 1.0)));
    }
    return color;
}

// Of four numbers a pixel.
std::vector<ExrChannel> channels_of(const std::array<const char*, 4>& names, bool half,
                                    const float* values, std::size_t pixels) {
    std::vector<ExrChannel> channels;
    for (std::size_t c = 0; c < names.size(); ++c) {
        channels.push_back({names[c], {}, half});
        for (std::size_t i = 0; i < pixels; ++i) channels[c].value.push_back(values[4 * i + c]);
    }
    return channels;
}

}  // namespace

std::vector<MatteColor> matte_colors(std::size_t count) {
    constexpr std::uint32_t kSteps = 16, kScatter = 0x9e3779;  // odd: each code comes once
    std::vector<MatteColor> colors = {{0, 0, 0}, {128, 128, 128}};
    std::set<MatteColor> taken(colors.begin(), colors.end());
    for (std::size_t n = colors.size(); n < count; ++n) {
        const double turned = kGolden * static_cast<double>(n);
        MatteColor color = color_of(turned - std::floor(turned), n % 2 == 0 ? 255 : 150);
        for (std::uint32_t k = 0; !taken.insert(color).second; ++k) {
            if (k < kSteps) {
                color[n % 3] = std::uint8_t(color[n % 3] + 1);
            } else {  // of thousands: any that is left
                const std::uint32_t code = (static_cast<std::uint32_t>(n) + k) * kScatter;
                for (int c : {0, 1, 2}) color[c] = std::uint8_t(code >> 8 * c);
            }
        }
        colors.push_back(color);
    }
    colors.resize(count);
    return colors;
}

PassWriter::PassWriter(const FrameStore& store, const RenderSettings& settings,
                       const DrawnFiles& files, const RunNames& names, const Quat& drawn_from_world)
    : store_(store),
      settings_(settings),
      files_(files),
      names_(names),
      world_from_drawn_(drawn_from_world.conjugate().toRotationMatrix()),
      bodies_(store.frame_count() > 0 ? store.frame(0).body.size() : 0) {
    int next = 2 + static_cast<int>(bodies_);
    for (int machine = 0; machine < store.machine_count(); ++machine) {
        first_part_.push_back(next);
        next += static_cast<int>(store.machine(machine).size());
    }
    if (settings_.has(PicturePass::piece)) {
        pieces_.emplace(store_, names.piece);
        for (std::size_t b = 0; b < bodies_; ++b) {
            first_piece_.push_back(next);
            next += pieces_->count(b) - 1;
        }
    }
    color_ = matte_colors(static_cast<std::size_t>(next));
}

int PassWriter::number_of_piece(std::size_t body, int piece) const {
    return piece == 0 ? number_of_body(body) : first_piece_.at(body) + piece - 1;
}

std::vector<int> PassWriter::pieces_of(std::size_t body, int skin, const TriMesh& mesh) const {
    return pieces_ ? pieces_->of_triangles(body, skin, mesh) : std::vector<int>();
}

template <typename NumberOf>
void PassWriter::write_colors(int frame, PicturePass pass, const Layers& layers,
                              const NumberOf& number_of) const {
    Image flat{layers.width, layers.height, {}};
    flat.rgb.reserve(3 * layers.item.size());
    for (std::size_t i = 0; i < layers.item.size(); ++i) {
        const int item = layers.item[i];
        const int whose = item == kNothingThere ? 0 : item == kGroundThere ? 1 : number_of(i, item);
        const MatteColor& color = color_.at(std::size_t(whose));
        flat.rgb.insert(flat.rgb.end(), color.begin(), color.end());
    }
    write_png(files_.pass(frame, pass), flat);
}

int PassWriter::number_of_part(int machine, std::size_t part) const {
    return first_part_.at(std::size_t(machine)) + static_cast<int>(part);
}

void PassWriter::write(int frame, int machine, const PassPicture& picture) {
    const Layers& layers = picture.layers;
    first_frame_.try_emplace(machine, frame);
    const auto write_floats = [&](PicturePass pass, const std::vector<ExrChannel>& channels) {
        write_file_whole(files_.pass(frame, pass),
                         encode_exr(layers.width, layers.height, channels));
    };
    if (settings_.has(PicturePass::depth)) {
        write_floats(PicturePass::depth, {{"depth.Z", layers.depth}});
    }
    if (settings_.has(PicturePass::normal)) {
        std::vector<ExrChannel> channels = {{"normal.X", {}}, {"normal.Y", {}}, {"normal.Z", {}}};
        const Eigen::Matrix3f turn = world_from_drawn_.cast<float>();
        for (const Eigen::Vector3f& drawn : layers.normal) {
            const Eigen::Vector3f world = turn * drawn;
            for (int k = 0; k < 3; ++k) channels[std::size_t(k)].value.push_back(world[k]);
        }
        write_floats(PicturePass::normal, channels);
    }
    // Channels are called as Nuke calls those of its layer "motion".
    if (settings_.has(PicturePass::motion)) {
        write_floats(PicturePass::motion,
                     channels_of({"forward.u", "forward.v", "backward.u", "backward.v"}, false,
                                 picture.motion.front().data(), picture.motion.size()));
    }
    if (settings_.has(PicturePass::beauty)) {
        write_floats(PicturePass::beauty,
                     channels_of({"R", "G", "B", "A"}, true, layers.beauty.data(),
                                 layers.beauty.size() / 4));
    }
    const auto number_of = [&](int item) { return picture.number.at(std::size_t(item)); };
    if (settings_.has(PicturePass::matte)) {
        write_colors(frame, PicturePass::matte, layers,
                     [&](std::size_t, int item) { return number_of(item); });
    }
    if (settings_.has(PicturePass::piece)) {
        write_colors(frame, PicturePass::piece, layers, [&](std::size_t pixel, int item) {
            const auto body = static_cast<std::size_t>(item);
            const int triangle = layers.triangle.at(pixel);
            if (body >= bodies_ || triangle < 0) return number_of(item);
            return number_of_piece(body, picture.piece.at(body).at(std::size_t(triangle)));
        });
    }
}

void PassWriter::finish() const {
    for (const PicturePass pass : settings_.passes) {
        if (is_colored(pass)) write_table(pass);
    }
}

void PassWriter::write_table(PicturePass pass) const {
    Json all = Json::array();
    const auto add = [&](int number, const char* kind, const std::string& name) -> Json& {
        all.push_back({{"number", number},
                       {"color", color_.at(std::size_t(number))},
                       {"is", kind},
                       {"name", name}});
        return all.back();
    };
    add(0, "nothing", "nothing");
    if (settings_.ground) add(1, "ground", "ground");
    for (std::size_t b = 0; b < bodies_; ++b) {
        const std::string name =
            b < names_.body.size() ? names_.body[b] : fmt::format("body-{}", b + 1);
        if (pass == PicturePass::matte) add(number_of_body(b), "body", name);
        for (int p = 0; pass == PicturePass::piece && p < pieces_->count(b); ++p) {
            Json& piece = add(number_of_piece(b, p), "piece", name);
            piece["piece"] = p + 1;
            piece["from_frame"] = pieces_->first_frame(b, p) + files_.first_frame - 1;
        }
    }
    for (const auto& [machine, frame] : first_frame_) {
        if (!settings_.tools || machine < 0 || machine >= store_.machine_count()) continue;
        const std::vector<DrawnPart> parts = store_.machine(machine);
        for (std::size_t n = 0; n < parts.size(); ++n) {
            if (!look_of(parts[n], settings_)) continue;
            add(number_of_part(machine, n), "tool", parts[n].name)["stage"] =
                stage_of_machine(names_.stage, machine, frame);
        }
    }
    const std::string list = std::string(kPassName[std::size_t(pass)]) + "s";
    write_file_whole(files_.table(pass), json_text({{list, all}}));
}

}  // namespace swage

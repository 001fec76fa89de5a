// SPDX-License-Identifier: GPL-3.0-or-later
// The field goes into texture coordinates and the colour map into the texture, so that between
// vertices it is the number that goes evenly and not its colour.
#include "pipeline/field_look.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "render/color_map.h"
#include "render/legend.h"
#include "render/png.h"

namespace swage {

namespace {

constexpr double kMatt = 0.85;  // roughness: highlights would hide the colours

constexpr double kBeyond = 1e-3;  // of a range, what lies less beyond it nobody sees

// Least and greatest of all frames.
std::array<double, 2> extent_of(const FrameStore& store, std::size_t number) {
    std::array<double, 2> extent = {0, 0};
    bool has_any = false;
    for (int f = 0; f < store.frame_count(); ++f) {
        for (const StoredBody& body : store.frame(f).body) {
            for (const double value : body.field[number]) {
                if (!std::isfinite(value)) continue;
                extent[0] = has_any ? std::min(extent[0], value) : value;
                extent[1] = has_any ? std::max(extent[1], value) : value;
                has_any = true;
            }
        }
    }
    return extent;
}

std::array<double, 2> range_of(std::array<double, 2> extent, bool is_signed) {
    if (!is_signed) extent[0] = 0;
    // Nothing anywhere, as before anything has flowed.
    if (!(extent[0] < extent[1])) extent[1] = extent[0] + std::max(1.0, std::abs(extent[0]));
    return extent;
}

}  // namespace

FieldLook::FieldLook(const FrameStore& store, const RenderSettings& settings)
    : field_(*settings.color) {
    const std::vector<SkinField>& held = store.fields();
    const auto at = std::find(held.begin(), held.end(), field_);
    if (at == held.end()) {
        std::vector<std::string> names;
        for (const SkinField one : held) names.emplace_back(words_of(one).name);
        fail(ExitCode::command_line,
             "the run contains no {}{}; it needs [output] fields = [\"{}\"] in its scene",
             words_of(field_).name, names.empty() ? "" : ", only " + joined(names, ", "),
             words_of(field_).name);
    }
    number_ = static_cast<std::size_t>(at - held.begin());
    extent_ = extent_of(store, number_);
    range_ = settings.color_range ? *settings.color_range
                                  : range_of(extent_, words_of(field_).is_signed);
    look_.name = words_of(field_).name;
    look_.color = Vec3::Ones();
    look_.roughness = kMatt;
    look_.embedded_texture = std::make_shared<const std::string>(encode_png(color_strip(scale())));
}

ColorScale FieldLook::scale() const {
    return color_scale(range_[0], range_[1], words_of(field_).is_signed);
}

void FieldLook::dress(const StoredBody& body, TriMesh& skin) const {
    skin.position_color.clear();
    skin.triangle_material.clear();
    skin.material = {look_};
    skin.triangle_uv = skin.triangle;
    skin.uv.clear();
    for (const double value : body.field[number_]) {
        const double share = (value - range_[0]) / (range_[1] - range_[0]);
        const double shown = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0;
        skin.uv.emplace_back(kMapEnd + (1 - 2 * kMapEnd) * shown, 0.5);
    }
}

std::array<bool, 2> FieldLook::beyond() const {
    const double least = kBeyond * (range_[1] - range_[0]);
    return {(extent_[0] < range_[0] - least), (extent_[1] > range_[1] + least)};
}

bool FieldLook::add_legend(Image& image) const {
    const SkinFieldWords& words = words_of(field_);
    Legend legend = make_legend(words.title, words.unit, range_[0], range_[1]);
    legend.scale = scale();
    legend.below = beyond()[0];
    legend.above = beyond()[1];
    return draw_legend(legend, image);
}

}  // namespace swage

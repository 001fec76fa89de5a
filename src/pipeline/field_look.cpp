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

std::array<double, 2> range_of(const FrameStore& store, std::size_t number, bool is_signed) {
    std::array<double, 2> range = {0, 0};
    bool has_any = false;
    for (int f = 0; f < store.frame_count(); ++f) {
        for (const StoredBody& body : store.frame(f).body) {
            for (const double value : body.field[number]) {
                if (!std::isfinite(value)) continue;
                range[0] = has_any ? std::min(range[0], value) : value;
                range[1] = has_any ? std::max(range[1], value) : value;
                has_any = true;
            }
        }
    }
    if (!is_signed) range[0] = 0;
    // Nothing anywhere, as before anything has flowed.
    if (!(range[0] < range[1])) range[1] = range[0] + std::max(1.0, std::abs(range[0]));
    return range;
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
             "the run holds no {}{}; a run holds what [output] fields = [\"{}\"] in its scene asks",
             words_of(field_).name, names.empty() ? "" : ", but " + joined(names, ", "),
             words_of(field_).name);
    }
    number_ = static_cast<std::size_t>(at - held.begin());
    range_ = settings.color_range ? *settings.color_range
                                  : range_of(store, number_, words_of(field_).is_signed);
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

void FieldLook::add_legend(Image& image) const {
    const SkinFieldWords& words = words_of(field_);
    Legend legend = make_legend(words.title, words.unit, range_[0], range_[1]);
    legend.scale = scale();
    draw_legend(legend, image);
}

}  // namespace swage

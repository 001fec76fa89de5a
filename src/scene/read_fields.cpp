// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_fields.h"

#include <algorithm>

#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

std::vector<std::string> field_names() {
    std::vector<std::string> names;
    for (const SkinFieldWords& words : kSkinFieldWords) names.emplace_back(words.name);
    return names;
}

}  // namespace

void read_fields(TableReader& output, std::vector<SkinField>& fields) {
    const std::vector<std::string> names = field_names();
    output.describe("fields", "texts [\"" + joined(names, "\", \"") + "\"], or some of these",
                    "none");
    const Node* node = output.find("fields");
    if (node == nullptr) return;
    if (node->kind != Node::Kind::array) {
        output.mistake("fields", "fields has to be a list of texts, such as [\"stress\"]");
        return;
    }
    for (const Node& item : node->item) {
        const std::optional<SkinField> field =
            item.kind == Node::Kind::text ? skin_field_named(item.text) : std::nullopt;
        if (field && std::find(fields.begin(), fields.end(), *field) == fields.end()) {
            fields.push_back(*field);
        } else if (!field) {
            const std::string said = item.kind == Node::Kind::text ? item.text : "";
            output.reading().mistakes.add(
                item.place, fmt::format("fields: {} is not one of {}{}",
                                        said.empty() ? kind_text(item) : '"' + said + '"',
                                        joined(names, ", "), did_you_mean(said, names)));
        }
    }
}

void read_field_color(TableReader& render, RenderSettings& settings) {
    std::vector<std::pair<std::string, std::optional<SkinField>>> choices;
    for (const SkinFieldWords& words : kSkinFieldWords) {
        choices.emplace_back(words.name, skin_field_named(words.name));
    }
    render.choice("color", choices, settings.color);
    const bool is_plain = settings.color && *words_of(*settings.color).unit == 0;
    std::array<double, 2> range{};
    if (!render.ends("color_range", is_plain ? Quantity::number : Quantity::stress, range)) return;
    if (range[0] < range[1]) settings.color_range = range;
    if (render.find("color") == nullptr) {
        render.mistake("color_range", "color_range is of a color, which is not there");
    }
}

void add_drawn_field(const RenderSettings& settings, std::vector<SkinField>& fields) {
    if (!settings.color) return;
    if (std::find(fields.begin(), fields.end(), *settings.color) != fields.end()) return;
    fields.push_back(*settings.color);
}

}  // namespace swage

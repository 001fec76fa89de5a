// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_fields.h"

#include <algorithm>
#include <sstream>

#include "base/suggest.h"
#include "base/text.h"

namespace swage {

namespace {

// "depth, motion" as the list that was meant, of those that there are; else `example` in one.
std::string as_list(const Node& node, const std::vector<std::string>& names,
                    const std::string& example) {
    std::vector<std::string> meant;
    std::istringstream parts(node.kind == Node::Kind::text ? node.text : "");
    for (std::string part; std::getline(parts, part, ',');) {
        std::erase(part, ' ');
        if (std::find(names.begin(), names.end(), part) != names.end()) meant.push_back(part);
    }
    if (meant.empty()) meant = {example};
    return "[\"" + joined(meant, "\", \"") + "\"]";
}

// A list of texts of these, none twice; numbers in `names`.
std::vector<std::size_t> read_list(TableReader& table, const std::string& key,
                                   const std::vector<std::string>& names, const char* example) {
    std::vector<std::size_t> chosen;
    table.describe(key, "any of [\"" + joined(names, "\", \"") + "\"]", "none");
    const Node* node = table.find(key);
    if (node == nullptr) return chosen;
    if (node->kind != Node::Kind::array) {
        table.mistake(key, fmt::format("{} must be a list of texts, such as {}", key,
                                       as_list(*node, names, example)));
        return chosen;
    }
    for (const Node& item : node->item) {
        const std::string said = item.kind == Node::Kind::text ? item.text : "";
        const auto at = std::find(names.begin(), names.end(), said);
        const auto number = static_cast<std::size_t>(at - names.begin());
        if (at == names.end()) {
            table.reading().mistakes.add(
                item.place, fmt::format("{}: {} is not one of {}{}", key,
                                        said.empty() ? kind_text(item) : '"' + said + '"',
                                        joined(names, ", "), did_you_mean(said, names)));
        } else if (std::find(chosen.begin(), chosen.end(), number) == chosen.end()) {
            chosen.push_back(number);
        }
    }
    return chosen;
}

}  // namespace

void read_fields(TableReader& output, std::vector<SkinField>& fields) {
    std::vector<std::string> names;
    for (const SkinFieldWords& words : kSkinFieldWords) names.emplace_back(words.name);
    for (const std::size_t number : read_list(output, "fields", names, "stress")) {
        fields.push_back(*skin_field_named(names[number]));
    }
}

void read_passes(TableReader& render, std::vector<PicturePass>& passes) {
    for (const std::size_t number :
         read_list(render, "passes", {kPassName.begin(), kPassName.end()}, "depth")) {
        passes.push_back(static_cast<PicturePass>(number));
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
        render.mistake("color_range", "color_range needs a color beside it");
    }
}

void add_drawn_field(const RenderSettings& settings, std::vector<SkinField>& fields) {
    if (!settings.color) return;
    if (std::find(fields.begin(), fields.end(), *settings.color) != fields.end()) return;
    fields.push_back(*settings.color);
}

}  // namespace swage

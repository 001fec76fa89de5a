// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_look.h"

#include "scene/read_color.h"

namespace swage {

void read_look(TableReader& table, std::optional<SurfaceMaterial>& look) {
    table.describe("look", "{color = [red, green, blue], roughness, metalness, clear}");
    const Node* node = table.find("look");
    if (node == nullptr) return;
    if (node->kind != Node::Kind::table) {
        table.mistake("look",
                      "look must be a table, such as look = {color = [0.98, 0.82, 0.76], roughness "
                      "= 0.3, metalness = 1}");
        return;
    }
    TableReader one(*node, "look", table.reading());
    SurfaceMaterial found = look.value_or(SurfaceMaterial());
    std::optional<Vec3> color;
    read_color(one, color);
    if (color) found.color = *color;
    if (!color && !look) one.missing("color", "[red, green, blue], each 0 to 1 as on a screen");
    const Range share = between(0, 1);
    one.quantity("roughness", Quantity::number, share, found.roughness);
    one.quantity("metalness", Quantity::number, share, found.metallic);
    one.quantity("clear", Quantity::number, share, found.clear);
    if (found.metallic + found.clear > 1) {
        one.mistake("clear",
                    "metal lets no light through: metalness and clear must add up to at most 1");
    }
    one.finish();
    look = found;
}

}  // namespace swage

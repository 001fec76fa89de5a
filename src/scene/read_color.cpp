// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_color.h"

#include <fmt/format.h>

#include "base/srgb.h"

namespace swage {

void read_color(TableReader& table, std::optional<Vec3>& color, const std::string& key) {
    Vec3 seen = Vec3::Zero();
    if (!table.vector(key, Quantity::number, seen)) return;
    if ((seen.array() < 0).any() || (seen.array() > 1).any()) {
        table.mistake(
            key, fmt::format("{} = [{:g}, {:g}, {:g}]: red, green and blue must each be 0 to 1",
                             key, seen.x(), seen.y(), seen.z()));
    }
    color =
        Vec3(linear_from_srgb(seen.x()), linear_from_srgb(seen.y()), linear_from_srgb(seen.z()));
}

}  // namespace swage

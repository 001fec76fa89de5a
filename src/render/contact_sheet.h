// SPDX-License-Identifier: GPL-3.0-or-later
// Many small pictures on one sheet.
#pragma once

#include <array>
#include <vector>

#include "render/image.h"

namespace swage {

// Scaled by the mean over each new pixel's area, in linear light. A picture is never enlarged by
// smoothing: above its own size pixels repeat. Sides are at least 1.
Image scaled(const Image& image, int width, int height);
// The same, no wider and no higher than told, keeping its proportions.
Image thumbnail(const Image& image, int largest_width, int largest_height);

struct SheetStyle {
    int gap = 10;  // between pictures and around them [pixel]
    std::array<std::uint8_t, 3> paper = {32, 34, 37};
};

// Row by row from the top left; cells as large as the largest picture, which stand centred in
// them. Throws Error(output) when there is no picture.
Image contact_sheet(const std::vector<Image>& thumbnails, int columns,
                    const SheetStyle& style = {});

}  // namespace swage
